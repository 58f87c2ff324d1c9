"""A planar laser scanner: distances to people and walls along evenly spaced beams."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Pose, Scene, SpatialPose, kernel
from crowdbot.core.geometry import nearest_on_segment, ray_to_disc, ray_to_segment

from .beams import Beams, beams, fan
from .cast import cast
from .noise import Randomness
from .ranging import Ranging, ended, incidence_of, settled
from .sensor import Reading, spatial_pose
from .shapes import FLOOR, NOTHING, OVERLAP, PROP, lengthened
from .shapes import WALLS as WALL
from .view import SensorView

__all__ = ["FLOOR", "NOTHING", "PROP", "WALL", "Lidar2D", "Scan"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

TURN = 2.0 * math.pi


@kernel
def _stretches(low: float, width: float, first: float, step: float, count: int) -> tuple[int, int, int, int]:
    """Return the beams from angle low over width, one beam more at each side, as two stretches begin, end."""
    low = (low - first) % TURN
    begin = max(0, math.floor(low / step) - 1)
    end = min(count, math.ceil((low + width) / step) + 2)
    before = max(0, math.floor((low - TURN) / step) - 1)
    after = min(count, math.ceil((low + width - TURN) / step) + 2)
    return begin, end, before, after


@kernel
def _see_disc(
    x: float, y: float, first: float, step: float, ux: Floats, uy: Floats,
    cx: float, cy: float, radius: float, agent: int, distance: Floats, facing: Floats, hit: Indices,
) -> None:  # fmt: skip
    count = len(ux)
    away = math.sqrt((cx - x) ** 2 + (cy - y) ** 2)
    begin, end, before, after = 0, count, 0, 0
    if away > radius:
        half = math.asin(radius / away)
        begin, end, before, after = _stretches(math.atan2(cy - y, cx - x) - half, 2.0 * half, first, step, count)
    for part in range(2):
        for k in range(begin if part == 0 else before, end if part == 0 else after):
            reach = ray_to_disc(x, y, ux[k], uy[k], cx, cy, radius)
            if reach < distance[k]:
                distance[k] = reach
                hit[k] = agent
                facing[k] = 1.0
                if reach > 0.0:
                    facing[k] = ((cx - x - reach * ux[k]) * ux[k] + (cy - y - reach * uy[k]) * uy[k]) / radius


@kernel
def _see_wall(
    x: float, y: float, first: float, step: float, ux: Floats, uy: Floats,
    wall: Floats, limit: float, distance: Floats, facing: Floats, hit: Indices,
) -> None:  # fmt: skip
    ax, ay, bx, by = wall[0], wall[1], wall[2], wall[3]
    nx, ny = nearest_on_segment(x, y, ax, ay, bx, by)
    near = math.sqrt((nx - x) ** 2 + (ny - y) ** 2)
    if near > limit:
        return
    count = len(ux)
    begin, end, before, after = 0, count, 0, 0
    if near > OVERLAP:
        low = math.atan2(ay - y, ax - x)
        width = (math.atan2(by - y, bx - x) - low + math.pi) % TURN - math.pi
        if abs(width) < math.pi - 1e-6:
            begin, end, before, after = _stretches(low + min(width, 0.0), abs(width), first, step, count)
    length = math.sqrt((bx - ax) ** 2 + (by - ay) ** 2)
    for part in range(2):
        for k in range(begin if part == 0 else before, end if part == 0 else after):
            reach = ray_to_segment(x, y, ux[k], uy[k], ax, ay, bx, by)
            if reach < distance[k]:
                distance[k] = reach
                hit[k] = WALL
                facing[k] = abs(ux[k] * (by - ay) - uy[k] * (bx - ax)) / length


@kernel
def _scan(
    place: Floats, heading: Floats, angles: Floats, step: float, centre: Floats, radius: Floats,
    active: NDArray[np.bool_], walls: Floats, limit: float,
) -> tuple[Floats, Floats, Indices]:  # fmt: skip
    """Return the distance to the nearest surface, the cosine of the incidence there and what it belongs to."""
    environments, count = len(place), len(angles)
    distance = np.full((environments, count), np.inf)
    facing = np.ones((environments, count))
    hit = np.full((environments, count), NOTHING)
    ux, uy = np.empty(count), np.empty(count)
    for e in range(environments):
        x, y, first = place[e, 0], place[e, 1], heading[e] + angles[0]
        for k in range(count):
            ux[k] = math.cos(heading[e] + angles[k])
            uy[k] = math.sin(heading[e] + angles[k])
        for a in range(centre.shape[1]):
            cx, cy, r = centre[e, a, 0], centre[e, a, 1], radius[e, a]
            if active[e, a] and (cx - x) ** 2 + (cy - y) ** 2 <= (limit + r) ** 2:
                _see_disc(x, y, first, step, ux, uy, cx, cy, r, a, distance[e], facing[e], hit[e])
        for m in range(len(walls)):
            _see_wall(x, y, first, step, ux, uy, walls[m], limit, distance[e], facing[e], hit[e])
    return distance, facing, hit


@dataclass(frozen=True)
class Scan(Reading):
    """One turn of a planar laser scanner in E environments, R beams (infinities as in ROS REP-117).

    Fields:
        ranges: ``[E, R]`` [m]; ``+inf`` nothing within reach, ``-inf`` something nearer than the smallest distance.
        angles: ``[R]`` [rad] in the sensor frame, counter-clockwise, 0 straight ahead.
        hit: ``[E, R]`` what the beam met: index of an agent, :data:`NOTHING` (-1), :data:`WALL` (-2), :data:`FLOOR`
            (-3) or :data:`PROP` (-4). Ground truth for labels; no real scanner knows it.
        facing: ``[E, R]`` cosine of the angle between beam and surface normal, 1 where nothing was met.
        part: ``[E, R]`` index into ``scene.bodies.parts``, -1 where there is none.
    """

    ranges: Floats
    angles: Floats
    hit: Indices
    facing: Floats
    part: Indices

    @property
    def incidence(self) -> Floats:
        """``[E, R]`` angle between beam and surface normal [rad], NaN where nothing returned."""
        return incidence_of(self.facing, self.hit)

    def points(self) -> Floats:
        """Return where the beams ended in the world, NaN where there is no finite range.

        ``[E, R, 2]`` [m] for a planar pose, ``[E, R, 3]`` for one in space.
        """
        if isinstance(self.pose, SpatialPose):
            return ended(self.pose, fan(self.angles), self.ranges, in_world=True)
        angle = self.pose.heading[:, None] + self.angles
        away = np.where(np.isfinite(self.ranges), self.ranges, np.nan)
        ends = self.pose.position[:, None] + away[..., None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        return np.asarray(ends)

    def seen(self, count: int) -> NDArray[np.bool_]:
        """Return which of ``count`` agents returned at least one beam, ``[E, A]``."""
        return seen_agents(self.hit, count)


def seen_agents(hit: Indices, count: int) -> NDArray[np.bool_]:
    """Return which of ``count`` agents are named in ``hit`` ``[E, ...]``, as ``[E, A]``."""
    flat = hit.reshape(len(hit), -1)
    marks = np.zeros((len(hit), count), dtype=np.bool_)
    rows, beams_ = np.nonzero(flat >= 0)
    marks[rows, flat[rows, beams_]] = True
    return marks


@dataclass(frozen=True)
class Lidar2D(Ranging):
    """A planar laser scanner that takes all beams at one instant.

    It sees active agents (also those that the crowd does not react to), walls, props and, when tilted, the floor. A
    beam ends at the first surface; when it meets that at more than ``max_incidence`` it returns nothing. Noise is
    added to true distances within reach, then the limits decide, then the value is rounded to ``resolution``: a
    finite range is always between ``range_min`` and ``range_max``. From inside a body or on a wall every beam that
    meets it has distance 0 and reads ``-inf``.

    In a scene without bodies a planar pose looks at discs and walls as from above. Otherwise the beams go through
    space from the height and tilt of the pose (a planar one is level, at the height of a usual mount).

    Fields:
        rays: number of beams R.
        field_of_view: angle covered [rad], evenly from ``-field_of_view / 2`` to ``+field_of_view / 2`` both included;
            a full circle begins at -pi and does not repeat its first beam; a single beam looks ahead.
        range_min, range_max: smallest and largest distance that is measured [m].
        max_incidence: largest angle between beam and surface normal that returns [rad].
        resolution: step of the returned distances [m], 0 for none.
        skins: whether agents that have triangle skins are seen by them and not by their limbs.

    Raises:
        InputError: a value is not allowed.

    >>> scene = Scene.of([[0.0, 0.0], [3.0, 0.0]], radius=0.5)
    >>> scan = Lidar2D(rays=4).read(scene.without(0), Pose.of((0.0, 0.0), 0.0))
    >>> scan.ranges.tolist(), scan.hit.tolist()
    ([[inf, inf, 2.5, inf]], [[-1, -1, 1, -1]])
    """

    rays: int = 360
    field_of_view: float = TURN
    range_min: float = 0.05
    range_max: float = 10.0
    max_incidence: float = math.pi / 2
    resolution: float = 0.0
    skins: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        self.check_count("rays")
        if not 0.0 < self.field_of_view <= TURN + 1e-9:
            raise InputError(f"Lidar2D: field_of_view = {self.field_of_view} rad must be above 0 and at most 2 pi")
        self.check_ranges()

    @property
    def step(self) -> float:
        """Angle between neighbouring beams [rad]."""
        if self.field_of_view >= TURN - 1e-9:
            return TURN / self.rays
        return self.field_of_view / max(1, self.rays - 1)

    @property
    def angles(self) -> Floats:
        """Angles of the beams ``[R]`` [rad] in the sensor frame."""
        if self.rays == 1:
            return np.zeros(1)
        return np.asarray(-0.5 * min(self.field_of_view, TURN) + self.step * np.arange(self.rays))

    def measure(self, view: SensorView, state: None, rng: Randomness | None = None) -> tuple[Scan, None]:
        """Return the scan from ``pose``; ``rng`` is needed only when there is noise.

        Raises:
            InputError: the pose does not fit the scene, or noise lacks a generator.
        """
        self.check(view)
        scene, pose = view.scene, view.pose
        if isinstance(pose, Pose) and scene.bodies is None and not self.skins:
            distance, facing, hit = self._from_above(scene, pose)
            part = np.full(hit.shape, -1)
        else:
            hits = cast(scene, spatial_pose(pose), _beams(self), self.range_max, skins=self.skins, normals=False)
            distance, facing, hit, part = hits.distance, hits.facing, hits.hit, hits.part
        ranges = settled(self, distance, facing, hit, part, rng)
        return Scan(scene.time, pose, ranges, self.angles, hit, facing, part), None

    def _from_above(self, scene: Scene, pose: Pose) -> tuple[Floats, Floats, Indices]:
        return _scan(
            np.ascontiguousarray(pose.position, dtype=np.float64),
            np.ascontiguousarray(pose.heading, dtype=np.float64),
            self.angles,
            self.step,
            np.ascontiguousarray(scene.position),
            np.ascontiguousarray(scene.radius),
            np.ascontiguousarray(scene.active),
            lengthened(scene.walls.segments()),
            self.range_max,
        )


def _beams(lidar: Lidar2D) -> Beams:
    return _made(lidar.rays, lidar.field_of_view)


@functools.lru_cache(maxsize=64)
def _made(rays: int, field_of_view: float) -> Beams:
    return beams(fan(Lidar2D(rays=rays, field_of_view=field_of_view).angles))

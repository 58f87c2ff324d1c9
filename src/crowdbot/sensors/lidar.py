"""A planar laser scanner."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Pose, Scene, SpatialPose, kernel
from crowdbot.core.geometry import nearest_on_segment, ray_to_disc, ray_to_segment

from .beams import Beams, sort_beams, unit_vectors
from .noise import Randomness
from .ranging import Ranging, apply_limits, end_points, incidence_of
from .ray_casting import cast_rays
from .ray_shapes import FLOOR, NOTHING, OVERLAP, PROP, extend_segments
from .ray_shapes import WALLS as WALL
from .sensor import Reading, spatial_pose
from .view import SensorView

__all__ = ["FLOOR", "NOTHING", "PROP", "WALL", "Lidar2D", "Scan"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

TURN = 2.0 * math.pi


@kernel
def _stretches(low: float, width: float, first: float, step: float, count: int) -> tuple[int, int, int, int]:
    """Return the beams from angle low over width, plus one beam on each side, as two index ranges."""
    low = (low - first) % TURN
    begin = max(0, math.floor(low / step) - 1)
    end = min(count, math.ceil((low + width) / step) + 2)
    before = max(0, math.floor((low - TURN) / step) - 1)
    after = min(count, math.ceil((low + width - TURN) / step) + 2)
    return begin, end, before, after


@kernel
def _see_disc(
    x: float, y: float, first: float, step: float, ux: Floats, uy: Floats,
    cx: float, cy: float, radius: float, agent: int, distance: Floats, cos_incidence: Floats, hit: Indices,
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
                cos_incidence[k] = 1.0
                if reach > 0.0:
                    cos_incidence[k] = ((cx - x - reach * ux[k]) * ux[k] + (cy - y - reach * uy[k]) * uy[k]) / radius


@kernel
def _see_wall(
    x: float, y: float, first: float, step: float, ux: Floats, uy: Floats,
    wall: Floats, limit: float, distance: Floats, cos_incidence: Floats, hit: Indices,
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
                cos_incidence[k] = abs(ux[k] * (by - ay) - uy[k] * (bx - ax)) / length


@kernel
def _scan(
    place: Floats, heading: Floats, angles: Floats, step: float, centre: Floats, radius: Floats,
    active: NDArray[np.bool_], walls: Floats, limit: float,
) -> tuple[Floats, Floats, Indices]:  # fmt: skip
    """Return the distance to the nearest surface, its cosine of incidence and its object."""
    environments, count = len(place), len(angles)
    distance = np.full((environments, count), np.inf)
    cos_incidence = np.ones((environments, count))
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
                _see_disc(x, y, first, step, ux, uy, cx, cy, r, a, distance[e], cos_incidence[e], hit[e])
        for m in range(len(walls)):
            _see_wall(x, y, first, step, ux, uy, walls[m], limit, distance[e], cos_incidence[e], hit[e])
    return distance, cos_incidence, hit


@dataclass(frozen=True)
class Scan(Reading):
    """One scan of a planar laser scanner in E environments, R beams (infinities as in ROS REP-117).

    Fields:
        ranges: ``[E, R]`` [m]; ``+inf`` beyond the range, ``-inf`` below the smallest range.
        angles: ``[R]`` [rad] in the sensor frame, counter-clockwise, 0 is forward.
        hit: ``[E, R]`` object hit by the beam: index of an agent, :data:`NOTHING` (-1), :data:`WALL` (-2),
            :data:`FLOOR` (-3) or :data:`PROP` (-4). Ground truth.
        cos_incidence: ``[E, R]`` cosine of the angle between beam and surface normal, 1 without a hit.
        part: ``[E, R]`` index into ``scene.bodies.parts``, -1 where there is none.
    """

    ranges: Floats
    angles: Floats
    hit: Indices
    cos_incidence: Floats
    part: Indices

    @property
    def incidence(self) -> Floats:
        """``[E, R]`` angle between beam and surface normal [rad], NaN without a return."""
        return incidence_of(self.cos_incidence, self.hit)

    def points(self) -> Floats:
        """Return the end points of the beams in the world, NaN without a finite range.

        ``[E, R, 2]`` [m] for a planar pose, ``[E, R, 3]`` for one in space.
        """
        if isinstance(self.pose, SpatialPose):
            return end_points(self.pose, unit_vectors(self.angles), self.ranges, in_world=True)
        angle = self.pose.heading[:, None] + self.angles
        away = np.where(np.isfinite(self.ranges), self.ranges, np.nan)
        ends = self.pose.position[:, None] + away[..., None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        return np.asarray(ends)

    def visible_agents(self, count: int) -> NDArray[np.bool_]:
        """Return which of ``count`` agents were hit by at least one beam, ``[E, A]``."""
        return visible_agents(self.hit, count)


def visible_agents(hit: Indices, count: int) -> NDArray[np.bool_]:
    """Return which of ``count`` agents occur in ``hit`` ``[E, ...]``, as ``[E, A]``."""
    flat = hit.reshape(len(hit), -1)
    marks = np.zeros((len(hit), count), dtype=np.bool_)
    rows, beams_ = np.nonzero(flat >= 0)
    marks[rows, flat[rows, beams_]] = True
    return marks


@dataclass(frozen=True)
class Lidar2D(Ranging):
    """A planar laser scanner. All beams are measured at the same instant.

    It detects active agents, walls, props and, if tilted, the floor. A beam ends at the first surface; beyond
    ``max_incidence`` there is no return. Noise is added to true distances within the range, then the limits apply, then
    the value is rounded to ``resolution``: a finite range is always between ``range_min`` and ``range_max``. Inside a
    body or on a wall the distance is 0 and the range ``-inf``.

    With a planar pose and a scene without bodies, beams meet discs and walls in the plane. Otherwise they go through
    space, from the height and tilt of the pose (a planar pose is level, at the height of a usual mount).

    Fields:
        rays: number of beams R.
        field_of_view: angle covered [rad], from ``-field_of_view / 2`` to ``+field_of_view / 2``, both included; a full
            circle starts at -pi and does not repeat its first beam; a single beam points forward.
        range_min, range_max: smallest and largest measured distance [m].
        max_incidence: largest angle between beam and surface normal that gives a return [rad].
        resolution: step of the distances [m], 0 for none.
        skins: whether triangle skins of agents are used instead of their limbs.

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
        """Angle between adjacent beams [rad]."""
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
        """Return the scan from the pose of the view.

        Raises:
            InputError: the pose does not fit the scene, or noise lacks a generator.
        """
        self.check(view)
        scene, pose = view.scene, view.pose
        if isinstance(pose, Pose) and scene.bodies is None and not self.skins:
            distance, cos_incidence, hit = self._from_above(scene, pose)
            part = np.full(hit.shape, -1)
        else:
            hits = cast_rays(scene, spatial_pose(pose), _beams(self), self.range_max, skins=self.skins, normals=False)
            distance, cos_incidence, hit, part = hits.distance, hits.cos_incidence, hits.hit, hits.part
        ranges = apply_limits(self, distance, cos_incidence, hit, part, rng)
        return Scan(scene.time, pose, ranges, self.angles, hit, cos_incidence, part), None

    def _from_above(self, scene: Scene, pose: Pose) -> tuple[Floats, Floats, Indices]:
        return _scan(
            np.ascontiguousarray(pose.position, dtype=np.float64),
            np.ascontiguousarray(pose.heading, dtype=np.float64),
            self.angles,
            self.step,
            np.ascontiguousarray(scene.position),
            np.ascontiguousarray(scene.radius),
            np.ascontiguousarray(scene.active),
            extend_segments(scene.walls.segments()),
            self.range_max,
        )


def _beams(lidar: Lidar2D) -> Beams:
    return _made(lidar.rays, lidar.field_of_view)


@functools.lru_cache(maxsize=64)
def _made(rays: int, field_of_view: float) -> Beams:
    return sort_beams(unit_vectors(Lidar2D(rays=rays, field_of_view=field_of_view).angles))

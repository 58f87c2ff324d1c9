"""A planar laser scanner."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Pose, Scene, SpatialPose, kernel, prange, read_only, storable
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.typing import Floats

from .beams import Beams, sort_beams, unit_vectors
from .noise import Randomness
from .ranging import Ranging, apply_limits, end_points, incidence_of, settle_ranges
from .ray_casting import cast_rays
from .ray_shapes import FLOOR, NOTHING, OVERLAP, PROP, wall_segments
from .ray_shapes import WALLS as WALL
from .sensor import Reading, spatial_pose
from .view import SensorView

__all__ = ["FLOOR", "NOTHING", "PROP", "WALL", "Lidar2D", "Scan", "cast_plane", "main_scan", "main_scanner"]

Indices = NDArray[np.int64]

TURN = 2.0 * math.pi
CHUNK = 4
"""Number of environments that one thread scans in sequence."""
PARALLEL = 16384
"""Smallest number of beams for several threads: below, starting them takes longer than the scan."""


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
def _aim(heading: float, angles: Floats, ux: Floats, uy: Floats) -> None:
    """Compute the missing directions of beams; most time of a scan is spent on cosines and sines."""
    for k in range(len(ux)):
        if np.isnan(ux[k]):
            angle = heading + angles[k]
            cos, sin = math.cos(angle), math.sin(angle)  # one call of the C library for both
            ux[k], uy[k] = cos, sin


@kernel
def _meet_disc(
    rx: float, ry: float, radius: float, ux: Floats, uy: Floats, number: int, distance: Floats, hit: Indices,
) -> None:  # fmt: skip
    """Shorten beams at a disc at rx, ry, as :func:`ray_to_disc`, without branches."""
    gap = rx * rx + ry * ry - radius * radius
    if gap <= 0.0:
        for k in range(len(ux)):
            if distance[k] > 0.0:
                distance[k] = 0.0
                hit[k] = number
        return
    for k in range(len(ux)):
        along = rx * ux[k] + ry * uy[k]
        across = rx * uy[k] - ry * ux[k]
        inside = radius * radius - across * across
        reach = gap / (along + math.sqrt(inside if inside > 0.0 else 0.0))
        nearer = (along > 0.0) & (inside >= 0.0) & (reach < distance[k])
        distance[k] = reach if nearer else distance[k]
        hit[k] = number if nearer else hit[k]


@kernel
def _meet_segment(
    rx: float, ry: float, ex: float, ey: float, ux: Floats, uy: Floats, number: int, distance: Floats, hit: Indices,
) -> None:  # fmt: skip
    """Shorten beams at a segment from rx, ry along ex, ey, as :func:`ray_to_segment`, without branches."""
    area = rx * ey - ry * ex
    for k in range(len(ux)):
        cross = ux[k] * ey - uy[k] * ex
        reach = area / cross
        place = rx * uy[k] - ry * ux[k]  # over cross it is the share of the segment; the limits need no division
        place = place if cross > 0.0 else -place
        nearer = (cross != 0.0) & (reach >= 0.0) & (place >= 0.0) & (place <= abs(cross)) & (reach < distance[k])
        distance[k] = reach if nearer else distance[k]
        hit[k] = number if nearer else hit[k]


@kernel
def _see_disc(
    x: float, y: float, heading: float, angles: Floats, step: float, ux: Floats, uy: Floats,
    cx: float, cy: float, radius: float, agent: int, distance: Floats, hit: Indices,
) -> None:  # fmt: skip
    count = len(ux)
    away = math.sqrt((cx - x) ** 2 + (cy - y) ** 2)
    begin, end, before, after = 0, count, 0, 0
    if away > radius:
        half = math.asin(radius / away)
        low = math.atan2(cy - y, cx - x) - half
        begin, end, before, after = _stretches(low, 2.0 * half, heading + angles[0], step, count)
    for part in range(2):
        start, stop = (begin, end) if part == 0 else (before, after)
        if start < stop:
            vx, vy = ux[start:stop], uy[start:stop]
            _aim(heading, angles[start:stop], vx, vy)
            _meet_disc(cx - x, cy - y, radius, vx, vy, agent, distance[start:stop], hit[start:stop])


@kernel
def _see_wall(
    x: float, y: float, heading: float, angles: Floats, step: float, ux: Floats, uy: Floats,
    wall: Floats, limit: float, number: int, distance: Floats, hit: Indices,
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
            low, first = low + min(width, 0.0), heading + angles[0]
            begin, end, before, after = _stretches(low, abs(width), first, step, count)
    for part in range(2):
        start, stop = (begin, end) if part == 0 else (before, after)
        if start < stop:
            vx, vy = ux[start:stop], uy[start:stop]
            _aim(heading, angles[start:stop], vx, vy)
            _meet_segment(ax - x, ay - y, bx - ax, by - ay, vx, vy, number, distance[start:stop], hit[start:stop])


@kernel
def _find_cosines(
    x: float, y: float, ux: Floats, uy: Floats, centre: Floats, radius: Floats, walls: Floats, distance: Floats,
    hit: Indices, cos_incidence: Floats,
) -> None:  # fmt: skip
    """Write the cosines of incidence, and replace the numbers of walls by their label."""
    agents = len(radius)
    for k in range(len(ux)):
        n, cosine = hit[k], 1.0
        if n >= agents:
            ex, ey = walls[n - agents, 2] - walls[n - agents, 0], walls[n - agents, 3] - walls[n - agents, 1]
            cosine = abs(ux[k] * ey - uy[k] * ex) / math.sqrt(ex**2 + ey**2)
            hit[k] = WALL
        elif n >= 0 and distance[k] > 0.0:
            rx, ry = centre[n, 0] - x - distance[k] * ux[k], centre[n, 1] - y - distance[k] * uy[k]
            cosine = (rx * ux[k] + ry * uy[k]) / radius[n]
        cos_incidence[k] = cosine


@kernel
def _scan_rows(
    begin: int, end: int, place: Floats, heading: Floats, angles: Floats, step: float, centre: Floats, radius: Floats,
    active: NDArray[np.bool_], walls: Floats, limits: tuple[float, float, float, float], exact: bool,
    distance: Floats, cos_incidence: Floats, hit: Indices, part: Indices,
) -> None:  # fmt: skip
    """Scan some environments: distance to the nearest surface, its cosine of incidence and its object.

    Without noise (``exact``) the limits of the sensor apply too, so that the distances become ranges.
    """
    limit = limits[2]
    count, agents = len(angles), centre.shape[1]
    ux, uy = np.empty(count), np.empty(count)
    for e in range(begin, end):
        x, y, turn = place[e, 0], place[e, 1], heading[e]
        found, object_ = distance[e], hit[e]
        ux[:] = np.nan
        found[:] = np.inf
        object_[:] = NOTHING
        part[e] = -1
        for a in range(agents):
            cx, cy, r = centre[e, a, 0], centre[e, a, 1], radius[e, a]
            if active[e, a] and (cx - x) ** 2 + (cy - y) ** 2 <= (limit + r) ** 2:
                _see_disc(x, y, turn, angles, step, ux, uy, cx, cy, r, a, found, object_)
        for m in range(len(walls)):
            _see_wall(x, y, turn, angles, step, ux, uy, walls[m], limit, agents + m, found, object_)
        _find_cosines(x, y, ux, uy, centre[e], radius[e], walls, found, object_, cos_incidence[e])
        if exact:
            settle_ranges(found, found, cos_incidence[e], object_, part[e], limits, found)


@kernel(parallel=True)
def _scan_parallel(
    place: Floats, heading: Floats, angles: Floats, step: float, centre: Floats, radius: Floats,
    active: NDArray[np.bool_], walls: Floats, limits: tuple[float, float, float, float], exact: bool,
    distance: Floats, cos_incidence: Floats, hit: Indices, part: Indices,
) -> None:  # fmt: skip
    """Scan all environments on all threads."""
    environments = len(place)
    for chunk in prange((environments + CHUNK - 1) // CHUNK):
        begin, end = chunk * CHUNK, min(environments, (chunk + 1) * CHUNK)
        _scan_rows(
            begin, end, place, heading, angles, step, centre, radius, active, walls, limits, exact, distance,
            cos_incidence, hit, part,
        )  # fmt: skip


@storable
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

    shared_fields: ClassVar[tuple[str, ...]] = ("angles",)
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


LEVEL = math.cos(math.radians(45.0))
"""Cosine of the largest angle between the plane of a main scanner and the horizontal."""


def main_scanner(scanners: Iterable[tuple[Floats, float]]) -> int | None:
    """Return the index of the main scanner: of the horizontal ones, that with the widest field of view.

    A scanner is horizontal if its plane is within 45 degrees of the horizontal. The width is the angle between the
    first and the last beam; of equally wide scanners, the one with more beams counts, then the first one.

    Args:
        scanners: angles of the beams ``[R]`` [rad], and cosine of the angle between the axis of the scanner and up.

    >>> beams = [np.linspace(-0.1, 0.1, 2), np.linspace(-2.0, 2.0, 90), np.linspace(-3.0, 3.0, 90)]
    >>> main_scanner(zip(beams, (1.0, -1.0, 0.0))), main_scanner([])
    (1, None)
    """
    level = [(k, angles) for k, (angles, up) in enumerate(scanners) if abs(up) >= LEVEL]
    if not level:
        return None
    return max(level, key=lambda row: (round(float(row[1][-1] - row[1][0]), 6), len(row[1])))[0]


def main_scan(readings: Iterable[Reading]) -> Scan | None:
    """Return the reading of the main scanner, see :func:`main_scanner`, or None without one.

    >>> from crowdbot.core import Pose, Scene
    >>> here = Scene.of([[2.0, 0.0]], radius=0.3), Pose.of((0.0, 0.0), 0.0)
    >>> narrow, wide = (Lidar2D(rays=count, field_of_view=angle).read(*here) for count, angle in ((2, 0.1), (90, 3.0)))
    >>> len(main_scan([narrow, wide]).angles), main_scan([])
    (90, None)
    """
    scans = [reading for reading in readings if isinstance(reading, Scan)]
    best = main_scanner((scan.angles, _up(scan)) for scan in scans)
    return None if best is None else scans[best]


def _up(scan: Scan) -> float:
    """Return the cosine of the angle between the axis of a scanner and up, in the first environment."""
    if not isinstance(scan.pose, SpatialPose):
        return 1.0
    _, x, y, _ = scan.pose.rotation[0].tolist()
    return float(1.0 - 2.0 * (x * x + y * y))


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

    batched = True

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
        return _step(self.rays, self.field_of_view)

    @property
    def angles(self) -> Floats:
        """Angles of the beams ``[R]`` [rad] in the sensor frame."""
        return beam_angles(self.rays, self.field_of_view).copy()

    def measure(self, view: SensorView, state: None, rng: Randomness | None = None) -> tuple[Scan, None]:
        """Return the scan from the pose of the view.

        Raises:
            InputError: the pose does not fit the scene, or noise lacks a generator.
        """
        self.check(view)
        scene, pose = view.scene, view.pose
        if isinstance(pose, Pose) and scene.bodies is None and not self.skins:
            ranges, cos_incidence, hit, part = self._from_above(scene, pose)
            if self.noises:
                ranges = apply_limits(self, ranges, cos_incidence, hit, part, rng)
        else:
            hits = cast_rays(scene, spatial_pose(pose), _beams(self), self.range_max, skins=self.skins, normals=False)
            cos_incidence, hit, part = hits.cos_incidence, hits.hit, hits.part
            ranges = apply_limits(self, hits.distance, cos_incidence, hit, part, rng)
        angles = beam_angles(self.rays, self.field_of_view)
        return Scan(scene.time, pose, ranges, angles, hit, cos_incidence, part), None

    def _from_above(self, scene: Scene, pose: Pose) -> tuple[Floats, Floats, Indices, Indices]:
        angles, environments = beam_angles(self.rays, self.field_of_view), scene.shape[0]
        # One block of memory: the system reuses it for the next scan, whereas it has to clear new pages for each array.
        block = np.empty((4, environments, self.rays))
        labels = block.view(np.int64)
        rows = (
            np.ascontiguousarray(pose.position, dtype=np.float64),
            np.ascontiguousarray(pose.heading, dtype=np.float64),
            angles,
            self.step,
            np.ascontiguousarray(scene.position),
            np.ascontiguousarray(scene.radius),
            np.ascontiguousarray(scene.active),
            wall_segments(scene.walls),
            self.limits,
            not self.noises,
            block[0],
            block[1],
            labels[2],
            labels[3],
        )
        if environments < CHUNK or environments * self.rays < PARALLEL:
            _scan_rows(0, environments, *rows)
        else:
            _scan_parallel(*rows)
        return rows[-4:]


def cast_plane(
    pose: Pose, angles: Floats, centre: Floats, radius: Floats, segments: Floats, range_max: float
) -> tuple[Floats, Indices]:
    """Return ranges [m] and objects ``[E, R]`` of scans of discs ``[E, A]`` and of segments ``[S, 4]``, without noise.

    ``hit`` is the index of a disc, -1 without a return, or -2 for a segment; a disc with a NaN centre is absent.
    """
    shape = (len(pose.heading), len(angles))
    ranges, cosine, hit, part = np.empty(shape), np.empty(shape), np.empty(shape, np.int64), np.empty(shape, np.int64)
    step = float(angles[1] - angles[0]) if len(angles) > 1 else TURN
    place = np.ascontiguousarray(centre, dtype=np.float64)
    _scan_rows(
        0, len(ranges), np.ascontiguousarray(pose.position), np.ascontiguousarray(pose.heading), read_only(angles),
        step, place, np.ascontiguousarray(radius), np.isfinite(place[..., 0]), read_only(segments),
        (-2.0, 0.0, range_max, 0.0), True, ranges, cosine, hit, part,
    )  # fmt: skip
    return ranges, hit


def _step(rays: int, field_of_view: float) -> float:
    return TURN / rays if field_of_view >= TURN - 1e-9 else field_of_view / max(1, rays - 1)


@functools.lru_cache(maxsize=64)
def beam_angles(rays: int, field_of_view: float) -> Floats:
    """Return the angles of the beams ``[R]`` [rad] in the sensor frame; the array is read-only and shared by scans."""
    first = 0.0 if rays == 1 else -0.5 * min(field_of_view, TURN)
    angles = first + _step(rays, field_of_view) * np.arange(rays)
    angles.flags.writeable = False
    return np.asarray(angles)


def _beams(lidar: Lidar2D) -> Beams:
    return _made(lidar.rays, lidar.field_of_view)


@functools.lru_cache(maxsize=64)
def _made(rays: int, field_of_view: float) -> Beams:
    return sort_beams(unit_vectors(Lidar2D(rays=rays, field_of_view=field_of_view).angles))

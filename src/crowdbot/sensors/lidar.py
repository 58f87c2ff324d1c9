"""A planar laser scanner: distances to people (discs) and walls along evenly spaced beams."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Pose, Scene
from crowdbot.core.geometry import nearest_on_segment, ray_to_disc, ray_to_segment
from crowdbot.core.kernels import kernel

from .noise import Randomness, disturbed
from .sensor import Reading, Sensor

__all__ = ["NOTHING", "WALL", "Lidar2D", "Scan"]

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

NOTHING = -1
"""Value of ``Scan.hit`` where a beam returned nothing."""
WALL = -2
"""Value of ``Scan.hit`` where a beam met a wall."""
OVERLAP = 1e-9
"""Walls are this much longer [m] at both ends, so that rounding lets no beam slip through a corner."""
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
        hit: ``[E, R]`` what the beam met: index of an agent, :data:`NOTHING` (-1) or :data:`WALL` (-2). Ground truth
            for labels; no real scanner knows it.
    """

    ranges: Floats
    angles: Floats
    hit: Indices

    def points(self) -> Floats:
        """Return where the beams ended, ``[E, R, 2]`` [m] in the world, NaN where there is no finite range."""
        angle = self.pose.heading[:, None] + self.angles
        away = np.where(np.isfinite(self.ranges), self.ranges, np.nan)
        ends = self.pose.position[:, None] + away[..., None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        return np.asarray(ends)

    def seen(self, count: int) -> NDArray[np.bool_]:
        """Return which of ``count`` agents returned at least one beam, ``[E, A]``."""
        marks = np.zeros((len(self.hit), count), dtype=np.bool_)
        rows, beams = np.nonzero(self.hit >= 0)
        marks[rows, self.hit[rows, beams]] = True
        return marks


@dataclass(frozen=True)
class Lidar2D(Sensor):
    """A planar laser scanner that takes all beams at one instant.

    It sees the discs of active agents (also of those that the crowd does not react to) and the walls. A beam ends at
    the first surface; when it meets that at more than ``max_incidence`` it returns nothing. Noise is added to true
    distances within reach, then the limits decide, then the value is rounded to ``resolution``: a finite range is
    always between ``range_min`` and ``range_max``. From inside a disc or on a wall every beam that meets it has
    distance 0 and reads ``-inf``.

    Fields:
        rays: number of beams R.
        field_of_view: angle covered [rad], evenly from ``-field_of_view / 2`` to ``+field_of_view / 2`` both included;
            a full circle begins at -pi and does not repeat its first beam; a single beam looks ahead.
        range_min, range_max: smallest and largest distance that is measured [m].
        max_incidence: largest angle between beam and surface normal that returns [rad].
        resolution: step of the returned distances [m], 0 for none.

    Raises:
        InputError: a value is not allowed.

    >>> scene = Scene.of([[0.0, 0.0], [3.0, 0.0]], radius=0.5)
    >>> scan = Lidar2D(rays=4).measure(scene.without(0), Pose.of((0.0, 0.0), 0.0))
    >>> scan.ranges.tolist(), scan.hit.tolist()
    ([[inf, inf, 2.5, inf]], [[-1, -1, 1, -1]])
    """

    rays: int = 360
    field_of_view: float = TURN
    range_min: float = 0.05
    range_max: float = 10.0
    max_incidence: float = math.pi / 2
    resolution: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.rays != int(self.rays) or self.rays < 1:
            raise InputError(f"Lidar2D: rays = {self.rays} must be a whole number of at least 1")
        if not 0.0 < self.field_of_view <= TURN + 1e-9:
            raise InputError(f"Lidar2D: field_of_view = {self.field_of_view} rad must be above 0 and at most 2 pi")
        if not 0.0 <= self.range_min < self.range_max < math.inf:
            raise InputError(
                f"Lidar2D: range_min = {self.range_min} m and range_max = {self.range_max} m must be finite,"
                " not negative, and range_min the smaller one"
            )
        if not 0.0 < self.max_incidence <= math.pi / 2 + 1e-9:
            raise InputError(f"Lidar2D: max_incidence = {self.max_incidence} rad must be above 0 and at most pi / 2")
        if not 0.0 <= self.resolution <= self.range_max - self.range_min:
            raise InputError(f"Lidar2D: resolution = {self.resolution} m must be at least 0 and fit between the ranges")

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

    def measure(self, scene: Scene, pose: Pose, rng: Randomness | None = None) -> Scan:
        """Return the scan from ``pose``; ``rng`` is needed only when there is noise.

        Raises:
            InputError: scene and pose have different numbers of environments, or noise lacks a generator.
        """
        self.check(scene, pose)
        distance, facing, hit = _scan(
            np.ascontiguousarray(pose.position, dtype=np.float64),
            np.ascontiguousarray(pose.heading, dtype=np.float64),
            self.angles,
            self.step,
            np.ascontiguousarray(scene.position),
            np.ascontiguousarray(scene.radius),
            np.ascontiguousarray(scene.active),
            _lengthened(scene.walls.segments()),
            self.range_max,
        )
        back = distance <= self.range_max
        if self.max_incidence < math.pi / 2:
            back &= facing >= math.cos(self.max_incidence) - 1e-12  # the limit itself returns, whatever the rounding
        measured = disturbed(np.where(back, distance, np.inf), self.noises, rng)
        near = back & ((distance < self.range_min) | (measured < self.range_min))
        far = ~back | (measured > self.range_max)
        ranges = np.where(near, -np.inf, np.where(far, np.inf, self._rounded(measured)))
        hit = np.where(far & ~near, NOTHING, hit)
        return Scan(scene.time, pose, np.asarray(ranges), self.angles, hit)

    def _rounded(self, measured: Floats) -> Floats:
        if self.resolution == 0.0:
            return measured
        lowest = math.ceil(self.range_min / self.resolution - 1e-9)
        highest = math.floor(self.range_max / self.resolution + 1e-9)
        steps = np.clip(np.round(measured / self.resolution), lowest, highest)
        return np.asarray(steps * self.resolution)


def _lengthened(walls: Floats) -> Floats:
    along = walls[:, 2:] - walls[:, :2]
    along = along * (OVERLAP / np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-300))[:, None]
    return np.ascontiguousarray(np.concatenate([walls[:, :2] - along, walls[:, 2:] + along], axis=1))

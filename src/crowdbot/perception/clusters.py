"""Detectors of people as clusters of points in planar scans, point clouds and depth images."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Walls, check_number, kernel
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.sensors import DepthImage, PointCloud, Reading, Scan, planar_pose
from crowdbot.typing import Bools, Floats, Ints

from .detector import Coverage, Detections, Detector

FLAT = 0.15
"""A cluster is flat if it bulges towards the scanner by less than this share of its width."""
WIDE = 0.35
"""Width [m] above which a flat cluster is not a person."""


@kernel
def hide_walls(points: Floats, segments: Floats, margin: float, use: Bools) -> None:
    """Clear ``use`` ``[R]`` at points ``[R, 2]`` within ``margin`` [m] of a wall ``[S, 4]``."""
    for s in range(len(segments)):
        ax, ay, bx, by = segments[s, 0], segments[s, 1], segments[s, 2], segments[s, 3]
        left, right = min(ax, bx) - margin, max(ax, bx) + margin
        low, high = min(ay, by) - margin, max(ay, by) + margin
        for k in range(len(points)):
            x, y = points[k, 0], points[k, 1]
            if use[k] and left <= x <= right and low <= y <= high:
                px, py = nearest_on_segment(x, y, ax, ay, bx, by)
                if math.hypot(px - x, py - y) <= margin:
                    use[k] = False


@kernel
def cut_clusters(
    ranges: Floats, use: Bools, step: float, circle: bool, gap: float, dip: float, begin: Ints, size: Ints,
) -> int:  # fmt: skip
    """Write first beam and number of beams of each cluster, and return the number of clusters.

    A cluster ends where two neighbouring points are more than ``gap`` [m] plus two beam widths apart, and where the
    range has a maximum that is ``dip`` [m] above the minima on both sides: two people side by side.
    """
    count, found, start = len(ranges), 0, 0
    if circle:
        for k in range(count):
            if not _joined(ranges, use, (k - 1) % count, k, step, gap):
                start = k
                break
    k = 0
    while k < count:
        if not use[(start + k) % count]:
            k += 1
            continue
        first = k
        while k + 1 < count and _joined(ranges, use, (start + k) % count, (start + k + 1) % count, step, gap):
            k += 1
        k += 1
        found = _split(ranges, start, first, k, dip, begin, size, found)
    return found


@kernel
def _joined(ranges: Floats, use: Bools, one: int, other: int, step: float, gap: float) -> bool:
    if not (use[one] and use[other]):
        return False
    a, b = ranges[one], ranges[other]
    square = a * a + b * b - 2.0 * a * b * math.cos(step)
    limit = gap + 2.0 * min(a, b) * step
    return bool(square <= limit * limit)


@kernel
def _split(ranges: Floats, start: int, first: int, last: int, dip: float, begin: Ints, size: Ints, found: int) -> int:
    """Cut the beams first to last - 1, counted from ``start``, at deep maxima of the range."""
    count = len(ranges)
    low, top, at = ranges[(start + first) % count], -math.inf, first
    for k in range(first + 1, last):
        value = ranges[(start + k) % count]
        if value < low and top < low + dip:
            low, top, at = value, -math.inf, k
        elif value > top:
            top, at = value, k
        if top >= low + dip and value <= top - dip:
            begin[found], size[found] = (start + first) % count, at - first
            found += 1
            first, low, top = at, value, -math.inf
    begin[found], size[found] = (start + first) % count, last - first
    return found + 1


@kernel
def place_clusters(
    ranges: Floats, points: Floats, bearing: Floats, step: float, begin: Ints, size: Ints, origin: Floats,
    body: float, limits: tuple[float, float, float], place: Floats, width: Floats, hidden: Bools,
) -> None:  # fmt: skip
    """Write the centre, the width and whether an edge is hidden for each cluster; NaN for those that are no person.

    ``limits`` are the smallest and the largest width [m], and the share of the beams on a leg that must return. The
    radius of a cluster of half angle a at distance d is d sin(a) / (1 - sin(a)), that of the disc which its outer
    beams touch; with a hidden edge, the disc of radius ``body`` is put at the visible one.
    """
    count = len(ranges)
    for c in range(len(begin)):
        n, b = size[c], begin[c]
        e = (b + n - 1) % count
        near = math.inf
        for k in range(n):
            near = min(near, ranges[(b + k) % count])
        chord = math.hypot(points[e, 0] - points[b, 0], points[e, 1] - points[b, 1])
        width[c] = chord + near * step
        place[c, 0] = math.nan
        if near <= 0.0 or chord > limits[1] or width[c] < limits[0] or n * near * step < limits[2] * 2.0 * LEG:
            continue
        if width[c] > WIDE and _bulge(points, b, n, origin) < FLAT * chord:
            continue
        before, after = ranges[(b - 1) % count], ranges[(e + 1) % count]
        left, right = before < ranges[b] - body, after < ranges[e] - body
        half = 0.5 * n * step
        angle = bearing[b] + 0.5 * (n - 1) * step
        sine = min(0.95, math.sin(min(half, 1.5)))
        radius = min(near * sine / (1.0 - sine), 1.4 * body)
        hidden[c] = (left or right) and radius < 0.8 * body
        if hidden[c] and left != right:
            wide = math.asin(min(1.0, body / (near + body)))
            angle += (wide - half) if right else (half - wide)
        radius = body if hidden[c] else radius
        place[c, 0] = origin[0] + (near + radius) * math.cos(angle)
        place[c, 1] = origin[1] + (near + radius) * math.sin(angle)


LEG = 0.06
"""Radius of a leg [m]."""


@kernel
def _bulge(points: Floats, begin: int, size: int, origin: Floats) -> float:
    """Return how far [m] a cluster bulges over the chord towards the scanner."""
    count = len(points)
    last = (begin + size - 1) % count
    ax, ay = points[begin, 0], points[begin, 1]
    dx, dy = points[last, 0] - ax, points[last, 1] - ay
    length = math.hypot(dx, dy)
    if length == 0.0:
        return 0.0
    side = 1.0 if dx * (origin[1] - ay) - dy * (origin[0] - ax) > 0.0 else -1.0
    best = 0.0
    for k in range(size):
        p = (begin + k) % count
        best = max(best, side * (dx * (points[p, 1] - ay) - dy * (points[p, 0] - ax)) / length)
    return best


LARGEST_GRID = 4_000_000
"""Largest number of cells of the grid on the ground."""


@dataclass(frozen=True, kw_only=True)
class CloudClusters(Detector):
    """Geometric detector of people in 3-D scans: connected cells of a grid on the ground, of the size of a person.

    Points between ``low`` and ``high`` above the floor are put in cells of the width ``cell``; cells that touch, also
    at a corner, are one cluster. A cluster is a person if its extent and its height fit.

    Fields:
        low, high: heights above the floor between which points count [m].
        cell: width of a cell [m].
        min_points: smallest number of points of a person.
        min_height: smallest height of the highest point of a person within 6 m, above the floor [m].
        max_width: largest extent of a person along x and y [m].
        margin: distance from walls of the map up to which points belong to them [m].
        max_range: largest distance [m].
        deviation: standard deviation of a position [m].

    Raises:
        InputError: a value is not allowed.

    >>> from crowdbot.core import Pose, Scene
    >>> from crowdbot.sensors import Lidar3D
    >>> scene = Scene.of([[3.0, 0.0], [0.0, -4.0]], radius=0.25)
    >>> found = CloudClusters().detect(Lidar3D(columns=900).read(scene, Pose.of((0.0, 0.0), 0.0).to_spatial(0.6)))
    >>> sorted(found.position.round(1).tolist())
    [[0.0, -4.0], [3.0, 0.0]]
    """

    reads: ClassVar[tuple[type[Reading], ...]] = (PointCloud,)
    low: float = 0.25
    high: float = 1.9
    cell: float = 0.12
    min_points: int = 4
    min_height: float = 0.5
    max_width: float = 1.1
    margin: float = 0.2
    max_range: float = 15.0
    deviation: float = 0.08

    def __post_init__(self) -> None:
        for name in ("cell", "max_width", "max_range", "deviation"):
            check_number("CloudClusters", name, getattr(self, name), "m", exclusive_min=0.0)
        check_number("CloudClusters", "margin", self.margin, "m", min=0.0)
        check_number("CloudClusters", "min_points", self.min_points, min=1, whole=True)
        if not self.low < self.high:
            raise InputError(f"CloudClusters: low = {self.low} m must be below high = {self.high} m")
        if (2.0 * self.max_range / self.cell) ** 2 > LARGEST_GRID:
            raise InputError(
                f"CloudClusters: cell = {self.cell} m is too small for max_range = {self.max_range} m; the grid has at"
                f" most {LARGEST_GRID} cells"
            )

    def detect(self, reading: Reading, walls: Walls | None = None) -> Detections:
        self.check(reading)
        pose = planar_pose(reading.pose)
        origin, heading = np.ascontiguousarray(pose.position[0]), float(pose.heading[0])
        ends, coverage = self._read(reading, origin, heading)
        away = np.hypot(ends[:, 0] - origin[0], ends[:, 1] - origin[1])
        use = np.isfinite(away) & (away <= self.max_range) & (ends[:, 2] >= self.low) & (ends[:, 2] <= self.high)
        points = np.ascontiguousarray(ends[use])
        if walls is not None and len(walls):
            kept = np.ones(len(points), dtype=np.bool_)
            hide_walls(np.ascontiguousarray(points[:, :2]), np.ascontiguousarray(walls.segments()), self.margin, kept)
            points = points[kept]
        place, beams = self._people(points, origin)
        covariance = np.tile(self.deviation**2 * np.eye(2), (len(place), 1, 1))
        return Detections(float(np.max(reading.time)), place, covariance, beams, coverage)

    def _people(self, points: Floats, origin: Floats) -> tuple[Floats, Ints]:
        """Return position and number of points of each cluster that can be a person."""
        side = math.ceil(2.0 * self.max_range / self.cell) + 3
        column = np.floor((points[:, :2] - origin + self.max_range) / self.cell).astype(np.int64) + 1
        label = _label(column, side)
        count = int(label.max(initial=-1)) + 1
        beams = np.bincount(label, minlength=count)
        low, high = np.full((count, 2), np.inf), np.full((count, 2), -np.inf)
        top = np.full(count, -np.inf)
        np.minimum.at(low, label, points[:, :2])
        np.maximum.at(high, label, points[:, :2])
        np.maximum.at(top, label, points[:, 2])
        centre = 0.5 * (low + high)
        away = np.hypot(centre[:, 0] - origin[0], centre[:, 1] - origin[1])
        fits = (beams >= self.min_points) & ((high - low) <= self.max_width).all(axis=1)
        fits &= (top >= self.min_height) | (away > 6.0)
        return self._centres(points, label, np.flatnonzero(fits), origin), beams[fits]

    def _centres(self, points: Floats, label: Ints, chosen: Ints, origin: Floats) -> Floats:
        """Return the centres of clusters: the nearest point, moved on by the half width across the view."""
        place = np.empty((len(chosen), 2))
        for k, number in enumerate(chosen.tolist()):
            own = points[label == number, :2] - origin
            mean = own.mean(axis=0)
            unit = mean / max(1e-9, math.hypot(*mean.tolist()))
            along, across = own @ unit, own @ np.array([-unit[1], unit[0]])
            half = 0.5 * (float(across.max()) - float(across.min()))
            depth = float(np.quantile(along, 0.05)) + min(max(half, 0.1), 0.3)
            side = 0.5 * (float(across.max()) + float(across.min()))
            place[k] = origin + depth * unit + side * np.array([-unit[1], unit[0]])
        return place

    def _read(self, reading: Reading, origin: Floats, heading: float) -> tuple[Floats, Coverage]:
        """Return the points ``[N, 3]`` in the world and what the sensor could see.

        That is of each column the farthest beam between the heights of people.
        """
        assert isinstance(reading, PointCloud)
        ends, azimuth = reading.points(in_world=True)[0].reshape(-1, 3), reading.azimuth
        step = float(azimuth[1] - azimuth[0]) if len(azimuth) > 1 else 2.0 * math.pi
        rings = len(reading.elevation)
        away = np.hypot(ends[:, 0] - origin[0], ends[:, 1] - origin[1]).reshape(rings, -1)
        at_body = (ends[:, 2].reshape(rings, -1) >= self.low) & np.isfinite(away)
        far = np.where(at_body, away, np.where(np.isposinf(reading.ranges[0]), self.max_range, 0.0))
        return ends, Coverage(origin, heading + float(azimuth[0]), step, np.minimum(far.max(axis=0), self.max_range))


def _label(column: Ints, side: int) -> Ints:
    """Return the number of the cluster of each point; points are in cells ``[N, 2]`` of a grid of ``side`` cells."""
    label = np.full(len(column), -1, dtype=np.int64)
    if len(column):
        _flood(column[:, 0] * side + column[:, 1], side, label)
    return label


@kernel
def _flood(cell: Ints, side: int, label: Ints) -> None:
    """Write the cluster of each point by flooding the occupied cells."""
    grid = np.full(side * side, -2, dtype=np.int32)
    for k in range(len(cell)):
        grid[cell[k]] = -1
    stack = np.empty(len(cell) + 1, dtype=np.int64)
    found = 0
    for k in range(len(cell)):
        if grid[cell[k]] != -1:
            continue
        grid[cell[k]] = found
        stack[0], size = cell[k], 1
        while size > 0:
            size -= 1
            here = stack[size]
            for dx in range(-1, 2):
                for dy in range(-1, 2):
                    other = here + dx * side + dy
                    if grid[other] == -1:
                        grid[other] = found
                        stack[size] = other
                        size += 1
        found += 1
    for k in range(len(cell)):
        label[k] = grid[cell[k]]


@dataclass(frozen=True, kw_only=True)
class DepthClusters(CloudClusters):
    """Geometric detector of people in depth images, as :class:`CloudClusters` in point clouds.

    Fields:
        stride: rows and columns of pixels of which one is used.
        min_points: smallest number of used pixels of a person.

    >>> from crowdbot.core import Pose, Scene
    >>> from crowdbot.sensors import DepthCamera
    >>> pose = Pose.of((0.0, 0.0), 0.0).to_spatial(1.0)
    >>> found = DepthClusters().detect(DepthCamera().read(Scene.of([[3.0, 0.5]], radius=0.25), pose))
    >>> found.position.round(1).tolist()
    [[3.0, 0.5]]
    """

    reads: ClassVar[tuple[type[Reading], ...]] = (DepthImage,)
    stride: int = 2
    min_points: int = 12
    max_range: float = 8.0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("DepthClusters", "stride", self.stride, min=1, whole=True)

    def _read(self, reading: Reading, origin: Floats, heading: float) -> tuple[Floats, Coverage]:
        # what the camera could see: in each direction, the farthest pixel of the middle rows
        assert isinstance(reading, DepthImage)
        ends = reading.points(in_world=True)[0, :: self.stride, :: self.stride].reshape(-1, 3)
        lens, depth = reading.lens, reading.depth[0]
        half = max(1, lens.height // 8)
        middle = depth[lens.height // 2 - half : lens.height // 2 + half + 1]
        far = np.where(np.isposinf(middle), self.max_range, np.where(np.isneginf(middle), 0.0, middle)).max(axis=0)
        right = (np.arange(lens.width) - lens.cx) / lens.fx
        bearing, distance = -np.arctan(right)[::-1], (far * np.hypot(1.0, right))[::-1]
        even = np.linspace(bearing[0], bearing[-1], lens.width)
        reach = np.minimum(np.interp(even, bearing, distance), self.max_range)
        step = float(even[1] - even[0]) if len(even) > 1 else 2.0 * math.pi
        return ends, Coverage(origin, heading + float(even[0]), step, reach)


LONE_LEG = 0.08
"""Additional standard deviation [m] of a person of whom one leg is seen."""
HIDDEN = 0.12
"""Additional standard deviation [m] of a person of whom an edge is hidden."""


def join_legs(
    place: Floats, width: Floats, hidden: Bools, size: Ints, leg_width: float, stride: float
) -> tuple[Floats, Floats, Ints]:
    """Return position ``[N, 2]``, additional deviation ``[N]`` [m] and beams ``[N]`` of the people in clusters.

    Legs are paired in the order of their distances, each at most once.

    Args:
        place: ``[C, 2]`` centres of the clusters [m].
        width: ``[C]`` [m].
        hidden: ``[C]`` whether an edge is hidden.
        size: ``[C]`` number of beams.
        leg_width: largest width of a leg [m].
        stride: largest distance of a pair [m].
    """
    leg = width <= leg_width
    partner = np.full(len(place), -1, dtype=np.int64)
    _pair(place, np.flatnonzero(leg), stride, partner)
    paired = partner >= 0
    first = paired & (np.arange(len(place)) < partner)
    centre = place.copy()
    centre[first] = 0.5 * (place[first] + place[partner[first]])
    beams = size.copy()
    beams[first] += size[partner[first]]
    spread = np.where(hidden, HIDDEN, np.where(leg & ~paired, LONE_LEG, 0.0))
    kept = ~paired | first
    return np.ascontiguousarray(centre[kept]), spread[kept], beams[kept]


@kernel
def _pair(place: Floats, legs: Ints, stride: float, partner: Ints) -> None:
    """Write the partner of each leg, the nearest pairs first."""
    while True:
        best, one, other = stride * stride, -1, -1
        for i in range(len(legs)):
            a = legs[i]
            for j in range(i + 1, len(legs)):
                b = legs[j]
                if partner[a] < 0 and partner[b] < 0:
                    square = (place[a, 0] - place[b, 0]) ** 2 + (place[a, 1] - place[b, 1]) ** 2
                    if square <= best:
                        best, one, other = square, a, b
        if one < 0:
            return
        partner[one], partner[other] = other, one


FEWEST = 2.0
"""A person farther away than the distance at which this many beams meet it is not expected to be found."""


@dataclass(frozen=True, kw_only=True)
class LidarClusters(Detector):
    """Geometric detector of people in planar scans.

    Neighbouring points closer than a distance that grows with the range form a cluster (adaptive breakpoints, Borges
    and Aldon (2004), Line extraction in 2D range images for mobile robotics, doi 10.1023/B:JINT.0000038945.55712.65).
    Clusters as wide as a leg and at most a stride apart are one person; wider clusters are people if they are not flat.

    Fields:
        gap: distance between points of two clusters [m], plus two beam widths.
        dip: depth of the gap between two people side by side [m].
        min_width, max_width: smallest and largest width of a cluster [m].
        leg_width: largest width of a leg [m].
        stride: largest distance between the legs of a person [m].
        body: radius of a person, of whom only a part is visible [m].
        margin: distance from walls of the map up to which points belong to them [m].
        min_share: share of the beams on a leg that must return.
        max_range: largest distance [m].
        deviation: standard deviation of a position [m].

    Raises:
        InputError: a value is not allowed.

    >>> from crowdbot.core import Pose, Scene
    >>> from crowdbot.sensors import Lidar2D
    >>> scene = Scene.of([[2.0, 0.0], [0.0, 3.0]], radius=0.25)
    >>> found = LidarClusters().detect(Lidar2D(rays=720).read(scene, Pose.of((0.0, 0.0), 0.0)))
    >>> np.abs(found.position).round(1).tolist()
    [[2.0, 0.0], [0.0, 3.0]]
    """

    reads: ClassVar[tuple[type[Reading], ...]] = (Scan,)
    gap: float = 0.15
    dip: float = 0.12
    min_width: float = 0.04
    max_width: float = 1.0
    leg_width: float = 0.25
    stride: float = 0.7
    body: float = 0.25
    margin: float = 0.15
    min_share: float = 0.5
    max_range: float = 15.0
    deviation: float = 0.06

    def __post_init__(self) -> None:
        for name in ("gap", "dip", "min_width", "max_width", "leg_width", "body", "max_range", "deviation"):
            check_number("LidarClusters", name, getattr(self, name), "m", exclusive_min=0.0)
        check_number("LidarClusters", "stride", self.stride, "m", min=0.0)
        check_number("LidarClusters", "margin", self.margin, "m", min=0.0)
        check_number("LidarClusters", "min_share", self.min_share, min=0.0, max=1.0)
        if self.min_width > self.max_width:
            raise InputError(
                f"LidarClusters: min_width = {self.min_width} m must be at most max_width = {self.max_width} m"
            )

    def detect(self, reading: Reading, walls: Walls | None = None) -> Detections:
        self.check(reading)
        assert isinstance(reading, Scan)
        pose = planar_pose(reading.pose)
        origin, heading = np.ascontiguousarray(pose.position[0]), float(pose.heading[0])
        angles, ranges = reading.angles, np.ascontiguousarray(reading.ranges[0])
        step = float(angles[1] - angles[0]) if len(angles) > 1 else 2.0 * math.pi
        bearing = heading + angles
        there = np.isfinite(ranges) & (ranges <= self.max_range)
        length = np.where(there, ranges, 0.0)
        points = origin + length[:, None] * np.stack([np.cos(bearing), np.sin(bearing)], axis=-1)
        if walls is not None and len(walls):
            hide_walls(points, np.ascontiguousarray(walls.segments()), self.margin, there)
        far = min(self.max_range, 2.0 * self.body / (FEWEST * step))
        reach = np.where(np.isneginf(ranges) | np.isnan(ranges), 0.0, np.minimum(ranges, far))
        coverage = Coverage(origin, float(bearing[0]), step, reach)
        place, width, hidden, size = self._clusters(ranges, points, bearing, there, step, origin)
        joined, spread, beams = join_legs(place, width, hidden, size, self.leg_width, self.stride)
        covariance = (self.deviation**2 + spread**2)[:, None, None] * np.eye(2)
        return Detections(float(np.max(reading.time)), joined, covariance, beams, coverage)

    def _clusters(
        self, ranges: Floats, points: Floats, bearing: Floats, use: NDArray[np.bool_], step: float, origin: Floats
    ) -> tuple[Floats, Floats, NDArray[np.bool_], NDArray[np.int64]]:
        """Return centre, width, whether an edge is hidden, and number of beams of each possible person."""
        count = len(ranges)
        begin, size = np.empty(count, dtype=np.int64), np.empty(count, dtype=np.int64)
        circle = step * count > 2.0 * math.pi - 0.5 * step
        found = cut_clusters(ranges, use, step, circle, self.gap, self.dip, begin, size)
        begin, size = begin[:found], size[:found]
        place, width, hidden = np.empty((found, 2)), np.empty(found), np.zeros(found, dtype=np.bool_)
        limits = (self.min_width, self.max_width, self.min_share)
        place_clusters(ranges, points, bearing, step, begin, size, origin, self.body, limits, place, width, hidden)
        kept = ~np.isnan(place[:, 0])
        return place[kept], width[kept], hidden[kept], size[kept]

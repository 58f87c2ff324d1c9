"""CloudClusters: people in point clouds of a laser scanner with several rings, as clusters on the ground."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.core import InputError, Walls, check_number, kernel
from crowdbot.sensors import PointCloud, Reading, planar_pose
from crowdbot.typing import Floats, Ints

from .cluster_kernels import hide_walls
from .detections import Coverage, Detections
from .detector import Detector

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
        """Return the people in a point cloud."""
        self.check(reading)
        assert isinstance(reading, PointCloud)
        pose = planar_pose(reading.pose)
        origin, heading = np.ascontiguousarray(pose.position[0]), float(pose.heading[0])
        ends = reading.points(in_world=True)[0].reshape(-1, 3)
        away = np.hypot(ends[:, 0] - origin[0], ends[:, 1] - origin[1])
        use = np.isfinite(away) & (away <= self.max_range) & (ends[:, 2] >= self.low) & (ends[:, 2] <= self.high)
        points = np.ascontiguousarray(ends[use])
        if walls is not None and len(walls):
            kept = np.ones(len(points), dtype=np.bool_)
            hide_walls(np.ascontiguousarray(points[:, :2]), np.ascontiguousarray(walls.segments()), self.margin, kept)
            points = points[kept]
        coverage = self._coverage(reading, ends, origin, heading)
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

    def _coverage(self, reading: PointCloud, ends: Floats, origin: Floats, heading: float) -> Coverage:
        """Return what the scanner could see: of each column, the farthest beam between the heights of people."""
        azimuth = reading.azimuth
        step = float(azimuth[1] - azimuth[0]) if len(azimuth) > 1 else 2.0 * math.pi
        rings = len(reading.elevation)
        away = np.hypot(ends[:, 0] - origin[0], ends[:, 1] - origin[1]).reshape(rings, -1)
        at_body = (ends[:, 2].reshape(rings, -1) >= self.low) & np.isfinite(away)
        far = np.where(at_body, away, np.where(np.isposinf(reading.ranges[0]), self.max_range, 0.0))
        return Coverage(origin, heading + float(azimuth[0]), step, np.minimum(far.max(axis=0), self.max_range))


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

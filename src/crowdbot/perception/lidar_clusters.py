"""LidarClusters: people in scans of a planar laser scanner, as clusters of points or as pairs of legs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Walls, check_number, kernel
from crowdbot.sensors import Reading, Scan, planar_pose
from crowdbot.typing import Bools, Floats, Ints

from .cluster_kernels import cut_clusters, hide_walls, place_clusters
from .detections import Coverage, Detections
from .detector import Detector

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
NO_WALLS = np.zeros((0, 4))


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
        """Return the people in a scan."""
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

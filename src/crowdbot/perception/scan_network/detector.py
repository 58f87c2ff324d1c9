"""ScanNetwork: people in planar scans by a small network that looks at the surroundings of each beam."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Walls, check_number
from crowdbot.perception.cluster_kernels import hide_walls
from crowdbot.perception.detections import Coverage, Detections
from crowdbot.perception.detector import Detector
from crowdbot.perception.network_layers import Layers, read_layers, run_layers
from crowdbot.sensors import Reading, Scan, planar_pose
from crowdbot.typing import Floats

from .cutouts import SAMPLES, collect_votes, cut_windows

FAR = 1e3
"""Range of a beam without a return in cutouts [m]."""


@dataclass(frozen=True, kw_only=True)
class ScanNetwork(Detector):
    """Learned detector of people in planar scans, at the height of legs or of bodies.

    A perceptron sees the ranges in a window of 1.66 m around each beam, cut out at the same width in metres at all
    ranges. It gives the probability that the beam meets a person, and a vote for the centre of the person; votes within
    ``radius`` are one person. The idea is that of Beyer, Hermans and Leibe (2017), DROW: real-time deep learning-based
    wheelchair detection in 2-D range data, doi 10.1109/LRA.2016.2645131. The built-in weights are trained on generated
    scans only, by ``crowdbot train scan-network``.

    Fields:
        weights: file of weights; default: the built-in ones.
        threshold: smallest probability of a beam that votes.
        share: smallest total of the votes of a person, as a share of the beams on a leg.
        radius: distance of votes for one person [m].
        margin: distance from walls of the map up to which points belong to them [m].
        max_range: largest distance [m].
        deviation: standard deviation of a position [m].

    Raises:
        InputError: a value is not allowed.
        DataError: the weights cannot be read.

    >>> from crowdbot.core import Pose, Scene
    >>> from crowdbot.sensors import Lidar2D
    >>> scene = Scene.of([[2.0, 0.0], [0.0, 3.0]], radius=0.25)
    >>> found = ScanNetwork().detect(Lidar2D(rays=720).read(scene, Pose.of((0.0, 0.0), 0.0)))
    >>> sorted(np.abs(found.position).round().tolist())
    [[0.0, 3.0], [2.0, 0.0]]
    """

    reads: ClassVar[tuple[type[Reading], ...]] = (Scan,)
    weights: str = ""
    threshold: float = 0.5
    share: float = 0.6
    radius: float = 0.35
    margin: float = 0.15
    max_range: float = 12.0
    deviation: float = 0.08

    def __post_init__(self) -> None:
        for name in ("radius", "max_range", "deviation"):
            check_number("ScanNetwork", name, getattr(self, name), "m", exclusive_min=0.0)
        check_number("ScanNetwork", "margin", self.margin, "m", min=0.0)
        check_number("ScanNetwork", "share", self.share, min=0.0)
        if not 0.0 < self.threshold < 1.0:
            raise InputError(f"ScanNetwork: threshold = {self.threshold} must be above 0 and below 1")
        _layers(self.weights)

    def detect(self, reading: Reading, walls: Walls | None = None) -> Detections:
        """Return the people in a scan."""
        self.check(reading)
        assert isinstance(reading, Scan)
        pose = planar_pose(reading.pose)
        origin, heading = np.ascontiguousarray(pose.position[0]), float(pose.heading[0])
        angles, ranges = reading.angles, reading.ranges[0]
        step = float(angles[1] - angles[0]) if len(angles) > 1 else 2.0 * math.pi
        bearing = heading + angles
        use = np.isfinite(ranges) & (ranges <= self.max_range) & (ranges > 0.0)
        if walls is not None and len(walls):
            length = np.where(use, ranges, 0.0)
            points = origin + length[:, None] * np.stack([np.cos(bearing), np.sin(bearing)], axis=-1)
            hide_walls(points, np.ascontiguousarray(walls.segments()), self.margin, use)
        beams = np.flatnonzero(use)
        far = min(self.max_range, 0.5 / (2.0 * step))
        reach = np.where(np.isneginf(ranges) | np.isnan(ranges), 0.0, np.minimum(ranges, far))
        coverage = Coverage(origin, float(bearing[0]), step, reach)
        votes, score = self._votes(ranges, beams, bearing, step, origin)
        place, count = np.empty((len(beams), 2)), np.empty(len(beams), dtype=np.int64)
        fewest = self.share * np.minimum(4.0, 0.12 / (step * ranges[beams]))
        found = collect_votes(votes, score, self.threshold, self.radius, fewest, place, count)
        covariance = np.tile(self.deviation**2 * np.eye(2), (found, 1, 1))
        return Detections(float(np.max(reading.time)), place[:found].copy(), covariance, count[:found].copy(), coverage)

    def _votes(
        self, ranges: Floats, beams: NDArray[np.int64], bearing: Floats, step: float, origin: Floats
    ) -> tuple[Floats, Floats]:
        """Return the vote ``[B, 2]`` [m] and the probability ``[B]`` of each beam."""
        filled = np.ascontiguousarray(np.where(np.isposinf(ranges), FAR, np.where(np.isfinite(ranges), ranges, 0.0)))
        windows = np.empty((len(beams), SAMPLES))
        cut_windows(filled, beams, step, step * len(ranges) > 2.0 * math.pi - 0.5 * step, windows)
        answer = run_layers(_layers(self.weights), windows)
        length, angle = ranges[beams] + answer[:, 1], bearing[beams]
        along, across = (np.stack([f(angle), g(angle)], axis=-1) for f, g in ((np.cos, np.sin), (_minus_sin, np.cos)))
        votes = origin + length[:, None] * along + answer[:, 2:] * across
        return np.ascontiguousarray(votes), np.asarray(1.0 / (1.0 + np.exp(-np.clip(answer[:, 0], -30.0, 30.0))))


def _minus_sin(angle: Floats) -> Floats:
    return np.asarray(-np.sin(angle))


def _layers(weights: str) -> Layers:
    return read_layers(weights, "scan-network.npz", "ScanNetwork", SAMPLES, 3)

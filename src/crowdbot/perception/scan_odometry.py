"""ScanOdometry: the motion of a planar scanner from its scans alone."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from crowdbot.core import InputError, Pose, check_number
from crowdbot.sensors import Reading, Scan
from crowdbot.typing import Bools, Floats

FEWEST = 30
"""Smallest number of pairs of points of a step."""
ROUNDS = 30
"""Largest number of steps of a match."""
SMALLEST = 1e-4
"""Change of the pose at which a match ends [m], [rad]."""
NEAREST, SHRINK = 0.12, 0.8
"""Smallest search distance of the nearest point [m], and its ratio from step to step."""
SPREAD = 0.02
"""Smallest scale of the residuals [m] beyond which a pair counts less."""
SURFACE = 0.25
"""Points farther apart than this [m], plus 8 beam spacings, are not of one surface."""
CELL = 0.1
"""Width of a cell of the ground [m], of which the map has one point."""
KEPT = 10.0
"""Points of the map are kept up to this distance from the scanner [m]."""
BEHIND = 0.2
"""A point of the map is dropped if beams end farther than this behind it [m]."""


@dataclass(frozen=True)
class ScanOdometryState:
    """State of :class:`ScanOdometry`.

    Fields:
        points, normals: ``[P, 2]`` of the surfaces around the scanner, in the frame of the first scan [m].
        key, pose, step: ``[3]`` poses x, y [m] and heading [rad] of the last scan that was added to these points and of
            the last scan, and the last motion in the frame of the scan before.
    """

    points: Floats
    normals: Floats
    key: Floats
    pose: Floats
    step: Floats


@dataclass(frozen=True, kw_only=True)
class ScanOdometry:
    """Odometry of a planar scanner by matching of scans; the first scan is at the origin.

    Each scan is placed on a map of the surfaces around it by the iterative closest point with the distance from the
    line through the neighbouring points (Censi (2008), An ICP variant using a point-to-line metric, doi
    10.1109/ROBOT.2008.4543181), from the pose that the last motion predicts. Pairs with large distances, such as those
    on people, have small weights. A scan is added to the map after a motion by ``distance`` or ``turn``, or if it
    overlaps too little: its points in cells that have none yet, so that a place that was seen before corrects the pose.
    Points through which beams pass by then, such as those of people who have walked on, are dropped. Along a corridor
    without ends the motion is not observable, and in new surroundings errors add up.

    Fields:
        search: largest distance of two points of a pair [m].
        distance, turn: motion after which a scan is added to the map [m], [rad].
        overlap: share of the points with a partner below which it is added, too.

    Raises:
        InputError: a value is not allowed.

    >>> from crowdbot.core import Pose, Scene
    >>> from crowdbot.sensors import Lidar2D
    >>> hall = Scene.of([[1.0, 3.0]], walls=[[[-3.0, -2.0], [4.0, -2.0], [4.0, 5.0], [-3.0, 5.0]]])
    >>> odometry, state = ScanOdometry(), None
    >>> for k in range(20):
    ...     pose, state = odometry.update(Lidar2D(rays=720).read(hall, Pose.of((0.05 * k, 0.0), 0.02 * k)), state)
    >>> pose.position.round(2).tolist(), pose.heading.round(2).tolist()
    ([[0.95, -0.0]], [0.38])
    """

    search: float = 0.6
    distance: float = 0.3
    turn: float = 0.25
    overlap: float = 0.7

    def __post_init__(self) -> None:
        name = type(self).__name__
        for word, unit in (("search", "m"), ("distance", "m"), ("turn", "rad")):
            check_number(name, word, getattr(self, word), unit, exclusive_min=0.0)
        check_number(name, "overlap", self.overlap, min=0.0, max=1.0)

    def update(self, reading: Reading, state: ScanOdometryState | None = None) -> tuple[Pose, ScanOdometryState]:
        """Return the pose of the scanner, relative to that of the first scan, and the next state.

        Args:
            reading: planar scan of one environment; its pose is not used.
            state: state of the last scan; None for the first one.

        Raises:
            InputError: the reading is not a planar scan of one environment.
        """
        if not isinstance(reading, Scan) or len(reading.pose.position) != 1:
            is_scan = isinstance(reading, Scan)
            what = f"has {len(reading.pose.position)} environments" if is_scan else f"is {type(reading).__name__}"
            raise InputError(f"ScanOdometry: the reading {what}, it must be one planar scan")
        points, normals, flat = _surfaces(reading)
        if state is None:
            zero = np.zeros(3)
            none = ScanOdometryState(np.zeros((0, 2)), np.zeros((0, 2)), zero, zero, zero)
            return _pose(zero), _added(none, reading, points[flat], normals[flat])
        pose, overlap = self._match(state, points, _compose(state.pose, state.step))
        moved = replace(state, pose=pose, step=_compose(_inverse(state.pose), pose))
        relative = _compose(_inverse(state.key), pose)
        far = math.hypot(relative[0], relative[1]) > self.distance or abs(relative[2]) > self.turn
        if far or overlap < self.overlap:
            moved = _added(moved, reading, points[flat], normals[flat])
        return _pose(pose), moved

    def _match(self, state: ScanOdometryState, points: Floats, guess: Floats) -> tuple[Floats, float]:
        """Return the pose, and the share of the points that have a partner in the map."""
        from scipy.spatial import cKDTree

        if len(state.points) < FEWEST:
            return guess, 0.0
        tree: Any = cKDTree(state.points)
        pose, search, overlap = guess.copy(), self.search, 0.0
        for _ in range(ROUNDS):
            placed = _place(pose, points)
            away, index = tree.query(placed, distance_upper_bound=search)
            near: Bools = np.isfinite(away)
            if near.sum() < FEWEST:
                return guess, 0.0
            overlap = float(near.mean())
            normal, arm = state.normals[index[near]], placed[near] - pose[:2]
            residual = ((placed[near] - state.points[index[near]]) * normal).sum(axis=1)
            slope = np.column_stack([normal, arm[:, 0] * normal[:, 1] - arm[:, 1] * normal[:, 0]])
            scale = max(SPREAD, 1.5 * float(np.median(np.abs(residual))))
            weighted = slope / (1.0 + (residual / scale) ** 2)[:, None]
            change = np.linalg.solve(weighted.T @ slope + 1e-6 * np.eye(3), -weighted.T @ residual)
            pose = pose + change
            search = max(NEAREST, SHRINK * search)
            if np.abs(change).max() < SMALLEST:
                break
        return pose, overlap


def _surfaces(scan: Scan) -> tuple[Floats, Floats, Bools]:
    """Return points and normals ``[P, 2]`` in the frame of the scanner, and which points are on a surface ``[P]``."""
    ranges, angles = scan.ranges[0], scan.angles
    there = np.isfinite(ranges) & (ranges > 0.0)
    points = ranges[there, None] * np.column_stack([np.cos(angles[there]), np.sin(angles[there])])
    along = np.roll(points, -2, axis=0) - np.roll(points, 2, axis=0)
    length = np.hypot(along[:, 0], along[:, 1])
    spacing = float(np.abs(np.diff(angles)).max(initial=0.0)) * ranges[there]
    flat = (length > 0.0) & (length < SURFACE + 8.0 * spacing)
    flat[:2] = flat[-2:] = False
    normals = np.column_stack([-along[:, 1], along[:, 0]]) / np.maximum(length, 1e-12)[:, None]
    return points, normals, flat


def _added(state: ScanOdometryState, scan: Scan, points: Floats, normals: Floats) -> ScanOdometryState:
    """Return the state with the ``points`` and ``normals`` ``[P, 2]`` of surfaces of the last scan in its map."""
    kept = np.hypot(*(state.points - state.pose[:2]).T) < KEPT
    kept &= ~_seen_through(scan, _place(_inverse(state.pose), state.points))
    placed, turned = _place(state.pose, points), _place(np.array([0.0, 0.0, state.pose[2]]), normals)
    cells = np.floor(np.concatenate([state.points[kept], placed]) / CELL)
    _, first = np.unique(cells, axis=0, return_index=True)  # a point of the map comes before the new ones of its cell
    both = np.concatenate([state.points[kept], placed])[first], np.concatenate([state.normals[kept], turned])[first]
    return replace(state, points=both[0], normals=both[1], key=state.pose)


def _seen_through(scan: Scan, points: Floats) -> Bools:
    """Return which points ``[P, 2]`` in the frame of the scanner have three beams that end behind them."""
    ranges = np.where(np.isfinite(scan.ranges[0]), scan.ranges[0], 0.0)  # a beam without a return shows nothing
    spacing = float(np.median(np.diff(scan.angles)))
    beam = np.rint((np.arctan2(points[:, 1], points[:, 0]) - scan.angles[0]) / spacing).astype(np.int64)
    inside = (beam > 0) & (beam < len(ranges) - 1)
    near = np.clip(beam, 1, len(ranges) - 2)
    clear = np.minimum(np.minimum(ranges[near - 1], ranges[near]), ranges[near + 1])
    return np.asarray(inside & (clear > np.hypot(points[:, 0], points[:, 1]) + BEHIND))


def _place(pose: Floats, points: Floats) -> Floats:
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return np.asarray(points @ np.array([[c, s], [-s, c]]) + pose[:2])


def _compose(first: Floats, second: Floats) -> Floats:
    return np.array([*_place(first, second[:2]), first[2] + second[2]])


def _inverse(pose: Floats) -> Floats:
    return np.array([*_place(np.array([0.0, 0.0, -pose[2]]), -pose[:2]), -pose[2]])


def _pose(pose: Floats) -> Pose:
    return Pose.of((float(pose[0]), float(pose[1])), float(pose[2]))

"""The contract of predictors of scans: past scans and the motion of the sensor give future scans."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import InputError, Pose
from crowdbot.metrics import OccupancyGrid
from crowdbot.sensors import Scan, planar_pose
from crowdbot.typing import Floats


@dataclass(frozen=True)
class ScanForecast:
    """K futures of the scans at T future instants.

    Fields:
        ahead: ``[T]`` time after the last scan [s].
        pose: T poses of the sensor in the world.
        angles: ``[R]`` angles of the beams in the sensor frame [rad].
        ranges: ``[K, T, R]`` [m]; ``+inf`` without a return.
        weight: ``[K]`` probabilities of the futures, with sum 1.

    Raises:
        InputError: a shape is wrong.
    """

    ahead: Floats
    pose: Pose
    angles: Floats
    ranges: Floats
    weight: Floats

    def __post_init__(self) -> None:
        shape = (len(self.weight), len(self.ahead), len(self.angles))
        if self.ranges.shape != shape or len(self.pose.heading) != shape[1]:
            raise InputError(
                f"scan forecast: ranges have shape {list(self.ranges.shape)} and there are {len(self.pose.heading)}"
                f" poses; {list(shape)} and {shape[1]} are expected"
            )

    def points(self) -> Floats:
        """Return the end points ``[K, T, R, 2]`` of the beams in the sensor frame [m], NaN without a return."""
        away = np.where(np.isfinite(self.ranges), self.ranges, np.nan)
        return np.asarray(away[..., None] * np.stack([np.cos(self.angles), np.sin(self.angles)], axis=-1))

    def occupancy(self, grid: OccupancyGrid | None = None) -> Floats:
        """Return the probability ``[T, N, N]`` that each cell of a grid before the sensor has a return."""
        cells = (grid or OccupancyGrid()).occupied(self.points())
        return np.asarray(np.einsum("k,ktxy->txy", self.weight, cells.astype(np.float64)))


@dataclass(frozen=True, kw_only=True)
class ScanPredictor(ABC):
    """Predicts the scans of a planar laser scanner: a frozen specification and pure functions.

    A predictor only uses what a real scanner measures: never ``hit``, ``part`` or other ground truth of a scan. The
    poses of the scans are those of the sensor in the world, as from odometry. The state is never changed in place, so
    that a copy of a reference is a snapshot.
    """

    @abstractmethod
    def begin(self) -> Any:
        """Return the state before the first scan."""

    @abstractmethod
    def update(self, scan: Scan, state: Any) -> Any:
        """Return the state after a scan of one environment."""

    @abstractmethod
    def forecast(
        self, state: Any, ahead: Floats, pose: Pose | None, samples: int, rng: np.random.Generator | None
    ) -> ScanForecast:
        """Return the scans ``ahead`` ``[T]`` [s] after the last one; arguments as for :meth:`predict`."""

    def predict(
        self,
        scans: Sequence[Scan],
        ahead: ArrayLike,
        pose: Pose | None = None,
        samples: int = 1,
        rng: np.random.Generator | None = None,
    ) -> ScanForecast:
        """Return the future scans.

        Args:
            scans: past scans of one environment, in the order of time; the last one is now.
            ahead: ``[T]`` times after the last scan [s].
            pose: T future poses of the sensor in the world, such as those of a plan; default: the sensor keeps the
                velocity of the last scans.
            samples: number of futures; predictors without uncertainty return one.
            rng: random generator; default: ``stream(0, "predict")``.

        Raises:
            InputError: no scan, several environments, or times and poses that do not fit.
        """
        times = np.asarray(ahead, dtype=np.float64).reshape(-1)
        if not len(scans):
            raise InputError(f"{type(self).__name__}: a prediction needs at least one scan")
        if samples < 1 or not (np.isfinite(times) & (times > 0.0)).all():
            raise InputError(f"{type(self).__name__}: samples = {samples} and all times ahead must be above 0")
        if pose is not None and len(pose.heading) != len(times):
            raise InputError(f"{type(self).__name__}: {len(pose.heading)} poses for {len(times)} times")
        state = self.begin()
        for scan in scans:
            if not isinstance(scan, Scan) or len(scan.ranges) != 1:
                raise InputError(f"{type(self).__name__}: each reading must be a Scan of one environment")
            state = self.update(scan, state)
        return self.forecast(state, times, pose, samples, rng)


def continue_motion(scans: Sequence[Scan], ahead: Floats) -> Pose:
    """Return the poses ``[T]`` of a sensor that keeps the velocity and the turn rate of its last scans.

    Args:
        scans: past scans; the velocity is that from the first to the last one.
        ahead: ``[T]`` times after the last scan [s].

    >>> empty = np.zeros((1, 0))
    >>> rest = (empty, np.zeros(0), empty, empty, empty)
    >>> past = [Scan(np.array([t]), Pose.of((t, 0.0), 0.0), *rest) for t in (0.0, 1.0)]
    >>> continue_motion(past, np.array([2.0])).position.tolist()
    [[3.0, 0.0]]
    """
    first, last = planar_pose(scans[0].pose), planar_pose(scans[-1].pose)
    passed = float(np.max(scans[-1].time) - np.max(scans[0].time))
    heading = float(last.heading[0])
    turn, forward, left = 0.0, 0.0, 0.0
    if passed > 0.0:
        turn = float(np.angle(np.exp(1j * (heading - first.heading[0])))) / passed
        chord = (last.position[0] - first.position[0]) / passed
        middle = heading - 0.5 * turn * passed
        sinc = float(np.sinc(0.5 * turn * passed / np.pi))
        forward = (np.cos(middle) * chord[0] + np.sin(middle) * chord[1]) / sinc
        left = (-np.sin(middle) * chord[0] + np.cos(middle) * chord[1]) / sinc
    half = heading + 0.5 * turn * ahead
    length = ahead * np.sinc(0.5 * turn * ahead / np.pi)
    x = last.position[0, 0] + length * (forward * np.cos(half) - left * np.sin(half))
    y = last.position[0, 1] + length * (forward * np.sin(half) + left * np.cos(half))
    return Pose(np.stack([x, y], axis=-1), heading + turn * ahead)

"""ScanForecast: future scans of a laser scanner."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError, Pose
from crowdbot.metrics import OccupancyGrid
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

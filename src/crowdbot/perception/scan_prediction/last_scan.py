"""LastScan and MovedScan: the future looks like the last scan."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crowdbot.core import Pose
from crowdbot.sensors import Scan, cast_plane
from crowdbot.typing import Floats

from .scan_forecast import ScanForecast
from .scan_predictor import ScanPredictor, continue_motion
from .static_segments import scan_segments

MEMORY = 5
"""Number of scans that give the velocity of the sensor."""


@dataclass(frozen=True, kw_only=True)
class LastScan(ScanPredictor):
    """Every future scan has the ranges of the last one.

    The state is a tuple of the last scans.

    >>> LastScan().begin()
    ()
    """

    def begin(self) -> tuple[Scan, ...]:
        """Return no scans."""
        return ()

    def update(self, scan: Scan, state: tuple[Scan, ...]) -> tuple[Scan, ...]:
        """Return the last scans."""
        return (*state, scan)[-MEMORY:]

    def forecast(
        self,
        state: tuple[Scan, ...],
        ahead: Floats,
        pose: Pose | None = None,
        samples: int = 1,
        rng: np.random.Generator | None = None,
    ) -> ScanForecast:
        """Return the last ranges at all times, as one future."""
        there = continue_motion(state, ahead) if pose is None else pose
        ranges = np.where(state[-1].ranges[0] > 0.0, state[-1].ranges[0], np.inf)
        repeated = np.broadcast_to(ranges, (1, len(ahead), len(ranges))).copy()
        return ScanForecast(ahead, there, state[-1].angles, repeated, np.ones(1))


@dataclass(frozen=True, kw_only=True)
class MovedScan(LastScan):
    """The surfaces of the last scan, seen from the future poses of the sensor; nothing moves but the sensor.

    Fields:
        range_max: largest range [m]; farther surfaces give no return.
    """

    range_max: float = 30.0

    def forecast(
        self,
        state: tuple[Scan, ...],
        ahead: Floats,
        pose: Pose | None = None,
        samples: int = 1,
        rng: np.random.Generator | None = None,
    ) -> ScanForecast:
        """Return the last surfaces from the future poses, as one future."""
        there = continue_motion(state, ahead) if pose is None else pose
        nobody = np.zeros((len(ahead), 0, 2))
        angles = state[-1].angles
        ranges, _ = cast_plane(there, angles, nobody, nobody[..., 0], scan_segments(state[-1]), self.range_max)
        return ScanForecast(ahead, there, angles, ranges[None], np.ones(1))

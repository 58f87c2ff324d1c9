"""ScanProtocol: what predictors of scans see, and where and when their forecasts are compared with the true scans."""

from __future__ import annotations

from dataclasses import dataclass, field

from crowdbot.core import InputError, check_number
from crowdbot.metrics import OccupancyGrid

WARM_UP = 1.0
"""Time of a log before the first forecast [s], if all scans are seen."""


@dataclass(frozen=True, kw_only=True)
class ScanProtocol:
    """Protocol of the evaluation of predictors of scans.

    Fields:
        horizons: times ahead [s]; each is rounded to a scan.
        every: time between forecasts [s].
        past: number of scans that a forecast sees; 0: all before, at least 1 s.
        grid: cells of the occupancy.
        known_motion: whether the future poses of the sensor are given, as from a plan; otherwise they are predicted.
        range_max: range that counts for missing returns [m].

    Raises:
        InputError: a value is not allowed.

    >>> ScanProtocol().horizons
    (0.1, 0.5, 1.0, 2.0, 3.0)
    """

    horizons: tuple[float, ...] = (0.1, 0.5, 1.0, 2.0, 3.0)
    every: float = 0.5
    past: int = 0
    grid: OccupancyGrid = field(default_factory=OccupancyGrid)
    known_motion: bool = True
    range_max: float = 10.0

    def __post_init__(self) -> None:
        if not self.horizons:
            raise InputError("ScanProtocol: horizons is empty, at least one time ahead is needed")
        for ahead in self.horizons:
            check_number("ScanProtocol", "horizons", ahead, "s", exclusive_min=0.0)
        check_number("ScanProtocol", "every", self.every, "s", exclusive_min=0.0)
        check_number("ScanProtocol", "past", self.past, min=0, whole=True)
        check_number("ScanProtocol", "range_max", self.range_max, "m", exclusive_min=0.0)

    def first(self, period: float) -> int:
        """Return the number of the scan of the first forecast, for the time between scans [s]."""
        return self.past - 1 if self.past else round(WARM_UP / period)

    def min_duration(self, period: float) -> float:
        """Return the shortest log with a forecast [s], for the time between scans [s].

        >>> SOGMP.min_duration(0.1)
        1.9
        """
        return round(self.first(period) * period + max(self.horizons), 9)


SOGMP = ScanProtocol(
    horizons=(0.1, 0.3, 0.5, 0.7, 1.0), past=10, grid=OccupancyGrid(dilation=0), known_motion=False
)  # fmt: skip
"""Protocol of Xie and Dames (2023), Stochastic occupancy grid map prediction in dynamic scenes.

10 past scans at 10 Hz, 64 x 64 cells of 0.1 m without dilation, motion of the robot predicted, up to 10 scans ahead
(https://proceedings.mlr.press/v229/xie23a.html).
"""

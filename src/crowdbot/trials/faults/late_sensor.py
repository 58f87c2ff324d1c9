"""LateSensor: a sensor whose readings arrive late."""

from __future__ import annotations

from dataclasses import dataclass

from crowdbot.core import InputError

from .fault import SensorFault

MOST = 60.0
"""Largest delay [s]."""


@dataclass(frozen=True)
class LateSensor(SensorFault):
    """A sensor whose readings arrive with an additional delay, in their order; people are where they were measured.

    Fields:
        delay: additional delay [s], rounded to time steps.

    Raises:
        InputError: the delay is not above 0 or is larger than 60 s.

    >>> LateSensor(delay=0.5).numbers()[2]
    0.5
    """

    delay: float = 0.5

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0.0 < self.delay <= MOST:
            raise InputError(f"delay = {self.delay:g} s must be above 0 and at most {MOST:g}")

    @classmethod
    def number_names(cls) -> tuple[str, ...]:
        """Return the names of the numbers."""
        return (*super().number_names(), "delay")

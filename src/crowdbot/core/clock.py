"""Clocks: simulated time is an integer tick times an exact step in nanoseconds.

The wall clock never affects the result of a simulation; :class:`PacedClock` reads it only to wait.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field

from .errors import InputError

__all__ = ["Clock", "ExternalClock", "FreeClock", "PacedClock"]

SECOND = 1_000_000_000


@dataclass
class Clock:
    """Simulated time [s] as ``tick`` times an exact step.

    Args:
        dt: length of one tick [s], 1e-9 to 3600; rounded to whole nanoseconds.

    >>> clock = FreeClock(0.1)
    >>> for _ in range(3):
    ...     clock.advance()
    >>> clock.time
    0.3
    """

    dt: float
    tick: int = 0
    step_ns: int = field(init=False)

    def __post_init__(self) -> None:
        if not 1e-9 <= self.dt <= 3600.0:
            raise InputError(f"time step {self.dt} s is outside 1e-9 to 3600 s")
        self.step_ns = round(self.dt * SECOND)

    @property
    def nanoseconds(self) -> int:
        """Simulated time [ns]."""
        return self.tick * self.step_ns

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.nanoseconds / SECOND

    def every(self, period: float) -> int:
        """Return the number of ticks in ``period`` [s]; the period must be a positive multiple of ``dt``."""
        ticks = round(period * SECOND / self.step_ns)
        if ticks < 1 or abs(ticks * self.step_ns - round(period * SECOND)) > 1000:
            raise InputError(f"period {period} s is not a whole number of time steps of {self.dt} s")
        return ticks

    def advance(self) -> None:
        """Advance by one tick."""
        self.tick += 1


class FreeClock(Clock):
    """Runs as fast as possible."""


@dataclass
class PacedClock(Clock):
    """Limits simulated time to ``rate`` times real time by waiting."""

    rate: float = 1.0
    _begin: float | None = field(default=None, init=False, repr=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.rate > 0.0:
            raise InputError(f"rate {self.rate} of a paced clock must be above 0")

    def advance(self) -> None:
        """Advance by one tick and sleep until it is due."""
        now = time.monotonic()
        if self._begin is None:
            self._begin = now - self.time / self.rate
        super().advance()
        ahead = self._begin + self.time / self.rate - time.monotonic()
        if ahead > 0.0:
            time.sleep(ahead)


class ExternalClock(Clock):
    """Follows an external time (ROS, a headset) in whole ticks."""

    def due(self, nanoseconds: int) -> int:
        """Return the number of ticks until ``nanoseconds``; time must not go backwards."""
        if nanoseconds < self.nanoseconds:
            raise InputError(f"external time went back from {self.nanoseconds} ns to {nanoseconds} ns")
        return nanoseconds // self.step_ns - self.tick

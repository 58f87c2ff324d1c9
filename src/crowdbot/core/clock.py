"""Clocks: simulated time is an integer tick times an exact step in nanoseconds.

The wall clock never affects the result of a simulation; :class:`PacedClock` reads it only to wait.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from .errors import InputError
from .tick_schedule import SECOND, TickSchedule

MAX_LAG = 0.25
"""Longest delay [s] that a paced clock catches up."""


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

    def schedule(self, period: float) -> TickSchedule:
        """Return the ticks at which something with a period [s] is due.

        Raises:
            InputError: the period is not finite, or shorter than the time step.

        >>> FreeClock(0.05).schedule(0.12).next_due(1)
        3
        """
        if not math.isfinite(period):
            raise InputError(f"period {period} s must be finite and at least the time step of {self.dt:g} s")
        return TickSchedule(self.step_ns, round(period * SECOND))

    def advance(self) -> None:
        """Advance by one tick."""
        self.tick += 1


class FreeClock(Clock):
    """Runs as fast as possible."""


@dataclass
class PacedClock(Clock):
    """Limits simulated time to ``rate`` times real time by waiting.

    A late tick is caught up, without waiting, if it is at most ``MAX_LAG`` late; after a longer gap, the schedule
    starts anew from there. The rate may change while the clock runs; it applies from the next tick on.

    Args:
        rate: simulated seconds per real second, above 0.
        monotonic: source of real time [s].
        sleep: function that waits for a time [s].

    >>> clock = PacedClock(0.05, rate=50.0)
    >>> clock.pause()
    >>> clock.advance()
    >>> clock.resume()
    >>> clock.tick, clock.paused
    (1, False)
    """

    rate: float = 1.0
    monotonic: Callable[[], float] = field(default=time.monotonic, compare=False, repr=False)
    sleep: Callable[[float], None] = field(default=time.sleep, compare=False, repr=False)
    _due: float | None = field(default=None, init=False, compare=False, repr=False)
    _lag: float | None = field(default=None, init=False, compare=False, repr=False)

    def __setattr__(self, name: str, value: Any) -> None:
        """Set a field; the rate must be above 0 and finite."""
        if name == "rate" and not 0.0 < value < math.inf:
            raise InputError(f"rate {value} of a paced clock must be above 0 and finite")
        super().__setattr__(name, value)

    @property
    def paused(self) -> bool:
        """Whether the clock is paused."""
        return self._lag is not None

    def pause(self) -> None:
        """Stop the schedule until :meth:`resume`; without effect if paused."""
        if self._lag is None:
            self._lag = 0.0 if self._due is None else self.monotonic() - self._due

    def resume(self) -> None:
        """Continue the schedule where it was paused; without effect if not paused."""
        if self._lag is not None:
            self._due = self.monotonic() - self._lag
            self._lag = None

    def advance(self) -> None:
        """Advance by one tick and sleep until it is due; a paused clock advances immediately, for single steps."""
        if self._lag is not None:
            super().advance()
            return
        if self._due is None:
            self._due = self.monotonic()
        super().advance()
        self._due += self.step_ns / SECOND / self.rate
        now = self.monotonic()
        if now < self._due:
            self.sleep(self._due - now)
        elif now - self._due > MAX_LAG:
            self._due = now


class ExternalClock(Clock):
    """Follows an external time (ROS, a headset) in whole ticks."""

    def due(self, nanoseconds: int) -> int:
        """Return the number of ticks until ``nanoseconds``; time must not go backwards."""
        if nanoseconds < self.nanoseconds:
            raise InputError(f"external time went back from {self.nanoseconds} ns to {nanoseconds} ns")
        return nanoseconds // self.step_ns - self.tick

"""Clocks and schedules: simulated time is an integer tick times an exact step in nanoseconds.

The wall clock never affects the result of a simulation; :class:`PacedClock` reads it only to wait.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from .errors import InputError

SECOND = 1_000_000_000
"""Nanoseconds in a second."""
SLACK = 1000
"""Largest difference [ns] between a period and the whole number of steps that replaces it."""
MIN_RATIO = 1000
"""Such a difference is at most this fraction of the period, which matters for periods below 1 ms."""
LARGEST = 2**62


def whole_ticks(step_ns: int, nanoseconds: int) -> int:
    """Return the number of steps in a time [ns], 0 if it is not a whole number of steps within the tolerance.

    The tolerance is 1000 ns, and for times below 1 ms a thousandth of the time.

    >>> whole_ticks(50_000_000, 400_000_000), whole_ticks(16_666_667, 100_000_000), whole_ticks(13_888_889, 10**8)
    (8, 6, 0)
    """
    ticks = (2 * nanoseconds + step_ns) // (2 * step_ns)
    off = abs(ticks * step_ns - nanoseconds)
    return ticks if off <= SLACK and off * MIN_RATIO <= nanoseconds else 0


@dataclass(frozen=True)
class TickSchedule:
    """Ticks at which something with a period is due; any period of at least one step is allowed.

    Instant k is k times the period. It is due at the first tick at or after it, so the mean rate is exact and no
    error accumulates. Tick 0 is due. A period within 1000 ns of a whole number of steps is that number of steps.

    Args:
        step_ns: length of a tick [ns].
        period_ns: period [ns].

    Attributes:
        every: number of ticks in a period, 0 if it is not a whole number.

    Raises:
        InputError: the step is not above 0, or the period is shorter than the step.

    >>> tenth = TickSchedule(13_888_889, 100_000_000)  # 10 Hz in steps of 1/72 s
    >>> [tick for tick in range(30) if tenth.is_due(tick)]
    [0, 8, 15, 22, 29]
    >>> tenth.is_due(np.array([7, 8])).tolist(), tenth.next_due(9), tenth.index(14), tenth.every
    ([False, True], 15, 1, 0)
    """

    step_ns: int
    period_ns: int
    every: int = field(init=False, compare=False, repr=False)
    _step: int = field(init=False, compare=False, repr=False)
    _period: int = field(init=False, compare=False, repr=False)

    def __post_init__(self) -> None:
        if self.step_ns < 1:
            raise InputError(f"step_ns = {self.step_ns} must be at least 1 ns")
        every = whole_ticks(self.step_ns, self.period_ns) if self.period_ns > 0 else 0
        if self.period_ns < self.step_ns and not every:
            raise InputError(
                f"period {self.period_ns / SECOND:g} s is shorter than the time step of {self.step_ns / SECOND:g} s;"
                " it must be at least one step: take a longer period or a shorter step"
            )
        common = math.gcd(self.step_ns, self.period_ns)
        step, period = (1, every) if every else (self.step_ns // common, self.period_ns // common)
        for name, value in (("every", every), ("_step", step), ("_period", period)):
            object.__setattr__(self, name, value)

    @overload
    def is_due(self, tick: int) -> bool: ...
    @overload
    def is_due(self, tick: NDArray[np.integer]) -> NDArray[np.bool_]: ...
    def is_due(self, tick: int | NDArray[np.integer]) -> bool | NDArray[np.bool_]:
        """Return whether an instant is due at a tick, or at each tick of an integer array."""
        if isinstance(tick, np.ndarray):
            phase = self._ticks(tick) % self._period * self._step % self._period
            return np.asarray(phase < self._step, dtype=np.bool_)
        return int(tick) * self._step % self._period < self._step

    @overload
    def index(self, tick: int) -> int: ...
    @overload
    def index(self, tick: NDArray[np.integer]) -> NDArray[np.int64]: ...
    def index(self, tick: int | NDArray[np.integer]) -> int | NDArray[np.int64]:
        """Return the number of the last instant at or before each tick; the instant at tick 0 has number 0."""
        if not isinstance(tick, np.ndarray):
            return int(tick) * self._step // self._period
        ticks = self._ticks(tick)
        whole, rest = ticks // self._period, ticks % self._period
        return np.asarray(whole * self._step + rest * self._step // self._period, dtype=np.int64)

    def next_due(self, tick: int) -> int:
        """Return the first tick at or after ``tick`` that is due."""
        if self.is_due(int(tick)):
            return int(tick)
        return self.tick_of(self.index(tick) + 1)

    def tick_of(self, index: int) -> int:
        """Return the tick at which the instant with a number is due.

        >>> TickSchedule(13_888_889, 100_000_000).tick_of(4)
        29
        """
        return -(-index * self._period // self._step)

    def _ticks(self, ticks: NDArray[np.integer]) -> NDArray[Any]:
        """Return ticks as 64-bit integers, or as Python's where products of the period would not fit."""
        if not np.issubdtype(ticks.dtype, np.integer):
            raise InputError(f"ticks have dtype {ticks.dtype}; they must be integers")
        return ticks.astype(np.int64 if self._period * self._step < LARGEST else object)


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
    late: float = field(default=0.0, init=False, compare=False, repr=False)
    """Real time [s] by which ticks were late and that was not caught up."""
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

    def late_remark(self, option: str) -> str:
        """Return a warning if the run could not keep up, otherwise an empty text.

        Args:
            option: name of the option that sets the rate.
        """
        if self.late <= 0.0:
            return ""
        return (
            f"the run could not keep up with {option} {self.rate:g}: {self.late:.1f} s late. People and robots that are"
            " moved live are too fast in simulated time; use a simpler trial or a faster machine"
        )

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
        # advance by one tick and sleep until it is due; a paused clock advances immediately, for single steps
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
            self.late += now - self._due
            self._due = now


class ExternalClock(Clock):
    """Follows an external time (ROS, a headset) in whole ticks."""

    def due(self, nanoseconds: int) -> int:
        """Return the number of ticks until ``nanoseconds``; time must not go backwards."""
        if nanoseconds < self.nanoseconds:
            raise InputError(f"external time went back from {self.nanoseconds} ns to {nanoseconds} ns")
        return nanoseconds // self.step_ns - self.tick

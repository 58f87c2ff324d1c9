"""TickSchedule: the ticks of a clock at which something periodic is due, in exact integer arithmetic."""

from __future__ import annotations

import math
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

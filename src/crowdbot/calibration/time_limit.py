"""TimeLimit: the time until which a search may evaluate candidates."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

from crowdbot.core import InputError


@dataclass(frozen=True)
class TimeLimit:
    """Time at which a search stops, whatever its budget of evaluations.

    The starts of a search are always evaluated. After them it evaluates candidates in parts that fit into half of the
    remaining time, by the speed of the part before. Results depend on the speed of the computer, therefore.

    Fields:
        end: reading of the clock at which the search stops [s].
        clock: returns the time [s].

    Raises:
        InputError: ``end`` is not a number.

    >>> now = iter([10.0, 10.5])
    >>> limit = TimeLimit(10.4, lambda: next(now))
    >>> round(limit.remaining, 3), limit.remaining
    (0.4, 0.0)
    """

    end: float
    clock: Callable[[], float] = time.perf_counter

    def __post_init__(self) -> None:
        if self.end != self.end:
            raise InputError("time limit: end = nan must be a number of seconds on its clock")

    @property
    def remaining(self) -> float:
        """Time that is left [s], 0 after the end."""
        return max(0.0, self.end - self.clock())

    def share(self, parts: int) -> TimeLimit:
        """Return the limit of the next of ``parts`` searches that have the same time each."""
        if parts == 1:
            return self
        now = self.clock()
        return TimeLimit(now + max(0.0, self.end - now) / parts, self.clock)

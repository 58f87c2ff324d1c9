"""CommandLatency: real time from the messages of a step to the command that answers them."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

MOST = 100_000
"""Largest number of latencies that are kept; the oldest are dropped."""


class LatencySummary(NamedTuple):
    """Latency of commands in real time.

    Fields:
        commands: number of commands that answered a step.
        median, p99: median and 99th percentile [s]; NaN without commands.
    """

    commands: int
    median: float
    p99: float


class CommandLatency:
    """Measures the real time between the messages of a step and the first command of a robot after them.

    Args:
        monotonic: source of real time [s].

    >>> latency = CommandLatency(iter([1.0, 1.004, 2.0, 2.01]).__next__)
    >>> for _ in range(2):
    ...     latency.note_step()
    ...     latency.note_command("robot")
    >>> [round(value, 4) for value in latency.summary()]
    [2, 0.007, 0.0099]
    """

    def __init__(self, monotonic: Callable[[], float] = time.monotonic) -> None:
        self.monotonic = monotonic
        self._begin = 0.0
        self._answered: set[str] | None = None
        self._found: deque[float] = deque(maxlen=MOST)

    def note_step(self) -> None:
        """Note that the messages of a step are sent now."""
        self._begin, self._answered = self.monotonic(), set()

    def note_command(self, robot: str) -> None:
        """Note a command of a robot; only the first one after a step counts."""
        if self._answered is not None and robot not in self._answered:
            self._answered.add(robot)
            self._found.append(self.monotonic() - self._begin)

    def summary(self) -> LatencySummary:
        """Return the number of commands, median and 99th percentile."""
        found = np.array(self._found)
        if not len(found):
            return LatencySummary(0, float("nan"), float("nan"))
        return LatencySummary(len(found), float(np.median(found)), float(np.percentile(found, 99)))

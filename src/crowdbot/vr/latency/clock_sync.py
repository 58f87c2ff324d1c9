"""ClockSync: offset between the clock of a headset and that of the server."""

from __future__ import annotations

import math
from collections import deque

DRIFT = 1e-4
"""Assumed largest drift between two clocks [s/s]: an old exchange counts as less certain by it."""


class ClockSync:
    """Estimates the offset of two clocks from exchanges of messages, as the Network Time Protocol does.

    A message leaves the headset at ``t0`` of its clock, arrives at ``t1`` and is answered at ``t2`` of the server's;
    the answer arrives at ``t3``. The delay is ``(t3 - t0) - (t2 - t1)`` and the offset
    ``((t1 - t0) + (t2 - t3)) / 2``, with an error of at most half of the delay. Of the latest exchanges, the one with
    the smallest delay counts, since queues only make delays longer and asymmetric.

    Source: RFC 5905, sections 8 and 10 (clock filter).

    Args:
        size: number of exchanges that are compared.

    >>> sync = ClockSync()
    >>> sync.add(0.0, 100.004, 100.004, 0.008)
    >>> sync.add(1.0, 101.050, 101.051, 1.057)
    >>> round(sync.to_server(2.0), 6), round(sync.delay, 6)
    (102.0, 0.008)
    """

    def __init__(self, size: int = 64) -> None:
        self._exchanges: deque[tuple[float, float, float]] = deque(maxlen=size)  # t3, offset, delay
        self.offset = self.delay = math.nan
        """Time of the server minus that of the headset, and round trip of the exchange that counts [s]."""

    def __bool__(self) -> bool:
        """Return whether there was an exchange."""
        return bool(self._exchanges)

    def add(self, t0: float, t1: float, t2: float, t3: float) -> None:
        """Add an exchange [s]; one whose times are impossible or not finite is left out."""
        delay, offset = (t3 - t0) - (t2 - t1), 0.5 * ((t1 - t0) + (t2 - t3))
        if not (math.isfinite(offset) and 0.0 <= delay < 60.0 and t2 >= t1):
            return
        self._exchanges.append((t3, offset, delay))
        _, self.offset, self.delay = min(self._exchanges, key=lambda one: one[2] + DRIFT * abs(t3 - one[0]))

    def to_server(self, time: float) -> float:
        """Return a time of the headset in that of the server [s]; NaN before the first exchange."""
        return time + self.offset

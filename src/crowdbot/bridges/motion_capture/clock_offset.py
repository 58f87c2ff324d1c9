"""ClockOffset: relation of two clocks, from pairs of time stamps with random delays."""

from __future__ import annotations

import math
from collections import deque

RESET = 2.0
"""A jump [s] between two clocks above which the estimate starts anew, for instance if the sender restarts."""


class ClockOffset:
    """Estimates the offset of the local clock to that of a sender.

    A datagram that is sent at ``sent`` arrives at ``sent + offset + delay`` with a delay of at least 0. The estimate is
    the smallest difference in a window that slides with the sender's clock: it follows drift and ignores queues. It
    contains the smallest delay of the path, which cannot be observed in one direction.

    Source: minimum filter of one-way delays, as in RFC 5905 section 10.

    Args:
        window: length of the window [s].

    >>> offset = ClockOffset()
    >>> for sent, delay in ((0.0, 0.03), (0.1, 0.01), (0.2, 0.05)):
    ...     offset.add(sent, sent + 7.0 + delay)
    >>> round(offset.value, 6)
    7.01
    """

    def __init__(self, window: float = 10.0) -> None:
        self.window = window
        self._lowest: deque[tuple[float, float]] = deque()

    @property
    def value(self) -> float:
        """The offset [s]; NaN before the first pair."""
        return self._lowest[0][1] if self._lowest else math.nan

    def add(self, sent: float, arrived: float) -> None:
        """Add the time stamps of a datagram [s]."""
        difference = arrived - sent
        if self._lowest and abs(difference - self._lowest[0][1]) > RESET:
            self._lowest.clear()
        while self._lowest and self._lowest[-1][1] >= difference:
            self._lowest.pop()
        self._lowest.append((sent, difference))
        while self._lowest[0][0] < sent - self.window:
            self._lowest.popleft()


class DelaySamples:
    """The latest 10 000 delays and their quantiles.

    >>> delays = DelaySamples()
    >>> for k in range(101):
    ...     delays.add(k / 1000)
    >>> delays.quantile(0.5), delays.quantile(0.99)
    (0.05, 0.099)
    """

    def __init__(self, most: int = 10_000) -> None:
        self._values: deque[float] = deque(maxlen=most)

    def __len__(self) -> int:
        """Return the number of delays."""
        return len(self._values)

    def add(self, delay: float) -> None:
        """Add a delay [s]."""
        self._values.append(delay)

    def quantile(self, share: float) -> float:
        """Return a quantile [s]; NaN without delays."""
        ordered = sorted(self._values)
        return ordered[min(len(ordered) - 1, int(share * len(ordered)))] if ordered else math.nan

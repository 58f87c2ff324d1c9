"""LatencyLog: the latest delays of a participant, and frames that were lost."""

from __future__ import annotations

import math
from collections import deque

LATEST = 200
"""Number of delays of which the median is taken."""


class LatencyLog:
    """Delays by name: ``motion``, from the motion of the headset to the step of the simulation that uses it, and
    ``picture``, from the state of the simulation to its picture in the headset.

    >>> log = LatencyLog()
    >>> for k in range(11):
    ...     log.add("motion", 0.02 + 0.001 * k)
    >>> round(log.median("motion"), 6), log.count("motion"), log.median("picture")
    (0.025, 11, nan)
    """

    def __init__(self) -> None:
        self._latest: dict[str, deque[float]] = {}
        self._counts: dict[str, int] = {}
        self.lost = 0
        """Messages of the headset that did not arrive, or came out of order."""
        self.dropped = 0
        """Frames that the headset has not drawn in time, as it says itself."""

    def add(self, name: str, delay: float) -> None:
        """Add a delay [s]; one that is not finite is left out."""
        if math.isfinite(delay):
            self._latest.setdefault(name, deque(maxlen=LATEST)).append(delay)
            self._counts[name] = self.count(name) + 1

    def count(self, name: str) -> int:
        """Return the number of all delays."""
        return self._counts.get(name, 0)

    def quantile(self, name: str, share: float) -> float:
        """Return a quantile of the latest 200 delays [s]; NaN without any."""
        ordered = sorted(self._latest.get(name, ()))
        return ordered[min(len(ordered) - 1, int(share * len(ordered)))] if ordered else math.nan

    def median(self, name: str) -> float:
        """Return the median of the latest 200 delays [s]; NaN without any."""
        return self.quantile(name, 0.5)

    def summary(self) -> dict[str, float | None]:
        """Return medians and 95th percentiles [ms] and the counts, for a page."""
        found: dict[str, float | None] = {"lost": self.lost, "dropped": self.dropped}
        for name in ("motion", "picture"):
            for word, share in (("median", 0.5), ("p95", 0.95)):
                value = self.quantile(name, share)
                found[f"{name}_{word}"] = round(1e3 * value, 2) if math.isfinite(value) else None
        return found

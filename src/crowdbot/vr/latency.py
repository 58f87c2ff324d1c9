"""Latency of a headset: offset of its clock, delays as they happen, and those of a recorded trial."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError
from crowdbot.experiments import TrialLatency
from crowdbot.typing import Floats

from .headset_sample import read_headset_clock, read_headset_recording

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
        _, self.offset, self.delay = min(
            self._exchanges, key=lambda exchange: exchange[2] + DRIFT * abs(t3 - exchange[0])
        )

    def to_server(self, time: float) -> float:
        """Return a time of the headset in that of the server [s]; NaN before the first exchange."""
        return time + self.offset


class HeadsetLatency(NamedTuple):
    """Delays of a participant, with all added delays.

    Fields:
        motion: ``[N]`` age of the pose that each step of the simulation used [s].
        picture: ``[M]`` age of the state of the simulation when the headset began to draw it [s].
        dropped: pictures that the headset did not draw in time.
        lost: messages of the headset that did not arrive.
    """

    motion: Floats
    picture: Floats
    dropped: int
    lost: int

    def of_trial(self) -> TrialLatency:
        """Return medians and 95th percentiles."""
        return TrialLatency(
            _quantile(self.motion, 0.5), _quantile(self.motion, 0.95),
            _quantile(self.picture, 0.5), _quantile(self.picture, 0.95),
            self.dropped, self.lost,
        )  # fmt: skip


def _quantile(delays: Floats, share: float) -> float | None:
    return float(np.quantile(delays, share)) if len(delays) else None


def read_headset_latency(paths: Iterable[Path | str]) -> HeadsetLatency:
    """Return the delays in recordings of one headset, such as those before and after a lost connection.

    Raises:
        InputError: a file is no recording of a headset, or an entry is damaged.

    >>> read_headset_latency([]).motion.tolist()
    []
    """
    motion, pairs, dropped, lost = [], [np.zeros((0, 2))], 0, 0
    for path in paths:
        before, first, last = -1, None, 0
        shown = [np.zeros((0, 2))]
        for record in read_headset_recording(path):
            if record.note is not None:
                motion += [float(record.note["age"])] if "age" in record.note else []
            elif record.sample is not None:
                lost += max(0, record.sample.number - before - 1) if before >= 0 else 0
                before = max(before, record.sample.number)
                last = record.sample.dropped
                first = last if first is None else first
                shown.append(record.sample.pictures)
        dropped += max(0, last - (first or 0))
        rows = np.concatenate(shown)
        if len(rows):
            pairs.append(np.stack([_server_times(path, rows[:, 1]), rows[:, 0]], axis=1))
    both = np.concatenate(pairs)
    picture = both[:, 0] - both[:, 1]
    return HeadsetLatency(np.array(motion), picture[np.isfinite(picture)], dropped, lost)


def _server_times(path: Path | str, times: Floats) -> Floats:
    """Return times of the headset in the clock of the server; unknown ones if the clocks were not compared."""
    try:
        return read_headset_clock(path).to_server(times)
    except InputError:
        return np.full(len(times), np.nan)


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
        result: dict[str, float | None] = {"lost": self.lost, "dropped": self.dropped}
        for name in ("motion", "picture"):
            for word, share in (("median", 0.5), ("p95", 0.95)):
                value = self.quantile(name, share)
                result[f"{name}_{word}"] = round(1e3 * value, 2) if math.isfinite(value) else None
        return result

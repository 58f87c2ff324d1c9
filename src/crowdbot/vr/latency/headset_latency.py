"""HeadsetLatency: all delays in the recordings of a headset, for the analysis of a trial."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError
from crowdbot.experiments import TrialLatency
from crowdbot.typing import Floats
from crowdbot.vr.headset_recording import read_headset_clock, read_headset_recording


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

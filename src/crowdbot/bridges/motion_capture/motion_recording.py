"""MotionRecording: poses of one or more subjects from a file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats

from .pose_stream import MotionSample, PoseStream, StreamStatistics

MOST_FRAMES = 1_000_000


@dataclass(frozen=True, eq=False)
class RecordedSubject:
    """The samples of one subject of a file.

    Fields:
        time: ascending time stamps ``[T]``; 0 is the begin of the file [s].
        sample: returns the sample with an index; poses are computed when they are needed.
    """

    time: Floats
    sample: Callable[[int], MotionSample]

    def __post_init__(self) -> None:
        if not len(self.time):
            raise InputError("a recording has no frames")
        if not np.all(np.isfinite(self.time)) or not np.all(np.diff(self.time) > 0.0):
            raise InputError("the times of a recording must be finite and increase")


class MotionRecording(PoseStream):
    """Plays the samples of a file in simulated time, from the start of the trial on.

    Args:
        recorded: the subjects by name, the main one first.
        begin: time in the file at which the trial begins [s].
    """

    live = False

    def __init__(self, recorded: dict[str, RecordedSubject], begin: float = 0.0) -> None:
        if not recorded:
            raise InputError("a recording has no subjects")
        self.recorded, self.begin = dict(recorded), begin

    def subjects(self) -> tuple[str, ...]:
        """Return the names of the subjects."""
        return tuple(self.recorded)

    def read(self, subject: str, now: float, ahead: float) -> list[tuple[float, MotionSample]]:
        """Return the samples before and after ``ahead``; none before the first and after the last sample."""
        found = self._find(subject)
        if found is None:
            return []
        wanted = ahead + self.begin
        k = int(np.searchsorted(found.time, wanted + 1e-9, side="right")) - 1
        last = len(found.time) - 1
        if k < 0 or (k == last and wanted > found.time[last] + 1e-9):
            return []
        return [(float(found.time[i]) - self.begin, found.sample(i)) for i in range(k, min(k + 1, last) + 1)]

    def statistics(self, subject: str = "") -> StreamStatistics:
        """Return number and rate of the samples."""
        found = self._find(subject)
        if found is None:
            return StreamStatistics()
        span = float(found.time[-1] - found.time[0])
        return StreamStatistics(len(found.time), rate=(len(found.time) - 1) / span if span > 0.0 else 0.0)

    def _find(self, subject: str) -> RecordedSubject | None:
        return self.recorded.get(subject) if subject else next(iter(self.recorded.values()))

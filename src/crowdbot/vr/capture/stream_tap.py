"""StreamTap: a motion capture stream whose samples are written down as they are used."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from crowdbot.bridges import MotionSample, PoseStream, StreamStatistics
from crowdbot.vr.rotation_matrices import unit_quaternions


def sample_record(sample: MotionSample) -> dict[str, Any]:
    """Return a sample as it came, JSON: positions ``[J, 3]`` [m] and quaternions ``[J, 4]`` of its joints.

    >>> sample_record(MotionSample(3, 0.5, np.zeros((1, 3)), np.eye(3)[None]))["rotation"]
    [[1.0, 0.0, 0.0, 0.0]]
    """
    turns = np.array([unit_quaternions(one) for one in sample.rotation])
    return {
        "number": sample.number, "time": sample.time, "position": sample.position.round(4).tolist(),
        "rotation": turns.round(5).tolist(),
    }  # fmt: skip


class StreamTap(PoseStream):
    """Gives the samples of an open stream, and tells each with its subject; it neither opens nor closes the stream.

    Args:
        stream: an open stream.
        tell: called with ``{"capture": subject, "step": simulated time [s], ...}`` and :func:`sample_record`.
    """

    def __init__(self, stream: PoseStream, tell: Callable[[dict[str, Any]], None]) -> None:
        self.stream, self.live = stream, stream.live
        self._tell = tell

    def subjects(self) -> tuple[str, ...]:
        """Return the names of the subjects that are known by now."""
        return self.stream.subjects()

    def read(self, subject: str, now: float, ahead: float) -> list[tuple[float, MotionSample]]:
        """Return the samples of the stream, see :meth:`crowdbot.bridges.PoseStream.read`."""
        found = self.stream.read(subject, now, ahead)
        for time, sample in found:
            self._tell({"capture": subject, "step": round(time, 6), **sample_record(sample)})
        return found

    def statistics(self, subject: str = "") -> StreamStatistics:
        """Return what has been received of a subject."""
        return self.stream.statistics(subject)

    def latency(self) -> tuple[float, float] | None:
        """Return the age of samples when they are used [s]."""
        return self.stream.latency()

"""PoseStream: poses of people and rigid bodies over time, from a motion capture system or a file."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from types import TracebackType

from crowdbot.typing import Floats

from .source_skeleton import SourceSkeleton


@dataclass(frozen=True, eq=False)
class MotionSample:
    """The pose of one subject at one instant; x forward, y left, z up, the floor at 0.

    Fields:
        number: number of the sample in the source; it increases.
        time: time stamp by the clock of the source [s].
        position: positions of the joints ``[J, 3]`` [m]; one for a rigid body.
        rotation: rotations ``[J, 3, 3]`` relative to the rest pose.
        skeleton: the joints; None: a rigid body.
    """

    number: int
    time: float
    position: Floats
    rotation: Floats
    skeleton: SourceSkeleton | None = None


@dataclass(frozen=True)
class StreamStatistics:
    """What a stream has received.

    Fields:
        samples: number of valid samples.
        lost: number of samples that were sent and did not arrive, by the numbers of the source.
        refused: number of datagrams that are not valid.
        reason: why the last one was refused, empty if none was.
        rate: samples per second of the source clock, 0 with fewer than two samples.
    """

    samples: int = 0
    lost: int = 0
    refused: int = 0
    reason: str = ""
    rate: float = 0.0


class PoseStream(ABC):
    """A motion capture system or a recording of one. Use it as a context: it holds sockets and threads.

    Attributes:
        live: whether samples come in real time; the simulation must then run in real time.
    """

    live = False

    def __enter__(self) -> PoseStream:
        """Start to receive."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop; a stream without sockets has nothing to do."""
        return

    @abstractmethod
    def subjects(self) -> tuple[str, ...]:
        """Return the names of the subjects that are known by now."""

    @abstractmethod
    def read(self, subject: str, now: float, ahead: float) -> list[tuple[float, MotionSample]]:
        """Return samples of a subject with their simulated times [s], in ascending order.

        A recording returns the samples around ``ahead``, at most two; a live stream the newest sample, if it is new.

        Args:
            subject: name of the subject; empty: the first one.
            now: current simulated time [s].
            ahead: simulated time of the next step [s].
        """

    def statistics(self, subject: str = "") -> StreamStatistics:
        """Return what has been received of a subject; empty: of the first one."""
        return StreamStatistics()

    def latency(self) -> tuple[float, float] | None:
        """Return median and 99th percentile of the age of samples when they are used [s]; None for a recording."""
        return None

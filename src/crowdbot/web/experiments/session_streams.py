"""SessionStreams: the Lab Streaming Layer during a session in the browser."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from crowdbot.experiments import StreamOutlets, StreamRecorder


@dataclass(frozen=True)
class StreamChoice:
    """What a session exchanges over the Lab Streaming Layer.

    Fields:
        send: whether events, poses of heads and poses of robots are sent.
        record: names of streams, or ``PROPERTY=VALUE`` such as ``type=EEG``, that are recorded.
    """

    send: bool = False
    record: tuple[str, ...] = ()


class SessionStreams:
    """Streams of a session, from its start to its end.

    Args:
        choice: which streams.
        source: name of the sender, that of the experiment.

    Raises:
        MissingExtra: streams are wanted, and the package ``pylsl`` is not installed.
    """

    def __init__(self, choice: StreamChoice, source: str) -> None:
        self.choice = choice
        self.outlets = StreamOutlets(source) if choice.send else None
        """Sink of step records and events, or None."""
        self._recorder: StreamRecorder | None = None

    def record(self, folder: Path) -> None:
        """Begin to record in the folder of a participant.

        Raises:
            InputError: a stream does not exist, or carries texts.
        """
        if self.choice.record:
            self._recorder = StreamRecorder(folder, self.choice.record)

    @property
    def counts(self) -> dict[str, int]:
        """Number of recorded samples by the name of the file."""
        return {} if self._recorder is None else self._recorder.counts

    def stop_recording(self) -> None:
        """Close the recorded files.

        Raises:
            EpisodeError: a file could not be written.
        """
        recorder, self._recorder = self._recorder, None
        if recorder is not None:
            recorder.close()

    def close(self) -> None:
        """End all streams; raises as :meth:`stop_recording` does."""
        with contextlib.ExitStack() as stack:
            if self.outlets is not None:
                stack.callback(self.outlets.close)
            self.outlets = None
            self.stop_recording()


def chosen_streams(send: bool, record: Sequence[str]) -> StreamChoice:
    """Return a choice; empty names are left out."""
    return StreamChoice(bool(send), tuple(item.strip() for item in map(str, record) if item.strip()))

"""HeadsetRecording: the raw messages of a headset with both clocks, and what the simulation made of them."""

from __future__ import annotations

import json
import struct
import threading
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import InputError
from crowdbot.typing import Floats
from crowdbot.web import StateFrame

from .headset_sample import HeadsetSample

MAGIC = b"CBHR1\n"
ENTRY = struct.Struct("<BdI")
"""Kind, time of the server [s] and number of bytes of an entry."""
MESSAGE, NOTE = 0, 1
LARGEST = 1 << 20


class HeadsetRecord(NamedTuple):
    """An entry of a recording.

    Fields:
        time: time of the server [s].
        sample: message of the headset, or None.
        note: what else was recorded, such as ``{"pose": {...}}`` of a step, or None.
    """

    time: float
    sample: HeadsetSample | None
    note: dict[str, Any] | None


class HeadsetClock(NamedTuple):
    """Estimated relations of the clocks of a recording, about once a second.

    Fields:
        server: ``[T]`` monotonic clock of the server [s], as in :class:`crowdbot.experiments.TrialClock`.
        offset: ``[T]`` server minus headset [s].
        round_trip: ``[T]`` round trip of the exchange that counts [s]; the offset is wrong by at most half of it.
        utc: ``[T]`` seconds since 1970.
    """

    server: Floats
    offset: Floats
    round_trip: Floats
    utc: Floats

    def to_server(self, time: ArrayLike) -> Floats:
        """Return times of the headset in the clock of the server [s], with the offset interpolated between estimates.

        >>> clock = HeadsetClock(np.array([50.0, 60.0]), np.array([40.0, 40.1]), np.full(2, 0.004), np.zeros(2))
        >>> clock.to_server([10.0, 19.9]).round(3).tolist()
        [50.0, 60.0]
        """
        instants = np.asarray(time, dtype=np.float64)
        return np.asarray(instants + np.interp(instants, self.server - self.offset, self.offset))


class HeadsetRecorder:
    """Writes the messages of a headset as they come, so that a run that is killed loses at most the last one.

    Args:
        path: file to write; an existing one is replaced.

    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "one.headset"
    >>> with HeadsetRecorder(path) as recorder:
    ...     recorder.note(5.0, {"participant": "P01"})
    >>> [one.note for one in read_headset_recording(path)]
    [{'participant': 'P01'}]
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        path.parent.mkdir(parents=True, exist_ok=True)
        self._file = path.open("wb", buffering=0)
        self._lock = threading.Lock()
        self._file.write(MAGIC)

    def __enter__(self) -> HeadsetRecorder:
        """Return the recorder."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the file."""
        self.close()

    def message(self, time: float, data: bytes) -> None:
        """Write a message of the headset that arrived at a time of the server [s]."""
        self._write(MESSAGE, time, data)

    def note(self, time: float, values: dict[str, Any]) -> None:
        """Write what happened at a time of the server [s], JSON."""
        self._write(NOTE, time, json.dumps(values, allow_nan=False).encode())

    def close(self) -> None:
        """Close the file; more entries are left out."""
        with self._lock:
            self._file.close()

    def _write(self, kind: int, time: float, data: bytes) -> None:
        with self._lock:
            if not self._file.closed:
                self._file.write(ENTRY.pack(kind, time, len(data)) + data)


def read_headset_recording(path: Path | str) -> Iterator[HeadsetRecord]:
    """Yield the entries of a recording in their order; a last one that is not whole is left out.

    Raises:
        InputError: the file is no recording of a headset, or an entry is damaged.
    """
    with Path(path).open("rb") as file:
        if file.read(len(MAGIC)) != MAGIC:
            raise InputError(f"{path}: not a recording of a headset")
        while len(head := file.read(ENTRY.size)) == ENTRY.size:
            kind, time, size = ENTRY.unpack(head)
            if kind not in (MESSAGE, NOTE) or size > LARGEST:
                raise InputError(f"{path}: an entry is damaged before byte {file.tell()}")
            data = file.read(size)
            if len(data) < size:
                return
            if kind == MESSAGE:
                yield HeadsetRecord(time, HeadsetSample.of_frame(StateFrame.decode(data)), None)
            else:
                yield HeadsetRecord(time, None, json.loads(data))


def read_headset_clock(path: Path | str) -> HeadsetClock:
    """Return the clocks of a recording.

    Raises:
        InputError: the file is no recording of a headset, an entry is damaged, or no clock was estimated.
    """
    notes = [(one.time, one.note["clock"]) for one in read_headset_recording(path) if one.note and "clock" in one.note]
    if not notes:
        raise InputError(f"{path}: the clocks were not compared; a recording needs two messages of the headset")
    rows = [(time, note["offset"], note["round_trip"], note["utc"]) for time, note in notes]
    return HeadsetClock(*np.array(rows, dtype=np.float64).T)

"""HeadsetRecording: the raw messages of a headset with both clocks, and what the simulation made of them."""

from __future__ import annotations

import json
import struct
import threading
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple

from crowdbot.core import InputError
from crowdbot.web import StateFrame

from .headset_sample import HeadsetSample

__all__ = ["HeadsetRecord", "HeadsetRecorder", "read_headset_recording"]

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

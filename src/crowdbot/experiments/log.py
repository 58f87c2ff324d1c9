"""The log of a session: a file of JSON lines that only grows. The session is what its events make of it."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import Any, BinaryIO, Literal

from crowdbot.core import EpisodeError

__all__ = ["SessionLog", "read_log"]

FORMAT = 1


class SessionLog:
    """A log that is being written.

    Every record is on the disk before :meth:`append` returns. A record that was cut by a crash is dropped.
    """

    def __init__(self, path: Path, stream: BinaryIO) -> None:
        self.path = path
        self._stream = stream

    @classmethod
    def create(cls, path: Path, head: dict[str, Any]) -> SessionLog:
        """Begin a log; its first record says what it is about.

        Raises:
            EpisodeError: there is one, or it cannot be written.
        """
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            log = cls(path, _locked(path, "xb"))
        except FileExistsError:
            raise EpisodeError(f"{path} is there already; a session is never written over") from None
        except OSError as error:
            raise EpisodeError(f"{path} cannot be written: {error.strerror}; give another place") from None
        log.append({"format": FORMAT, **head})
        return log

    @classmethod
    def open(cls, path: Path) -> tuple[SessionLog, list[dict[str, Any]]]:
        """Go on with a log; return also its records.

        Raises:
            EpisodeError: it is missing, cannot be written or is no log.
        """
        try:
            stream = _locked(path, "r+b")
        except OSError as error:
            raise EpisodeError(f"{path} cannot be written: {error.strerror}") from None
        try:
            records, length = _records(path)
            stream.truncate(length)
            stream.seek(length)
        except BaseException:
            stream.close()
            raise
        return cls(path, stream), records

    def append(self, record: dict[str, Any]) -> None:
        """Write a record.

        Raises:
            EpisodeError: the disk does not take it.
        """
        line = json.dumps(record, ensure_ascii=False, allow_nan=False) + "\n"
        try:
            self._stream.write(line.encode())
            self._stream.flush()
            os.fsync(self._stream.fileno())
        except OSError as error:
            raise EpisodeError(f"{self.path} cannot be written: {error.strerror}") from None

    def close(self) -> None:
        """Close the file."""
        self._stream.close()


def _locked(path: Path, mode: Literal["xb", "r+b"]) -> BinaryIO:
    """Open a file that nobody else is writing, where the system can tell."""
    stream: BinaryIO = path.open(mode)
    if sys.platform != "win32":
        import fcntl

        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            stream.close()
            raise EpisodeError(f"{path} is being written by another program; end that one first") from None
    return stream


def read_log(path: Path) -> list[dict[str, Any]]:
    """Return the records of a log, the first one says what it is about; a cut last record is left out.

    Raises:
        EpisodeError: it is missing or no log.
    """
    return _records(path)[0]


def _records(path: Path) -> tuple[list[dict[str, Any]], int]:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise EpisodeError(f"{path} cannot be read: {error.strerror}") from None
    length = data.rfind(b"\n") + 1
    records = []
    for number, line in enumerate(data[:length].splitlines(), 1):
        try:
            record = json.loads(line)
        except ValueError:
            record = None
        if not isinstance(record, dict):
            raise EpisodeError(f"{path}:{number}: this is no record of a session, but {line[:40]!r}")
        records.append(record)
    if not records or records[0].get("format") != FORMAT:
        raise EpisodeError(f"{path} is no log of a session that this version reads (format {FORMAT})")
    return records, length

"""The log of a session: an append-only file of JSON lines, from which the session is restored."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, BinaryIO, Literal

from crowdbot.core import EpisodeError, lock_file

FORMAT = 1


class SessionLog:
    """A log open for writing.

    Every record is on the disk before :meth:`append` returns. An incomplete last record, after a crash, is dropped.
    """

    def __init__(self, path: Path, stream: BinaryIO) -> None:
        self.path = path
        self._stream = stream

    @classmethod
    def create(cls, path: Path, head: dict[str, Any]) -> SessionLog:
        """Create a log; its first record describes the session.

        Raises:
            EpisodeError: the file exists or cannot be written.
        """
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            log = cls(path, _open_locked(path, "xb"))
        except FileExistsError:
            raise EpisodeError(f"{path} already exists; sessions are not overwritten") from None
        except OSError as error:
            raise EpisodeError(f"cannot write {path}: {error.strerror}; use another folder") from None
        log.append({"format": FORMAT, **head})
        return log

    @classmethod
    def open(cls, path: Path) -> tuple[SessionLog, list[dict[str, Any]]]:
        """Open a log to continue it, and return its records.

        Raises:
            EpisodeError: the file is missing, cannot be written or is not a log.
        """
        try:
            stream = _open_locked(path, "r+b")
        except OSError as error:
            raise EpisodeError(f"cannot write {path}: {error.strerror}") from None
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
            EpisodeError: the disk is full or failed.
        """
        line = json.dumps(record, ensure_ascii=False, allow_nan=False) + "\n"
        try:
            self._stream.write(line.encode())
            self._stream.flush()
            os.fsync(self._stream.fileno())
        except OSError as error:
            raise EpisodeError(f"cannot write {self.path}: {error.strerror}") from None

    def close(self) -> None:
        """Close the file."""
        self._stream.close()


def _open_locked(path: Path, mode: Literal["xb", "r+b"]) -> BinaryIO:
    """Open a file for writing and lock it until it is closed.

    Raises:
        EpisodeError: another program has locked it.
        OSError: it cannot be opened.
    """
    stream: BinaryIO = path.open(mode)
    try:
        lock_file(stream)
    except OSError:
        stream.close()
        raise EpisodeError(f"{path} is in use by another program; close that program first") from None
    return stream


def read_log(path: Path) -> list[dict[str, Any]]:
    """Return the records of a log; the first one describes the session. An incomplete last record is left out.

    Raises:
        EpisodeError: the file is missing or is not a log.
    """
    return _records(path)[0]


def _records(path: Path) -> tuple[list[dict[str, Any]], int]:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise EpisodeError(f"cannot read {path}: {error.strerror}") from None
    length = data.rfind(b"\n") + 1
    records = []
    for number, line in enumerate(data[:length].splitlines(), 1):
        try:
            record = json.loads(line)
        except ValueError:
            record = None
        if not isinstance(record, dict):
            raise EpisodeError(f"{path}:{number}: invalid session record {line[:40]!r}")
        records.append(record)
    if not records or records[0].get("format") != FORMAT:
        raise EpisodeError(f"{path} is not a session log supported by this version (format {FORMAT})")
    return records, length

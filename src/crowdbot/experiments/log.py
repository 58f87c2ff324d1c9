"""Events of a session, and its log: an append-only file of JSON lines."""

from __future__ import annotations

import dataclasses
import json
import os
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, Literal

from crowdbot.core import EpisodeError, InputError, kebab_case, lock_file

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


@dataclass(frozen=True)
class Start:
    """Start of the session."""


@dataclass(frozen=True)
class Next:
    """The participant leaves a screen, or the experimenter continues after a failed trial."""


@dataclass(frozen=True)
class Answered:
    """Answer to a question of the current screen. If a question is answered again, the last answer counts."""

    question: str
    value: Any


@dataclass(frozen=True)
class Begin:
    """Start of a trial with a seed; its episode is recorded in a folder of the session."""

    seed: int
    folder: str


@dataclass(frozen=True)
class Finish:
    """End of a trial: outcome, metrics and digest of its episode."""

    outcome: str
    digest: str
    metrics: Mapping[str, Any]


@dataclass(frozen=True)
class Fail:
    """Failure of a trial."""

    reason: str


@dataclass(frozen=True)
class Pause:
    """Pause of the session."""

    reason: str = ""


@dataclass(frozen=True)
class Resume:
    """End of a pause."""


@dataclass(frozen=True)
class Repeat:
    """Repetition of the last trial; answers given after it are discarded."""


@dataclass(frozen=True)
class Abort:
    """Permanent end of the session."""

    reason: str = ""


Event = Start | Next | Answered | Begin | Finish | Fail | Pause | Resume | Repeat | Abort

EVENTS: dict[str, type] = {kebab_case(kind.__name__): kind for kind in typing.get_args(Event)}
"""Event classes by their names in the log."""


def record_of(event: Event) -> dict[str, Any]:
    """Return an event as JSON values.

    >>> record_of(Answered("age", 27))
    {'event': 'answered', 'question': 'age', 'value': 27}
    """
    return {"event": kebab_case(type(event).__name__), **dataclasses.asdict(event)}


def event_of(record: Mapping[str, Any]) -> Event:
    """Return the event of a record.

    Raises:
        InputError: the record is not an event.

    >>> event_of({"event": "pause", "reason": "phone"})
    Pause(reason='phone')
    """
    kind = EVENTS.get(str(record.get("event")))
    if kind is None:
        raise InputError(f"{str(record.get('event'))[:40]!r} is not an event; events are {', '.join(EVENTS)}")
    kinds = typing.get_type_hints(kind)
    given = {key: value for key, value in record.items() if key not in ("event", "at")}
    for field in dataclasses.fields(kind):
        fits = typing.get_origin(kinds[field.name]) or kinds[field.name]
        if field.name not in given or not (fits is Any or isinstance(given[field.name], fits)):
            raise InputError(f"event {record['event']!r} has an invalid {field.name!r}")
    if set(given) != {field.name for field in dataclasses.fields(kind)}:
        raise InputError(f"event {record['event']!r} has fields other than {', '.join(kinds) or 'its name'}")
    made: Event = kind(**given)
    return made

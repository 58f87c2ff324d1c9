"""Events: what can happen in a session. Each is one record of its log."""

from __future__ import annotations

import dataclasses
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from crowdbot.core import InputError, kebab_case

__all__ = [
    "EVENTS", "Abort", "Answered", "Begin", "Event", "Fail", "Finish", "Next", "Pause", "Repeat", "Resume", "Start",
    "event_of", "record_of",
]  # fmt: skip


@dataclass(frozen=True)
class Start:
    """The session begins."""


@dataclass(frozen=True)
class Next:
    """The participant goes on from a screen, or the experimenter from a trial that failed."""


@dataclass(frozen=True)
class Answered:
    """A question of the screen was answered, perhaps again; the last answer counts."""

    question: str
    value: Any


@dataclass(frozen=True)
class Begin:
    """The trial begins, with a seed, and is recorded in a folder of the session."""

    seed: int
    folder: str


@dataclass(frozen=True)
class Finish:
    """The trial is over: how it ended, what was measured, and the digest of its episode."""

    outcome: str
    digest: str
    metrics: Mapping[str, Any]


@dataclass(frozen=True)
class Fail:
    """The trial could not be run to its end."""

    reason: str


@dataclass(frozen=True)
class Pause:
    """Everything waits."""

    reason: str = ""


@dataclass(frozen=True)
class Resume:
    """It goes on where it waited."""


@dataclass(frozen=True)
class Repeat:
    """The trial is run once more from its beginning; what was answered after it no longer counts."""


@dataclass(frozen=True)
class Abort:
    """The session ends here for good."""

    reason: str = ""


Event = Start | Next | Answered | Begin | Finish | Fail | Pause | Resume | Repeat | Abort

EVENTS: dict[str, type] = {kebab_case(kind.__name__): kind for kind in typing.get_args(Event)}
"""The kinds of events by their words."""


def record_of(event: Event) -> dict[str, Any]:
    """Return an event as JSON values.

    >>> record_of(Answered("age", 27))
    {'event': 'answered', 'question': 'age', 'value': 27}
    """
    return {"event": kebab_case(type(event).__name__), **dataclasses.asdict(event)}


def event_of(record: Mapping[str, Any]) -> Event:
    """Return the event of a record.

    Raises:
        InputError: it is none.

    >>> event_of({"event": "pause", "reason": "phone"})
    Pause(reason='phone')
    """
    kind = EVENTS.get(str(record.get("event")))
    if kind is None:
        raise InputError(f"{str(record.get('event'))[:40]!r} is no event; known are {', '.join(EVENTS)}")
    kinds = typing.get_type_hints(kind)
    given = {key: value for key, value in record.items() if key not in ("event", "at")}
    for field in dataclasses.fields(kind):
        fits = typing.get_origin(kinds[field.name]) or kinds[field.name]
        if field.name not in given or not (fits is Any or isinstance(given[field.name], fits)):
            raise InputError(f"event {record['event']!r} has no right {field.name!r}")
    if set(given) != {field.name for field in dataclasses.fields(kind)}:
        raise InputError(f"event {record['event']!r} holds more than {', '.join(kinds) or 'its name'}")
    made: Event = kind(**given)
    return made

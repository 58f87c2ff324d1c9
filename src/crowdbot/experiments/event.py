"""Events of a session; each one is a record of its log."""

from __future__ import annotations

import dataclasses
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from crowdbot.core import InputError, kebab_case


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

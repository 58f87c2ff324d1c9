"""Realism of a crowd around a robot: how near its people come, beside recorded people, and what follows for a verdict.

The numbers are measured by ``studies/around_robots.py`` in recordings of people around a golf cart.
"""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import importlib.resources
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import builtin_name, explain_write_errors
from crowdbot.models import CrowdModel
from crowdbot.trials import Agent, Crowds, RandomizedModel, RecordedPeople, SourceSpec, Spawner, Trial

Group = Agent | Spawner | SourceSpec | RecordedPeople
FILE = "around-robots.json"
NOTICES = {
    "likelier": "contacts with {} are likelier than with real people",
    "rarer": "contacts with {} are rarer than with real people",
    "alike": "{} keep about the distance of recorded people around a robot",
    "unknown": "{} were not compared with recordings around a robot",
}
"""What a reader of a verdict must know, by what the realism of a crowd means for contacts."""
BIAS = {
    "likelier": (
        "It comes nearer than recorded people or touches the robot more often, so contacts are likelier here than with"
        " real people: the verdict is rather too strict."
    ),
    "rarer": (
        "It keeps farther away than recorded people or touches the robot less often, so contacts are rarer here than"
        " with real people: the verdict is rather too mild."
    ),
    "alike": "It keeps the distance of recorded people within 20 %, and touches the robot as rarely.",
}
UNKNOWN = "whether contacts are likelier or rarer here than with real people is unknown"
TOLERANCE = 0.2
"""Crowds whose median clearance differs by less than this share of that of recorded people are alike."""
MOST_CHANGES = 3
"""Largest number of changed parameters that a sentence names."""


@dataclass(frozen=True)
class ClearanceRow:
    """Least clearances to the robot over all recordings: of recorded people, or of the median run of a crowd.

    Fields:
        crowd: crowd model, with the parameters that are not its defaults; or recorded people.
        median: median over the recordings [m].
        deviation: standard deviation over the recordings [m].
        quartiles: first and last quartile [m].
        touched: number of recordings with a contact (of a crowd: in the median run).
        digest: :func:`model_digest` of the model that was simulated; empty for recorded people.
        fitted: whether parameters of the model are fitted to these recordings.
    """

    crowd: str
    median: float
    deviation: float
    quartiles: tuple[float, float]
    touched: int
    digest: str = ""
    fitted: bool = False

    @classmethod
    def of(
        cls, crowd: str, least: Sequence[float], model: CrowdModel | None = None, fitted: bool = False
    ) -> ClearanceRow:
        """Return the row of the least clearances in each recording [m], rounded to 0.01 m.

        >>> ClearanceRow.of("recorded people", [0.5, 0.7, 0.9, -0.1]).touched
        1
        """
        first, last = np.quantile(least, [0.25, 0.75])
        numbers = (float(np.median(least)), float(np.std(least, ddof=1)), float(first), float(last))
        median, deviation, first, last = (round(value, 2) + 0.0 for value in numbers)
        touched = sum(value <= 0.0 for value in least)
        digest = "" if model is None else model_digest(model)
        return cls(crowd, median, deviation, (first, last), touched, digest, fitted)


@dataclass(frozen=True)
class ClearanceTable:
    """Least clearances of recorded people to a robot, and of crowds in the same places.

    Fields:
        recordings: number of recordings.
        seeds: number of simulated runs of each recording.
        recorded: row of the recorded people.
        crowds: rows of the crowds.
    """

    recordings: int
    seeds: int
    recorded: ClearanceRow
    crowds: tuple[ClearanceRow, ...]

    def find(self, model: CrowdModel) -> ClearanceRow | None:
        """Return the row of a model with exactly these parameters, or None if it was not compared."""
        digest = model_digest(model)
        return next((row for row in self.crowds if row.digest == digest), None)

    def save(self, path: Path) -> None:
        """Write the table as JSON, in the form that :func:`load_clearances` reads."""
        with explain_write_errors(path):
            path.write_text(json.dumps(dataclasses.asdict(self), indent=1) + "\n", encoding="utf-8")


@dataclass(frozen=True)
class CrowdRealism:
    """What the comparison with recorded people says about some people of a trial.

    Fields:
        crowd: name of the crowd and its model, or of people who follow none.
        contacts: ``likelier``, ``rarer`` or ``alike``: contacts with the robot beside those with real people; or
            ``unknown``.
        sentence: all of this in words.
    """

    crowd: str
    contacts: str
    sentence: str


@functools.cache
def load_clearances() -> ClearanceTable:
    """Return the table that is shipped.

    >>> load_clearances().recordings
    23
    """
    file = importlib.resources.files("crowdbot").joinpath("assets", "evaluation", FILE)
    values = json.loads(file.read_text(encoding="utf-8"))
    recorded, *crowds = (
        ClearanceRow(**row | {"quartiles": tuple(row["quartiles"])}) for row in (values["recorded"], *values["crowds"])
    )
    return ClearanceTable(values["recordings"], values["seeds"], recorded, tuple(crowds))


def model_digest(model: CrowdModel) -> str:
    """Return a digest of the class and the parameter values of a model.

    >>> from crowdbot.models import ORCA
    >>> model_digest(ORCA()) == model_digest(ORCA(time_horizon=9.0))
    False
    """
    values = {field.name: _plain(getattr(model, field.name)) for field in dataclasses.fields(model)}
    kind = type(model)
    text = json.dumps([f"{kind.__module__}.{kind.__qualname__}", values], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def trial_realism(trial: Trial) -> tuple[CrowdRealism, ...]:
    """Return what is known about the people of a trial around its first robot; empty without people or robot.

    >>> from crowdbot.trials import load_trial
    >>> [(one.crowd, one.contacts) for one in trial_realism(load_trial("frontal"))]
    [('people', 'alike')]
    """
    every: tuple[Group, ...] = (*trial.agents, *trial.spawners, *trial.sources, *trial.recorded)
    groups = [item for item in every if _has_people(item)]
    if not trial.robots or not (groups or trial.avatars):
        return ()
    robot = trial.robots[0]
    if robot.ghost:
        return (CrowdRealism("", "unknown", "The robot is a ghost, which people neither see nor touch."),)
    if not robot.visible:
        sentence = (
            "People do not see the robot (visible=false) and do not evade it, as real people would. So contacts are"
            " likelier here than with real people: the verdict is rather too strict. This was not compared with"
            " recordings around a robot."
        )
        return (CrowdRealism("", "likelier", sentence),)
    return (*_crowds(trial, groups), *_people_of_their_own(trial, groups))


def realism_notice(realism: Sequence[CrowdRealism]) -> str:
    """Return one line for a verdict on people with this realism; empty without people.

    >>> from crowdbot.trials import load_trial
    >>> realism_notice(trial_realism(load_trial("frontal")))
    'These people keep about the distance of recorded people around a robot.'
    """
    kinds = dict.fromkeys(item.contacts for item in realism)
    if not kinds:
        return ""
    who = "these people" if len(kinds) == 1 else "some of these people"
    words = "; ".join(NOTICES[kind].format(who) for kind in kinds)
    return f"{words[0].upper()}{words[1:]}."


def _has_people(group: Group) -> bool:
    if isinstance(group, Spawner):
        return group.count > 0
    return not isinstance(group, SourceSpec) or group.max_count != 0


def _stands(group: Group) -> bool:
    """Return whether the people of a group have no place to walk to."""
    if isinstance(group, Agent):
        return not (group.goal or group.goal_zone or group.journey)
    return isinstance(group, Spawner) and group.stands


def _crowds(trial: Trial, groups: Sequence[Group]) -> Iterator[CrowdRealism]:
    """Yield the realism of each crowd with people who walk."""
    crowds = Crowds.spread(trial.crowd)
    walking = [group for group in groups if not _stands(group) and not isinstance(group, RecordedPeople)]
    used = {item.crowd or crowds[0].name for item in walking}
    change = _trial_change(trial)
    for crowd in crowds:
        if crowd.name in used:
            yield _crowd_realism(crowd.name, crowd.model, change)


def _trial_change(trial: Trial) -> str:
    """Return what a trial changes for all crowds, compared with the trials of the recordings; empty if nothing."""
    (margin,) = (field.default for field in dataclasses.fields(Trial) if field.name == "robot_margin")
    if trial.robot_margin != margin:
        return f"robot-margin={trial.robot_margin:g}"
    if trial.limits is not None and trial.limits.max_acceleration is not None:
        return "a limit of the acceleration"
    return ""


def _crowd_realism(name: str, model: CrowdModel, change: str) -> CrowdRealism:
    drawn = isinstance(model, RandomizedModel)
    inner = model.model if isinstance(model, RandomizedModel) else model
    kind = builtin_name(type(inner), CrowdModel)
    title = f"{name} ({kind})" if name else kind
    table = load_clearances()
    row = None if drawn or change else table.find(inner)
    if row is None:
        changes = [*_changes(model), *([change] if change else [])]
        more = f" and {len(changes) - MOST_CHANGES} more" if len(changes) > MOST_CHANGES else ""
        own = f" with {', '.join(changes[:MOST_CHANGES])}{more}" if changes else ""
        return CrowdRealism(
            title, "unknown", f"The crowd {title}{own} was not compared with recordings around a robot: {UNKNOWN}."
        )
    values = f" with {', '.join(changes)}" if (changes := _changes(inner)) else ""
    contacts = _compare_contacts(row, table.recorded)
    parts = [
        f"Around a golf cart, recorded people keep a median least clearance of"
        f" {_metres(table.recorded.median)} (quartiles {_ends(table.recorded)}), simulated people"
        f" of the crowd {title!r}{values} {_metres(row.median)} ({_ends(row)}); in their median run they"
        f" touch the cart in {_of(row.touched, table.recordings)}, recorded people in {_of(table.recorded.touched)}.",
        BIAS[contacts],
        *(["Its parameters are fitted to these recordings, so this is no independent test."] if row.fitted else []),
    ]
    return CrowdRealism(title, contacts, " ".join(parts))


def _compare_contacts(crowd: ClearanceRow, recorded: ClearanceRow) -> str:
    """Return how likely contacts with a crowd are: by its contacts where they differ, else by its clearance."""
    if crowd.touched != recorded.touched:
        return "likelier" if crowd.touched > recorded.touched else "rarer"
    gap = crowd.median - recorded.median
    if abs(gap) <= TOLERANCE * recorded.median:
        return "alike"
    return "likelier" if gap < 0.0 else "rarer"


def _people_of_their_own(trial: Trial, groups: Sequence[Group]) -> Iterator[CrowdRealism]:
    """Yield the realism of people whose behaviour around a robot is not that of their crowd alone."""
    compared = f"was not compared with recordings around a robot: {UNKNOWN}."
    if any(map(_stands, groups)):
        yield CrowdRealism(
            "people who stand", "unknown", f"Some people stand and do not step aside for a robot. This {compared}"
        )
    own = [group for group in groups if isinstance(group, Agent) and group.parameters]
    if own:
        names = ", ".join(dict.fromkeys(parameter.name for agent in own for parameter in agent.parameters))
        yield CrowdRealism(
            "people with own parameters",
            "unknown",
            f"{len(own)} of the people {'has' if len(own) == 1 else 'have'} own parameters ({names}). This {compared}",
        )
    kinds = dict.fromkeys(
        kind
        for group in groups
        if not isinstance(group, RecordedPeople)
        for kind in (*(reaction.type for reaction in group.reactions), *("behaviour tree" for _ in group.behaviors))
    )
    if kinds:
        yield CrowdRealism(
            "reactions", "unknown", f"Some people react to the robot ({', '.join(kinds)}). This {compared}"
        )
    modes = {item.mode for item in trial.recorded}
    if "scripted" in modes:
        yield CrowdRealism(
            "people of a recording",
            "likelier",
            "People who follow a recording do not evade the robot. So contacts with them are likelier here than with"
            " real people: the verdict is rather too strict.",
        )
    if "reactive" in modes:
        yield CrowdRealism(
            "people of a recording", "unknown", f"People follow a recording until a robot is near. This {compared}"
        )
    if trial.avatars:
        yield CrowdRealism("avatars", "unknown", f"Avatars move as their source says. This {compared}")


def _changes(model: CrowdModel) -> list[str]:
    """Return the parameters of a model that are not the defaults of its class."""
    if isinstance(model, RandomizedModel):
        drawn = [name for name, _ in model.draws]
        words = [word for word in _changes(model.model) if word.partition("=")[0].replace("-", "_") not in drawn]
        return [*words, *(f"drawn {name.replace('_', '-')}" for name in drawn)]
    changes = []
    for field in dataclasses.fields(model):
        default, value = field.default, getattr(model, field.name)
        if field.default_factory is not dataclasses.MISSING:
            default = field.default_factory()
        plain = _plain(value)
        if default is not dataclasses.MISSING and _plain(default) != plain:
            shown = f"={plain:g}" if isinstance(plain, float) else f"={plain}" if isinstance(plain, str) else " changed"
            changes.append(f"{field.name.replace('_', '-')}{shown}")
    return changes


def _plain(value: Any) -> Any:
    """Return a parameter as JSON holds it: whole numbers and decimal ones alike."""
    if isinstance(value, bool | str) or value is None:
        return value
    if isinstance(value, int | float | np.number):
        return float(value)
    if isinstance(value, Mapping):
        return {str(name): _plain(item) for name, item in value.items()}
    if isinstance(value, np.ndarray | list | tuple):
        return [_plain(item) for item in value]
    return repr(value)


def _metres(value: float) -> str:
    return f"{value:.2f} m" + (", an overlap" if value < 0.0 else "")


def _ends(row: ClearanceRow) -> str:
    first, last = row.quartiles
    return f"{first:.2f} to {last:.2f} m"


def _of(count: int, whole: int | None = None) -> str:
    """Return a number of recordings in words."""
    return (str(count) if count else "none") + (f" of {whole} recordings" if whole is not None else "")

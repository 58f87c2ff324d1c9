"""Preset: a trial that is made from parameters."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from crowdbot import models, navigation
from crowdbot.core import InputError, TrialError, did_you_mean, find_class, parse_number
from crowdbot.trials.parser import check_trial
from crowdbot.trials.trial import RobotSpec, Trial

__all__ = ["Preset", "PresetOption"]


@dataclass(frozen=True)
class PresetOption:
    """A parameter of a preset: what it is when nothing is said, what it means, and what it may be."""

    default: float | int | str | bool
    about: str
    unit: str = ""
    low: float = -math.inf
    high: float = math.inf
    choices: tuple[str, ...] = ()

    def value(self, given: Any) -> Any:
        """Return a value of the type of the default, from Python or from a text.

        Raises:
            InputError: it is none, or not allowed.
        """
        if isinstance(self.default, str):
            text = str(given)
            if self.choices and text not in self.choices:
                raise InputError(f"must be {' or '.join(self.choices)}{did_you_mean(text, self.choices)}")
            return text
        if isinstance(self.default, bool):
            if str(given).lower() not in ("true", "false"):
                raise InputError("must be true or false")
            return str(given).lower() == "true"
        value = parse_number(str(given))
        if isinstance(self.default, int) and value != int(value):
            raise InputError("must be a whole number")
        if not self.low <= value <= self.high:
            raise InputError(f"must be from {self.low:g} to {self.high:g} {self.unit}".rstrip())
        return int(value) if isinstance(self.default, int) else value

    def __str__(self) -> str:
        """Return a line about it."""
        reach = f" [{self.low:g} to {self.high:g} {self.unit}]" if math.isfinite(self.high) else ""
        words = f" [{', '.join(self.choices)}]" if self.choices else ""
        plain = str(self.default).lower() if isinstance(self.default, bool) else self.default
        return f"{self.about}{reach.replace(' ]', ']')}{words}, {plain}"


COMMON = {
    "model": PresetOption("orca", "crowd model of the people"),
    "navigator": PresetOption("orca", "who steers the robot"),
    "robot": PresetOption(True, "whether there is a robot"),
    "reactive": PresetOption(True, "whether people see the robot"),
    "seed": PresetOption(1, "seed of everything random", "", -(2**53), 2**53),
}
"""Parameters of every preset."""


@dataclass(frozen=True)
class Preset:
    """A built-in trial with parameters.

    Fields:
        name: on the command line.
        about: one line for people.
        make: a function of the own parameters that returns the trial without what all have in common.
        own: its parameters, those in common apart.
        also: what others call it, and with which parameters.
    """

    name: str
    about: str
    make: Callable[..., Trial]
    own: Mapping[str, PresetOption] = field(default_factory=dict)
    also: str = ""

    @property
    def options(self) -> dict[str, PresetOption]:
        """All parameters by name."""
        return {**self.own, **COMMON}

    def trial(self, **given: Any) -> Trial:
        """Return the trial.

        Args:
            given: parameters, the others have their defaults.

        Raises:
            TrialError: one is unknown or not allowed, each in a sentence; or the trial is impossible with them.
        """
        options = self.options
        values, problems = {name: option.default for name, option in options.items()}, []
        for name, value in given.items():
            word = name.replace("-", "_")
            if word not in options:
                near = did_you_mean(word, options)
                problems.append(f"{self.name} has no parameter {name!r}{near}; it has {', '.join(options)}")
                continue
            try:
                values[word] = options[word].value(value)
            except InputError as error:
                problems.append(f'{self.name}: {name}="{str(value)[:60]}" {error}')
        if problems:
            raise TrialError(*problems)
        trial = self.make(**{name: values[name] for name in self.own})
        try:
            trial = _with_common_options(trial, self, values)
        except InputError as error:
            raise TrialError(f"{self.name}: {error}") from None
        if given:
            check_trial(trial)
        return trial


def _with_common_options(trial: Trial, preset: Preset, values: Mapping[str, Any]) -> Trial:
    """Return a trial with what all presets have in common: model, navigator, robot, seed."""
    changes: dict[str, Any] = {"name": preset.name, "about": preset.about, "seed": values["seed"]}
    if values["model"] != "orca":
        changes["crowd"] = find_class(values["model"], models, models.CrowdModel, trust=False)()
    robots: Iterable[RobotSpec] = trial.robots if values["robot"] else ()
    found = find_class(values["navigator"], navigation, navigation.Navigator, trust=False)
    robots = [
        one if isinstance(one.navigator, found) else dataclasses.replace(one, navigator=found()) for one in robots
    ]
    if not values["reactive"]:
        robots = [dataclasses.replace(one, visible=False) for one in robots]
    return dataclasses.replace(trial, **changes, robots=tuple(robots))

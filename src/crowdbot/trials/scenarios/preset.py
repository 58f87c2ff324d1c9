"""Preset: a built-in trial with parameters."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from crowdbot import models, navigation
from crowdbot.core import InputError, TrialError, did_you_mean, find_class, parse_number
from crowdbot.core.fields import unit_hint
from crowdbot.trials.parser import check_trial
from crowdbot.trials.trial import RobotSpec, Trial


@dataclass(frozen=True)
class PresetOption:
    """A parameter of a preset: default, description and allowed values."""

    default: float | int | str | bool
    about: str
    unit: str = ""
    low: float = -math.inf
    high: float = math.inf
    choices: tuple[str, ...] = ()

    def value(self, given: Any) -> Any:
        """Return a value with the type of the default, from a Python value or a text.

        Raises:
            InputError: the value has another type or is not allowed.
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
        try:
            value = parse_number(str(given))
        except InputError as error:
            raise InputError(f"{error}{unit_hint(str(given), self.unit)}") from None
        if isinstance(self.default, int) and value != int(value):
            raise InputError("must be a whole number")
        if not self.low <= value <= self.high:
            raise InputError(f"must be from {self.low:g} to {self.high:g} {self.unit}".rstrip())
        return int(value) if isinstance(self.default, int) else value

    def __str__(self) -> str:
        """Return a one-line description."""
        reach = f" [{self.low:g} to {self.high:g} {self.unit}]" if math.isfinite(self.high) else ""
        words = f" [{', '.join(self.choices)}]" if self.choices else ""
        plain = str(self.default).lower() if isinstance(self.default, bool) else self.default
        return f"{self.about}{reach.replace(' ]', ']')}{words}, {plain}"


COMMON = {
    "model": PresetOption("people", "crowd model of the people"),
    "navigator": PresetOption("orca", "navigator of the robot"),
    "robot": PresetOption(True, "whether there is a robot"),
    "reactive": PresetOption(True, "whether people see the robot"),
    "seed": PresetOption(1, "seed of everything random", "", -(2**53), 2**53),
}
"""Parameters of every preset. The default of ``model`` is that of the preset."""

BUILT = "orca"
"""Model of the crowds that presets build, with the parameters of each scenario."""


@dataclass(frozen=True, kw_only=True)
class ScenarioCard:
    """Card of a scenario of Francis et al. 2025, doi:10.1145/3700599, which a built-in trial simulates.

    Fields:
        name: name in the article (Table 3 and Figure 7).
        setup: place, and what people do.
        robot: intended behaviour of the robot.
        success: ideal outcome.
        metrics: metrics of quality by name (``docs/reference/metrics.md``).
        lacks: what the trial does not show.
        values: parameters with which the trial is this scenario.
    """

    name: str
    setup: str
    robot: str
    success: str
    metrics: tuple[str, ...]
    lacks: str
    values: Mapping[str, Any] = field(default_factory=dict)

    def command(self, trial: str) -> str:
        """Return the name of the trial, and the options that give this scenario.

        >>> from crowdbot.trials import PRESETS
        >>> [card.command("frontal") for card in PRESETS["frontal"].cards]
        ['frontal', 'frontal --set width=1.2']
        """
        return " ".join([trial, *(f"--set {name}={value}" for name, value in self.values.items())])


@dataclass(frozen=True)
class Preset:
    """A built-in trial with parameters.

    Fields:
        name: name on the command line.
        about: description, one line.
        make: function of the parameters in ``own`` that returns the trial.
        own: parameters of this preset, without those of every preset.
        also: names of the scenario in other simulators and benchmarks, with the parameters.
        model: crowd model of the people; scenarios of a benchmark keep its model.
        cards: scenarios of Francis et al. 2025 that the trial simulates.
    """

    name: str
    about: str
    make: Callable[..., Trial]
    own: Mapping[str, PresetOption] = field(default_factory=dict)
    also: str = ""
    model: str = str(COMMON["model"].default)
    cards: tuple[ScenarioCard, ...] = ()

    @property
    def options(self) -> dict[str, PresetOption]:
        """All parameters by name."""
        return {**self.own, **COMMON, "model": dataclasses.replace(COMMON["model"], default=self.model)}

    def trial(self, folder: Path | None = None, /, **given: Any) -> Trial:
        """Return the trial.

        Args:
            folder: folder of the code that the model and the navigator may come from (default: the working folder).
            given: parameters (default: the defaults of the preset).

        Raises:
            TrialError: a parameter is unknown or not allowed, or the trial is impossible with the parameters.
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
            trial = _with_common_options(trial, self, values, folder)
        except InputError as error:
            raise TrialError(f"{self.name}: {error}") from None
        if given:
            check_trial(trial)
        return trial


def _with_common_options(trial: Trial, preset: Preset, values: Mapping[str, Any], folder: Path | None) -> Trial:
    """Return a trial with the parameters of every preset: model, navigator, robot, seed."""
    changes: dict[str, Any] = {"name": preset.name, "about": preset.about, "seed": values["seed"]}
    if values["model"] != BUILT:
        changes["crowd"] = find_class(values["model"], models, models.CrowdModel, folder=folder, trust=False)()
    robots: Iterable[RobotSpec] = trial.robots if values["robot"] else ()
    found = find_class(values["navigator"], navigation, navigation.Navigator, folder=folder, trust=False)
    robots = [
        robot if isinstance(robot.navigator, found) else dataclasses.replace(robot, navigator=found())
        for robot in robots
    ]
    if not values["reactive"]:
        robots = [dataclasses.replace(robot, visible=False) for robot in robots]
    return dataclasses.replace(trial, **changes, robots=tuple(robots))

"""Published values: defaults, ranges and presets on which results of users depend, kept in a file for each room.

A change of one of them is a change of results: it needs a line in CHANGELOG.md. Write the files again with::

    python tests/published_values.py
"""

from __future__ import annotations

import dataclasses
import enum
import hashlib
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

HERE = Path(__file__).parent
FILE = "published_values.json"
ADVICE = "if the change is meant: python tools/fix.py published-values, and a line in CHANGELOG.md"


def plain(value: Any) -> Any:
    """Return a value as JSON holds it: dataclasses as their fields, with the name of the class."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = [field.name for field in dataclasses.fields(value)]
        return {"class": type(value).__name__, **{name: plain(getattr(value, name)) for name in fields}}
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, list | tuple | set | frozenset):
        return [plain(item) for item in value]
    if isinstance(value, enum.Enum | Path | type) or not isinstance(value, str | int | float | bool | None):
        return str(value)
    return value


def made(classes: Mapping[str, type]) -> dict[str, Any]:
    """Return what every class is without arguments, but those that need some."""
    result = {}
    for name, kind in sorted(classes.items()):
        needed = [
            field.name
            for field in dataclasses.fields(kind)
            if field.init and field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING
        ]
        if not needed:
            result[name] = plain(kind())
    return result


def models() -> dict[str, Any]:
    """Return parameters and ranges of all crowd models and goals."""
    from crowdbot import models
    from crowdbot.core import builtin_classes, parameters

    crowds = builtin_classes(models, models.CrowdModel)
    table = {name: [plain(row) for row in parameters(kind)] for name, kind in sorted(crowds.items())}
    return {"parameters": table, "goals": made(builtin_classes(models, models.Goal))}


def sensors() -> dict[str, Any]:
    """Return defaults of all sensors, and the presets."""
    from crowdbot import sensors
    from crowdbot.core import builtin_classes

    return {"sensors": made(builtin_classes(sensors, sensors.Sensor)), "presets": plain(sensors.PRESETS)}


def navigation() -> dict[str, Any]:
    """Return defaults of all navigators."""
    from crowdbot import navigation
    from crowdbot.core import builtin_classes

    kinds = builtin_classes(navigation, navigation.Navigator)
    del kinds["process"]  # needs an address or a command
    return {"navigators": made(kinds)}


def calibration() -> dict[str, Any]:
    """Return defaults of all searches and costs."""
    from crowdbot import calibration
    from crowdbot.calibration.parameter_space import PREFERRED_SPEED, RADIUS
    from crowdbot.core import builtin_classes

    return {
        "searches": made(builtin_classes(calibration, calibration.Search)),
        "costs": made(builtin_classes(calibration, calibration.Cost)),
        "speed": plain(PREFERRED_SPEED),
        "radius": plain(RADIUS),
    }


def prediction() -> dict[str, Any]:
    """Return defaults of all predictors and of their training."""
    from crowdbot import prediction
    from crowdbot.core import builtin_classes
    from crowdbot.prediction.anchor_net import training, training_data
    from crowdbot.prediction.social_ways import config

    classes = {
        name: kind
        for module in (training, training_data, config)
        for name, kind in vars(module).items()
        if isinstance(kind, type) and kind.__module__ == module.__name__ and not name.startswith("_")
    }
    classes = {name: kind for name, kind in classes.items() if dataclasses.is_dataclass(kind)}
    return {
        "predictors": made(builtin_classes(prediction, prediction.Predictor)),
        "training": made(classes),
        "presets": plain(config.PRESETS),
    }


def trials() -> dict[str, Any]:
    """Return a hash of every built-in trial as XML."""
    from crowdbot.trials import builtin_trials, load_trial, trial_xml

    return {
        name: hashlib.blake2b(trial_xml(load_trial(name)).encode(), digest_size=8).hexdigest()
        for name in builtin_trials()
    }


ROOMS: dict[str, Callable[[], dict[str, Any]]] = {
    function.__name__: function for function in (models, sensors, navigation, calibration, prediction, trials)
}


def lines(value: Any, path: str = "") -> list[str]:
    """Return one line for each number or word of a tree, with its path."""
    if isinstance(value, dict) and value:
        return [line for key, item in value.items() for line in lines(item, f"{path}/{key}")]
    if isinstance(value, list) and value:
        return [line for key, item in enumerate(value) for line in lines(item, f"{path}/{key}")]
    return [f"{path} = {json.dumps(value)}"]


def differences(room: str) -> list[str]:
    """Return what to do and the values of a room that differ from its file: ``-`` in the file, ``+`` today."""
    kept = lines(json.loads((HERE / room / FILE).read_text(encoding="utf-8")))
    today = lines(json.loads(json.dumps(ROOMS[room]())))
    found = sorted([f"- {line}" for line in set(kept) - set(today)] + [f"+ {line}" for line in set(today) - set(kept)])
    return [ADVICE, *found] if found else []


def main() -> None:
    """Write the file of every room."""
    for room, read in ROOMS.items():
        text = json.dumps(read(), indent=1, sort_keys=True)
        (HERE / room / FILE).write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

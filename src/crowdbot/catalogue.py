"""Catalogue of built-in names by kind, and their references."""

from __future__ import annotations

import importlib
import inspect
import re
from typing import Any

from crowdbot.core import InputError, Paper, UnknownName, builtin_classes

KINDS = {
    "models": ("models", "CrowdModel"),
    "goals": ("models.goals", "Goal"),
    "sensors": ("sensors", "Sensor"),
    "drives": ("world", "Drive"),
    "navigators": ("navigation", "Navigator"),
    "costs": ("calibration", "Cost"),
    "searches": ("calibration", "Search"),
    "predictors": ("prediction", "Predictor"),
    "detectors": ("perception", "Detector"),
    "trackers": ("perception", "Tracker"),
    "scan-predictors": ("perception", "ScanPredictor"),
    "degradations": ("data.degrade", "Degradation"),
}
"""Kinds of plug-ins with their room and contract."""

REPORT = Paper(
    "EU H2020 CROWDBOT project",
    2019,
    "D4.2 Crowd Simulator, intermediate version",
    "Public deliverable of ICT-25-2016-2017",
)
PROGRAM = Paper(
    "The crowdbot authors",
    2026,
    "crowdbot: crowd prediction and robot testing in simulated crowds",
    "Software, Apache-2.0",
)


def builtin_names(kind: str | None = None) -> dict[str, dict[str, str]]:
    """Return one-line descriptions by name, for one kind or for all.

    >>> "orca" in builtin_names("models")["models"]
    True
    >>> "robot-speed" in builtin_names("experiments")["experiments"]
    True
    """
    listings = {
        "trials": _trials,
        "scenarios": _scenarios,
        "experiments": _experiments,
        "robots": _robots,
        "humans": _humans,
        "presets": _presets,
        "protocols": _protocols,
        "formats": _formats,
    }
    known = [*KINDS, *listings]
    if kind is not None and kind not in known:
        raise UnknownName("kind", kind, known)
    result: dict[str, dict[str, str]] = {}
    for name in known if kind is None else [kind]:
        if name in KINDS:
            result[name] = {key: _first_line(cls) for key, cls in _classes(name).items()}
        else:
            result[name] = listings[name]()
    return result


def papers(name: str) -> list[Paper]:
    """Return the papers behind a built-in name; ``crowdbot`` itself has its report.

    Raises:
        InputError: no built-in has this name, or it has no paper.
    """
    if name.lower() == "crowdbot":
        return [PROGRAM, REPORT]
    plain = name.replace("-", "").replace("_", "").lower()
    classes = {f"{kind} {key}": cls for kind in KINDS for key, cls in _classes(kind).items()}
    meant = [cls for key, cls in classes.items() if key.split()[1].replace("-", "") == plain]
    if not meant:
        raise UnknownName("name", name, {key.split()[1] for key in classes})
    result = list(dict.fromkeys(paper for cls in meant for paper in _papers_of(cls)))
    if not result:
        raise InputError(f"{name} has no paper; to cite crowdbot itself: crowdbot cite")
    return result


def cite(thing: Any) -> str:
    """Return the papers behind a name, a class or an instance, one per line.

    >>> cite("orca").endswith("https://doi.org/10.1007/978-3-642-19457-3_1")
    True
    """
    found = papers(thing) if isinstance(thing, str) else _papers_of(thing)
    return "\n".join(str(paper) for paper in found)


def _papers_of(thing: Any) -> list[Paper]:
    paper = getattr(thing, "paper", None)
    if isinstance(paper, Paper):
        return [paper]
    return list(paper or ())


def _classes(kind: str) -> dict[str, type]:
    room_name, contract = KINDS[kind]
    room = importlib.import_module(f"crowdbot.{room_name}")
    return builtin_classes(room, getattr(room, contract))


def _first_line(thing: Any) -> str:
    line = (inspect.getdoc(thing) or "").split("\n\n")[0].replace("\n", " ").replace("``", "")
    return re.sub(r":\w+:`([^`]*)`", r"\1", line)


def _trials() -> dict[str, str]:
    from crowdbot.trials import trial_titles

    return trial_titles()


def _scenarios() -> dict[str, str]:
    """Return the scenarios of Francis et al. 2025 by name: the trial with its options."""
    from crowdbot.trials import PRESETS

    cards = {card.name: (name, card) for name, preset in PRESETS.items() for card in preset.cards}
    return {key: f"{card.command(name)}: {card.setup}" for key, (name, card) in sorted(cards.items())}


def _experiments() -> dict[str, str]:
    from crowdbot.experiments import builtin_experiments, load_experiment

    return {name: load_experiment(name).about for name in builtin_experiments()}


def _robots() -> dict[str, str]:
    from crowdbot.world import Robot, builtin_robots

    return {name: Robot.load(name).about for name in builtin_robots()}


def _humans() -> dict[str, str]:
    from crowdbot.humans import persons

    humans = {}
    for person in persons():
        who = [person.sex, f"{person.years} years"] if person.years else ["a plain figure"]
        humans[person.name] = ", ".join([*filter(None, who), f"{person.height:.2f} m", f"{person.mass:.0f} kg"])
    return humans


def _presets() -> dict[str, str]:
    from crowdbot.models import crowd_presets

    return {name: preset.about for name, preset in crowd_presets().items()}


def _protocols() -> dict[str, str]:
    from crowdbot.data import PROTOCOLS

    return dict(PROTOCOLS)


def _formats() -> dict[str, str]:
    from crowdbot.data import FORMATS

    return dict(FORMATS)

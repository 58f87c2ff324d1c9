"""Plan of an evaluation: trials, navigators, robots and seeds, and the cells that they form."""

from __future__ import annotations

import dataclasses
import hashlib
import itertools
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crowdbot.core import InputError
from crowdbot.metrics import LOG_FAMILIES
from crowdbot.trials import (
    Trial,
    blind_remarks,
    expand_sweeps,
    narrow_passage,
    passage_remarks,
    remarks_at_end,
    trial_xml,
)

from .method import Method, own_method
from .run_metrics import check_families

MOST_SEEDS = 1_000_000
MOST_CELLS = 10_000
RANGE = re.compile(r"(-?\d{1,18})(?::(-?\d{1,18}))?")
OTHER_RANGE = re.compile(r"(-?\d{1,18})\s*(?:\.{2,3}|-|to)\s*(-?\d{1,18})")
"""Ranges as other tools write them."""


@dataclass(frozen=True)
class EvaluationCell:
    """A trial with one navigator and one robot, to run with all seeds.

    Fields:
        trial: name of the trial, with the values of its sweeps.
        method: name of the navigator.
        robot: name of the robot type; empty as in the trial.
        variant: the trial with this navigator and robot.
        factors: levels of the factors of a sweep by name; empty without one.
        base: name of the trial without the levels.
    """

    trial: str
    method: str
    robot: str
    variant: Trial
    factors: Mapping[str, str] = dataclasses.field(default_factory=dict)
    base: str = ""

    @property
    def xml(self) -> str:
        """Text of the variant."""
        return trial_xml(self.variant)

    @property
    def hash(self) -> str:
        """Hash of that text: SHA-256 in hexadecimal."""
        return hashlib.sha256(self.xml.encode()).hexdigest()

    @property
    def remarks(self) -> tuple[str, ...]:
        """What a reader must know about the robots: passages that are too narrow, navigators that see nobody."""
        return (*passage_remarks(self.variant), *blind_remarks(self.variant))

    @property
    def protocol(self) -> dict[str, Any]:
        """What a reader must know to compare the numbers: world, visibility, margin, sensors, time steps."""
        robot = self.variant.robots[0]
        sensors = sorted({type(mount.sensor).__name__ for mount in robot.sensors})
        return {
            "world": self.variant.world,
            "visible": robot.visible,
            "ghost": robot.ghost,
            "robot": robot.type or f"disc of {robot.radius:g} m",
            "width": round(2.0 * robot.body.half_width, 3),
            "narrow_passage": narrow_passage(self.variant, robot),
            "drive": type(robot.drive).__name__,
            "holonomic": robot.holonomic,
            "safety": robot.safety is not None,
            "margin": _margin(robot.navigator),
            "senses": ["true people", *sensors] if robot.people == "true" else sensors,
            "people": self.variant.people,
            "crowd": type(self.variant.crowd).__name__,
            "step": self.variant.step,
            "control_period": robot.control_period,
            "latency": robot.latency,
            "duration": self.variant.duration,
            "goal_tolerance": robot.goal.tolerance,
        }


@dataclass(frozen=True)
class EvaluationPlan:
    """Trials times navigators times robots times seeds.

    Args:
        trials: trials; those with sweeps count as all their variants.
        methods: navigators (default: that of each trial).
        robots: types of robots; an empty name keeps the robot of the trial (default).
        seeds: seeds of the runs, the same for all navigators.
        trust: whether code from outside the folders of the trials may be loaded.
        families: families of metrics to compute from the logs, see :func:`crowdbot.metrics.metric_families` (default:
            all that need no paired run).
        factors: name of the trial without levels, and levels of factors, by name of a trial; trials with sweeps in
            their files have them without this.
        folder: folder of the robot folders and the code that methods and robots name, see :meth:`Method.put_into`
            (default: the working folder).

    Raises:
        InputError: a list is empty, a name or a seed is there twice, there are too many cells, or a family is unknown.
        TrialError: a navigator or robot is not possible in a trial.

    >>> from crowdbot.evaluation import EvaluationPlan, parse_methods
    >>> from crowdbot.trials import load_trial
    >>> plan = EvaluationPlan([load_trial("frontal")], parse_methods("orca, straight"), seeds=range(10))
    >>> [(cell.trial, cell.method) for cell in plan.cells]
    [('frontal', 'orca'), ('frontal', 'straight')]
    """

    trials: Sequence[Trial]
    methods: Sequence[Method] = (own_method(),)
    robots: Sequence[str] = ("",)
    seeds: Sequence[int] = range(20)
    trust: bool = True
    families: tuple[str, ...] = tuple(LOG_FAMILIES)
    factors: Mapping[str, tuple[str, Mapping[str, str]]] = dataclasses.field(default_factory=dict)
    folder: Path | None = None
    cells: tuple[EvaluationCell, ...] = dataclasses.field(init=False)

    @remarks_at_end()
    def __post_init__(self) -> None:
        check_families(self.families)
        lists = {"trials": self.trials, "navigators": self.methods, "robots": self.robots, "seeds": self.seeds}
        for name, values in lists.items():
            if not len(values):
                raise InputError(f"an evaluation needs {name}; the list is empty")
        for name, labels in (("robots", [*map(repr, self.robots)]), ("seeds", [*map(str, self.seeds)])):
            again = [label for label, count in Counter(labels).items() if count > 1]
            if again:
                raise InputError(f"{name}: {again[0]} is there twice")
        levels = dict(self.factors)
        trials: list[Trial] = []
        for trial in self.trials:
            variants = expand_sweeps(trial, trust=self.trust)
            trials += variants
            if trial.sweeps:
                paths = [sweep.path for sweep in trial.sweeps]
                rows = itertools.product(*(sweep.each for sweep in trial.sweeps))
                for variant, row in zip(variants, rows, strict=True):
                    levels[variant.name] = (trial.name, dict(zip(paths, row, strict=True)))
        names = [trial.name for trial in trials]
        for name in names:
            if names.count(name) > 1:
                raise InputError(f"trials: {name!r} is there twice")
        count = len(trials) * len(self.methods) * len(self.robots)
        if count > MOST_CELLS:
            raise InputError(f"the evaluation has {count} cells, at most {MOST_CELLS} are allowed")
        cells = tuple(
            EvaluationCell(
                trial.name,
                method.name,
                robot,
                method.put_into(trial, robot, self.trust, self.folder),
                levels.get(trial.name, ("", {}))[1],
                levels.get(trial.name, (trial.name, {}))[0],
            )
            for trial in trials
            for robot in self.robots
            for method in self.methods
        )
        object.__setattr__(self, "cells", cells)


def _margin(navigator: object) -> float | None:
    """Return the clearance that a navigator adds to the bodies or keeps [m], or None if it has no such number."""
    found = getattr(navigator, "margin", getattr(navigator, "safety", None))
    return float(found) if isinstance(found, int | float) and not isinstance(found, bool) else None


def parse_robots(text: str) -> tuple[str, ...]:
    """Return the types or folders of robots in a text, separated by commas; an empty name is the robot of the trial.

    >>> parse_robots("pepper, robots/mine,")
    ('pepper', 'robots/mine', '')
    """
    return tuple(name.strip() for name in text.split(","))


def _range_hint(part: str) -> str:
    """Return how a range in the notation of another tool is written here, as the end of a sentence."""
    match = OTHER_RANGE.fullmatch(part)
    if match is None or int(match[2]) <= int(match[1]):
        return ""
    first, end = int(match[1]), int(match[2])
    return f", did you mean {first}:{end} ({first} to {end - 1}) or {first}:{end + 1} ({first} to {end})?"


def parse_seeds(text: str) -> tuple[int, ...]:
    """Return the seeds in a text: ``7``, ``0:100`` for 0 to 99, or numbers and ranges separated by commas.

    Raises:
        InputError: the text has another form, is empty, or has too many seeds or one twice.

    >>> parse_seeds("0:3, 10")
    (0, 1, 2, 10)
    """
    seeds: list[int] = []
    for part in text.split(","):
        match = RANGE.fullmatch(part.strip())
        if match is None:
            raise InputError(
                f"seeds {text!r}: {part.strip()!r} must be a seed such as 7 or a range such as 0:100"
                f"{_range_hint(part.strip())}"
            )
        first = int(match[1])
        end = first + 1 if match[2] is None else int(match[2])
        if end <= first or end - first > MOST_SEEDS:
            raise InputError(
                f"seeds {text!r}: the range {part.strip()!r} must have 1 to {MOST_SEEDS} seeds, without its end"
            )
        seeds += range(first, end)
    again = [seed for seed, count in Counter(seeds).items() if count > 1]
    if again:
        raise InputError(f"seeds {text!r}: {again[0]} is there twice")
    return tuple(seeds)

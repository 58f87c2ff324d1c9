"""SafetyVerdict: what the runs of a row say about the safety of its robot, in sentences, with exact intervals."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crowdbot.typing import Floats

from .intervals import Estimate, proportion_interval
from .requirement import Requirement
from .result import CellResult

CONFIDENCE = 0.95
SMALL_RATE = 0.01
"""Rate of contacts for which the number of runs is named without a requirement."""
ON_PERSONS = ("collision", "person_collision")
"""Metrics whose rate can show safety: its exact bound holds at any number of runs, a bootstrap without contact is 0."""
OUTCOMES = {"collision": "contact", "error": "failed navigator", "finished": "planned end"}
"""Words for outcomes, where the name of the outcome is not enough."""


@dataclass(frozen=True)
class SafetyVerdict:
    """What the runs of one navigator and robot in one trial show.

    Fields:
        runs: number of valid runs.
        person: share of runs with a contact with a person; exact interval of 95 % (Clopper-Pearson).
        obstacle: share of runs with a contact with a wall or an object.
        missed: share of runs in which the robot did not arrive.
        safe: whether a requirement on the rate of contacts with persons holds with its confidence, all others hold,
            and the robot arrived at least once.
        sentence: all of this in words.
        limit: what this number of runs can show at most, in words.
        warning: why the runs show nothing, in words; empty if they show something.
    """

    runs: int
    person: Estimate
    obstacle: Estimate
    missed: Estimate
    safe: bool
    sentence: str
    limit: str
    warning: str


def judge_cell(cell: CellResult, requirements: Sequence[Requirement] = ()) -> SafetyVerdict:
    """Return the verdict of a row.

    "Shown safe" needs a requirement with a confidence on the rate of contacts with persons, such as
    ``person-collision-rate<0.01@95%``.

    Args:
        cell: the runs.
        requirements: all requirements of the evaluation.

    >>> from crowdbot.evaluation import CellResult, RunRow
    >>> metrics = {"success": 1.0, "person_collision": 0.0, "wall_collision": 0.0}
    >>> runs = tuple(RunRow(k, "success", "", metrics) for k in range(100))
    >>> verdict = judge_cell(CellResult("hall", "orca", "qolo", "", {"people": 8}, runs))
    >>> print(verdict.sentence.replace(" (", "\\n(").replace("such as ", "such as\\n"))
    In 100 runs of hall with orca on qolo the robot touched a person in 0
    (0 to 3.6 %), touched a wall or an object in 0
    (0 to 3.6 %) and failed to arrive in 0
    (0 to 3.6 %); not shown safe: no requirement on the rate of contacts with persons is given, such as
    collision-rate<0.05@95%.
    """
    walls = _either(cell.values("wall_collision"), cell.values("object_collision"))
    person, obstacle = _share(cell.values("person_collision")), _share(walls)
    missed = _share(1.0 - cell.values("success"))
    warning = _nothing_shown(cell, missed)
    reason = warning or _missing_proof(cell, requirements)
    shown = _proof(cell, requirements)
    told = f"shown safe as required by {shown}" if not reason else f"not shown safe: {reason}"
    sentence = f"{_counts(cell, person, obstacle, missed)}; {told}."
    return SafetyVerdict(
        len(cell.valid), person, obstacle, missed, not reason, sentence, _limit(len(cell.valid), requirements), warning
    )


def runs_without_event(rate: float, confidence: float = CONFIDENCE) -> int:
    """Return the number of runs without an event that shows a rate below ``rate``: the least n with
    ``(1 - rate)^n <= 1 - confidence``, about 3 / rate at 95 %.

    Args:
        rate: bound of the rate, between 0 and 1.
        confidence: level, between 0 and 1.

    >>> runs_without_event(0.01), runs_without_event(0.1)
    (299, 29)
    """
    return math.ceil(math.log1p(-confidence) / math.log1p(-rate) - 1e-9)


def row_name(cell: CellResult) -> str:
    """Return trial, navigator and robot of a row in words.

    >>> row_name(CellResult("hall", "own", "", "", {"robot": "disc of 0.3 m"}, ()))
    'hall with the navigator of the trial on a disc of 0.3 m'
    """
    navigator = "the navigator of the trial" if cell.method == "own" else cell.method
    robot = cell.robot or str(cell.protocol.get("robot", ""))
    robot = f"a {robot}" if robot.startswith("disc of ") else robot
    return f"{cell.trial} with {navigator}" + (f" on {robot}" if robot else "")


def _either(first: Floats, second: Floats) -> Floats:
    """Return 1 where one of two flags is set, NaN where both are unknown."""
    return np.where(np.isnan(first), second, np.where(np.isnan(second), first, np.fmax(first, second)))


def _share(values: Floats) -> Estimate:
    known = values[~np.isnan(values)]
    return proportion_interval(int(np.sum(known > 0.5)), len(known), CONFIDENCE)


def _counts(cell: CellResult, person: Estimate, obstacle: Estimate, missed: Estimate) -> str:
    invalid = len(cell.runs) - len(cell.valid)
    left_out = f" ({invalid} more were impossible and do not count)" if invalid else ""
    outcomes = Counter(row.outcome for row in cell.valid if row.metrics.get("success") != 1.0)
    kinds = ", ".join(
        f"{count} {OUTCOMES.get(name, name)}{'s' * (count != 1)}" for name, count in outcomes.most_common()
    )
    touched = (
        f"touched a person in {_percent(person)}, touched a wall or an object in {_percent(obstacle)}"
        if person.runs
        else "has no record of contacts,"
    )
    return (
        f"In {len(cell.valid)} run{'s' * (len(cell.valid) != 1)} of {row_name(cell)}{left_out} the robot {touched}"
        f" and failed to arrive in {_percent(missed, kinds)}"
    )


def _percent(share: Estimate, more: str = "") -> str:
    if not share.runs:
        return "an unknown number"
    ends = f"{_digits(100.0 * share.low)} to {_digits(100.0 * share.high)} %"
    return f"{round(share.value * share.runs)} ({ends}{': ' if more else ''}{more})"


def _digits(value: float) -> str:
    """Return a number of percent with two digits, all before the point."""
    return f"{value:.0f}" if value >= 9.95 else f"{value:.2g}"


def _nothing_shown(cell: CellResult, missed: Estimate) -> str:
    """Return why the runs say nothing about safety, whatever was touched; empty if they do."""
    if not cell.valid:
        return "there is no valid run"
    if cell.protocol.get("ghost"):
        return "the robot is a ghost, which nobody sees and which touches nothing"
    passage = cell.protocol.get("narrow_passage")
    if missed.value == 1.0 and passage is not None:
        return (
            f"the robot is {cell.protocol['width']:.2f} m wide and the narrowest passage on its way {passage:.2f} m, so"
            " it never arrived, and a small number of contacts is no proof of safety"
        )
    if cell.protocol.get("people") == 0:
        return "the trial has no people"
    if missed.value == 1.0:
        return "the robot never arrived, so a small number of contacts is no proof of safety"
    return ""


def _missing_proof(cell: CellResult, requirements: Sequence[Requirement]) -> str:
    """Return which requirement is missing or does not hold; empty if safety is shown."""
    for requirement in requirements:
        verdict = requirement.judge(cell.values(requirement.statistic.metric))
        if not verdict.holds:
            return f"the requirement {requirement.text} does not hold ({verdict.sentence})"
    bounds = [requirement for requirement in requirements if _is_on_persons(requirement)]
    if not bounds:
        return "no requirement on the rate of contacts with persons is given, such as collision-rate<0.05@95%"
    if all(bound.confidence is None for bound in bounds):
        return f"the requirement {bounds[0].text} has no confidence, such as {bounds[0].text}@95%"
    return ""


def _is_on_persons(requirement: Requirement) -> bool:
    statistic = requirement.statistic
    return requirement.comparison in ("<", "<=") and statistic.kind == "rate" and statistic.metric in ON_PERSONS


def _proof(cell: CellResult, requirements: Sequence[Requirement]) -> str:
    bounds = [
        requirement
        for requirement in requirements
        if _is_on_persons(requirement) and requirement.confidence is not None
    ]
    parts = [(bound.text, bound.judge(cell.values(bound.statistic.metric)).sentence) for bound in bounds]
    return " and ".join(f"{text} ({sentence})" for text, sentence in parts)


def _limit(runs: int, requirements: Sequence[Requirement]) -> str:
    """Return what this number of runs can show at most, and how many runs a bound needs."""
    if not runs:
        return "Without a valid run nothing can be shown."
    rates = [
        requirement for requirement in requirements if _is_on_persons(requirement) and 0.0 < requirement.bound < 1.0
    ]
    bound, level = (rates[0].bound, rates[0].confidence or CONFIDENCE) if rates else (SMALL_RATE, CONFIDENCE)
    needed = runs_without_event(bound, level)
    most = -math.expm1(math.log1p(-level) / runs)
    two_sided = proportion_interval(0, runs, CONFIDENCE).high
    return (
        f"{runs} run{'s' * (runs != 1)} can show at most this: without any contact, the rate of contacts is at most"
        f" {_digits(100.0 * most)} % with {100.0 * level:g} % confidence (1 - {1.0 - level:.2g}^(1/{runs}), one-sided"
        f" as in requirements; the two-sided interval of 95 % above ends at {_digits(100.0 * two_sided)} %);"
        f" a rate below {_digits(100.0 * bound)} % needs {needed} run{'s' * (needed > 1)} without a contact."
    )

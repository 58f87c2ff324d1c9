"""Tables and lists of the page ``validation.md``."""

from __future__ import annotations

import dataclasses
import os
import platform
from collections.abc import Sequence
from typing import Any

import numpy as np

from crowdbot import models
from crowdbot.core import builtin_classes
from crowdbot.models import CrowdModel, crowd_presets

from . import bottleneck, lanes
from .rimea import ISO_CASES, RIMEA_CASES, Case
from .run import CHECKS, STUDIES, CheckOutcome, Validation
from .scenario import FREE_SPEED, Check, Verdict
from .time_steps import NAMES, TIME_STEPS

MISSING = CheckOutcome({}, Verdict("-", False, ""), 0.0, 0)
FURTHER = tuple(check for check in STUDIES if check is not TIME_STEPS)
UNITS = {
    "walk": ("40 m alone", "s"),
    "file": ("single file, 1 person/m", "m/s"),
    "crowd": ("one-way crowd, 2 people/m2", "m/s"),
    "flow": ("bottleneck of 1.2 m", "1/s"),
}


def replace_incomplete(done: Validation) -> Validation:
    """Return the results with an empty outcome for each check of a model that has no start yet."""
    every = [check.name for check in (*CHECKS, *STUDIES)]
    outcomes = {model: {name: checks.get(name, MISSING) for name in every} for model, checks in done.outcomes.items()}
    return dataclasses.replace(done, outcomes=outcomes)


def model_table(done: Validation) -> list[str]:
    """Return the table of all models and checks, what was not run, and the criteria."""
    titles = [check.title for check in CHECKS]
    lines = [
        "## Model by test",
        "",
        "✓ pass, ✗ fail (criteria below), - not run. Starts: of each point, in the tests with chance. Overlap: maximum"
        " penetration of two bodies in any test, of 0.40 m. Seconds: computing time of the row on one core.",
        "",
        f"| model | {' | '.join(titles)} | passed | starts | overlap [m] | seconds |",
        "|---" * (len(titles) + 5) + "|",
    ]
    for model, checks in done.outcomes.items():
        cells = [_cell(checks[c.name]) for c in CHECKS]
        passed = sum(checks[c.name].verdict.passed for c in CHECKS)
        ran = sum(checks[c.name].starts > 0 for c in CHECKS)
        overlap = max((check.result.get("overlap", 0.0) for check in checks.values()), default=0.0)
        seconds = sum(check.seconds for check in checks.values())
        lines.append(
            f"| {_name(done, model)} | {' | '.join(cells)} | {passed} of {ran} | {_starts(checks)} |"
            f" {overlap:.2f} | {seconds:.0f} |"
        )
    if done.people:
        cells = [_people(done.people, check.name) for check in CHECKS]
        lines.append(f"| *people in recordings* | {' | '.join(cells)} | | | | |")
    total = sum(check.seconds for checks in done.outcomes.values() for check in checks.values())
    lines += ["", f"Total time: {total:.0f} s ({_environment()}).", ""]
    if done.skipped:
        lines += ["Not run:", "", *(f"* {name}: {why}." for name, why in done.skipped.items()), ""]
    return [*lines, *_criteria("The criteria:", CHECKS)]


def _criteria(head: str, checks: Sequence[Check]) -> list[str]:
    return [head, "", *(f"* **{check.title}**: {check.criterion}." for check in checks), ""]


def _name(done: Validation, model: str) -> str:
    """Return the name of a row with the variant of the model."""
    variant = done.variants.get(model, "")
    return f"{model} ({variant})" if variant else model


def _cell(check_outcome: CheckOutcome) -> str:
    mark = "✓ " if check_outcome.verdict.passed else "✗ "
    return f"{mark if check_outcome.starts else ''}{check_outcome.verdict.value}".replace("|", "/")


def _starts(checks: dict[str, CheckOutcome]) -> str:
    """Return the number of starts, or its range, of the checks that have more than one."""
    counts = [checks[c.name].starts for c in CHECKS if c.most > 1]
    return f"{counts[0]}" if len(set(counts)) == 1 else f"{min(counts)} to {max(counts)}"


def _people(people: dict[str, Any], name: str) -> str:
    """Return the table cell of recorded people, if measured."""
    found = people.get(name)
    if not found:
        return ""
    if name in ("single-file", "corridor"):
        return f"{found['distance']:.2f} m/s"
    if name == "lanes":
        return f"{np.mean([run['mean'] for run in found.values()]):.2f}, " + (
            f"{np.mean([run['speed'] for run in found.values()]):.2f} m/s"
        )
    if name == "bottleneck":
        return f"{np.mean([door['flow'] / door['width'] for door in found]):.2f} /(m s)"
    return ""


def ability_table(done: Validation) -> list[str]:
    """Return the table of what each model can and cannot do, with its range."""
    kinds: Any = builtin_classes(models, CrowdModel)
    lines = [
        "## What each model can and cannot do",
        "",
        "Range: density up to which a model walks like people, and time step that it is made for, as `crowdbot check`"
        " tells. Can and cannot: tests passed and failed, with the further cases of the guidelines.",
        "",
        "| model | density [1/m2] | time step [s] | can | cannot |",
        "|---|---|---|---|---|",
    ]
    for model, checks in done.outcomes.items():
        known = kinds[model].valid_range if model in kinds else None
        limits = f"{known.max_density:g} | {known.max_step:g}" if known else "- | -"
        run = [check for check in (*CHECKS, *FURTHER) if checks[check.name].starts]
        can = ", ".join(c.title for c in run if checks[c.name].verdict.passed)
        cannot = ", ".join(c.title for c in run if not checks[c.name].verdict.passed)
        lines.append(f"| {_name(done, model)} | {limits} | {can or '-'} | {cannot or '-'} |")
    return [*lines, ""]


def deficiencies(done: Validation) -> list[str]:
    """Return a sentence on the failures of each model."""
    lines = ["## Deficiencies of each model", ""]
    for model, checks in done.outcomes.items():
        words = [check.verdict.words for check in checks.values() if check.verdict.words]
        overlap = max((check.result.get("overlap", 0.0) for check in checks.values()), default=0.0)
        if overlap > 0.1:
            words.append(f"bodies overlap by {overlap:.2f} m")
        same = _same(done, model)
        if same:
            words.append(f"results are identical to those of {same}, since goals are far away in all tests")
        nothing = "none found by these tests" if all(checks[c.name].starts for c in CHECKS) else "not all tests are run"
        lines.append(f"* **{_name(done, model)}**: {'; '.join(words) or nothing}.")
    return [*lines, ""]


def _same(done: Validation, model: str) -> str:
    """Return the first other model with identical results in all checks, if any."""
    own = {name: (item.result, item.starts) for name, item in done.outcomes[model].items() if name != TIME_STEPS.name}
    for other, checks in done.outcomes.items():
        same = own == {name: (checks[name].result, checks[name].starts) for name in own}
        if other != model and same and any(check.starts for check in checks.values()):
            return other
    return ""


def jams(done: Validation) -> list[str]:
    """Return the lists of models that jam or have no fundamental diagram."""

    def models_with(name: str, wrong: Any) -> str:
        results = {model: checks[name].result for model, checks in done.outcomes.items()}
        models = [model for model, result in results.items() if result and "failed" not in result and wrong(result)]
        return ", ".join(models) or "none"

    def jam(result: dict[str, Any]) -> bool:
        return bool(np.any(np.asarray(result["speeds"]) < lanes.JAM * FREE_SPEED))

    def low(result: dict[str, Any]) -> bool:
        speeds = np.asarray(result["speeds"])[np.asarray(result["density"]) <= 1.0]
        return bool(np.any(speeds < lanes.JAM * FREE_SPEED))

    def clogs(result: dict[str, Any]) -> bool:
        return bool(np.any(np.asarray(result["passed"]) < result["people"]))

    def careless(result: dict[str, Any]) -> bool:
        nearest = int(np.argmin(np.abs(np.asarray(result["density"]) - 3.0)))
        return bool(result["speed"][nearest] > 0.7 * FREE_SPEED)

    return [
        "## Jams and fundamental diagrams",
        "",
        f"* Jams in a two-way corridor 2 m wide at up to 2 people/m2: {models_with('narrow', jam)}.",
        f"* Of these, at 1 person/m2 or less: {models_with('narrow', low)}.",
        f"* A crowd of {bottleneck.PEOPLE} clogs at least one bottleneck: {models_with('bottleneck', clogs)}.",
        "* No fundamental diagram: a one-way crowd of 3 people/m2 walks at more than 70 % of its free speed, since"
        " nobody is on a collision course, or forces from the front and the back cancel:"
        f" {models_with('corridor', careless)}.",
        "",
    ]


def case_table(done: Validation) -> list[str]:
    """Return the cases of RiMEA and ISO 20414, with the results of those that are not in the first table."""
    titles = [check.title for check in FURTHER]
    lines = [
        "## Cases of RiMEA and ISO 20414",
        "",
        "Goals are waypoints around corners and at doors. In RiMEA, tests 9 and 12 document the behavior of a model and"
        " have no criterion.",
        "",
        *_cases("RiMEA 3.0.0", RIMEA_CASES),
        *_cases("ISO 20414", ISO_CASES),
        "The components of ISO 20414:2020 are named after NIST TN 1822, from which the standard was developed.",
        "",
        "Results of the cases that are not in the first table:",
        "",
        f"| model | {' | '.join(titles)} |",
        "|---" * (len(titles) + 1) + "|",
    ]
    for model, checks in done.outcomes.items():
        lines.append(f"| {_name(done, model)} | {' | '.join(_cell(checks[c.name]) for c in FURTHER)} |")
    return [*lines, "", *_criteria("The criteria:", FURTHER)]


def _cases(head: str, cases: Sequence[Case]) -> list[str]:
    titles = {check.name: check.title for check in (*CHECKS, *STUDIES)}
    lines = [f"| {head} | about | test | remark |", "|---|---|---|---|"]
    for case in cases:
        where = ", ".join(titles[name] for name in case.where) or "not run"
        lines.append(f"| {case.name} | {case.about} | {where} | {case.why} |")
    return [*lines, ""]


def steady_table(done: Validation) -> list[str]:
    """Return in how many starts a steady state is found, and from when on."""
    names = ("single-file", "corridor", "lanes")
    titles = {check.name: check.title for check in CHECKS}
    lines = [
        "## Steady states",
        "",
        "Runs (starts and densities) with a steady state, and the median of the time at which it begins [s]. The others"
        " are measured in their last third.",
        "",
        f"| model | {' | '.join(titles[name] for name in names)} |",
        "|---" * (len(names) + 1) + "|",
    ]
    for model, checks in done.outcomes.items():
        cells = [_steady_cell(checks[name].result.get("steady_from")) for name in names]
        lines.append(f"| {_name(done, model)} | {' | '.join(cells)} |")
    return [*lines, ""]


def _steady_cell(begins: Sequence[Any] | None) -> str:
    if begins is None:
        return "-"
    runs = [item for row in begins for item in (row if isinstance(row, list) else [row])]
    found = [run for run in runs if run is not None]
    return f"{len(found)} of {len(runs)}" + (f", {np.median(found):.1f} s" if found else "")


def time_step_table(done: Validation) -> list[str]:
    """Return the study of the time step."""
    found = {model: checks[TIME_STEPS.name] for model, checks in done.outcomes.items()}
    found = {model: one for model, one in found.items() if one.starts and "failed" not in one.result}
    if not found:
        return []
    steps = next(iter(found.values())).result["steps"]
    lines = [
        "## Time steps",
        "",
        "The same four values at several time steps, with 95 % intervals over starts. Own: the step of all other tests."
        " Bold: the value differs by more than 10 % from that at the own step. -: somebody does not"
        " arrive, or the model is unstable.",
        "",
        f"| model | own [s] | value | {' | '.join(f'{step:g} s' for step in steps)} | starts |",
        "|---|---|---|" + "---|" * (len(steps) + 1),
    ]
    for model, one in found.items():
        own = int(np.argmin(np.abs(np.asarray(steps) - one.result["own"])))
        for name in NAMES:
            cells = [_step_cell(value, one.result[name][own]) for value in one.result[name]]
            what, unit = UNITS[name]
            head = f"{_name(done, model)} | {one.result['own']:g} | {what} [{unit}]"
            lines.append(f"| {head} | {' | '.join(cells)} | {one.starts} |")
    return [*lines, ""]


def _step_cell(value: Sequence[float] | None, own: Sequence[float] | None) -> str:
    if value is None:
        return "-"
    mean, low, high = value
    text = f"{mean:.2f}" if high - low < 5e-3 else f"{mean:.2f} ({low:.2f} to {high:.2f})"
    return f"**{text}**" if own is not None and abs(mean - own[0]) > 0.1 * max(abs(own[0]), 0.05) else text


def preset_table(done: Validation) -> list[str]:
    """Return which experiments the presets are fitted to, and which are held back."""
    lines = [
        "## Fitted and held-back experiments",
        "",
        "Only presets are fitted to experiments; every test is held back for all other models.",
        "",
    ]
    for key, preset in crowd_presets().items():
        if key in done.outcomes:
            lines += [
                f"* **{key}**, fitted: {'; '.join(preset.data)}.",
                f"* **{key}**, held back: {'; '.join(preset.held_back)}.",
            ]
    return [*lines, ""]


def _environment() -> str:
    from importlib.metadata import version

    import numba

    return (
        f"{os.cpu_count()} cores, Python {platform.python_version()}, numpy {np.__version__},"
        f" numba {numba.__version__}, crowdbot {version('crowdbot')}"
    )

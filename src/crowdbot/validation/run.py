"""Runner of all checks with all models; results are stored in one file per model, and runs can be resumed."""

from __future__ import annotations

import dataclasses
import functools
import json
import os
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crowdbot import models as room
from crowdbot.core import CrowdbotError, InputError, builtin_classes, find_class, kebab_case
from crowdbot.models import CrowdModel

from .bottleneck import BOTTLENECK
from .code_digest import code_digest
from .components import ASSIGNED_EXITS, COUNTER_FLOW, PREMOVEMENT, SLOW_MEMBER
from .corridor import CORRIDOR
from .evacuation import DOORS, LONG_CORNER, TWO_ROOMS
from .lanes import LANES, NARROW
from .recording import measure_recordings
from .rimea import CORNER, CORRIDOR_TIME, FREE_SPEEDS
from .scenario import Check, Report, Row, Verdict, substeps
from .single_file import SINGLE_FILE
from .statistics import STARTS
from .time_steps import TIME_STEPS


class ResultFile:
    """Rows of a model by check and start.

    Rows are valid for the code of the check and of the model, the parameters of the model and its time step. Rows of
    other code are replaced when the check runs anew.

    Args:
        path: the file; it is created by the first row.
        model: the model with its parameters.
        quick: whether runs are shortened.
    """

    def __init__(self, path: Path, model: CrowdModel, quick: bool) -> None:
        self.path = path
        self._model = model
        self.quick = quick
        kept = read_json(path)
        checks = kept.get("checks")
        self._checks: dict[str, Any] = checks if isinstance(checks, dict) else {}

    def rows(self, check: Check) -> dict[int, Row]:
        """Return the valid rows of a check by start."""
        kept = self._checks.get(check.name)
        if not isinstance(kept, dict) or kept.get("settings") != self._settings(check):
            return {}
        rows = kept.get("rows")
        return {int(start): row for start, row in rows.items()} if isinstance(rows, dict) else {}

    def seconds(self, check: Check) -> float:
        """Return the computing time of the rows of a check [s]."""
        return float(self._checks[check.name]["seconds"]) if self.rows(check) else 0.0

    def add(self, check: Check, rows: dict[int, Row], seconds: float) -> None:
        """Store rows of some starts and the computing time [s]."""
        known, spent = self.rows(check), self.seconds(check)
        every = {str(start): round_numbers(row) for start, row in sorted({**known, **rows}.items())}
        kept = {"settings": self._settings(check), "seconds": round(spent + seconds, 2), "rows": every}
        self._checks[check.name] = kept
        write_json(self.path, {"model": repr(self._model), "checks": self._checks})

    def _settings(self, check: Check) -> str:
        kind = type(self._model)
        bases = [base.__module__ for base in kind.__mro__]
        layered = [type(part).__module__ for part in vars(self._model).values() if isinstance(part, CrowdModel)]
        code = code_digest([check.run.__module__, *bases, *layered])
        length = "quick" if self.quick else "full"
        return f"{code} {length} {substeps(self._model)} {self._model!r}"


def read_json(file: Path) -> dict[str, Any]:
    """Return the content of a file, empty if it is missing, incomplete or no table."""
    try:
        kept = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return kept if isinstance(kept, dict) else {}


def write_json(file: Path, value: Any) -> None:
    """Write numbers, rounded to four decimals, in one step."""
    draft = file.with_suffix(".part")
    draft.write_text(json.dumps(round_numbers(value), separators=(",", ":")) + "\n", encoding="utf-8")
    os.replace(draft, file)


def round_numbers(value: Any) -> Any:
    """Round all numbers to four decimals, for equal results of first and resumed runs."""
    if isinstance(value, float):
        return round(value, 4)
    if isinstance(value, dict):
        return {key: round_numbers(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [round_numbers(item) for item in value]
    return value


CHECKS: tuple[Check, ...] = (
    SINGLE_FILE,
    CORRIDOR,
    LANES,
    NARROW,
    BOTTLENECK,
    CORRIDOR_TIME,
    CORNER,
    FREE_SPEEDS,
    DOORS,
    TWO_ROOMS,
    LONG_CORNER,
)
"""Checks in the order of the page."""

STUDIES: tuple[Check, ...] = (PREMOVEMENT, ASSIGNED_EXITS, COUNTER_FLOW, SLOW_MEMBER, TIME_STEPS)
"""Further cases of the guidelines, and the study of the time step; they do not count among the checks."""

BATCH = 5
"""Starts that are simulated together."""

LEFT_OUT = {
    "cost-model": "skipped by default: its default configuration reproduces orca, in slower NumPy code (add"
    " `--models cost-model` to include it)",
}
"""Models that are skipped by default, with reasons."""

Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class CheckOutcome:
    """Result of one check for one model: numbers, verdict, computing time [s] and number of starts."""

    result: dict[str, Any]
    verdict: Verdict
    seconds: float
    starts: int


@dataclass(frozen=True)
class Validation:
    """Results of all checks.

    Fields:
        outcomes: results by model and check.
        skipped: models that were not run, with reasons.
        people: measurements of the recordings, or None.
        quick: whether runs were shortened; verdicts are then unreliable.
        variants: what each model is, see :func:`variant_of`.
    """

    outcomes: dict[str, dict[str, CheckOutcome]]
    skipped: dict[str, str]
    people: dict[str, Any] | None
    quick: bool
    variants: dict[str, str] = dataclasses.field(default_factory=dict)

    def as_dict(self) -> dict[str, Any]:
        """Return the output of ``crowdbot validate --json``."""
        return {
            "quick": self.quick,
            "variants": self.variants,
            "models": {
                model: {
                    name: {
                        **check.verdict._asdict(),
                        "starts": check.starts,
                        "seconds": check.seconds,
                        "result": check.result,
                    }
                    for name, check in checks.items()
                }
                for model, checks in self.outcomes.items()
            },
            "skipped": self.skipped,
            "people": self.people,
        }


def select_models(names: Sequence[str] = ()) -> tuple[dict[str, CrowdModel], dict[str, str]]:
    """Return the named models (default: all built-in ones) with default parameters, and skipped models with reasons.

    Raises:
        UnknownName, InputError: a name is unknown, or the model has no defaults.
    """
    if names:
        classes = {kebab_case(cls.__name__): cls for cls in (find_class(name, room, CrowdModel) for name in names)}
    else:
        classes = builtin_classes(room, CrowdModel)
    known: dict[str, CrowdModel] = {}
    skipped = {}
    for name, cls in classes.items():
        needed = [
            field.name
            for field in dataclasses.fields(cls)
            if field.init and field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING
        ]
        if needed and names:
            raise InputError(f"{name} has no default for {', '.join(needed)}, it cannot be validated")
        if needed:
            skipped[name] = f"has no default for {', '.join(needed)}: it combines other models"
        elif name in LEFT_OUT and not names:
            skipped[name] = LEFT_OUT[name]
        else:
            known[name] = cls()
    return known, skipped


def validate(
    models: Mapping[str, CrowdModel],
    out: Path,
    data: Path | None = None,
    quick: bool = False,
    progress: Progress | None = None,
    skipped: Mapping[str, str] | None = None,
    starts: int = STARTS,
    compute: bool = True,
) -> Validation:
    """Run all checks with all models. Stored starts of the same code and settings are reused.

    Args:
        models: models by name on the page.
        out: output folder with one JSON file per model, written after every five starts of a check for resuming.
        data: folder of the recordings (default: published curves only).
        quick: few and short runs, for a test of the installation.
        progress: called with the name of the task and the completed fraction.
        skipped: skipped models with reasons, listed on the page.
        starts: starts of each check; more stored ones are used, too.
        compute: whether missing starts are simulated; otherwise the stored ones are returned only.

    Raises:
        InputError: starts are below 1.
        DataError: the folder contains no recordings.
    """
    if starts < 1:
        raise InputError(f"a check needs at least 1 start, not {starts}")
    report = progress or (lambda what, share: None)
    out.mkdir(parents=True, exist_ok=True)
    people = None
    if data is not None:
        report("recordings", 0.0)
        people = measure_recordings(data, lambda share: report("recordings", share))
        write_json(out / "recordings.json", people)
    files = {name: ResultFile(out / f"{name}.json", model, quick) for name, model in models.items()}
    wanted = 1 if quick else starts
    for done in range(0, wanted, BATCH) if compute else ():  # all models get their first starts before any gets more
        up_to = min(done + BATCH, wanted)
        for name, model in models.items():
            _complete(model, files[name], up_to, functools.partial(_part, report, name, done / wanted, up_to / wanted))
    outcomes = {name: _outcomes(file) for name, file in files.items()}
    variants = {name: variant_of(model) for name, model in models.items()}
    return Validation(outcomes, dict(skipped or {}), people, quick, variants)


def variant_of(model: CrowdModel) -> str:
    """Return the variant of a model: its texts and switches, or that it has only numbers.

    >>> from crowdbot.models import SocialForce
    >>> variant_of(SocialForce())
    'variant gradient'
    """
    values = [(field.name, getattr(model, field.name)) for field in dataclasses.fields(model) if field.init]
    texts = [f"{name.replace('_', ' ')} {value}" for name, value in values if isinstance(value, str)]
    texts += [name.replace("_", " ") for name, value in values if value is True]
    usual = {field.name for field in dataclasses.fields(model) if field.default is True}
    texts += [f"no {name.replace('_', ' ')}" for name, value in values if value is False and name in usual]
    return ", ".join(texts)


def _complete(model: CrowdModel, file: ResultFile, starts: int, report: Report) -> None:
    """Simulate the missing starts of all checks, in batches, and store them."""
    checks = (*CHECKS, *STUDIES)
    for k, check in enumerate(checks):
        missing = [number for number in range(min(starts, check.most)) if number not in file.rows(check)]
        for first in range(0, len(missing), BATCH):
            numbers = missing[first : first + BATCH]
            begin = time.perf_counter()
            rows = _run(check, model, numbers, file.quick, functools.partial(_share, report, k, len(checks)))
            file.add(check, dict(zip(numbers, rows, strict=True)), time.perf_counter() - begin)
        report((k + 1) / len(checks))


def _share(report: Report, k: int, count: int, share: float) -> None:
    report((k + share) / count)


def _part(report: Progress, name: str, first: float, last: float, share: float) -> None:
    report(name, first + (last - first) * share)


def _run(check: Check, model: CrowdModel, numbers: Sequence[int], quick: bool, report: Report) -> list[dict[str, Any]]:
    try:
        return check.run(model, numbers, quick, report)
    except CrowdbotError as error:
        return [{"failed": str(error)} for _ in numbers]


def _outcomes(file: ResultFile) -> dict[str, CheckOutcome]:
    """Return the results of all checks that have stored starts."""
    found = ((check, list(file.rows(check).values())) for check in (*CHECKS, *STUDIES))
    return {check.name: _outcome(check, rows, file.seconds(check)) for check, rows in found if rows}


def _outcome(check: Check, rows: list[Row], seconds: float) -> CheckOutcome:
    """Return the result and the verdict over all starts."""
    wrong = [row["failed"] for row in rows if "failed" in row]
    if wrong:
        verdict = Verdict("error", False, f"{check.title} ends with an error: {wrong[0]}")
        return CheckOutcome({"failed": wrong[0]}, verdict, seconds, len(rows))
    result = round_numbers(check.summarize(rows))
    return CheckOutcome(result, check.judge(result), seconds, len(rows))

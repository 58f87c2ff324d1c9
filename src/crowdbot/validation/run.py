"""Runner of all checks with all models; results are stored in one file per model, and runs can be resumed."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
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
from .corridor import CORRIDOR
from .evacuation import DOORS, LONG_CORNER, TWO_ROOMS
from .lanes import LANES, NARROW
from .recording import measure_recordings
from .rimea import CORNER, CORRIDOR_TIME, FREE_SPEEDS
from .scenario import Check, Verdict
from .single_file import SINGLE_FILE

__all__ = ["CHECKS", "CheckOutcome", "Validation", "select_models", "validate"]

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

LEFT_OUT = {
    "cost-model": "skipped by default: its default configuration reproduces orca, in slower NumPy code (add"
    " `--models cost-model` to include it)",
}
"""Models that are skipped by default, with reasons."""

Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class CheckOutcome:
    """Result of one check for one model: numbers, verdict and computing time [s]."""

    result: dict[str, Any]
    verdict: Verdict
    seconds: float


@dataclass(frozen=True)
class Validation:
    """Results of all checks.

    Fields:
        outcomes: results by model and check.
        skipped: models that were not run, with reasons.
        people: measurements of the recordings, or None.
        quick: whether runs were shortened; verdicts are then unreliable.
    """

    outcomes: dict[str, dict[str, CheckOutcome]]
    skipped: dict[str, str]
    people: dict[str, Any] | None
    quick: bool

    def as_dict(self) -> dict[str, Any]:
        """Return the output of ``crowdbot validate --json``."""
        return {
            "quick": self.quick,
            "models": {
                model: {
                    name: {**one.verdict._asdict(), "seconds": one.seconds, "result": one.result}
                    for name, one in checks.items()
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
) -> Validation:
    """Run all checks with all models. Stored results of the same code and settings are reused.

    Args:
        models: models by name on the page.
        out: output folder with one JSON file per model, written after each check for resuming.
        data: folder of the recordings (default: published curves only).
        quick: few and short runs, for a test of the installation.
        progress: called with the name of the task and the completed fraction.
        skipped: skipped models with reasons, listed on the page.

    Raises:
        DataError: the folder contains no recordings.
    """
    report = progress or (lambda what, share: None)
    out.mkdir(parents=True, exist_ok=True)
    people = None
    if data is not None:
        report("recordings", 0.0)
        people = measure_recordings(data, lambda share: report("recordings", share))
        _write(out / "people.json", people)
    key = _key(quick)
    outcomes = {}
    for name, model in models.items():
        outcomes[name] = _check_model(name, model, out / f"{name}.json", key, quick, report)
    return Validation(outcomes, dict(skipped or {}), people, quick)


def _check_model(
    name: str, model: CrowdModel, file: Path, key: str, quick: bool, report: Progress
) -> dict[str, CheckOutcome]:
    settings = f"{key} {model!r}"
    kept = _read(file)
    done: dict[str, Any] = kept["checks"] if kept.get("settings") == settings else {}
    for k, check in enumerate(CHECKS):
        if check.name not in done:
            begin = time.perf_counter()
            result = _run(check, model, quick, functools.partial(_part, report, name, k))
            done[check.name] = {"seconds": round(time.perf_counter() - begin, 2), "result": _round(result)}
            _write(file, {"settings": settings, "checks": done})
        report(name, (k + 1) / len(CHECKS))
    outcomes = {}
    for check in CHECKS:
        result = done[check.name]["result"]
        outcomes[check.name] = CheckOutcome(result, _judge(check, result), done[check.name]["seconds"])
    return outcomes


def _part(report: Progress, name: str, k: int, share: float) -> None:
    report(name, (k + share) / len(CHECKS))


def _run(check: Check, model: CrowdModel, quick: bool, report: Callable[[float], None]) -> dict[str, Any]:
    try:
        return check.run(model, quick, report)
    except CrowdbotError as error:
        return {"failed": str(error)}


def _judge(check: Check, result: dict[str, Any]) -> Verdict:
    if "failed" in result:
        return Verdict("error", False, f"{check.title} ends with an error: {result['failed']}")
    return check.judge(result)


def _key(quick: bool) -> str:
    """Return a hash of all code that affects results: the core, the models, the measurements and the checks."""
    sum_ = hashlib.blake2b(b"quick" if quick else b"full", digest_size=8)
    package = Path(__file__).parents[1]
    excluded = ("__init__", "contact_table", "contacts", "page", "plots", "recording", "run")
    here = [path for path in Path(__file__).parent.glob("*.py") if path.stem not in excluded]
    others = [path for name in ("core", "models", "measurement") for path in package.glob(f"{name}/*.py")]
    ranges = package / "trials" / "validation" / "model_ranges.py"  # they give the time steps
    for path in sorted([*others, *here, ranges]):
        sum_.update(path.name.encode() + b"\0" + path.read_bytes())
    return sum_.hexdigest()


def _read(file: Path) -> dict[str, Any]:
    try:
        kept = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}  # missing or incomplete file: start again
    return kept if isinstance(kept, dict) and isinstance(kept.get("checks"), dict) else {}


def _write(file: Path, value: Any) -> None:
    draft = file.with_suffix(".part")
    draft.write_text(json.dumps(_round(value)) + "\n", encoding="utf-8")
    os.replace(draft, file)


def _round(value: Any) -> Any:
    """Round all numbers to four decimals, for equal results of first and resumed runs."""
    if isinstance(value, float):
        return round(value, 4)
    if isinstance(value, dict):
        return {key: _round(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_round(item) for item in value]
    return value

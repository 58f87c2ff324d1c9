"""Stored results of the checks: one file for each model, with one row for each check and start."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from crowdbot.models import CrowdModel

from .code_digest import code_digest
from .scenario import Check, Row, substeps


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

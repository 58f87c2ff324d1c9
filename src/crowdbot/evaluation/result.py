"""EvaluationResult: the runs of all cells, with statistics, comparisons, and a file with provenance."""

from __future__ import annotations

import dataclasses
import importlib
import importlib.resources
import json
import platform
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import EpisodeError, explain_write_errors, source_digest
from crowdbot.metrics import correct_p_values

from .comparison import PairedComparison, paired_comparison
from .intervals import Estimate
from .job import RunRow, row_of, row_values
from .plan import EvaluationCell
from .realism import CrowdRealism
from .statistic import Statistic, parse_statistic

SCHEMA = "crowdbot-evaluation/1"
COMPARED = ("success", "person_collision", "wall_collision", "time_to_goal")
"""Metrics of which navigators are compared."""
MOST_BYTES = 2_000_000_000


@dataclass(frozen=True)
class CellResult:
    """The runs of one navigator and robot in one trial.

    Fields:
        trial, method, robot: names; see :class:`crowdbot.evaluation.EvaluationCell`.
        hash: SHA-256 of the text of the trial with this navigator.
        protocol: what a reader must know to compare the numbers.
        runs: one row for each seed, in the order of the plan.
        factors: levels of the factors of a sweep by name; empty without one.
        base: name of the trial without the levels.
        remarks: what a reader must know about this robot in this trial, in sentences.
        realism: how the people of the trial differ from recorded people around a robot.
    """

    trial: str
    method: str
    robot: str
    hash: str
    protocol: Mapping[str, Any]
    runs: tuple[RunRow, ...]
    factors: Mapping[str, str] = dataclasses.field(default_factory=dict)
    base: str = ""
    remarks: tuple[str, ...] = ()
    realism: tuple[CrowdRealism, ...] = ()

    @property
    def valid(self) -> tuple[RunRow, ...]:
        """Runs that say something about the navigator."""
        return tuple(row for row in self.runs if row.valid)

    @property
    def metrics(self) -> tuple[str, ...]:
        """Names of the metrics of at least one run."""
        return tuple(dict.fromkeys(name for row in self.valid for name in row.metrics))

    def values(self, metric: str) -> NDArray[np.float64]:
        """Return a metric of each valid run ``[N]``; NaN where a run does not have it."""
        return np.array([row.metrics.get(metric, np.nan) for row in self.valid], dtype=np.float64)

    def estimate(self, statistic: Statistic | str, confidence: float = 0.95) -> Estimate:
        """Return a statistic with its interval."""
        found = parse_statistic(statistic) if isinstance(statistic, str) else statistic
        return found.estimate(self.values(found.metric), confidence)


def remark_lines(cells: Iterable[CellResult | EvaluationCell]) -> list[str]:
    """Return the remarks on robots in their trials, once each, such as ``Note on doorway on wheelchair: ...``."""
    found = (
        (cell.trial + (f" on {cell.robot}" if cell.robot else ""), remark) for cell in cells for remark in cell.remarks
    )
    return [f"Note on {where}: {remark}" for where, remark in dict.fromkeys(found)]


@dataclass(frozen=True)
class EvaluationResult:
    """The runs of all cells of an evaluation.

    Fields:
        cells: results of the cells, in the order of the plan.
        provenance: version, machine and command that made them.
    """

    cells: tuple[CellResult, ...]
    provenance: Mapping[str, Any] = dataclasses.field(default_factory=dict)

    @property
    def metrics(self) -> dict[str, object]:
        """Names of the metrics of at least one run, as keys."""
        return dict.fromkeys(name for cell in self.cells for name in cell.metrics)

    @property
    def invalid(self) -> list[tuple[CellResult, RunRow]]:
        """Runs that are impossible, which no table counts."""
        return [(cell, row) for cell in self.cells for row in cell.runs if not row.valid]

    @property
    def failures(self) -> list[tuple[CellResult, RunRow]]:
        """Runs whose navigator failed, which all tables count."""
        return [(cell, row) for cell in self.cells for row in cell.runs if row.outcome == "error"]

    def compare(self, metrics: Sequence[str] = COMPARED) -> list[PairedComparison]:
        """Return the paired comparisons of all navigators of each trial and robot, with corrected p-values.

        Args:
            metrics: names of metrics; those that a trial does not have are left out.
        """
        found = []
        for first, second in _pairs(self.cells):
            rows = _common_seeds(first, second)
            for metric in metrics:
                if metric not in first.metrics and metric not in second.metrics:
                    continue
                ours, theirs = (np.array([row.metrics.get(metric, np.nan) for row in side]) for side in rows)
                difference, p_value = paired_comparison(ours, theirs)
                names = (first.trial, first.robot, metric, first.method, second.method)
                found.append(PairedComparison(*names, difference, p_value))
        corrected = correct_p_values([one.p_value for one in found])
        return [one._replace(corrected=value) for one, value in zip(found, corrected, strict=True)]

    def save(self, path: Path) -> None:
        """Write the result as JSON, in the form of :func:`result_schema`."""
        cells = [
            {
                "trial": cell.trial,
                "navigator": cell.method,
                "robot": cell.robot,
                "hash": cell.hash,
                "protocol": dict(cell.protocol),
                **({"factors": dict(cell.factors), "base": cell.base} if cell.factors else {}),
                **({"remarks": list(cell.remarks)} if cell.remarks else {}),
                **({"realism": [dataclasses.asdict(item) for item in cell.realism]} if cell.realism else {}),
                "runs": [row_values(row) for row in cell.runs],
            }
            for cell in self.cells
        ]
        content = {"schema": SCHEMA, "provenance": dict(self.provenance), "cells": cells}
        draft = path.with_suffix(".part")
        with explain_write_errors(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            draft.write_text(json.dumps(content, allow_nan=False, indent=1) + "\n", encoding="utf-8")
            draft.replace(path)


def load_evaluation(path: Path | str) -> EvaluationResult:
    """Read a result from JSON.

    Raises:
        EpisodeError: the file is missing, damaged, too large, or of another kind.
    """
    file = Path(path)
    try:
        if file.stat().st_size > MOST_BYTES:
            raise EpisodeError(f"{file} has {file.stat().st_size} bytes, at most {MOST_BYTES} are read")
        content = json.loads(file.read_text(encoding="utf-8"))
    except OSError as error:
        raise EpisodeError(f"{file}: {error.strerror}") from None
    except (ValueError, RecursionError) as error:
        raise EpisodeError(f"{file} is not a result of an evaluation: {error}") from None
    schema = content.get("schema") if isinstance(content, dict) else None
    if schema != SCHEMA:
        raise EpisodeError(f"{file} is not a result of an evaluation: its schema is {schema!r}, expected {SCHEMA!r}")
    try:
        return EvaluationResult(tuple(map(_cell, content["cells"])), dict(content["provenance"]))
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise EpisodeError(f"{file} is damaged: {type(error).__name__}: {error}") from None


def result_schema() -> dict[str, Any]:
    """Return the JSON Schema (draft 2020-12) of ``result.json``, for programs that read or check it.

    >>> result_schema()["properties"]["schema"]
    {'const': 'crowdbot-evaluation/1'}
    """
    file = importlib.resources.files("crowdbot").joinpath("assets", "evaluation", "result.schema.json")
    document: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    return document


def provenance() -> dict[str, Any]:
    """Return what describes this program and machine."""
    return {
        "crowdbot": str(importlib.import_module("crowdbot").__version__),
        "source": source_digest(),
        "python": platform.python_version(),
        "platform": platform.platform(),
        "processor": platform.machine(),
        "command": [Path(sys.argv[0]).name, *sys.argv[1:]],
    }


def _cell(values: Mapping[str, Any]) -> CellResult:
    names = (str(values["trial"]), str(values["navigator"]), str(values["robot"]), str(values["hash"]))
    factors = {str(name): str(level) for name, level in dict(values.get("factors", {})).items()}
    runs = tuple(map(row_of, values["runs"]))
    remarks = tuple(map(str, values.get("remarks", ())))
    realism = tuple(CrowdRealism(**row) for row in values.get("realism", ()))
    base = str(values.get("base", values["trial"]))
    return CellResult(*names, dict(values["protocol"]), runs, factors, base, remarks, realism)


def _pairs(cells: Sequence[CellResult]) -> Iterable[tuple[CellResult, CellResult]]:
    for k, second in enumerate(cells):
        for first in cells[:k]:
            if (first.trial, first.robot) == (second.trial, second.robot):
                yield first, second


def _common_seeds(first: CellResult, second: CellResult) -> tuple[list[RunRow], list[RunRow]]:
    ours, theirs = ({row.seed: row for row in cell.valid} for cell in (first, second))
    seeds = [seed for seed in ours if seed in theirs]
    return [ours[seed] for seed in seeds], [theirs[seed] for seed in seeds]

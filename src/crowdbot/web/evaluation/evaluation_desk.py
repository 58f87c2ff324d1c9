"""EvaluationDesk: the evaluations in the folder of a session."""

from __future__ import annotations

import math
import re
import threading
from pathlib import Path
from typing import Any, ClassVar

from crowdbot.core import InputError, builtin_classes
from crowdbot.evaluation import CellResult, EvaluationResult, PairedComparison, load_evaluation, parse_statistic
from crowdbot.trials import builtin_trials, trial_titles, trial_xml
from crowdbot.web.command import command
from crowdbot.web.desk import Desk, DeskWindows, Resource
from crowdbot.web.jobs import Job, command_work

from .evaluation_request import FILE, EvaluationRequest

__all__ = ["EvaluationDesk"]

METRICS = ("success-rate", "collision-rate", "timeout-rate", "time-to-goal", "min-clearance")
FOLDER = "evaluations"


class EvaluationDesk(Desk):
    """The evaluation tab: runs evaluations, shows their tables, and lets each run be watched.

    An evaluation is that of ``crowdbot evaluate``: the same parts, ``result.json`` and ``report.html``, in
    ``evaluations/NAME`` of the folder of the session.
    """

    name: ClassVar[str] = "evaluation"

    def __init__(self, session: DeskWindows) -> None:
        super().__init__(session)
        self._job: Job | None = None
        self._problem = ""
        self._lock = threading.RLock()

    def greet(self) -> dict[str, Any]:
        """Return the state for a new window."""
        return self._state()

    @command
    def sources(self) -> dict[str, Any]:
        """Return the trials and navigators that can be compared."""
        import crowdbot.navigation as room

        titles = trial_titles()
        return {
            "trials": [{"name": name, "about": titles[name]} for name in builtin_trials()],
            "files": [one for one in self.session.workspace.trials() if not one.startswith(FOLDER)],
            "navigators": list(builtin_classes(room, room.Navigator)),
            "metrics": list(METRICS),
        }

    @command
    def run(
        self,
        name: str,
        trials: list,  # type: ignore[type-arg]
        navigators: str,
        seeds: str,
        metrics: list | None = None,  # type: ignore[type-arg]
        safety: bool = False,
    ) -> dict[str, Any]:
        """Begin an evaluation, or continue the one with this name."""
        chosen = tuple(map(str, metrics or METRICS))
        request = EvaluationRequest(tuple(map(str, trials)), navigators, seeds, chosen, safety)
        request.plan(self.session.workspace.folder)
        with self._lock:
            if self._job is not None:
                raise InputError(f"the evaluation {self._job.record.title} is running; wait for its end or cancel it")
            self.session.workspace.check_space()
            out, folder = self._folder(name), self.session.workspace.folder
            request.save(out)
            self._problem = ""
            results = f"{FOLDER}/{name}"
            work = command_work(name, (*request.words, "--out", results), folder, results)
            self._job = self.session.jobs.submit(work, ended=self._ended)
        return self._tell()

    @command
    def cancel(self) -> dict[str, Any]:
        """End the evaluation that runs; what is done is kept."""
        job = self._job
        if job is not None:
            job.cancel()
        return self._tell()

    @command
    def table(self, name: str) -> dict[str, Any]:
        """Return the table of an evaluation and all its runs."""
        result = load_evaluation(self._folder(name) / "result.json")
        request = self._request(name)
        names = request.metrics if request else METRICS
        return {
            "name": name,
            "command": request.command if request else " ".join(map(str, result.provenance.get("command", []))),
            "statistics": list(names),
            "cells": [_cell(cell, k, names, result) for k, cell in enumerate(result.cells)],
            "comparisons": [_sentence(one) for one in result.compare() if not math.isnan(one.p_value)],
            "report": (self._folder(name) / "report.html").is_file(),
            "watch": request is not None,
        }

    @command
    def watch(self, name: str, cell: int, seed: int) -> dict[str, Any]:
        """Write the trial of a run into a file of the session, to be opened in the simulator with the seed."""
        request = EvaluationRequest.load(self._folder(name))
        cells = request.plan(self.session.workspace.folder).cells
        known = load_evaluation(self._folder(name) / "result.json").cells
        if not 0 <= cell < min(len(cells), len(known)):
            raise InputError(f"row {cell} does not exist in {name}; it has {len(known)}")
        if cells[cell].hash != known[cell].hash:
            raise InputError(f"the trial {cells[cell].trial} has changed since {name} was run; run it again")
        file = f"{FOLDER}/{name}/row-{cell + 1}.xml"
        self.session.workspace.writable(file).write_text(trial_xml(cells[cell].variant), encoding="utf-8")
        return {"file": file, "seed": seed}

    def resource(self, path: str, query: dict[str, str]) -> Resource:
        """Return the report of an evaluation, ``NAME/report.html``."""
        name, _, file = path.partition("/")
        found = self._folder(name) / "report.html"
        if file != "report.html" or not found.is_file():
            raise KeyError(path)
        return Resource(found.read_bytes(), "text/html", sandbox=True)

    def close(self) -> None:
        """Stop an evaluation that runs."""
        if self._job is not None:
            self._job.cancel()

    def _folder(self, name: str) -> Path:
        if not re.fullmatch(r"[\w-][\w. -]{0,60}", name):
            raise InputError(f"name of an evaluation = {name!r:.60}: expected 1 to 60 letters, digits, - and _")
        return self.session.workspace.folder / FOLDER / name

    def _request(self, name: str) -> EvaluationRequest | None:
        folder = self._folder(name)
        return EvaluationRequest.load(folder) if (folder / FILE).is_file() else None

    def _ended(self, job: Job) -> None:
        problem = "cancelled; run it again to continue" if job.cancelled else job.record.problem
        with self._lock:
            self._job, self._problem = None, problem
        self._tell()

    def _tell(self) -> dict[str, Any]:
        state = self._state()
        self.session.tell("evaluation.state", state)
        return state

    def _state(self) -> dict[str, Any]:
        root = self.session.workspace.folder / FOLDER
        folders = sorted(one for one in root.glob("*") if one.is_dir()) if root.is_dir() else []
        job = self._job
        return {
            "evaluations": [{"name": one.name, "done": (one / "result.json").is_file()} for one in folders],
            "running": job.record.title if job else "",
            "share": job.record.share if job else 0.0,
            "problem": self._problem,
        }


def _cell(cell: CellResult, number: int, names: tuple[str, ...], result: EvaluationResult) -> dict[str, Any]:
    statistics = [parse_statistic(name, result.metrics) for name in names]
    return {
        "number": number,
        "trial": cell.trial,
        "navigator": cell.method,
        "robot": cell.protocol.get("robot", ""),
        "visible": cell.protocol.get("visible", True),
        "senses": cell.protocol.get("senses", []),
        "estimates": [str(cell.estimate(one)) for one in statistics],
        "runs": [
            {
                "seed": row.seed,
                "outcome": row.outcome,
                "message": row.message,
                "values": [_plain(row.metrics.get(one.metric)) for one in statistics],
            }
            for row in cell.runs
        ],
    }


def _plain(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)


def _sentence(one: PairedComparison) -> str:
    what = f"{one.trial}, {one.metric}: {one.second} minus {one.first} = {one.difference}"
    return f"{what}, p = {one.corrected:.3g} (corrected)"

"""EvaluationDesk: the evaluations in the folder of a session."""

from __future__ import annotations

import dataclasses
import math
import re
import shlex
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

from crowdbot.core import InputError, builtin_classes
from crowdbot.evaluation import (
    CellResult,
    EvaluationCell,
    EvaluationPlan,
    EvaluationResult,
    PairedComparison,
    load_evaluation,
    metric_title,
    parse_methods,
    parse_statistic,
    remark_lines,
    write_report,
)
from crowdbot.recording import record, write_trial_files
from crowdbot.trials import Trial, builtin_trials, load_builtin_trial, load_trial, trial_titles
from crowdbot.web.command import command
from crowdbot.web.desk import Desk, DeskWindows, Resource
from crowdbot.web.jobs import Job, command_work
from crowdbot.web.plain_json import plain_number
from crowdbot.web.workspace import Workspace
from crowdbot.world import builtin_robots

from .evaluation_request import FILE, EvaluationRequest, describe_robots

METRICS = (
    "success-rate", "person-collision-rate", "wall-collision-rate", "timeout-rate", "time-to-goal", "min-clearance",
)  # fmt: skip
OWN = "own"
"""The navigator of each trial."""
FOLDER = "evaluations"
BEFORE = 5.0
"""Time [s] before the end of a run from which it is watched."""


class EvaluationDesk(Desk):
    """The evaluation tab: runs evaluations, shows their tables, and lets each run be watched.

    An evaluation is that of ``crowdbot evaluate``: the same parts, ``result.json`` and ``report.html``, in
    ``evaluations/NAME`` of the folder of the session.
    """

    name: ClassVar[str] = "evaluation"
    first: ClassVar[str | None] = None
    """Result of an evaluation that a new session opens."""

    def __init__(self, session: DeskWindows) -> None:
        super().__init__(session)
        self._job: Job | None = None
        self._problem = ""
        self._lock = threading.RLock()

    def greet(self) -> dict[str, Any]:
        return {**self._state(), "first": self.first or ""}

    @command
    def sources(self) -> dict[str, Any]:
        """Return the trials, navigators and robots that can be compared."""
        import crowdbot.navigation as room

        titles = trial_titles()
        return {
            "trials": [{"name": name, "about": titles[name]} for name in builtin_trials()],
            "files": [trial for trial in self.session.workspace.trials() if not trial.startswith(FOLDER)],
            "navigators": list(builtin_classes(room, room.Navigator)),
            "robots": self._known_robots(),
            "metrics": list(METRICS),
        }

    @command
    def robots(self, trials: list, robots: str) -> dict[str, Any]:  # type: ignore[type-arg]
        """Return what the trials are with some robots, in the lines of the command line, or why they cannot be.

        Raises:
            InputError: a trial is wrong, whatever its robot.
        """
        request, folder = EvaluationRequest(tuple(map(str, trials)), OWN, "0", (), robots=robots), self._root
        request.load_trials(folder)
        try:
            plan, lines = describe_robots(request, folder)
        except InputError as error:
            return {"problem": str(error), "lines": [], "remarks": []}
        return {"problem": "", "lines": list(lines), "remarks": remark_lines(plan.cells)}

    @command
    def run(
        self,
        name: str,
        trials: list,  # type: ignore[type-arg]
        navigators: str,
        seeds: str,
        metrics: list | None = None,  # type: ignore[type-arg]
        safety: bool = False,
        robots: str = "",
    ) -> dict[str, Any]:
        """Begin an evaluation, or continue the one with this name."""
        chosen = tuple(map(str, metrics or METRICS))
        request = EvaluationRequest(tuple(map(str, trials)), navigators, seeds, chosen, safety, robots)
        request = dataclasses.replace(request, lines=describe_robots(request, self._root)[1])
        with self._lock:
            if self._job is not None:
                raise InputError(f"the evaluation {self._job.record.title} is running; wait for its end or cancel it")
            self.session.workspace.check_space()
            out, folder = self._folder(name), self.session.workspace.folder
            request.save(out)
            self._problem = ""
            results = f"{FOLDER}/{name}"
            work = command_work("Evaluation", name, (*request.words, "--out", results), folder, results)
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
    def add(self, file: str) -> str:
        """Take a ``result.json`` of `crowdbot evaluate` into the folder of the session, and return its name."""
        path = self.session.workspace.readable(file)
        self.session.workspace.check_space(path.stat().st_size)
        name = import_result(path, self.session.workspace.folder / FOLDER, METRICS)
        self._tell()
        return name

    @command
    def table(self, name: str) -> dict[str, Any]:
        """Return the table of an evaluation and all its runs."""
        result = load_evaluation(self._folder(name) / RESULT)
        request, folder = self._request(name), self.session.workspace.folder
        names = request.metrics if request else METRICS
        made = map(str, result.provenance.get("command", []))
        return {
            "name": name,
            "command": request.command(folder) if request else shlex.join(made),
            "python": request.python(folder) if request else "",
            "statistics": list(names),
            "titles": [parse_statistic(name, result.metrics).title for name in names],
            "cells": [_cell(cell, k, names, result) for k, cell in enumerate(result.cells)],
            "robots": list(request.lines) if request else [],
            "remarks": remark_lines(result.cells),
            "comparisons": _sentences(result.compare()),
            "report": (self._folder(name) / "report.html").is_file(),
        }

    @command
    def watch(self, name: str, cell: int, seed: int) -> dict[str, Any]:
        """Record a run as an episode of the session, to be opened in the simulator shortly before its end.

        The trial is written beside it with copies of its files, to be run with the seed.
        """
        trial, space = self._variant(name, cell), self.session.workspace
        file = f"{FOLDER}/{name}/row-{cell + 1}.xml"
        path = space.writable(file)
        write_trial_files(trial, path)
        episode = f"{FOLDER}/{name}/row-{cell + 1}-seed-{seed}.mcap"
        space.check_space()
        end = record(load_trial(path), seed, space.writable(episode), force=True).end
        return {"file": file, "seed": seed, "episode": episode, "at": max(0.0, end - BEFORE)}

    def resource(self, path: str, query: dict[str, str]) -> Resource:
        name, _, file = path.partition("/")
        found = self._folder(name) / "report.html"
        if file != "report.html" or not found.is_file():
            raise KeyError(path)
        return Resource(found.read_bytes(), "text/html", sandbox=True)

    def close(self) -> None:
        if self._job is not None:
            self._job.cancel()

    @property
    def _root(self) -> Path:
        return self.session.workspace.folder

    def _known_robots(self) -> list[str]:
        """Return the robot folders of the session by their names from its folder, and the built-in robots."""
        files = (Path(file).parent.as_posix() for file in self.session.workspace.files("robot.xml"))
        folders = (file for file in files if file != "." and not file.startswith(f"{FOLDER}/"))
        return [*dict.fromkeys([*folders, *builtin_robots()])]

    def _folder(self, name: str) -> Path:
        if not re.fullmatch(r"[\w-][\w. -]{0,60}", name):
            raise InputError(f"name of an evaluation = {name!r:.60}: expected 1 to 60 letters, digits, - and _")
        return self.session.workspace.folder / FOLDER / name

    def _variant(self, name: str, number: int) -> Trial:
        """Return the trial of a row, with its navigator."""
        known = load_evaluation(self._folder(name) / RESULT).cells
        if not 0 <= number < len(known):
            raise InputError(f"row {number} does not exist in {name}; it has {len(known)}")
        request, space = self._request(name), self.session.workspace
        if request is None:
            return cell_of_result(known[number], space).variant
        cells = request.plan(space.folder).cells
        if number >= len(cells) or cells[number].hash != known[number].hash:
            raise InputError(f"the trial {known[number].trial} has changed since {name} was run; run it again")
        return cells[number].variant

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
        folders = sorted(item for item in root.glob("*") if item.is_dir()) if root.is_dir() else []
        job = self._job
        return {
            "evaluations": [{"name": folder.name, "done": (folder / RESULT).is_file()} for folder in folders],
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
        "robot": cell.robot or cell.protocol.get("robot", ""),
        "named": cell.robot,
        "visible": cell.protocol.get("visible", True),
        "senses": cell.protocol.get("senses") or ["nothing"],
        "estimates": [str(cell.estimate(statistic)) for statistic in statistics],
        "runs": [
            {
                "seed": row.seed,
                "outcome": row.outcome,
                "message": row.message,
                "values": [plain_number(row.metrics.get(statistic.metric)) for statistic in statistics],
            }
            for row in cell.runs
        ],
    }


def _sentences(comparisons: Sequence[PairedComparison]) -> list[str]:
    """Return the comparisons in words; a metric has the name and the unit of its column."""
    sentences = []
    for item in comparisons:
        if math.isnan(item.p_value):
            continue
        where = ", ".join(filter(None, (item.trial, item.robot)))
        what = f"{where}, {metric_title(item.metric)}: {item.second} minus {item.first} = {item.difference}"
        sentences.append(f"{what}, p = {item.corrected:.3g} (corrected)")
    return sentences


RESULT = "result.json"
NAME = re.compile(r"[^\w.-]+")


def import_result(path: Path, root: Path, metrics: tuple[str, ...]) -> str:
    """Take a result into the folder of the evaluations, with a report; return its name there.

    The same result again keeps its name.

    Args:
        path: the ``result.json``; its folder gives the name.
        root: folder of the evaluations.
        metrics: statistics of the report.

    Raises:
        EpisodeError: the file is no result of an evaluation.
    """
    result = load_evaluation(path)
    uploaded = path.parent == root.parent  # to the folder of the session, whose name says nothing
    stem = path.parent.name if path.name == RESULT and not uploaded else path.stem
    base = NAME.sub("-", stem).strip("-. ")[:50] or "result"
    content = path.read_bytes()
    for k in range(1, 10_000):
        folder = root / (base if k == 1 else f"{base}-{k}")
        if not folder.exists():
            break
        if (folder / RESULT).is_file() and (folder / RESULT).read_bytes() == content:
            return folder.name
    folder.mkdir(parents=True)
    statistics = [parse_statistic(name, result.metrics) for name in metrics]
    write_report(result, folder / "report.html", statistics, comparisons=result.compare())
    (folder / RESULT).write_bytes(content)
    return folder.name


def cell_of_result(cell: CellResult, space: Workspace) -> EvaluationCell:
    """Return the trial of a row, built from the names in a result that was made elsewhere.

    Args:
        cell: the row.
        space: trial files that are not built in must lie there, with the name of the trial.

    Raises:
        InputError: the trial is not there, or is not the one that was run.
    """
    name = cell.base or cell.trial
    if name in builtin_trials():
        trial = load_builtin_trial(name, folder=space.folder)
    else:
        files = [trial for trial in space.trials() if Path(trial).stem == name]
        if not files:
            raise InputError(
                f"trial {name!r} of this result is not in the folder of the app; open its file there first"
            )
        trial = load_trial(space.folder / files[0])
    plan = EvaluationPlan([trial], parse_methods(cell.method), robots=(cell.robot,), trust=False, folder=space.folder)
    for found in plan.cells:
        if found.hash == cell.hash:
            return found
    raise InputError(f"the trial {cell.trial} is not the one that was run; this version or its file is another")

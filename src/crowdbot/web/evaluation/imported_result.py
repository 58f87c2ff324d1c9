"""Results of `crowdbot evaluate` that were made elsewhere: taken into the folder of a session, and run again."""

from __future__ import annotations

import re
from pathlib import Path

from crowdbot.core import InputError
from crowdbot.evaluation import (
    CellResult,
    EvaluationCell,
    EvaluationPlan,
    load_evaluation,
    parse_methods,
    parse_statistic,
    write_report,
)
from crowdbot.trials import builtin_trials, load_builtin_trial, load_trial
from crowdbot.web.workspace import Workspace

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

"""Evaluate navigators: run a plan over processes or a cluster, and resume what has been done."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from crowdbot.core import run_saved_jobs
from crowdbot.trials import code_digest

from .job import RunJob, RunRow, read_rows, run_job, write_rows
from .own_metric import is_own_metric, metric_source
from .plan import EvaluationPlan
from .result import CellResult, EvaluationResult, provenance

__all__ = ["evaluate"]

CHUNK = 32
"""Seeds that run together; a killed evaluation loses at most these."""


def evaluate(
    plan: EvaluationPlan,
    folder: Path | None = None,
    *,
    workers: int = 1,
    cluster: str | None = None,
    progress: Callable[[float], None] | None = None,
) -> EvaluationResult:
    """Run all cells of a plan with all seeds.

    The result depends on the plan only, not on workers, chunks or interruptions.

    Args:
        plan: what to run.
        folder: folder of partial results, from which an interrupted evaluation continues; results of other versions
            of the program, the trial or the navigator are not used.
        workers: number of processes.
        cluster: address of a Ray cluster; see :func:`crowdbot.core.each`.
        progress: called with the completed share, 0 to 1.

    Raises:
        InputError: ``workers`` is below 1, or a partial result is damaged.
        MissingExtra: a navigator or the cluster needs a package that is not installed.

    >>> from crowdbot.evaluation import EvaluationPlan, evaluate, parse_methods
    >>> from crowdbot.trials import load_trial
    >>> trial = load_trial("frontal", duration=3.0)
    >>> result = evaluate(EvaluationPlan([trial], parse_methods("orca, straight"), seeds=range(3)))
    >>> [str(cell.estimate("collision-rate")) for cell in result.cells]
    ['0 [0, 0.708]', '0 [0, 0.708]']
    """
    jobs = [
        RunJob(
            k,
            cell.xml,
            cell.variant.folder,
            tuple(map(int, plan.seeds[begin : begin + CHUNK])),
            plan.trust,
            plan.families,
        )
        for k, cell in enumerate(plan.cells)
        for begin in range(0, len(plan.seeds), CHUNK)
    ]
    keys = [] if folder is None else [_key(job) for job in jobs]
    files = [] if folder is None else [folder / f"{key}.json" for key in keys]
    rows: dict[int, list[RunRow]] = {}
    for number, found in run_saved_jobs(run_job, jobs, files, write_rows, read_rows, workers, cluster):
        rows[number] = found
        if progress is not None:
            progress(len(rows) / len(jobs))
    cells = tuple(
        CellResult(
            cell.trial,
            cell.method,
            cell.robot,
            cell.hash,
            cell.protocol,
            tuple(row for number, job in enumerate(jobs) if job.cell == k for row in rows[number]),
            cell.factors,
            cell.base,
        )
        for k, cell in enumerate(plan.cells)
    )
    return EvaluationResult(cells, provenance())


def _key(job: RunJob) -> str:
    """Return a name for the result of a job, which changes with everything that the result depends on."""
    own = [metric_source(name) for name in job.families if is_own_metric(name)]
    return code_digest(job.xml, job.folder, str(job.seeds), str(job.families), *own)

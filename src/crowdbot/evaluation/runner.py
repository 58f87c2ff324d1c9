"""Evaluate navigators: run a plan over processes or a cluster, and resume what has been done."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from crowdbot.core import InputError, each
from crowdbot.recording import files_digest
from crowdbot.trials import Trial, code_digest, needs_trust

from .job import RunJob, RunRow, append_rows, read_rows, run_job
from .own_metric import is_own_metric, metric_source
from .plan import EvaluationCell, EvaluationPlan
from .realism import trial_realism
from .result import CellResult, EvaluationResult, provenance

BATCH, PARALLEL_BATCH = 32, 4
"""Largest number of seeds that run together, in one process and in each of several; a killed evaluation loses these."""
PART_SECONDS = 4.0
"""Time that a batch may last [s], since a kill loses it."""


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
        folder: folder of finished runs, from which an interrupted evaluation continues, also with more seeds; runs of
            other versions of the program, the trial or the navigator are not used.
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
    if workers < 1:
        raise InputError(f"workers = {workers} must be at least 1")
    seeds = [int(seed) for seed in plan.seeds]
    jobs = [
        RunJob(k, cell.xml, cell.variant.folder, (), plan.trust or _is_allowed(plan, cell), plan.families)
        for k, cell in enumerate(plan.cells)
    ]
    files = [] if folder is None else [folder / f"{_key(job, plan.cells[job.cell].variant)}.jsonl" for job in jobs]
    rows: list[dict[int, RunRow]] = [{row.seed: row for row in read_rows(file)} for file in files] or [{} for _ in jobs]
    left = [replace(job, seeds=tuple(seed for seed in seeds if seed not in rows[job.cell])) for job in jobs]
    done = sum(seed in own for own in rows for seed in seeds)
    runs = _one_by_one(left) if workers == 1 and cluster is None else _in_parallel(left, workers, cluster)
    for k, new in runs:
        rows[k] |= {row.seed: row for row in new}
        if files:
            append_rows(new, files[k])
        done += len(new)
        if progress is not None:
            progress(done / (len(seeds) * len(jobs)))
    if progress is not None:
        progress(1.0)
    cells = tuple(
        CellResult(
            cell.trial,
            cell.method,
            cell.robot,
            cell.hash,
            cell.protocol,
            tuple(rows[k][seed] for seed in seeds),
            cell.factors,
            cell.base,
            cell.remarks,
            trial_realism(cell.variant),
        )
        for k, cell in enumerate(plan.cells)
    )
    return EvaluationResult(cells, provenance())


def _is_allowed(plan: EvaluationPlan, cell: EvaluationCell) -> bool:
    """Return whether a cell has code from the folder of the plan that is outside the folder of its trial."""
    return plan.folder is not None and needs_trust(cell.variant)


def _one_by_one(jobs: Sequence[RunJob]) -> Iterator[tuple[int, list[RunRow]]]:
    """Run the seeds of each cell in batches of about :data:`PART_SECONDS`; the first seed alone measures the time."""
    for job in jobs:
        left, size = job.seeds, 1
        while left:
            batch, left = left[:size], left[size:]
            begin = time.perf_counter()
            rows = run_job(replace(job, seeds=batch))
            fits = PART_SECONDS * len(batch) / max(1e-9, time.perf_counter() - begin)
            size = max(1, int(min(BATCH, 4 * size, fits)))
            yield job.cell, rows


def _in_parallel(jobs: Sequence[RunJob], workers: int, cluster: str | None) -> Iterator[tuple[int, list[RunRow]]]:
    """Run the seeds of all cells in small batches on several processes."""
    parts = [
        replace(job, seeds=job.seeds[begin : begin + PARALLEL_BATCH])
        for job in jobs
        for begin in range(0, len(job.seeds), PARALLEL_BATCH)
    ]
    for number, rows in each(run_job, parts, workers, cluster):
        yield parts[number].cell, rows


def _key(job: RunJob, trial: Trial) -> str:
    """Return a name for the rows of a cell, which changes with everything that they depend on."""
    own = [metric_source(name) for name in job.families if is_own_metric(name)]
    return code_digest(job.xml, job.folder, files_digest(trial), str(job.families), *own)

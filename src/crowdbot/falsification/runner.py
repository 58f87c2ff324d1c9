"""SampleRunner: runs points of a search space over processes, and keeps all samples."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import run_saved_jobs
from crowdbot.trials import code_digest, trial_xml

from .failure import FailureCriterion
from .sample import Sample, SampleJob, read_samples, run_samples, write_samples
from .search_space import SearchSpace

CHUNK = 64
"""Points that run together; a killed search loses at most these for each process."""
MOST_SEEDS = 2**31
"""Seeds of the runs are drawn from 0 to this number."""


class SampleRunner:
    """Runs points and keeps their samples in the order of the requests.

    A search is a deterministic function of its seed and of the samples. A search that continues asks for the same
    points again, and gets the samples that are in its folder.

    Args:
        space: what is varied.
        failure: when a run fails.
        budget: number of runs.
        folder: folder of samples, or None.
        workers, cluster: as in :func:`crowdbot.core.each`.
        progress: called with the share of the budget that is spent.
    """

    def __init__(
        self,
        space: SearchSpace,
        failure: FailureCriterion,
        budget: int,
        folder: Path | None = None,
        workers: int = 1,
        cluster: str | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> None:
        self.space, self.failure, self.budget = space, failure, budget
        self.samples: list[Sample] = []
        self._folder, self._workers, self._cluster = folder, workers, cluster
        self._progress = progress
        self._xml = trial_xml(space.trial)
        self._code = code_digest(self._xml, space.trial.folder)

    @property
    def remaining(self) -> int:
        """Remaining runs."""
        return self.budget - len(self.samples)

    @property
    def dimensions(self) -> int:
        """Number of factors D."""
        return len(self.space.factors)

    def run(self, points: NDArray[np.float64], seeds: NDArray[np.int64]) -> list[Sample]:
        """Return the samples of points ``[N, D]`` with seeds ``[N]``; those beyond the budget are left out."""
        count = min(len(points), self.remaining)
        jobs = [
            self._job(points[k : min(k + CHUNK, count)], seeds[k : min(k + CHUNK, count)])
            for k in range(0, count, CHUNK)
        ]
        files = [] if self._folder is None else [self._folder / f"{self._key(job)}.json" for job in jobs]
        found: dict[int, list[Sample]] = {}
        for number, rows in run_saved_jobs(
            run_samples, jobs, files, write_samples, read_samples, self._workers, self._cluster
        ):
            found[number] = rows
            if self._progress is not None:
                done = len(self.samples) + sum(map(len, found.values()))
                self._progress(done / self.budget)
        new = [sample for number in range(len(jobs)) for sample in found[number]]
        self.samples += new
        return new

    def _job(self, points: NDArray[np.float64], seeds: NDArray[np.int64]) -> SampleJob:
        trial = self.space.trial
        return SampleJob(
            self._xml,
            trial.folder or Path.cwd(),  # jobs with the same text in another working folder are others
            self.space.trust,
            self.space.factors,
            self.failure.text,
            tuple(map(tuple, points.tolist())),
            tuple(map(int, seeds)),
        )

    def _key(self, job: SampleJob) -> str:
        """Return a name for the samples of a job, which changes with everything that they depend on."""
        found = hashlib.blake2b(digest_size=12)
        for part in (self._code, repr(job.factors), job.failure, repr(job.points), repr(job.seeds)):
            found.update(part.encode() + b"\0")
        return found.hexdigest()

"""Samples: the points of a search that were run, and their runner."""

from __future__ import annotations

import functools
import hashlib
import json
import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CrowdbotError, InputError, MissingExtra, run_saved_jobs
from crowdbot.recording import files_digest
from crowdbot.simulation import Episode, RunFailureWarning, simulate_variants
from crowdbot.trials import Trial, code_digest, parse_trial, trial_xml

from .failure import FailureCriterion, collision_urgency, describe_event, parse_failure
from .search_space import Factor, SearchSpace


@dataclass(frozen=True)
class SampleJob:
    """Some points of a search space with their seeds.

    Fields:
        xml: text of the trial.
        folder: folder of the trial, or None.
        trust: whether code from outside the folder may be loaded.
        factors: what is varied.
        failure: text of the criterion.
        points: points of D numbers.
        seeds: seed of each point.
    """

    xml: str
    folder: Path | None
    trust: bool
    factors: tuple[Factor, ...]
    failure: str
    points: tuple[tuple[float, ...], ...]
    seeds: tuple[int, ...]


@dataclass(frozen=True)
class Sample:
    """A run of a search.

    Fields:
        point: standard normal coordinates of the factors.
        seed: seed of the run.
        outcome: outcome of the episode; ``invalid`` if the variant is impossible.
        robustness: at most 0 for a failure; infinite for an invalid run.
        digest: digest of the episode; empty for an invalid run.
        event: what happens in a failure, in words.
        message: why the run is invalid, or what ended it with an error.
    """

    point: tuple[float, ...]
    seed: int
    outcome: str
    robustness: float
    digest: str = ""
    event: str = ""
    message: str = ""

    @property
    def fails(self) -> bool:
        """Whether the run is a failure."""
        return self.robustness <= 0.0

    @property
    def valid(self) -> bool:
        """Whether the variant is possible."""
        return self.outcome != "invalid"

    @property
    def log_density(self) -> float:
        """Logarithm of the density of the point, without the constant: 0 for the most likely one."""
        return -0.5 * sum(z * z for z in self.point)


def run_samples(job: SampleJob) -> list[Sample]:
    """Run the points of a job and return a sample for each.

    Raises:
        KeyboardInterrupt: Ctrl-C has ended the runs.
        InputError: the runs do not have the metric of the criterion.
    """
    space = _space(job.xml, job.folder, job.trust, job.factors)
    trials: list[Trial | str] = [_variant(space, point) for point in job.points]
    rows: list[Episode | str] = ["" if isinstance(trial, Trial) else trial for trial in trials]
    there = [k for k, trial in enumerate(trials) if isinstance(trial, Trial)]
    for group in _groups([trials[k] for k in there]):
        index = [there[k] for k in group]
        for k, row in zip(index, _run([trials[k] for k in index], [job.seeds[k] for k in index]), strict=True):
            rows[k] = row
    if any(isinstance(row, Episode) and row.outcome == "interrupted" for row in rows):
        raise KeyboardInterrupt
    duration = space.trial.duration
    return [_sample(job, k, row, duration) for k, row in enumerate(rows)]


@functools.lru_cache(maxsize=4)
def _space(xml: str, folder: Path | None, trust: bool, factors: tuple[Factor, ...]) -> SearchSpace:
    return SearchSpace(parse_trial(xml, folder=folder, trust=trust), factors, trust)


def _variant(space: SearchSpace, point: tuple[float, ...]) -> Trial | str:
    """Return a variant, or why it is impossible."""
    try:
        return space.variant_of(point)
    except MissingExtra:
        raise
    except CrowdbotError as error:
        return _sentence(error)


def _groups(trials: Sequence[Any]) -> list[list[int]]:
    """Return the indices of variants that can run in one simulation, as far as a cheap look tells."""
    found: dict[Any, list[int]] = {}
    for k, trial in enumerate(trials):
        shape = tuple(spawner.count for spawner in trial.spawners)
        key = (shape, len(trial.agents), trial.duration, trial.step, trial.world, type(trial.crowd).__name__)
        found.setdefault(key, []).append(k)
    return list(found.values())


def _run(trials: Sequence[Any], seeds: Sequence[int]) -> list[Episode | str]:
    """Run variants in one simulation, or alone if they cannot share one or one of them is impossible."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RunFailureWarning)
        try:
            return list(simulate_variants(trials, seeds))
        except MissingExtra:
            raise
        except CrowdbotError as error:
            if len(trials) == 1:
                return [_sentence(error)]
        return [row for trial, seed in zip(trials, seeds, strict=True) for row in _run([trial], [seed])]


def _sentence(error: Exception) -> str:
    return " ".join(str(error).split())


def _sample(job: SampleJob, k: int, row: Episode | str, duration: float) -> Sample:
    point, seed = job.points[k], job.seeds[k]
    if isinstance(row, str):
        return Sample(point, seed, "invalid", math.inf, message=row)
    time, urgency = row.trial.duration or duration, collision_urgency(row)
    robustness = parse_failure(job.failure).robustness(row.outcome, row.metrics, time, urgency)
    event = describe_event(row) if robustness <= 0.0 else ""
    message = "" if row.failure is None else str(row.failure)
    return Sample(point, seed, row.outcome, float(robustness), row.digest, event, message)


def write_samples(samples: Sequence[Sample], path: Path) -> None:
    """Write samples as JSON; an infinite robustness is null."""
    rows = [
        asdict(sample) | {"robustness": sample.robustness if math.isfinite(sample.robustness) else None}
        for sample in samples
    ]
    path.write_text(json.dumps(rows, allow_nan=False), encoding="utf-8")


def read_samples(path: Path) -> list[Sample]:
    """Read samples from JSON.

    Raises:
        InputError: a value is missing.
    """
    rows = json.loads(path.read_text(encoding="utf-8"))
    try:
        return [sample_of(row) for row in rows]
    except (KeyError, TypeError) as error:
        raise InputError(f"{path} has no samples: {error}") from None


def sample_of(row: dict[str, Any]) -> Sample:
    """Return a sample from JSON values."""
    robustness = math.inf if row["robustness"] is None else float(row["robustness"])
    return Sample(**(row | {"point": tuple(map(float, row["point"])), "robustness": robustness}))


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
        self._code = code_digest(self._xml, space.trial.folder, files_digest(space.trial))

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

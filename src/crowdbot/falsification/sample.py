"""Samples of a search: runs of variants in parallel, saved and resumed."""

from __future__ import annotations

import functools
import json
import math
import warnings
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from crowdbot.core import CrowdbotError, InputError, MissingExtra
from crowdbot.simulation import Episode, RunFailureWarning, simulate_variants
from crowdbot.trials import Trial, parse_trial

from .event import describe_event
from .factor import Factor
from .failure import parse_failure
from .search_space import SearchSpace
from .urgency import collision_urgency


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
    rows = [asdict(one) | {"robustness": one.robustness if math.isfinite(one.robustness) else None} for one in samples]
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

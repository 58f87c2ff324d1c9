"""Result of a search for failures, its clusters of similar failures, and failures as trial files."""

from __future__ import annotations

import dataclasses
import importlib
import json
import math
import platform
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import explain_write_errors, source_digest
from crowdbot.evaluation import Estimate
from crowdbot.recording import write_trial_files
from crowdbot.simulation import RunFailureWarning, simulate
from crowdbot.trials import load_trial
from crowdbot.typing import Floats

from .sample import Sample
from .search_space import Factor, SearchSpace

MOST = 2000
"""Failures of one event that are compared with each other; others join the nearest cluster."""
CUT = 1.1
"""Distance of two clusters, relative to that of two random points."""


@dataclass(frozen=True)
class FailureCluster:
    """Failures with the same event and similar factors.

    Fields:
        event: what happens.
        members: indices of the failures among the samples.
        share: share of the failure probability, or of the failures found if no probability is estimated.
        likely: index of the failure with the most likely values.
        worst: index of the failure with the smallest robustness.
        shifts: ``[D]`` mean coordinate of each factor; 0 for a factor that has no influence.
    """

    event: str
    members: tuple[int, ...]
    share: float
    likely: int
    worst: int
    shifts: tuple[float, ...]


def find_clusters(samples: Sequence[Sample], weights: Floats) -> list[FailureCluster]:
    """Return the clusters of the failures, by their share of the probability.

    Failures with one event are divided by average linkage at 1.1 times the distance that two random points have.

    Args:
        samples: all samples of a search.
        weights: ``[N]`` weight of each sample; if no failure has one, all count the same.
    """
    failed = [k for k, sample in enumerate(samples) if sample.fails]
    total = float(sum(weights[k] for k in failed))
    mass = np.array(weights) / total if total > 0.0 else np.full(len(samples), 1.0 / max(1, len(failed)))
    found = []
    for event in dict.fromkeys(samples[k].event for k in failed):
        own = [k for k in failed if samples[k].event == event]
        labels = _labels(np.array([samples[k].point for k in own]).reshape(len(own), -1))
        for label in dict.fromkeys(labels.tolist()):
            found.append(
                _cluster(samples, event, [k for k, item in zip(own, labels, strict=True) if item == label], mass)
            )
    return sorted(found, key=lambda one: (-one.share, samples[one.worst].robustness, one.members))


def _cluster(samples: Sequence[Sample], event: str, members: list[int], mass: Floats) -> FailureCluster:
    share = float(sum(mass[k] for k in members))
    part = mass[members] if share > 0.0 else np.ones(len(members))
    points = np.array([samples[k].point for k in members]).reshape(len(members), -1)
    return FailureCluster(
        event,
        tuple(members),
        share,
        max(members, key=lambda k: (samples[k].log_density, -k)),
        min(members, key=lambda k: (samples[k].robustness, k)),
        tuple((part @ points / part.sum()).tolist()),
    )


def _labels(points: Floats) -> NDArray[np.int64]:
    """Return ``[N]`` the cluster of each point."""
    count, dimensions = points.shape
    if count < 2 or not dimensions:
        return np.zeros(count, dtype=np.int64)
    chosen = np.unique(np.linspace(0, count - 1, min(count, MOST)).astype(np.int64))
    from scipy.cluster import hierarchy  # takes longer to import than the rest

    tree = hierarchy.linkage(points[chosen], "average")
    own = hierarchy.fcluster(tree, CUT * math.sqrt(2.0 * dimensions), "distance")
    if len(chosen) == count:
        return np.asarray(own, dtype=np.int64)
    centers = np.array([points[chosen][own == label].mean(axis=0) for label in range(1, own.max() + 1)])
    away = np.stack([np.sum((points - center) ** 2, axis=1) for center in centers])
    return np.asarray(np.argmin(away, axis=0) + 1, dtype=np.int64)


SCHEMA = "crowdbot-falsification/1"


@dataclass(frozen=True)
class FoundFailure:
    """A failure that is kept.

    Fields:
        sample: index of the run.
        cluster: number of its cluster, from 1.
        values: values of the factors by path.
        file: the trial in the folder of the search, such as ``found/1.xml``; empty without a folder.
        same: whether that trial gives the digest of the run; None without a folder.
    """

    sample: int
    cluster: int
    values: Mapping[str, float | int | str]
    file: str = ""
    same: bool | None = None


@dataclass(frozen=True)
class FalsificationResult:
    """The result of a search for failures.

    Fields:
        trial: name of the trial.
        method: name of the navigator.
        failure: the criterion as text.
        search: name of the search.
        seed: seed of the search.
        factors: what was varied, besides the seed.
        samples: all runs in their order.
        weights: ``[N]`` weight of each run; see :class:`crowdbot.falsification.SamplingResult`.
        levels: thresholds of the robustness that the search has passed.
        estimate: the failure probability with its 95 % interval, or None.
        clusters: clusters of failures, by their share of the probability.
        found: failures that are kept.
        robot: type of the robot, a built-in name or the name of its folder; empty for a robot without a type.
        remarks: what a reader must know about this robot in this trial, in sentences.
    """

    trial: str
    method: str
    failure: str
    search: str
    seed: int
    factors: tuple[Factor, ...]
    samples: tuple[Sample, ...]
    weights: NDArray[np.float64]
    levels: tuple[float, ...]
    estimate: Estimate | None
    clusters: tuple[FailureCluster, ...]
    found: tuple[FoundFailure, ...]
    robot: str = ""
    remarks: tuple[str, ...] = ()

    @property
    def title(self) -> str:
        """Trial, navigator and robot."""
        return f"{self.trial}, {self.method}{f' on {self.robot}' if self.robot else ''}"

    @property
    def failures(self) -> int:
        """Number of runs that fail."""
        return sum(sample.fails for sample in self.samples)

    @property
    def invalid(self) -> int:
        """Number of runs that are impossible, which count nowhere."""
        return sum(not sample.valid for sample in self.samples)

    @property
    def first_failure(self) -> int | None:
        """Number of the first run that fails, from 1; None if no run fails."""
        return next((k for k, sample in enumerate(self.samples, 1) if sample.fails), None)

    @property
    def errors(self) -> dict[str, int]:
        """Number of runs in which the navigator failed, by message."""
        result: dict[str, int] = {}
        for sample in self.samples:
            if sample.outcome == "error":
                result[sample.message] = result.get(sample.message, 0) + 1
        return result

    def ranges(self, members: Sequence[int]) -> dict[str, tuple[Any, ...]]:
        """Return the smallest and the largest value of each factor among some runs; of a choice, all its values."""
        result: dict[str, tuple[Any, ...]] = {}
        for d, factor in enumerate(self.factors):
            values = [factor.value_at(self.samples[k].point[d]) for k in members]
            if factor.kind == "choice":
                result[factor.path] = tuple(sorted(set(map(str, values))))
            else:
                result[factor.path] = (min(values), max(values))
        return result

    def table(self) -> dict[str, Any]:
        """Return the values of the result as JSON values, without the single runs."""
        return {
            "trial": self.trial,
            "navigator": self.method,
            "robot": self.robot,
            "remarks": list(self.remarks),
            "failure": self.failure,
            "search": self.search,
            "seed": self.seed,
            "factors": {factor.path: factor.text for factor in self.factors},
            "runs": len(self.samples),
            "failures": self.failures,
            "first_failure": self.first_failure,
            "invalid": self.invalid,
            "errors": self.errors,
            "estimate": None if self.estimate is None or not self.estimate.runs else self.estimate._asdict(),
            "levels": list(self.levels),
            "clusters": [
                {
                    "number": number,
                    "event": cluster.event,
                    "failures": len(cluster.members),
                    "share": cluster.share,
                    "worst": self.samples[cluster.worst].robustness,
                    "ranges": {path: list(values) for path, values in self.ranges(cluster.members).items()},
                }
                for number, cluster in enumerate(self.clusters, 1)
            ],
            "found": [
                {
                    "file": one.file,
                    "cluster": one.cluster,
                    "event": self.samples[one.sample].event,
                    "seed": self.samples[one.sample].seed,
                    "robustness": self.samples[one.sample].robustness,
                    "values": dict(one.values),
                    "digest": self.samples[one.sample].digest,
                    "same": one.same,
                }
                for one in self.found
            ],
        }

    def save(self, path: Path) -> None:
        """Write the result as JSON, with all runs and the provenance.

        Raises:
            InputError: the file cannot be written.
        """
        rows = [
            [
                list(sample.point),
                sample.seed,
                sample.outcome,
                sample.robustness if np.isfinite(sample.robustness) else None,
                weight,
            ]
            for sample, weight in zip(self.samples, self.weights.tolist(), strict=True)
        ]
        columns = ["point", "seed", "outcome", "robustness", "weight"]
        content = {"schema": SCHEMA, "provenance": _provenance(), **self.table(), "columns": columns, "samples": rows}
        draft = path.with_suffix(".part")
        with explain_write_errors(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            draft.write_text(json.dumps(content, indent=1, allow_nan=False), encoding="utf-8")
            draft.replace(path)


def _provenance() -> dict[str, str]:
    return {
        "crowdbot": str(importlib.import_module("crowdbot").__version__),
        "source": source_digest(),
        "python": platform.python_version(),
        "platform": platform.platform(),
    }


class FoundTrial(NamedTuple):
    """A failure in a file.

    Fields:
        path: the trial.
        sample: index of the run.
        same: whether the trial in the file gives the digest of the run.
    """

    path: Path
    sample: int
    same: bool


def select_failures(clusters: Sequence[FailureCluster], most: int) -> list[int]:
    """Return the failures to keep: the most likely one of each cluster, then the worst ones."""
    found = [cluster.likely for cluster in clusters] + [cluster.worst for cluster in clusters]
    return [*dict.fromkeys(found)][:most]


def write_failures(
    space: SearchSpace, samples: Sequence[Sample], chosen: Sequence[int], folder: Path
) -> list[FoundTrial]:
    """Write failures to ``1.xml``, ``2.xml`` and so on, with the files that they need, and run each once.

    Files of an earlier search in the folder are replaced.

    Args:
        space: the search space.
        samples: all samples.
        chosen: indices of the failures.
        folder: where to write.

    Raises:
        InputError: a file cannot be written.
    """
    found_trials = []
    with explain_write_errors(folder):
        folder.mkdir(parents=True, exist_ok=True)
        for old in folder.glob("*.xml"):
            if old.stem.isdecimal():
                old.unlink()
        for number, k in enumerate(chosen, 1):
            sample, path = samples[k], folder / f"{number}.xml"
            variant = space.variant_of(sample.point)
            name = f"{variant.name[:60]}, failure {number}"
            write_trial_files(dataclasses.replace(variant, seed=sample.seed, name=name), path)
            found_trials.append(FoundTrial(path, k, _digest(path) == sample.digest))
    return found_trials


def _digest(path: Path) -> str:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RunFailureWarning)
        return simulate(load_trial(str(path))).digest

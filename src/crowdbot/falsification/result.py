"""FalsificationResult: what a search has found, with a file."""

from __future__ import annotations

import importlib
import json
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import explain_write_errors, source_digest
from crowdbot.evaluation import Estimate

from .cluster import FailureCluster
from .factor import Factor
from .sample import Sample

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
        found: dict[str, int] = {}
        for sample in self.samples:
            if sample.outcome == "error":
                found[sample.message] = found.get(sample.message, 0) + 1
        return found

    def ranges(self, members: Sequence[int]) -> dict[str, tuple[Any, ...]]:
        """Return the smallest and the largest value of each factor among some runs; of a choice, all its values."""
        found: dict[str, tuple[Any, ...]] = {}
        for d, factor in enumerate(self.factors):
            values = [factor.value_at(self.samples[k].point[d]) for k in members]
            if factor.kind == "choice":
                found[factor.path] = tuple(sorted(set(map(str, values))))
            else:
                found[factor.path] = (min(values), max(values))
        return found

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
            [list(one.point), one.seed, one.outcome, one.robustness if np.isfinite(one.robustness) else None, weight]
            for one, weight in zip(self.samples, self.weights.tolist(), strict=True)
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

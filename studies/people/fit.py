"""Fit of a crowd model to recorded people and to published values of crowds, with experiments left out."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.calibration import CMAES
from crowdbot.core import InputError, stream
from crowdbot.models import CrowdModel
from crowdbot.typing import Floats

from .crowd_values import CrowdValues, measure_crowds
from .experiments import KINDS, RecordedExperiment
from .track_errors import keep_velocity, measure_tracks, ttc_distance

__all__ = ["BOX", "Candidate", "PopulationFit", "set_of"]


FOLLOW = "follow_gap"
"""Time gap less anticipation: the time gap of people who follow each other at the same speed [s]."""
BOX: dict[str, tuple[float, float]] = {
    FOLLOW: (0.6, 1.15),
    "headway_anticipation": (0.1, 1.4),
    "headway_spacing": (0.0, 0.12),
    "headway_width": (0.4, 0.9),
    "headway_taper": (0.3, 1.0),
    "headway_oncoming": (0.0, 1.0),
    "strength": (1.0, 12.0),
    "range": (0.02, 0.12),
    "wall_strength": (0.5, 8.0),
    "wall_range": (0.01, 0.08),
}
"""Searched values and their bounds."""
WEIGHTS = (0.5, 0.5, 0.1, 0.05)
"""Weights of the errors after 0.4 s and over 4.8 s (relative to constant velocity), of the distance of the times to
collision, and of the penalty of crowds."""
POPULATION = 12


@dataclass(frozen=True)
class Candidate:
    """A parameter set and its errors.

    Fields:
        values: searched values, see :data:`BOX`.
        tracks: by experiment: errors after 0.4 s and over all rows relative to constant velocity, and distance of the
            times to collision.
        crowd: values of whole crowds.
    """

    values: dict[str, float]
    tracks: dict[str, tuple[float, float, float]]
    crowd: CrowdValues

    def objectives(self, experiments: Sequence[RecordedExperiment]) -> tuple[float, float, float, float]:
        """Return the means over kinds of experiments of the three errors of tracks, and the penalty of crowds."""
        kinds = [[self.tracks[e.name] for e in experiments if e.kind == kind] for kind in KINDS]
        means = np.mean([np.mean(kind, axis=0) for kind in kinds if kind], axis=0)
        return float(means[0]), float(means[1]), float(means[2]), self.crowd.penalty

    def cost(self, experiments: Sequence[RecordedExperiment]) -> float:
        """Return the weighted sum of the objectives."""
        return float(np.dot(WEIGHTS, self.objectives(experiments)))


def set_of(values: Mapping[str, float]) -> dict[str, float]:
    """Return parameters of the model: the time gap is the sum of the follow gap and the anticipation.

    >>> set_of({"follow_gap": 0.75, "headway_anticipation": 0.5})
    {'headway_anticipation': 0.5, 'headway_time_gap': 1.25}
    """
    found = {name: value for name, value in values.items() if name != FOLLOW}
    return {**found, "headway_time_gap": values[FOLLOW] + values["headway_anticipation"]}


class PopulationFit:
    """Searches with stored candidates: a run with the same settings continues where the last one ended.

    Args:
        model: crowd model; its other parameters are fixed.
        experiments: recorded experiments.
        state: file of candidates (JSON lines).
        report: called with the name of the search, the candidate and its cost.
    """

    def __init__(
        self,
        model: CrowdModel,
        experiments: Sequence[RecordedExperiment],
        state: Path,
        report: Callable[[str, Candidate, float], None] | None = None,
    ) -> None:
        self.model, self.experiments, self.state = model, tuple(experiments), state
        self.report = report
        self.constant = {e.name: keep_velocity(e) for e in self.experiments}
        self.found: dict[str, Candidate] = {}
        if state.exists():
            for line in state.read_text(encoding="utf-8").splitlines():
                candidate = _candidate(json.loads(line))
                self.found[_key(candidate.values)] = candidate

    def search(self, name: str, starts: Sequence[Mapping[str, float]], budget: int, width: float) -> Candidate:
        """Return the best candidate of a search by CMA-ES.

        Args:
            name: name of the search; the random numbers depend on it.
            starts: values that are evaluated first.
            budget: number of candidates.
            width: initial standard deviation, relative to the box.
        """
        if budget < len(starts) + 1:
            raise InputError(f"a search from {len(starts)} starts needs a budget above it, not {budget}")

        def cost(candidates: Floats, which: Any) -> Floats:
            rows = self.evaluate(name, [dict(zip(BOX, map(float, item), strict=True)) for item in candidates[:, 0, 0]])
            costs = np.array([row.cost(self.experiments) for row in rows])
            if self.report is not None:
                best = int(np.argmin(costs))
                self.report(name, rows[best], float(costs[best]))
            return costs[:, None, None]

        low, high = (np.array([ends[k] for ends in BOX.values()]) for k in range(2))
        begin = np.array([[start[key] for key in BOX] for start in starts])[:, None, None]
        search = CMAES(population=POPULATION, width=width, tolerance=-np.inf)
        search.minimize(cost, low, high, [stream(0, "population", name)], budget, begin)
        return self.best()

    def best(self, left_out: int | None = None) -> Candidate:
        """Return the best stored candidate for the experiments outside a fold."""
        used = [e for e in self.experiments if e.fold != left_out]
        return min(self.candidates(), key=lambda candidate: candidate.cost(used))

    def candidates(self) -> list[Candidate]:
        """Return the stored candidates of all searches."""
        return list(self.found.values())

    def evaluate(self, search: str, rows: Sequence[dict[str, float]]) -> list[Candidate]:
        """Return the candidates of some values; new ones are measured together and stored."""
        new = [row for row in rows if _key(row) not in self.found]
        for candidate in self.measure(new) if new else ():
            self._write(search, candidate)
        return [self.found[_key(row)] for row in rows]

    def measure(self, rows: Sequence[dict[str, float]]) -> list[Candidate]:
        """Return the errors of some values."""
        sets = [set_of(row) for row in rows]
        tracks: list[dict[str, tuple[float, float, float]]] = [{} for _ in rows]
        for experiment in self.experiments:
            errors = measure_tracks(self.model, sets, experiment)
            early, mean = self.constant[experiment.name]
            distance = ttc_distance(errors.ttc, errors.ttc_real)
            for k, row in enumerate(tracks):
                row[experiment.name] = (
                    float(errors.early[k].mean() / early),
                    float(errors.mean[k].mean() / mean),
                    float(distance[k]),
                )
        crowds = measure_crowds(self.model, sets)
        return [Candidate(*item) for item in zip(rows, tracks, crowds, strict=True)]

    def _write(self, search: str, candidate: Candidate) -> None:
        row = {"search": search, "values": candidate.values, "tracks": candidate.tracks, "crowd": candidate.crowd}
        with self.state.open("a", encoding="utf-8") as out:
            out.write(json.dumps(row) + "\n")
        self.found[_key(candidate.values)] = candidate


def _key(values: Mapping[str, float]) -> str:
    return " ".join(f"{values[name]:.9g}" for name in BOX)


def _candidate(row: dict[str, Any]) -> Candidate:
    names = dict(zip(CrowdValues._fields, row["crowd"], strict=True))
    crowd = CrowdValues(**{**names, "queues": tuple(names["queues"])})
    return Candidate(row["values"], {name: tuple(item) for name, item in row["tracks"].items()}, crowd)

"""Forecasts of recorded people by all crowd models at their defaults, compared with one of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import stream
from crowdbot.models import CrowdModel

from .experiments import KINDS, RecordedExperiment
from .track_errors import keep_velocity, measure_tracks, ttc_distance

__all__ = ["CONSTANT", "PredictionTable", "compare_predictions"]

Floats = NDArray[np.float64]

CONSTANT = "constant velocity"
RESAMPLES = 2000
SMALLEST = 1e-6
"""Smallest error that others are compared with [m]."""


@dataclass(frozen=True, eq=False)
class PredictionTable:
    """Errors of forecasts of models M in experiments E.

    Fields:
        names: names of the models; the last is :data:`CONSTANT`.
        experiments: the experiments.
        errors: ``[M, E, 3]`` errors after 0.4 s [m] and over all rows [m], and distance of the times to collision; NaN
            for those of constant velocity.
        people: number of forecasts of each experiment.
    """

    names: tuple[str, ...]
    experiments: tuple[RecordedExperiment, ...]
    errors: Floats
    people: tuple[int, ...]

    def by_kind(self) -> Floats:
        """Return the means over the experiments of each kind, ``[M, K, 3]``."""
        kinds = [[k for k, e in enumerate(self.experiments) if e.kind == kind] for kind in KINDS]
        return np.stack([self.errors[:, own].mean(axis=1) for own in kinds if own], axis=1)

    def relative(self, name: str, column: int) -> Floats:
        """Return the errors of a model less those of the others, relative to the others, with 95 % intervals.

        The interval is the bootstrap over experiments within their kinds; kinds have the same weight.

        Args:
            name: the model.
            column: 0 for the error after 0.4 s, 1 for that over all rows.

        Returns:
            ``[M, 3]`` mean, low, high; negative values mean that the model is better.
        """
        own = self.errors[self.names.index(name), :, column]
        share = own / np.maximum(self.errors[:, :, column], SMALLEST) - 1.0
        rng = stream(0, "predictions", "bootstrap")
        mean, drawn = np.zeros(len(self.names)), np.zeros((len(self.names), RESAMPLES))
        kinds = [[k for k, e in enumerate(self.experiments) if e.kind == kind] for kind in KINDS]
        kinds = [one for one in kinds if one]
        for part in kinds:
            mean += share[:, part].mean(axis=1) / len(kinds)
            numbers = rng.integers(0, len(part), (RESAMPLES, len(part)))
            drawn += share[:, part][:, numbers].mean(axis=2) / len(kinds)
        return np.column_stack([mean, *np.percentile(drawn, (2.5, 97.5), axis=1)])

    def markdown(self, name: str) -> str:
        """Return two tables: errors by kind of experiment, and a model against each of the others."""
        present = [kind for kind in KINDS if any(e.kind == kind for e in self.experiments)]
        means = self.by_kind()
        lines = [f"| model | {' | '.join(present)} |", f"|---{'|---' * len(present)}|"]
        for m, model in enumerate(self.names):
            cells = [f"{early:.3f}, {mean:.3f}" for early, mean, _ in means[m]]
            lines.append(f"| {model} | {' | '.join(cells)} |")
        lines += ["", f"| against | after 0.4 s | over 4.8 s | experiments of {len(self.experiments)} with a smaller"
                  " error over 4.8 s |", "|---|---|---|---|"]  # fmt: skip
        early, whole = self.relative(name, 0), self.relative(name, 1)
        own = self.errors[self.names.index(name), :, 1]
        for m, model in enumerate(self.names):
            if model != name:
                better = int(np.sum(own < self.errors[m, :, 1]))
                lines.append(f"| {model} | {_percent(early[m])} | {_percent(whole[m])} | {better} |")
        return "\n".join(lines)


def compare_predictions(
    models: Mapping[str, CrowdModel],
    experiments: Sequence[RecordedExperiment],
    report: Callable[[str], None] = lambda name: None,
) -> PredictionTable:
    """Return the errors of forecasts of models, from the same starts and with the same goals.

    Args:
        models: models by name.
        experiments: recorded experiments.
        report: called with the name of each model before it runs.
    """
    errors = np.full((len(models) + 1, len(experiments), 3), np.nan)
    people = []
    for k, model in enumerate(models.values()):
        report(list(models)[k])
        for e, experiment in enumerate(experiments):
            found = measure_tracks(model, [{}], experiment)
            distance = ttc_distance(found.ttc, found.ttc_real)[0]
            errors[k, e] = found.early.mean(), found.mean.mean(), distance
            if k == 0:
                people.append(found.early.shape[1])
    for e, experiment in enumerate(experiments):
        errors[-1, e, :2] = keep_velocity(experiment)
    return PredictionTable((*models, CONSTANT), tuple(experiments), errors, tuple(people))


def _percent(row: Floats) -> str:
    return f"{100.0 * row[0]:+.1f} % ({100.0 * row[1]:+.1f} to {100.0 * row[2]:+.1f})"

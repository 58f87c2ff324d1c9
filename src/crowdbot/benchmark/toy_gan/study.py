"""GanComparison: methods against mode collapse on the toy data, with several seeds."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, each, stream
from crowdbot.prediction import SocialWaysConfig, TrainingSchedule, torch_threads, train

from .methods import METHODS
from .toy_data import ToyData

__all__ = ["MEASURES", "GanComparison", "GanRun", "with_settings"]

MEASURES = ("nearest_neighbor", "emd", "modes", "coverage", "whole", "nearest_neighbor_20", "emd_20")
"""Metrics, see :func:`~crowdbot.benchmark.toy_gan.training.compare_distributions`."""
SHOWN = 128
"""Number of paths of each group stored for plots."""


@dataclass(frozen=True)
class GanRun:
    """One method with one seed.

    Fields:
        method, seed: the method and its seed.
        update: updates of the measurements ``[C]``.
        measures: name -> ``[C]``, see ``MEASURES``.
        drawn: ``[groups, draws, T, 2]`` [m] futures sampled with the final weights.
    """

    method: str
    seed: int
    update: NDArray[np.int64]
    measures: Mapping[str, NDArray[np.float64]]
    drawn: NDArray[np.float64]


@dataclass(frozen=True)
class GanComparison:
    """Settings of a comparison of methods on the toy data.

    Fields:
        methods: names of methods, see ``METHODS``.
        seeds: seeds of weights, order, noise and data; each method is trained with each seed.
        updates: updates per training.
        check_every: updates between measurements.
        toy: the toy data.
        values: settings of all methods, such as learning rates or network size.
        device: ``cpu`` or ``cuda``.

    Raises:
        InputError: there is no method or seed.
    """

    methods: tuple[str, ...] = tuple(METHODS)
    seeds: tuple[int, ...] = (0, 1, 2)
    updates: int = 20_000
    check_every: int = 500
    toy: ToyData = field(default_factory=ToyData)
    values: Mapping[str, Any] = field(default_factory=dict)
    device: str = "cpu"

    def __post_init__(self) -> None:
        if not self.methods or not self.seeds:
            raise InputError("a GAN study needs at least one method and one seed")

    def run(self, folder: Path | None = None, workers: int = 1) -> Iterator[GanRun]:
        """Yield the runs seed by seed; runs stored in the folder are not repeated."""
        jobs = [
            (self, method, seed, None if folder is None else folder / f"{method}-{seed}")
            for seed in self.seeds
            for method in self.methods
        ]
        for _, run in each(_train_run, jobs, workers):
            yield run

    def real_futures(self) -> NDArray[np.float64]:
        """Return real futures ``[groups, draws, T, 2]`` [m], for pictures."""
        return self._real(0)[:, :SHOWN]

    def ideal(self, repeats: int = 20) -> dict[str, float]:
        """Return the metrics of new real paths against real paths, the best possible values except for chance."""
        from .training import compare_distributions

        found = [compare_distributions(self.toy, self._real(2 * n), self._real(2 * n + 1)) for n in range(repeats)]
        return {name: float(np.mean([one[name] for one in found])) for name in MEASURES}

    def _real(self, number: int) -> NDArray[np.float64]:
        from .training import real_paths

        return real_paths(self.toy, stream(number, "ideal"))

    @staticmethod
    def rows(runs: Sequence[GanRun]) -> list[dict[str, Any]]:
        """Return one row per method: means over the last quarter of the measurements of each seed, and their sd."""
        found = []
        for method in dict.fromkeys(run.method for run in runs):
            own = [run for run in runs if run.method == method]
            row: dict[str, Any] = {"method": method, "seeds": len(own), "updates": int(own[0].update[-1])}
            last = max(1, len(own[0].update) // 4)
            for name in MEASURES:
                ends = [float(run.measures[name][-last:].mean()) for run in own]
                row[name], row[f"{name}_sd"] = float(np.mean(ends)), float(np.std(ends))
            found.append(row)
        return found


def _train_run(job: tuple[GanComparison, str, int, Path | None]) -> GanRun:
    """Train one method with one seed, or resume its training."""

    from .training import ToyTraining, gan_config, sample_futures

    study, method, seed, folder = job
    with torch_threads(1):
        model = ToyTraining(study.toy, gan_config(method, study.toy, study.values), seed, study.device)
        schedule = TrainingSchedule(study.updates, None, study.check_every, study.check_every, ("emd",), None, seed)
        done = train(model, schedule, folder, resume=True)
        drawn = sample_futures(model, SHOWN, stream(seed, "shown"))
    update = np.array([row["update"] for row in done.rows], dtype=np.int64)
    return GanRun(method, seed, update, {n: np.array([row[n] for row in done.rows]) for n in MEASURES}, drawn)


def with_settings(study: GanComparison, values: Mapping[str, str]) -> GanComparison:
    """Return the study with settings for all methods, given as text."""
    from crowdbot.core import from_attributes

    read = from_attributes(SocialWaysConfig, dict(values))
    names = [name.replace("-", "_") for name in values]
    return dataclasses.replace(study, values={name: getattr(read, name) for name in names})

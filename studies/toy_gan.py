"""Compare GANs on the toy data of report D4.2, with respect to mode collapse: ``python studies/toy_gan.py --out DIR``.

Trains Social Ways without neighbors by each method and with each seed, or resumes the trainings of the folder, and
writes ``study.json``, ``samples.png`` (figure 17 of the report) and ``measures.png`` (figure 18) there.
"""

from __future__ import annotations

import argparse
import dataclasses
import math
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from crowdbot.cli.output import json_text, number, print_table, progress
from crowdbot.cli.settings import parse_settings
from crowdbot.core import CrowdbotError, InputError, UnknownName, each, explain_write_errors, from_attributes, stream
from crowdbot.metrics import earth_mover_distance, mode_count, mode_coverage, nearest_neighbor_accuracy
from crowdbot.prediction import (
    PRESETS,
    STEADY,
    Samples,
    SocialWaysConfig,
    SocialWaysTraining,
    TrainingSchedule,
    torch_device,
    torch_threads,
    train,
)
from crowdbot.typing import Floats

METHODS: dict[str, dict[str, Any]] = {
    "vanilla": {},
    "l2": {"use_l2_loss": True},
    "s-gan-v20": {"use_variety_loss": True, "variety_draws": 20},
    "unrolled10": {"unrolling_steps": 10},
    "info": {"use_info_loss": True},
    "info+unrolled5": {"use_info_loss": True, "unrolling_steps": 5},
    "unrolled10+l2": {"unrolling_steps": 10, "use_l2_loss": True},
    "info+rates-of-code": {
        "use_info_loss": True, "generator_rate": 1e-4, "discriminator_rate": 1e-3, "adversarial": "least-squares"
    },
    "vanilla+slope-penalty": STEADY,
    "info+slope-penalty": {"use_info_loss": True, **STEADY},
    "info+discrete-codes": {"use_info_loss": True, **STEADY, "code_levels": 3, "noise": 4},
    "info+discrete-code+variety": {
        "use_info_loss": True, **PRESETS["modes"], "variety_draws": 20, "variety_growth": 100.0
    },
}  # fmt: skip
"""Settings of each method that differ from a plain GAN with the settings of the report.

The first seven are in figures 17 and 18 of the report; ``info+rates-of-code`` has the settings of its published code;
the others are new.
"""


@dataclass(frozen=True)
class ToyData:
    """Toy data: people walk towards the center, then continue straight or turn to one side.

    The rows of a track lie on circles of decreasing radius. The observed rows are the same for all tracks of a group;
    later rows are rotated about the center by the angle of the mode and a uniform jitter.

    Fields:
        groups: number of start places, evenly spaced on the circle.
        modes: rotation of the later rows [rad], one for each mode.
        radii: radius of each row [m].
        observe: number of observed rows.
        jitter: half width of the uniform jitter of each later row [rad].
        tracks: number of tracks for each mode of each group.

    Report: CROWDBOT D4.2, figure 14; the values are those of its published code, 768 tracks rounded to even modes.

    Raises:
        InputError: a value is not allowed.

    >>> ToyData().paths(np.random.default_rng(0), 5).shape
    (6, 3, 5, 4, 2)
    """

    groups: int = 6
    modes: tuple[float, ...] = (-math.radians(16.0), 0.0, math.radians(16.0))
    radii: tuple[float, ...] = (1.0, 0.75, 0.5, 0.25)
    observe: int = 2
    jitter: tuple[float, ...] = (math.radians(2.0), math.radians(3.0))
    tracks: int = 43

    def __post_init__(self) -> None:
        if self.groups < 1 or not self.modes or self.tracks < 1:
            raise InputError("toy data: groups, modes and tracks must be at least 1")
        if not 2 <= self.observe < len(self.radii) or len(self.jitter) != len(self.radii) - self.observe:
            raise InputError(
                f"toy data: {self.observe} of {len(self.radii)} rows are observed and {len(self.jitter)} later rows"
                " have a jitter; at least two rows must be observed, and each later row needs a jitter"
            )

    @property
    def predict(self) -> int:
        """Number of predicted rows."""
        return len(self.radii) - self.observe

    def paths(self, rng: np.random.Generator, tracks: int) -> Floats:
        """Draw tracks ``[groups, modes, tracks, rows, 2]`` [m]."""
        jitter = rng.uniform(-1.0, 1.0, (self.groups, len(self.modes), tracks, self.predict)) * np.array(self.jitter)
        return self._rotate(jitter + np.array(self.modes)[:, None, None])

    def middles(self) -> Floats:
        """Return the center of every mode ``[groups, modes, rows, 2]`` [m]."""
        zero = np.zeros((self.groups, len(self.modes), 1, self.predict))
        return self._rotate(zero + np.array(self.modes)[:, None, None])[:, :, 0]

    def samples(self, rng: np.random.Generator) -> Samples:
        """Return drawn tracks as training samples; every track is a scene with one person."""
        position = self.paths(rng, self.tracks).reshape(-1, len(self.radii), 2)
        count = len(position)
        return Samples(
            position=position,
            there=np.ones((count, len(self.radii)), dtype=bool),
            scored=np.ones(count, dtype=bool),
            first=np.arange(count + 1),
            source=np.zeros(count, dtype=np.int64),
            names=("toy",),
            observe=self.observe,
            dt=1.0,
        )

    def _rotate(self, later: Floats) -> Floats:
        """Return the tracks with later rows rotated by angles ``[groups, modes, N, predict]`` [rad]."""
        begin = 2.0 * np.pi * np.arange(self.groups) / self.groups
        turn = np.concatenate([np.zeros((*later.shape[:3], self.observe)), later], axis=-1)
        angle = begin[:, None, None, None] + turn
        return np.asarray(np.array(self.radii)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1))


COMPARED, REPEATS = 20, 10
"""Number of real and drawn paths per group in one comparison, and number of comparisons."""
WITHIN = 0.05
"""Maximum distance [m] of a path from the center of its mode; adjacent modes are 0.1 m apart."""


def gan_config(method: str, toy: ToyData, values: Mapping[str, Any] | None = None) -> SocialWaysConfig:
    """Return the settings of a method: no neighbors, world frame.

    Raises:
        UnknownName: there is no such method.
    """
    if method not in METHODS:
        raise UnknownName("method", method, METHODS)
    plain = SocialWaysConfig(
        use_info_loss=False, social=False, frame="world", residual=False, observe=toy.observe, predict=toy.predict
    )
    return dataclasses.replace(plain, **{**METHODS[method], **(values or {})})


class ToyTraining(SocialWaysTraining):
    """Training of a method on the toy data, monitored by metrics of distributions."""

    kind: ClassVar[str] = "social-ways"

    def __init__(self, toy: ToyData, config: SocialWaysConfig, seed: int = 0, device: str = "cpu") -> None:
        samples = toy.samples(stream(seed, "toy"))
        super().__init__(config, samples, samples, seed, device)
        self.toy, self.seed = toy, seed

    def check(self) -> Mapping[str, float]:
        """Return 1-NN accuracy, EMD [m], number of modes and coverage, means over groups and repeats."""
        real = real_paths(self.toy, stream(self.seed, "real"))
        return compare_distributions(
            self.toy, real, sample_futures(self, COMPARED * REPEATS, stream(self.seed, "drawn"))
        )


def real_paths(toy: ToyData, rng: np.random.Generator) -> Floats:
    """Draw real future paths with random modes for every group, ``[groups, draws, T, 2]`` [m]."""
    count = COMPARED * REPEATS
    mode = rng.integers(len(toy.modes), size=(toy.groups, count))
    return toy.paths(rng, count)[np.arange(toy.groups)[:, None], mode, np.arange(count), toy.observe :]


def compare_distributions(toy: ToyData, real: Floats, drawn: Floats) -> dict[str, float]:
    """Return metrics of drawn paths against the same number of real paths, means over the groups.

    ``nearest_neighbor`` and ``emd`` compare all 200 paths of a group. The keys with ``_20`` compare 20 paths at a time,
    ten times, as the report does; real paths against real paths then have an EMD of 0.027 m, since the number of paths
    per mode is random. ``whole`` is the share of groups with all modes.
    """
    split = (toy.groups, REPEATS, COMPARED, toy.predict, 2)
    few = real.reshape(split), drawn.reshape(split)
    middles = toy.middles()[:, :, toy.observe :]
    modes = mode_count(drawn, middles, WITHIN)
    measures = {
        "nearest_neighbor": nearest_neighbor_accuracy(real, drawn),
        "emd": earth_mover_distance(real, drawn),
        "modes": modes,
        "coverage": mode_coverage(drawn, middles, WITHIN),
        "whole": modes == len(toy.modes),
        "nearest_neighbor_20": nearest_neighbor_accuracy(*few),
        "emd_20": earth_mover_distance(*few),
    }
    return {name: float(np.mean(values)) for name, values in measures.items()}


def sample_futures(model: ToyTraining, draws: int, rng: np.random.Generator) -> Floats:
    """Draw future paths of each group with the averaged generator, ``[groups, draws, T, 2]`` [m]."""
    past = model.toy.middles()[:, 0, : model.toy.observe, None]  # [groups, T, 1, 2]
    futures = model.sample_futures(past, draws, rng)  # [K, groups, T, 1, 2]
    return np.ascontiguousarray(futures[:, :, :, 0].swapaxes(0, 1))


MEASURES = ("nearest_neighbor", "emd", "modes", "coverage", "whole", "nearest_neighbor_20", "emd_20")
"""Metrics, see :func:`compare_distributions`."""
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
    measures: Mapping[str, Floats]
    drawn: Floats


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

    def real_futures(self) -> Floats:
        """Return real futures ``[groups, draws, T, 2]`` [m], for pictures."""
        return self._real(0)[:, :SHOWN]

    def ideal(self, repeats: int = 20) -> dict[str, float]:
        """Return the metrics of new real paths against real paths, the best possible values except for chance."""
        found = [compare_distributions(self.toy, self._real(2 * n), self._real(2 * n + 1)) for n in range(repeats)]
        return {name: float(np.mean([one[name] for one in found])) for name in MEASURES}

    def _real(self, number: int) -> Floats:
        return real_paths(self.toy, stream(number, "ideal"))

    @staticmethod
    def rows(runs: Sequence[GanRun]) -> list[dict[str, Any]]:
        """Return one row per method: means over the last quarter of the measurements of each seed, and their sd."""
        result = []
        for method in dict.fromkeys(run.method for run in runs):
            own = [run for run in runs if run.method == method]
            row: dict[str, Any] = {"method": method, "seeds": len(own), "updates": int(own[0].update[-1])}
            last = max(1, len(own[0].update) // 4)
            for name in MEASURES:
                ends = [float(run.measures[name][-last:].mean()) for run in own]
                row[name], row[f"{name}_sd"] = float(np.mean(ends)), float(np.std(ends))
            result.append(row)
        return result


def _train_run(job: tuple[GanComparison, str, int, Path | None]) -> GanRun:
    """Train one method with one seed, or resume its training."""

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
    read = from_attributes(SocialWaysConfig, dict(values))
    names = [name.replace("-", "_") for name in values]
    return dataclasses.replace(study, values={name: getattr(read, name) for name in names})


COLOURS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9", "#000000")
"""Colours that are distinguishable with colour blindness (Okabe & Ito)."""
SEEN, REAL = "#0072b2", "#9a9a9a"
PANELS = {
    "nearest_neighbor": "1-NN accuracy (0.5 is ideal)",
    "emd": "earth mover's distance [m]",
    "modes": "modes found, of {modes}",
}


def plot_samples(study: GanComparison, runs: Sequence[GanRun], file: Path) -> Path:
    """Plot samples of each method with its first seed beside the real data (figure 17)."""
    toy = study.toy
    first = {run.method: run for run in sorted(runs, key=lambda run: -run.seed)}
    named = {"real": None, **{m: first[m] for m in study.methods if m in first}}
    columns = min(4, len(named))
    rows = -(-len(named) // columns)
    figure = Figure(figsize=(3.0 * columns, 3.1 * rows), layout="constrained")
    begin = toy.middles()[:, 0, : toy.observe]
    for place, (name, run) in enumerate(named.items()):
        axes = figure.add_subplot(rows, columns, place + 1)
        drawn = study.real_futures() if run is None else run.drawn
        for group in range(toy.groups):
            joined = np.concatenate([np.broadcast_to(begin[group, -1], (drawn.shape[1], 1, 2)), drawn[group]], axis=1)
            axes.plot(*np.moveaxis(joined, -1, 0).swapaxes(1, 2), color="#d55e00", lw=0.4, alpha=0.35)
            axes.plot(*drawn[group][:, -1].T, ".", color="#009e73", ms=2.0)
            axes.plot(*begin[group].T, "-o", color=SEEN, lw=1.5, ms=2.5)
        axes.set(title=name, xlim=(-1.1, 1.1), ylim=(-1.1, 1.1), aspect="equal", xticks=[], yticks=[])
    return _save(figure, file)


def plot_measures(study: GanComparison, runs: Sequence[GanRun], ideal: Mapping[str, float], file: Path) -> Path:
    """Plot the metrics over the updates, mean and range over the seeds (figure 18)."""
    figure = Figure(figsize=(7.0, 8.5), layout="constrained")
    for panel, (measure, label) in enumerate(PANELS.items()):
        axes = figure.add_subplot(len(PANELS), 1, panel + 1)
        for k, method in enumerate(study.methods):
            colour, line = COLOURS[k % len(COLOURS)], "-" if k < len(COLOURS) else "--"
            own = [run for run in runs if run.method == method]
            if own:
                values = np.stack([run.measures[measure] for run in own])
                axes.plot(own[0].update, values.mean(axis=0), color=colour, label=method, lw=1.4, ls=line)
                axes.fill_between(own[0].update, values.min(axis=0), values.max(axis=0), color=colour, alpha=0.12, lw=0)
        axes.axhline(ideal[measure], color=REAL, ls="--", lw=1.0, label="real against real")
        axes.set(ylabel=label.format(modes=len(study.toy.modes)), xlabel="updates")
        if measure == "emd":
            axes.set_yscale("log")
        if panel == 0:
            axes.legend(ncols=3, fontsize=7, frameon=False)
    return _save(figure, file)


def _save(figure: Any, file: Path) -> Path:
    draft = file.with_suffix(".part")
    figure.savefig(draft, format="png", dpi=120, metadata={"Software": None})
    os.replace(draft, file)
    return file


def main(words: Sequence[str] | None = None) -> int:
    """Train every method with every seed, then write the table and the plots."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--methods", nargs="+", default=[*METHODS], metavar="NAME", help=f"default: all, {', '.join(METHODS)}")
    add("--seeds", type=int, default=3, metavar="N", help="number of seeds per method (default: 3)")
    add("--updates", type=int, default=20_000, metavar="N", help="updates per training (default: 20000)")
    add("--check-every", type=int, default=500, metavar="N", help="updates between measurements (default: 500)")
    add("--set", nargs="+", default=[], metavar="NAME=VALUE", help="settings of all methods, such as hidden=64")
    add("--workers", type=int, default=1, metavar="N", help="number of processes (default: 1)")
    add("--device", default="cpu", metavar="NAME", help="cpu or cuda (default: cpu)")
    add("--out", type=Path, required=True, metavar="DIR", help="folder of trainings, table and plots")
    options = parser.parse_args(words)
    try:
        torch_device(options.device)
        methods, seeds = tuple(options.methods), tuple(range(options.seeds))
        study = GanComparison(methods, seeds, options.updates, options.check_every, device=options.device)
        study = with_settings(study, parse_settings(options.set))
        runs: list[GanRun] = []
        with progress() as report:
            for run in study.run(options.out / "trainings", options.workers):
                runs.append(run)
                report(run.method, sum(other.method == run.method for other in runs) / len(seeds))
        write_and_print(study, runs, options.out)
    except CrowdbotError as error:
        parser.error(str(error))
    return 0


def write_and_print(study: GanComparison, runs: Sequence[GanRun], folder: Path) -> None:
    """Write ``study.json``, ``samples.png`` and ``measures.png``, and print the table of methods."""
    ideal, methods = study.ideal(), study.rows(runs)
    result = {
        "updates": study.updates, "seeds": [*study.seeds], "settings": dict(study.values), "ideal": ideal,
        "methods": methods,
        "runs": [
            {"method": run.method, "seed": run.seed, "update": run.update.tolist(),
             **{name: values.tolist() for name, values in run.measures.items()}}
            for run in runs
        ],
    }  # fmt: skip
    with explain_write_errors(folder):
        (folder / "study.json").write_text(json_text(result) + "\n", encoding="utf-8")
        plot_samples(study, runs, folder / "samples.png")
        plot_measures(study, runs, ideal, folder / "measures.png")
    names = ("nearest_neighbor", "emd", "modes", "whole", "nearest_neighbor_20", "emd_20")
    rows = [("real against real", *(number(ideal[name]) for name in names))]
    rows += [(row["method"], *(number(row[name]) for name in names)) for row in methods]
    print_table(
        "GANs on the toy data",
        ("method", "1-NN", "EMD [m]", "modes", "groups with all", "1-NN of 20", "EMD of 20"),
        rows,
        f"{study.updates} updates, {len(study.seeds)} seeds; 200 real against 200 drawn paths per group, and 20 against"
        " 20 as in the report; means over the last quarter of the measurements",
    )


if __name__ == "__main__":
    sys.exit(main())

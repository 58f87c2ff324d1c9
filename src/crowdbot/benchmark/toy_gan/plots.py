"""Plots of the GAN comparison: samples of each method, and metrics over the updates."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from .study import GanComparison, GanRun

__all__ = ["plot_measures", "plot_samples"]

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
    from matplotlib.figure import Figure

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
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 8.5), layout="constrained")
    for panel, (measure, label) in enumerate(PANELS.items()):
        axes = figure.add_subplot(len(PANELS), 1, panel + 1)
        for number, method in enumerate(study.methods):
            colour, line = COLOURS[number % len(COLOURS)], "-" if number < len(COLOURS) else "--"
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

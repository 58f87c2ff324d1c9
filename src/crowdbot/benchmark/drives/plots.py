"""Plots of the drive laboratory."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .laboratory import DRIVE_BARS, DriveReport
from .traces import SAMPLE

if TYPE_CHECKING:
    from .manoeuvre import Manoeuvre
    from .traces import DriveTrace

__all__ = ["plot_drives"]

PLANE, PHYSICS, TURN = "#9a9a9a", "#0072b2", "#d55e00"
COLORS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9", "#000000")
COLUMNS = 3
SMALLEST = 1e-5
"""Smaller figures are drawn here on a logarithmic axis."""
FIGURES = (
    ("overshoot", "overshoot"), ("steady_error", "steady error"), ("path_error", "path error by distance"),
    ("heading_error", "heading error [rad per rad]"),
)  # fmt: skip


def plot_drives(report: DriveReport, folder: Path) -> list[Path]:
    """Write ``steps.png``, ``paths.png``, ``slip.png`` and ``time-steps.png`` and return them.

    Args:
        report: result of the laboratory.
        folder: existing output folder.
    """
    from matplotlib import rc_context

    made: dict[str, Callable[[], Any]] = {
        "steps": lambda: _panels(report, _step_panel),
        "paths": lambda: _panels(report, _path_panel),
        "slip": lambda: _panels(report, _slip_panel),
        "time-steps": lambda: _time_steps(report),
    }
    files = []
    with rc_context(
        {"font.family": "sans-serif", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False}
    ):
        for name, figure in made.items():
            file = folder / f"{name}.png"
            draft = file.with_suffix(".png.part")
            figure().savefig(draft, format="png", dpi=110, metadata={"Software": None})
            os.replace(draft, file)
            files.append(file)
    return files


def _panels(report: DriveReport, draw: Any) -> Any:
    from matplotlib.figure import Figure

    count = len(report.traces)
    columns = min(COLUMNS, count)
    rows = -(-count // columns)
    figure = Figure(figsize=(0.4 + 3.6 * columns, 0.3 + 2.7 * rows), layout="constrained")
    grid = figure.subplots(rows, columns, squeeze=False)
    for number, (axes, (name, runs)) in enumerate(zip(grid.flat, report.traces.items(), strict=False)):
        axes.set_title(name, fontsize=9)
        axes.grid(alpha=0.25)
        draw(axes, runs, number == 0)
    for axes in list(grid.flat)[count:]:
        axes.set_axis_off()
    figure.legend(*grid[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3, frameon=False)
    return figure


def _step_panel(axes: Any, runs: tuple[tuple[Manoeuvre, DriveTrace, DriveTrace], ...], first: bool) -> None:
    """Draw the step to full speed and turn rate, and the stop."""
    if first:
        axes.set_ylabel("speed, turn rate")
    steps = [run for run in runs if run[0].name == "grid" and run[0].commands[0].left == 0.0]
    _, physics, plane = max(steps, key=lambda run: run[0].commands[0].forward + 1e-3 * run[0].commands[0].turn)
    times = SAMPLE * np.arange(1, len(plane.heading) + 1)
    for part, color, word in ((0, PHYSICS, "speed [m/s]"), (2, TURN, "turn rate [rad/s]")):
        axes.plot(times, plane.twist[:, part], color=PLANE, lw=3.0, label="plane" if part == 0 else None)
        axes.plot(times, physics.twist[:, part], color=color, lw=1.1, label=f"physics: {word}")
    axes.set_xlabel("time [s]")


def _path_panel(axes: Any, runs: tuple[tuple[Manoeuvre, DriveTrace, DriveTrace], ...], first: bool) -> None:
    """Draw the paths of the grid and of the swerves."""
    for run, physics, plane in runs:
        if run.name in ("grid", "weave"):
            axes.plot(*plane.position.T, color=PLANE, lw=2.6, label="plane" if run.name == "weave" else None)
            label = "physics" if run.name == "weave" else None
            axes.plot(*physics.position.T, color=TURN if run.name == "weave" else PHYSICS, lw=0.9, label=label)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("x [m]")
    if first:
        axes.set_ylabel("y [m]")


def _slip_panel(axes: Any, runs: tuple[tuple[Manoeuvre, DriveTrace, DriveTrace], ...], first: bool) -> None:
    """Draw the turn rate in swerves on the normal and on the slippery floor."""
    found = {run.name: (physics, plane) for run, physics, plane in runs}
    times = SAMPLE * np.arange(1, len(found["weave"][1].heading) + 1)
    axes.plot(times, found["weave"][1].twist[:, 2], color=PLANE, lw=3.0, label="plane")
    axes.plot(times, found["weave"][0].twist[:, 2], color=PHYSICS, lw=1.1, label="physics")
    axes.plot(times, found["slip"][0].twist[:, 2], color=TURN, lw=1.1, label="physics, slippery")
    axes.set_xlabel("time [s]")
    if first:
        axes.set_ylabel("turn rate [rad/s]")


def _time_steps(report: DriveReport) -> Any:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11.2, 3.2), layout="constrained")
    panels = figure.subplots(1, len(FIGURES), squeeze=False)[0]
    names = list(dict.fromkeys(row.robot for row in report.rows))
    for axes, (name, title) in zip(panels, FIGURES, strict=True):
        for robot, color in zip(names, COLORS * len(names), strict=False):
            rows = [row for row in report.rows if row.robot == robot]
            values = [max(getattr(row.grid, name), SMALLEST) for row in rows]
            axes.plot([1000.0 * row.step for row in rows], values, color=color, marker="o", ms=3, lw=1.0, label=robot)
        axes.axhline(DRIVE_BARS[name], color="black", ls="--", lw=0.8)
        axes.set_xscale("log")
        axes.set_yscale("log")
        ticks = sorted({1000.0 * row.step for row in report.rows})
        axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks], minor=False)
        axes.minorticks_off()
        axes.set_xlabel("time step [ms]")
        axes.set_title(title, fontsize=9)
        axes.grid(alpha=0.25)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside right center", frameon=False)
    return figure

"""Measure how robots follow velocity commands in the physics world: docs/results/drives.md with its plots.

    python studies/drives.py --page docs/results/drives.md [--makers FILE ...] [--keep FOLDER]

``crowdbot bench drives`` measures the same and prints the table.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure

from crowdbot.benchmark import (
    DRIVE_BARS,
    DRIVE_COLUMNS,
    DriveReport,
    DriveRow,
    DriveTrace,
    Manoeuvre,
    grid_cells,
    measure_drives,
)
from crowdbot.benchmark.drives.laboratory import BARRED, REGULAR, STEPS, STRAIGHT
from crowdbot.benchmark.drives.traces import SAMPLE
from crowdbot.cli.output import progress
from crowdbot.core import CrowdbotError, explain_write_errors

HEAD = """# Drives in the physics world

A robot drives alone in an empty hall, in the plane and in the physics world, with the same commands. The plane moves it
exactly as its drive says. Made by

```
{command}
```

Grid: speeds and turn rates of -100, -50, 0, 50 and 100 % of the limits of the drive in all combinations, for
omnidirectional robots also sideways. Each is a step from rest, held for 2 s, and a stop. The tables have the largest
figure over the grid. *Overshoot* and *steady* error are shares of the speed asked for (at least of a tenth of the
limit); *acc.* and *turn acc.* the largest accelerations over 0.04 s by those declared, or by the planar one if that is
larger (a skid-steer base slides outwards); overshoot is measured in the same way; *path* the largest distance from the
planar position by the distance driven; *heading* the largest difference by the angle turned; *stop* the difference of
the stop distances; *tilt* the largest angle from the vertical. At 1 and 20 ms, only full speed, full turn rate and both
are driven.

Bars at 2, 5 and 10 ms: overshoot {overshoot:.0f} %, steady error {steady:.0f} %, accelerations {acc:.0f} % of the
declared ones, path {path:.0f} %, heading {heading:g} rad per rad, at most {straight:g} rad of heading change beside the
planar one, no fall."""


def write_drives_page(report: DriveReport, file: Path, command: str = "python studies/drives.py") -> list[Path]:
    """Write a Markdown page, with its plots in a folder of the same name, and return all files.

    Args:
        report: result of the laboratory.
        file: the page; its folder must exist.
        command: command to show on the page.

    Raises:
        OutputError: a file cannot be written.
    """
    folder = file.with_suffix("")
    with explain_write_errors(file):
        folder.mkdir(parents=True, exist_ok=True)
        plots = plot_drives(report, folder)
        file.write_text(_page(report, folder.name, command), encoding="utf-8")
    return [file, *plots]


def _page(report: DriveReport, folder: str, command: str) -> str:
    bars = {name: 100.0 * most for name, most in DRIVE_BARS.items()}
    head = HEAD.format(
        command=command,
        overshoot=bars["overshoot"],
        steady=bars["steady_error"],
        acc=bars["acceleration"],
        path=bars["path_error"],
        heading=DRIVE_BARS["heading_error"],
        straight=STRAIGHT,
    )
    parts = [head, _verdict(report), f"Machine: {report.machine}."]
    parts += ["## Over the grid", _rows_table("base", report.rows)]
    parts += ["## Step to full speed and turn rate, and stop", f"![Steps]({folder}/steps.png)"]
    parts += ["## Paths of the grid and of swerves", f"![Paths]({folder}/paths.png)"]
    if len({row.step for row in report.rows}) > 1:
        parts += ["## Time steps", f"![Largest errors over the time step]({folder}/time-steps.png)", DASHED]
    parts += ["## Straight, ramp, sine and swerves", _other_table(report), OTHERS]
    parts += ["## Slippery floor", f"![Turn rate in swerves]({folder}/slip.png)", SLIP, "## How it works", HOW]
    if report.makers:
        parts += ["## Robots of other makers", MAKERS]
        parts += [_rows_table("kind of base", report.makers), _misses(report.makers)]
    return "\n\n".join(parts) + "\n"


MAKERS = """Robots from files that cannot ship, as `crowdbot new robot FILE --yes` reads them, with the quick grid: full
speed, full turn rate, and both. Limits of a base that its file does not give are guesses of the import."""
DASHED = "Dashed: the bar. Wheels are servos with a time constant of 10 ms, or two steps if that is longer."
OTHERS = """Heading change is the difference of the sums of all changes of heading. *straight*: full speed for 10 s and
a stop; *ramp*: from rest to full speed in 10 s; *sine*: half speed, turn rate of half the limit like a sine of 4 s;
*weave*: full speed, half the largest turn rate, other side every second."""
SLIP = """The same swerves with a tenth of the friction: wheels slip, and the robot no longer follows. Bases that are
pulled (`base="planar"`) have no tyres and do not slip."""
HOW = """* A driven wheel is a servo within the torque of its motor. The solver finds the torques of the motors and the
  forces of the tyres together, so servos are stable at all time steps and with wheels in the air.
* Tyres touch the floor in one point and are firm; a tyre bears friction times load in any direction. The friction is
  that of the tyre times that of the floor. Castors glide without friction. Their own turning is not simulated.
* Tyres of skid-steer bases slide by Coulomb's law, against their slip at the end of each step.
* A planar base is moved by forces at its centre of mass: those of the commanded acceleration, and a correction of the
  velocity error with the same time constant as wheels. They are limited to 4 N and 1.5 N m for each kg.
* Robots feel contacts with mass and motor torque only: nothing else holds them on their paths.
* Qolo carries a standing driver, and its wheels would lift in fast curves: its drive limits speed times turn rate to
  1 m/s2 (assumed), in the plane as well."""


def _verdict(report: DriveReport) -> str:
    barred = [row for row in report.rows if any(abs(row.step - step) < 1e-9 for step in BARRED)]
    failed = [f"{row.robot} at {1000.0 * row.step:g} ms ({', '.join(row.failures)})" for row in barred if row.failures]
    if failed:
        return f"Not within the bars: {'; '.join(failed)}."
    names = len({row.robot for row in barred})
    return f"All figures of {names} {'robots' if names != 1 else 'robot'} are within the bars."


def _misses(rows: tuple[DriveRow, ...]) -> str:
    """Return a sentence about the figures of other makers' robots beyond the bars."""
    words = {"overshoot": "overshoot", "steady_error": "steady error", "acceleration": "acceleration",
             "turn_acceleration": "turn acceleration", "path_error": "path", "heading_error": "heading",
             "heading_change": "heading change", "fall": "fall"}  # fmt: skip
    missed: dict[str, list[str]] = {}
    for row in rows:
        for name in row.failures:
            found = missed.setdefault(row.robot, [])
            found += [words[name]] if words[name] not in found else []
    within = len({row.robot for row in rows}) - len(missed)
    listed = "; ".join(f"{robot}: {', '.join(found)}" for robot, found in missed.items())
    said = f"Within all bars at all steps: {within} {'robots' if within != 1 else 'robot'}."
    return said + (f" Beyond a bar at some step: {listed}." if listed else "")


def _rows_table(base: str, rows: tuple[DriveRow, ...]) -> str:
    head = ["robot", base, "step [ms]", *(title for _, title in DRIVE_COLUMNS)]
    return _table(head, [[row.robot, row.base, f"{1000.0 * row.step:g}", *grid_cells(row.grid)] for row in rows])


def _other_table(report: DriveReport) -> str:
    """Return the other manoeuvres at the time step nearest to 5 ms."""
    steps = {row.step for row in report.rows} or set(STEPS)
    shown = min(steps, key=lambda step: abs(step - 0.005))
    names = [*REGULAR[1:], "slip"]
    head = ["robot", *(f"{name}: path [%]" for name in names), *(f"{name}: heading change [rad]" for name in names)]
    return _table(head, [_other_cells(row, names) for row in report.rows if row.step == shown])


def _other_cells(row: DriveRow, names: list[str]) -> list[str]:
    paths = [f"{100.0 * row.others[name].path_error:.2f}" for name in names]
    return [row.robot, *paths, *(f"{row.others[name].heading_change:.3f}" for name in names)]


def _table(head: list[str], rows: list[list[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


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


def main(words: Sequence[str] | None = None) -> int:
    """Measure, and write the page and its plots."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--page", type=Path, required=True, metavar="FILE.md", help="page; its plots go to a folder of the same name")
    add("--robot", nargs="+", default=[], metavar="NAME", help="robots or their folders (default: built-in)")
    add("--makers", type=Path, nargs="+", default=[], metavar="FILE", help="URDF, xacro or SDF files (default: none)")
    add("--keep", type=Path, metavar="FOLDER", help="folder of the motions; the same command continues there")
    add("--quick", action="store_true", help="few manoeuvres: a test of the command")
    options = parser.parse_args(words)
    try:
        with progress() as report:
            drives = measure_drives(
                options.robot or None, quick=options.quick, makers=options.makers, keep=options.keep, report=report
            )
        write_drives_page(drives, options.page, _command(options))
    except CrowdbotError as error:
        parser.error(str(error))
    return 0


def _command(options: argparse.Namespace) -> str:
    """Return the command, with a file of a maker on each line."""
    text = ["python studies/drives.py", *(["--robot", *options.robot] if options.robot else [])]
    text += [*(["--quick"] if options.quick else []), "--page", options.page.name]
    return " \\\n    ".join([" ".join(text) + (" --makers" if options.makers else ""), *map(str, options.makers)])


if __name__ == "__main__":
    sys.exit(main())

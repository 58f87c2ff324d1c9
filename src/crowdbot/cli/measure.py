"""``crowdbot measure PATH ...``: density, speed, flow and encounters in recordings, episodes and trials."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .output import Progress, add_json, note, number, print_json, print_table, progress
from .recordings import add_file_options, recording

if TYPE_CHECKING:
    from crowdbot.data import Trajectories
    from crowdbot.measurement import MeasurementPlan, Measurements

    from .parser import CommandParser

METHOD_NAMES = "individual, area, diagram, line, passing, profiles, encounters, pairs, lanes, stops, headways"


def arguments(parser: CommandParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("source", nargs="+", metavar="PATH", help="recording, episode (.mcap), trial file or name of a built-in trial")
    add(
        "--starts",
        type=int,
        default=1,
        metavar="N",
        help="runs of each trial, by consecutive seeds (default: 1)",
    )
    add("--methods", nargs="+", default=[], metavar="NAME", help=f"{METHOD_NAMES} (default: all possible)")
    corners: dict[str, Any] = {"nargs": "+", "type": float, "metavar": "METRES"}
    add("--area", **corners, help="corners of the measurement area, X Y X Y X Y ... (default: the walkable area)")
    add("--line", nargs=4, type=float, metavar=("X1", "Y1", "X2", "Y2"), help="line for flow (default: none)")
    add("--passage", type=float, metavar="METRES", help="distance of a second line to the left, for passages"
        " (default: none)")  # fmt: skip
    add("--walkable", **corners, help="corners of the walkable area (default: walls of the recording, or the box of all"
        " positions and 1 m)")  # fmt: skip
    add("--axis", default="x", metavar="NAME", help="coordinate along the corridor: x or y (default: x)")
    add("--window", type=float, default=0.5, metavar="SECONDS", help="time before and after for speeds (default: 0.5)")
    add("--every", type=float, default=0.5, metavar="SECONDS", help="time between Voronoi diagrams (default: 0.5)")
    add("--cut-off", type=float, metavar="METRES", help="largest radius of Voronoi cells (default: none)")
    add("--grid", type=float, default=0.5, metavar="METRES", help="cells of profiles (default: 0.5)")
    add("--bin", type=float, default=0.25, metavar="DENSITY", help="bins of the fundamental diagram (default: 0.25)")
    add("--interval", type=float, default=10.0, metavar="SECONDS", help="intervals of the flow (default: 10)")
    add("--radius", type=float, default=0.2, metavar="METRES", help="radius of people for encounters (default: 0.2)")
    add("--steady", nargs=2, type=float, metavar=("FIRST", "LAST"), help="reference of the steady state in seconds"
        " (default: none)")  # fmt: skip
    add("--dt", type=float, default=0.1, metavar="SECONDS", help="time step of people of a trial (default: 0.1)")
    add_file_options(parser.add_rare_group("reading of recordings"), agents="all")
    add("--seed", type=int, default=0, metavar="N", help="seed of shuffles and intervals (default: 0)")
    add("--trust", action="store_true", help="allow code outside the folder of a trial")
    add("--out", type=Path, metavar="DIR", help="folder for tables (CSV), measurements.json and plots (default: none)")
    add("--no-plots", action="store_true", help="write no plots")
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Measure all recordings, print the figures and write tables and plots."""
    from crowdbot.core import InputError
    from crowdbot.measurement import measure, plot_measurements

    if options.starts < 1:
        raise InputError(f"--starts {options.starts} must be at least 1")
    plan = _plan(options)
    found, odd = [], list[str]()
    with progress(options.json) as report:
        for source in options.source:
            for tracks in _tracks(source, options, report):
                found.append(measure(tracks, plan))
                odd += [f"{tracks.name}: warning: {sentence}" for sentence in tracks.warnings]
                report(f"measure {tracks.name}", 1.0)
    for sentence in dict.fromkeys([*odd, *(f"{one.name}: {text}" for one in found for text in one.notes)]):
        note(sentence)
    summary = _summary(found)
    if options.out is not None:
        summary["files"] = _write(found, summary, options.out, options.bin)
        if not options.no_plots:
            summary["files"] += [str(file) for file in plot_measurements(found, options.out)]
    if options.json:
        print_json(summary)
    else:
        _print(found, summary)
    return 0


def _plan(options: argparse.Namespace) -> MeasurementPlan:
    from crowdbot.measurement import MeasurementArea, MeasurementLine, MeasurementPlan, WalkableArea

    line = options.line
    return MeasurementPlan(
        methods=tuple(options.methods),
        walkable=None if options.walkable is None else WalkableArea(_corners("--walkable", options.walkable)),
        area=None if options.area is None else MeasurementArea(_corners("--area", options.area)),
        line=None if line is None else MeasurementLine((line[0], line[1]), (line[2], line[3])),
        steady=None if options.steady is None else (options.steady[0], options.steady[1]),
        **{
            name: getattr(options, name)
            for name in ("passage", "axis", "window", "every", "cut_off", "grid", "bin", "interval", "radius", "seed")
        },
    )


def _corners(option: str, values: Sequence[float]) -> list[tuple[float, float]]:
    from crowdbot.core import InputError

    if len(values) % 2 or len(values) < 6:
        raise InputError(f"{option} needs x and y of at least three corners, not {len(values)} numbers")
    return list(zip(values[::2], values[1::2], strict=True))


def _tracks(source: str, options: argparse.Namespace, report: Progress) -> list[Trajectories]:
    """Return the recording of a file or a folder, or one for each run of a trial."""
    from crowdbot.trials import builtin_trials

    path = Path(source)
    folder = path.is_dir() and source not in builtin_trials()  # `run frontal --out frontal` makes such a folder
    if path.suffix.lower() != ".xml" and (path.is_file() or folder):
        return [recording(options, path).original]
    return _run(source, options, report)


def _run(source: str, options: argparse.Namespace, report: Progress) -> list[Trajectories]:
    """Run a trial from several seeds and return its people."""
    import dataclasses

    from crowdbot.recording import run
    from crowdbot.trials import load_trial

    trial = load_trial(source, trust=options.trust)
    runs = []
    for seed in range(trial.seed, trial.seed + options.starts):
        done = run(trial, seed, progress=lambda share: report(f"run {trial.name}", share))
        name = trial.name if options.starts == 1 else f"{trial.name}, seed {seed}"
        runs.append(dataclasses.replace(done.tracks(options.dt), name=name))
    return runs


def _summary(found: Sequence[Measurements]) -> dict[str, Any]:
    """Return the figures of each recording, and means with intervals over several."""
    import dataclasses
    import math

    from crowdbot.measurement import mean_over_starts

    names = dict.fromkeys(name for one in found for name in one.figures)
    means = {}
    for name in names:
        values = [one.figures.get(name, math.nan) for one in found]
        if len(values) > 1 and all(math.isfinite(value) for value in values):
            means[name] = dataclasses.asdict(mean_over_starts(values))
    if len(found) > 1 and all("time-to-collision" in one.tables for one in found):
        means |= _pooled_energy(found)
    return {
        "recordings": [{"name": one.name, "figures": one.figures, "notes": list(one.notes)} for one in found],
        "mean": means,
    }


def _pooled_energy(found: Sequence[Measurements]) -> dict[str, Any]:
    """Return the exponent of the interaction energy over all recordings, which need few pairs each."""
    import math

    from crowdbot.measurement import pool_interaction_energy

    energy = pool_interaction_energy([one.tables["time-to-collision"] for one in found])
    if math.isnan(energy.exponent) or math.isnan(energy.exponent_low):
        return {}
    ends = {"low": energy.exponent_low, "high": energy.exponent_high}
    return {"energy_exponent": {"mean": energy.exponent, **ends, "starts": len(found), "pooled": True}}


def _write(found: Sequence[Measurements], summary: dict[str, Any], out: Path, bins: float) -> list[str]:
    """Write one CSV for each table, with the name of the recording as the first column, and the figures as JSON."""
    import os

    import pandas as pd

    from crowdbot.measurement import pool_diagrams, pool_interaction_energy

    from .output import json_text

    out.mkdir(parents=True, exist_ok=True)
    files = []
    for name in dict.fromkeys(name for one in found for name in one.tables):
        parts = [one.tables[name].assign(recording=one.name) for one in found if name in one.tables]
        whole = pd.concat(parts, ignore_index=True)
        text = whole[["recording", *whole.columns.drop("recording")]].to_csv(index=False, lineterminator="\n")
        files.append((out / f"{name}.csv", text))
    if len(found) > 1 and "diagram-values" in found[0].tables:
        pooled = pool_diagrams(found, bins)
        files.append((out / "diagram-pooled.csv", pooled.to_csv(index=False, lineterminator="\n")))
    if len(found) > 1 and all("time-to-collision" in one.tables for one in found):
        energy = pool_interaction_energy([one.tables["time-to-collision"] for one in found])
        text = energy.table.to_csv(index=False, lineterminator="\n")
        files.append((out / "time-to-collision-pooled.csv", text))
    files.append((out / "measurements.json", json_text(summary) + "\n"))
    for file, text in files:
        draft = file.with_suffix(".part")
        draft.write_text(text, encoding="utf-8")
        os.replace(draft, file)
    return [str(file) for file, _ in files]


def _print(found: Sequence[Measurements], summary: dict[str, Any]) -> None:
    from crowdbot.measurement import FIGURES

    means = summary["mean"]
    head = ("figure", *(one.name for one in found[:4]), *(("mean", "95 % interval") if means else ()), "unit")
    rows = []
    for name in dict.fromkeys(name for one in found for name in one.figures):
        row = [name.replace("_", " "), *(number(one.figures.get(name)) for one in found[:4])]
        if means:
            mean = means.get(name)
            row += ["-", "-"] if mean is None else [number(mean["mean"]), f"{mean['low']:.3f} to {mean['high']:.3f}"]
        rows.append([*row, FIGURES.get(name, "")])
    print_table("measurements", head, rows)
    for file in summary.get("files", []):
        print(file)

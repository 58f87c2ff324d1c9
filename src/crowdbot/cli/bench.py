"""``crowdbot bench``: measure speed on this machine."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from .output import add_json, json_text, note, number, print_json, print_table, progress

if TYPE_CHECKING:
    from crowdbot.benchmark import DriveReport, EngineReport, EnvironmentReport, WorkRate

Measured = TypeVar("Measured", "DriveReport", "EngineReport", "EnvironmentReport")
ENVIRONMENTS = "environments"
"""Name of the benchmark of environments, which has tables of its own."""
ENGINES = "engines"
"""Name of the benchmark of crowd models beside other engines."""
DRIVES = "drives"
"""Name of the drive laboratory, which measures motion and not speed of computing."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "names",
        metavar="NAME",
        nargs="*",
        help=f"measurements (default: all; bridges: those of robot interfaces), or {ENVIRONMENTS}: simulations of many"
        f" environments, compared with"
        f" navground and ir-sim, {ENGINES}: crowd models beside RVO2, JuPedSim, navground and PySocialForce, or"
        f" {DRIVES}: how robots follow velocity commands in the physics world",
    )
    parser.add_argument("--repeats", type=int, default=7, help="timed repetitions after a warm-up (default: 7)")
    parser.add_argument(
        "--data", type=Path, metavar="PATH", help="recording for scheme-frame (default: a simulated crowd)"
    )
    parser.add_argument(
        "--out", type=Path, metavar="FILE.json", help="output file for the measurements (default: none)"
    )
    parser.add_argument(
        "--quick",
        action="store_true",
        help=f"tiny counts for {ENVIRONMENTS} and {ENGINES}, or few manoeuvres for {DRIVES}: a test of the command",
    )
    parser.add_argument(
        "--rvo2",
        type=Path,
        metavar="FOLDER",
        help=f"source of RVO2 for {ENGINES}, compiled with optimisation (default: the package pyrvo)",
    )
    parser.add_argument(
        "--robot",
        metavar="NAME",
        nargs="+",
        default=[],
        help=f"robots or their folders for {DRIVES} (default: built-in)",
    )
    parser.add_argument(
        "--makers",
        metavar="FILE",
        type=Path,
        nargs="+",
        default=[],
        help=f"URDF, xacro or SDF files for {DRIVES}, imported as by crowdbot new robot FILE --yes (default: none)",
    )
    parser.add_argument(
        "--keep",
        type=Path,
        metavar="FOLDER",
        help=f"folder of the motions measured by {DRIVES}: the same command continues there after an interruption",
    )
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Measure and print the rows."""
    from crowdbot.benchmark import measure
    from crowdbot.core import InputError
    from crowdbot.web import app_measurements

    if options.rvo2 is not None and options.names != [ENGINES]:
        raise InputError(f"--rvo2 belongs to crowdbot bench {ENGINES}")
    if ENGINES in options.names:
        if len(options.names) > 1 or options.data is not None or options.robot or options.makers:
            raise InputError(f"{ENGINES} is measured alone, without other measurements and without --data")
        return _measure_engines(options)
    if ENVIRONMENTS in options.names:
        if len(options.names) > 1 or options.data is not None or options.robot or options.makers:
            raise InputError(f"{ENVIRONMENTS} is measured alone, without other measurements and without --data")
        return _measure_environments(options)
    if DRIVES in options.names:
        if len(options.names) > 1 or options.data is not None:
            raise InputError(f"{DRIVES} is measured alone, without other measurements and without --data")
        return _measure_drives(options)
    if options.robot or options.makers or options.keep is not None:
        raise InputError(f"--robot, --makers and --keep belong to crowdbot bench {DRIVES}")
    if options.quick:
        raise InputError(f"--quick belongs to crowdbot bench {ENVIRONMENTS}, {ENGINES} or {DRIVES}; use --repeats 1")
    with progress(options.json) as report:
        rows = measure(options.names, options.repeats, report, options.data, app_measurements())
    table = [row.as_dict() for row in rows]
    _write(options.out, table)
    if options.json:
        print_json({"rows": table})
        return 0
    cells = [(r.name, number(r.median, 4 if r.median < 1 else 1), r.unit, r.against, number(r.ratio, 2)) for r in rows]
    print_table("speed", ("name", "median", "unit", "against", "ratio"), cells, caption=rows[0].environment)
    return 0


def _write(path: Path | None, value: Any) -> None:
    from crowdbot.core import explain_write_errors

    if path is not None:
        with explain_write_errors(path):
            path.write_text(json_text(value) + "\n", encoding="utf-8")


def _show(options: argparse.Namespace, measured: Measured, print_measured: Callable[[Measured], None]) -> int:
    """Write a report to ``--out``, and print what is missing and the report."""
    _write(options.out, measured.as_dict())
    for sentence in getattr(measured, "missing", {}).values():
        note(f"crowdbot: {sentence}")
    if options.json:
        print_json(measured.as_dict())
    else:
        print_measured(measured)
    return 0


def _measure_environments(options: argparse.Namespace) -> int:
    from crowdbot.benchmark import BenchmarkSizes, measure_environments

    sizes = BenchmarkSizes.quick(options.repeats) if options.quick else BenchmarkSizes(repeats=options.repeats)
    with progress(options.json) as report:
        measured = measure_environments(sizes, report)
    return _show(options, measured, _print_environments)


def _measure_engines(options: argparse.Namespace) -> int:
    from crowdbot.benchmark import EngineSizes, measure_engines

    sizes = EngineSizes.quick(options.repeats) if options.quick else EngineSizes(options.repeats)
    with progress(options.json) as report:
        measured = measure_engines(sizes, options.rvo2, report)
    return _show(options, measured, _print_engines)


def _print_engines(found: EngineReport) -> None:
    cells = [
        (row.model, row.engine, str(row.people), row.order, str(row.threads), number(row.ours, 3),
         number(row.theirs, 3), number(row.ratio, 2), f"{number(row.low, 2)} to {number(row.high, 2)}")
        for row in found.rows
    ]  # fmt: skip
    head = ("model", "engine", "people", "order", "threads", "ms", "engine ms", "ratio", "10 to 90 %")
    print_table("engines: time of a step", head, cells, caption=found.machine, words=2)
    if found.threads == 1:
        print("Our kernels have one thread here: rows with two are left out.")
    for engine, protocol in found.protocols.items():
        print(f"{engine}: {protocol}")
    if found.million is not None:
        one = found.million
        print(f"{one.people} people, {one.model}: {one.seconds:.2f} s a step, {one.megabytes:.0f} MB")


def _measure_drives(options: argparse.Namespace) -> int:
    from crowdbot.benchmark import measure_drives

    with progress(options.json) as report:
        measured = measure_drives(
            options.robot or None, quick=options.quick, makers=options.makers, keep=options.keep, report=report
        )
    return _show(options, measured, _print_drives)


def _print_drives(found: DriveReport) -> None:
    from crowdbot.benchmark import DRIVE_COLUMNS, grid_cells

    cells = [
        (row.robot, row.base, f"{1000.0 * row.step:g}", *grid_cells(row.grid), ", ".join(row.failures))
        for row in (*found.rows, *found.makers)
    ]
    head = ("robot", "base", "ms", *(title for _, title in DRIVE_COLUMNS), "beyond the bars")
    print_table("drives: largest figures over the grid", head, cells, caption=found.machine, words=2)


def _print_environments(found: EnvironmentReport) -> None:
    cells: list[tuple[str, ...]] = []
    for row in found.rows:
        cells.append((row.name, "crowdbot", *_rate(row.rate), row.unit, "", ""))
        cells += [
            ("", peer.peer, *_rate(peer.rate), row.unit, number(peer.ratio_cpu, 2), number(peer.ratio_wall, 2))
            for peer in row.peers
        ]
    head = ("name", "simulator", "per CPU s", "per wall s", "unit", "ratio CPU", "ratio wall")
    print_table("environments", head, cells, caption=found.machine, words=2)
    print("\n".join(f"{row.name}: {row.protocol}" for row in found.rows))
    for peer, protocol in {peer.peer: peer.protocol for row in found.rows for peer in row.peers}.items():
        print(f"{peer}: {protocol}")
    calls = [
        (r.name, str(r.environments), number(r.python_calls, 1), number(r.builtin_calls, 1), number(r.ratio, 2))
        for r in found.calls
    ]
    print_table("calls per step", ("name", "E", "Python", "compiled", "ratio"), calls)
    trials = []
    for trial in found.trials:
        if trial.single is None or trial.batch is None:
            trials.append((trial.name, "", "", "", "", "", trial.reason))
            continue
        trials.append(
            (trial.name, str(trial.agents), *_rate(trial.single), *_rate(trial.batch), number(trial.ratio, 1))
        )
    batch = f"E = {found.sizes.trial_environments}"
    head = ("trial", "agents", "E = 1, per CPU s", "wall s", f"{batch}, per CPU s", "wall s", "ratio CPU")
    load = ", ".join(number(value, 2) for value in found.load)
    print_table("steps of built-in trials", head, trials, caption=f"load average before and after: {load}")


def _rate(rate: WorkRate) -> tuple[str, str]:
    cpu, wall = rate.per_cpu_second, rate.per_second
    return number(cpu, 1 if cpu < 1000 else 0), number(wall, 1 if wall < 1000 else 0)

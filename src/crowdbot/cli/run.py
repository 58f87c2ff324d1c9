"""``crowdbot run TRIAL``: run one trial, record it and print a summary."""

from __future__ import annotations

import argparse
import contextlib
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from .bridge import add_bridge, check_bridge_options, run_with_bridge
from .bridge.mocap import add_mocap, open_captures, print_captures
from .output import (
    add_json,
    note,
    number,
    print_json,
    print_metrics,
    print_robots,
    print_table,
    print_warnings,
    progress,
)
from .settings import add_settings, add_world, load_variant

if TYPE_CHECKING:
    from crowdbot.simulation import OrderSchedule, OrderSource, RunSummary
    from crowdbot.trials import Trial

    from .parser import CommandParser


def arguments(parser: CommandParser) -> None:
    """Declare the options."""
    parser.add_argument("trial", metavar="TRIAL", help="trial file or built-in name, such as crossing-flows")
    parser.add_argument("--seed", type=int, help="random seed (default: the seed of the trial)")
    parser.add_argument("--pace", type=float, metavar="X", help="speed relative to real time (default: unlimited)")
    parser.add_argument("--trust", action="store_true", help="allow code outside the folder of the trial")
    add_json(parser)
    changes = parser.add_argument_group("changes of the trial")
    add_world(changes)
    add_settings(changes)
    changes.add_argument("--variant", type=int, metavar="N", help="variant of a trial with sweeps, counted from 1")
    recording = parser.add_argument_group("recording")
    recording.add_argument("--out", type=Path, metavar="DIR", help="record to DIR/episode.mcap")
    recording.add_argument("--force", action="store_true", help="overwrite an existing file")
    steering = parser.add_argument_group("steering from outside")
    steering.add_argument(
        "--orders", type=Path, metavar="FILE", help="file of orders with times, one JSON object a line"
    )
    add_mocap(steering)
    add_bridge(parser)


def main(options: argparse.Namespace) -> int:
    """Run the trial."""
    from crowdbot.core import InputError

    if options.pace is not None and not options.pace > 0.0:
        raise InputError(f"--pace {options.pace:g} must be above 0; 1 is real time, 2 is twice as fast")
    trial = load_variant(options)
    print_robots([trial], options.json)
    with contextlib.ExitStack() as stack:
        captures = open_captures(trial, options, stack)
        if options.bridge:
            if options.orders is not None:
                raise InputError("--orders cannot be combined with --bridge; send the orders over the bridge")
            done, wall = run_with_bridge(trial, options, captures)
        else:
            check_bridge_options(options)
            done, wall = _run(trial, options, [*captures, *_schedule(trial, options.orders)])
    print_captures(captures)
    return print_run(done, options, wall)


def _schedule(trial: Trial, file: Path | None) -> list[OrderSchedule]:
    """Return the orders of a file."""
    from crowdbot.core import InputError
    from crowdbot.simulation import OrderSchedule

    if file is None:
        return []
    for robot in trial.robots:
        if getattr(robot.navigator, "source", ""):
            raise InputError(f"--orders cannot be used with robot {robot.name!r}, whose navigator is another program")
    return [OrderSchedule.read(file)]


def _run(trial: Trial, options: argparse.Namespace, sources: Sequence[OrderSource]) -> tuple[RunSummary, float]:
    """Run the trial and return its summary and the real time [s]."""
    from crowdbot.core import PacedClock
    from crowdbot.recording import record

    file = None if options.out is None else options.out / "episode.mcap"
    clock = None if options.pace is None else PacedClock(trial.step, rate=options.pace)
    begin = time.perf_counter()
    with print_warnings(), progress(options.json) as report:
        done = record(
            trial,
            options.seed,
            file,
            progress=lambda share: report(f"run {trial.name}", share),
            clock=clock,
            force=options.force,
            sources=sources,
        )
    if clock is not None and (remark := clock.late_remark("--pace")):
        note(f"warning: {remark}")
    return done, time.perf_counter() - begin


def print_run(done: RunSummary, options: argparse.Namespace, wall: float) -> int:
    """Print the summary of a run and return the exit status: 1 after an exception in the code of the trial."""
    from crowdbot.trials import blind_remarks, passage_remarks, trial_remarks

    summary = {
        "trial": done.trial.name,
        "seed": done.seed,
        "outcome": done.outcome,
        "steps": done.steps,
        "sim_seconds": done.end,
        "wall_seconds": wall,
        "digest": done.digest,
        "episode": None if done.path is None else str(done.path),
    }
    if done.failure is not None:
        summary |= {"error": done.failure.message, "error_place": done.failure.place}
    if options.json:
        print_json({**summary, "metrics": done.metrics})
        return _report_failure(done, options.debug)
    print_table(f"{done.trial.name}, seed {done.seed}", ("", ""), [(key, number(v)) for key, v in summary.items()])
    print_metrics("navigation", done.metrics)
    for remark in (*trial_remarks(done.trial), *passage_remarks(done.trial), *blind_remarks(done.trial)):
        print(f"note: {remark}")
    return _report_failure(done, options.debug)


def _report_failure(done: RunSummary, debug: bool) -> int:
    if done.failure is None:
        return 0
    if debug:
        note(done.failure.trace)
    hint = "" if debug else "; --debug prints the traceback"
    note(f"crowdbot: trial {done.trial.name!r} ended with an error: {done.failure}{hint}")
    return 1

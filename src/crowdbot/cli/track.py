"""``crowdbot track SOURCE``: find and track people in the readings of a laser scanner, and score the tracks."""

from __future__ import annotations

import argparse
import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .output import Progress, add_json, print_json, print_table, progress

if TYPE_CHECKING:
    from crowdbot.evaluation import ReadingLog, TrackingRun
    from crowdbot.perception import Detector, Tracker


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("source", metavar="SOURCE", help="trial file, name of a built-in trial, or episode (.mcap)")
    add("--detector", default="lidar-clusters", metavar="NAME", help="detector: a name from `crowdbot list detectors`,"
        " or file.py:Name (default: lidar-clusters)")  # fmt: skip
    add("--tracker", nargs="+", default=["global-nearest-neighbor"], metavar="NAME", help="trackers: names from"
        " `crowdbot list trackers`, or file.py:Name (default: global-nearest-neighbor)")  # fmt: skip
    add("--sensor", default="", metavar="ROBOT/SENSOR", help="sensor (default: the first that the detector reads)")
    add("--seed", type=int, metavar="N", help="first seed of a trial (default: the seed of the trial)")
    add("--starts", type=int, default=1, metavar="N", help="runs of a trial, by consecutive seeds (default: 1)")
    add("--duration", type=float, metavar="SECONDS", help="simulated time of a trial (default: of the trial)")
    add("--reach", type=float, default=0.5, metavar="METRES", help="largest distance of a person and the matching track"
        " (default: 0.5)")  # fmt: skip
    add("--no-map", action="store_true", help="do not tell the detector the walls of the stage")
    add("--trust", action="store_true", help="allow code outside the folder of a trial")
    add("--plot", type=Path, metavar="FILE", help="PNG of the tracks of the first run and tracker (default: none)")
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Track people in all runs, print the scores and draw the plot."""
    from crowdbot import perception
    from crowdbot.core import InputError, explain_write_errors, find_class
    from crowdbot.evaluation import estimate_scores, plot_tracks, track_people

    if options.starts < 1:
        raise InputError(f"--starts {options.starts} must be at least 1")
    if not options.reach > 0.0:
        raise InputError(f"--reach {options.reach} m must be above 0")
    detector: Detector = find_class(options.detector, perception, perception.Detector)()
    trackers: dict[str, Tracker] = {
        name: find_class(name, perception, perception.Tracker)() for name in options.tracker
    }
    with progress(options.json) as report:
        logs = _logs(options, detector, report)
    runs = {
        name: [track_people(log, detector, tracker, not options.no_map) for log in logs]
        for name, tracker in trackers.items()
    }
    scores = {name: estimate_scores(some, options.reach) for name, some in runs.items()}
    if options.plot is not None:
        with explain_write_errors(options.plot):
            plot_tracks(next(iter(runs.values()))[0], options.plot)
    summary = _summary(options, logs, {name: _as_json(one) for name, one in scores.items()})
    if options.json:
        print_json(summary)
    else:
        _print(options, logs, runs, scores)
    return 0


def _logs(options: argparse.Namespace, detector: Detector, report: Progress) -> list[ReadingLog]:
    """Return the readings of the episode, or of each run of the trial."""
    from crowdbot.core import InputError
    from crowdbot.evaluation import log_readings, read_readings
    from crowdbot.trials import load_trial

    if options.source.endswith(".mcap"):
        if options.starts != 1 or options.seed is not None or options.duration is not None:
            raise InputError("--starts, --seed and --duration are for trials; an episode is one run")
        return [read_readings(options.source, detector, options.sensor)]
    given: dict[str, Any] = {} if options.duration is None else {"duration": options.duration}
    trial = load_trial(options.source, trust=options.trust, **given)
    first = trial.seed if options.seed is None else options.seed
    logs = []
    for k in range(options.starts):
        logs.append(log_readings(trial, first + k, detector, options.sensor))
        report(f"run {trial.name}", (k + 1) / options.starts)
    return logs


def _as_json(scores: Any) -> dict[str, Any]:
    found = {}
    for name, one in scores.items():
        is_record = dataclasses.is_dataclass(one) and not isinstance(one, type)
        found[name] = dataclasses.asdict(one) if is_record else one._asdict()
    return found


def _summary(options: argparse.Namespace, logs: list[ReadingLog], scores: dict[str, Any]) -> dict[str, Any]:
    return {
        "source": logs[0].name,
        "seeds": [log.seed for log in logs],
        "sensor": logs[0].sensor,
        "readings": sum(len(log.rows) for log in logs),
        "detector": options.detector,
        "map": not options.no_map,
        "reach": options.reach,
        "scores": scores,
    }


def _print(
    options: argparse.Namespace, logs: list[ReadingLog], runs: dict[str, list[TrackingRun]], scores: dict[str, Any]
) -> None:
    from crowdbot.metrics import TRACKING_SCORES

    rows = []
    for name, unit in TRACKING_SCORES.items():
        rows.append([name.replace("_", " "), *(str(found[name]) for found in scores.values()), unit])
    count = sum(len(log.rows) for log in logs)
    title = f"{logs[0].name}, {logs[0].sensor}: {options.detector}, {count} readings"
    caption = f"mean over {len(logs)} runs"
    caption += " and 95 % interval by bootstrap over runs" if len(logs) > 1 else ""
    print_table(title, ("score", *runs, "unit"), rows, f"{caption}; reach {options.reach:g} m")
    if options.plot is not None:
        print(options.plot)

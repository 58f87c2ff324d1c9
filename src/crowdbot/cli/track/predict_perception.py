"""``crowdbot predict --perception SOURCE``: score predictors of future scans."""

from __future__ import annotations

import argparse
import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from crowdbot.cli.output import print_json, print_table, progress

from .reading_logs import add_runs, check_plain_runs, reading_logs

if TYPE_CHECKING:
    from crowdbot.cli.output import Progress
    from crowdbot.cli.parser import CommandParser
    from crowdbot.evaluation import ReadingLog, ScanProtocol, ScanScores


PREDICTORS = ("last-scan", "moved-scan", "tracked-scene", "learned-scene")
REFERENCE = "true-people"


def add_perception(parser: CommandParser) -> None:
    """Add the options of predictors of scans."""
    group = parser.add_rare_group("prediction of scans")
    add = group.add_argument
    add("--perception", metavar="SOURCE", help="source of the scans: a trial, an episode (.mcap) or a folder of"
        " OGM-Turtlebot2")  # fmt: skip
    add("--scan-predictor", nargs="+", default=list(PREDICTORS), metavar="NAME",
        help="predictors: names from `crowdbot list scan-predictors`, or file.py:Name (default: all)")  # fmt: skip
    add("--ego", choices=("known", "predicted"), help="future motion of the robot: known, as from a plan, or predicted"
        " from the past poses (default: known; predicted for a folder)")  # fmt: skip
    add("--horizons", nargs="+", type=float, metavar="SECONDS",
        help="times ahead (default: 0.1 0.5 1 2 3; 0.1 0.3 0.5 0.7 1 for a folder)")  # fmt: skip
    add("--plot", type=Path, metavar="FILE", help="PNG of the scores by horizon (default: none)")
    add_runs(group)


def predict_perception(options: argparse.Namespace) -> int:
    """Score the predictors of scans, print the table and draw the plot."""
    from crowdbot import perception
    from crowdbot.core import InputError, explain_write_errors, find_class
    from crowdbot.evaluation import TruePeople, plot_scan_scores, score_scans
    from crowdbot.perception import ScanPredictor, TrackedScene

    if options.starts < 1:
        raise InputError(f"--starts {options.starts} must be at least 1")
    chosen: dict[str, ScanPredictor | TruePeople] = {
        name: find_class(name, perception, ScanPredictor)() for name in options.scan_predictor
    }
    recorded = Path(options.perception).is_dir()
    if not recorded:
        chosen[REFERENCE] = TruePeople(TrackedScene())
    protocol = _protocol(options, recorded)
    with progress(options.json) as report:
        logs = _logs(options, recorded, protocol, report)
    scores = {name: score_scans(logs, item, protocol, samples=options.samples) for name, item in chosen.items()}
    unit = "runs" if not recorded else "piece" if len(logs) == 1 else "pieces"
    title = f"{logs[0].name}, {logs[0].sensor}, {len(logs)} {unit}"
    if options.plot is not None:
        with explain_write_errors(options.plot):
            plot_scan_scores(scores, title, options.plot)
    if options.json:
        print_json(_summary(options, logs, protocol, scores))
        return 0
    _print(options, title, _caption(logs, recorded, protocol), scores)
    return 0


def _protocol(options: argparse.Namespace, recorded: bool) -> ScanProtocol:
    """Return the protocol: that of SOGMP for recorded scans, with the given horizons and motion."""
    from crowdbot.evaluation import SOGMP, ScanProtocol

    protocol = SOGMP if recorded else ScanProtocol()
    if options.horizons is not None:
        protocol = replace(protocol, horizons=tuple(options.horizons))
    return protocol if options.ego is None else replace(protocol, known_motion=options.ego == "known")


def _logs(
    options: argparse.Namespace, recorded: bool, protocol: ScanProtocol, report: Progress
) -> list[ReadingLog]:  # fmt: skip
    """Return the scans of the source."""
    from crowdbot.core import InputError
    from crowdbot.evaluation import OGM_PERIOD, read_ogm
    from crowdbot.perception import LidarClusters

    if not recorded:
        return reading_logs(options, options.perception, LidarClusters(), report)
    check_plain_runs(options, "a folder has recorded scans")
    if options.sensor:
        raise InputError(f"--sensor {options.sensor} is for trials and episodes; a folder has one scanner")
    duration = math.inf if options.duration is None else options.duration
    return read_ogm(options.perception, duration, protocol.min_duration(OGM_PERIOD))


def _summary(
    options: argparse.Namespace, logs: list[ReadingLog], protocol: ScanProtocol, scores: dict[str, ScanScores]
) -> dict[str, object]:
    """Return the output of ``--json``."""
    return {
        "source": logs[0].name,
        "seeds": [log.seed for log in logs],
        "sensor": logs[0].sensor,
        "scans": sum(len(log.rows) for log in logs),
        "ego": "known" if protocol.known_motion else "predicted",
        "past": protocol.past,
        "dilation": protocol.grid.dilation,
        "samples": options.samples,
        "horizons": list(next(iter(scores.values())).horizons),
        "scores": {
            label: {name: [item._asdict() for item in row] for name, row in found.estimates().items()}
            for label, found in scores.items()
        },
    }


def _caption(logs: list[ReadingLog], recorded: bool, protocol: ScanProtocol) -> str:
    """Return what the numbers are."""
    ego = f"motion of the robot {'known' if protocol.known_motion else 'predicted'}"
    if recorded:
        scans = sum(len(log.rows) for log in logs)
        caption = f"{scans} recorded scans, of which a forecast sees {protocol.past}; no map; {ego};"
        return f"{caption} mean over pieces, 95 % intervals by bootstrap over pieces"
    caption = f"mean over runs, 95 % intervals by bootstrap over runs; {ego};"
    return f"{caption} {REFERENCE} is a reference that knows the people"


def _print(options: argparse.Namespace, title: str, caption: str, scores: dict[str, ScanScores]) -> None:
    from crowdbot.evaluation import SCAN_SCORES

    horizons = next(iter(scores.values())).horizons
    tables = {label: found.estimates() for label, found in scores.items()}
    rows = [
        [name.replace("_", " ") + (f" [{unit}]" if unit else ""), label, *(str(item) for item in tables[label][name])]
        for name, unit in SCAN_SCORES.items()
        for label in scores
    ]
    head = ("score", "predictor", *(f"{ahead:g} s" for ahead in horizons))
    print_table(title, head, rows, caption, words=2)
    if options.plot is not None:
        print(options.plot)

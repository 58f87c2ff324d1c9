"""``crowdbot track SOURCE``: find and track people in the readings of a sensor, and score the tracks."""

from __future__ import annotations

import argparse
import dataclasses
import math
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crowdbot.cli.output import add_json, print_json, print_table, progress
from crowdbot.cli.recordings import check_no_file_options

from .annotated_scans import is_annotated, read_annotated, score_annotated
from .reading_logs import add_runs, reading_logs
from .results_folder import plots, write_results
from .tracker_choice import add_choice, chosen_detectors, chosen_trackers
from .video import add_video, track_from_video

if TYPE_CHECKING:
    from crowdbot.cli.parser import CommandParser
    from crowdbot.evaluation import Estimate, ReadingLog, TrackingRun
    from crowdbot.perception import Tracks

    Table = dict[str, dict[str, Estimate]]


def score_downstream(options: argparse.Namespace, runs: dict[str, list[TrackingRun]]) -> dict[str, Any]:
    """Return the scores by tracker, predictor and input."""
    from crowdbot.cli.schemes import build_predictor
    from crowdbot.evaluation import estimate_downstream

    predictors = {name: build_predictor(name, None, {}) for name in options.predictor or []}
    return {
        label: {name: estimate_downstream(some, predictor, options.reach) for name, predictor in predictors.items()}
        for label, some in runs.items()
    }


def print_downstream(scores: dict[str, Any]) -> None:
    """Print one table for each tracker."""
    from crowdbot.evaluation import DOWNSTREAM_SCORES

    head = ("predictor", "input", "ADE [m]", "FDE [m]", "inside 90 %")
    for label, by_predictor in scores.items():
        rows = [
            [name, given, *(str(found[score]) for score in DOWNSTREAM_SCORES)]
            for name, inputs in by_predictor.items()
            for given, found in inputs.items()
        ]
        caption = "forecasts of 3.2 s every 0.4 s of people who are tracked; the same people for all inputs"
        print_table(f"prediction of tracks of {label}", head, rows, caption, words=2)


def print_statistics(options: argparse.Namespace) -> int:
    """Print the statistics of the scans of a trial, an episode or recorded scans."""
    from crowdbot.evaluation import scan_statistics

    if is_annotated(options.source):
        title = Path(options.source).name
        bands, missing = scan_statistics(_annotated(options))
    else:
        options.detector = options.detector or ["lidar-clusters"]
        with progress(options.json) as report:
            logs = reading_logs(options, options.source, next(iter(chosen_detectors(options).values())), report)
        title = f"{logs[0].name}, {logs[0].sensor}, {len(logs)} runs"
        bands, missing = scan_statistics(row for log in logs for row in _logged(log))
    if options.json:
        print_json({"source": title, "missing": missing, "bands": [band._asdict() for band in bands]})
        return 0
    rows = [
        [f"{band.near:g} to {band.far:g} m", str(band.people), f"{band.returns:.1f}",
         f"{band.low:.0f} to {band.high:.0f}", f"{band.unseen:.3f}", _shown(band.apart), _shown(band.width)]
        for band in bands if band.people
    ]  # fmt: skip
    head = ("distance", "people", "returns a person", "10 to 90 %", "without return", "in two pieces", "width [m]")
    caption = "people who are not hidden; returns at most 0.45 m from the centre;"
    print_table(f"scans of {title}", head, rows, f"{caption} {100 * missing:.1f} % of all beams have no return")
    return 0


def _shown(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.2f}"


def _annotated(options: argparse.Namespace) -> Iterator[tuple[Any, Any]]:
    for row in read_annotated(options):
        if row.people is not None:
            yield row.scan, row.people


def _logged(log: ReadingLog) -> Iterator[tuple[Any, Any]]:
    import numpy as np

    for row in log.rows:
        yield row.reading, np.array(list(row.people.values())).reshape(-1, 2)


def arguments(parser: CommandParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("source", metavar="SOURCE", nargs="?", help="trial file, name of a built-in trial,"
        " episode (.mcap), or recorded scans (DROW .csv, FROG .h5, L-CAS, .bag)")  # fmt: skip
    add("--scenes", action="store_true", help="five scenes instead of SOURCE: low density, high density, occlusion,"
        " noise, moving robot")  # fmt: skip
    add_choice(parser)
    add("--seed", type=int, metavar="N", help="first seed of a trial (default: the seed of the trial)")
    add_runs(parser)
    add("--reach", type=float, metavar="METRES", help="largest distance of a person and the matching track (default:"
        " 0.5, or 1 for a video)")  # fmt: skip
    add("--by", metavar="PART", help="divide the scores by distance, density or occlusion")
    add("--predictor", nargs="+", metavar="NAME", help="predictors whose forecasts from tracks and from the true past"
        " are compared; for a video the predictor of the tracks (default: none, or constant-velocity)")  # fmt: skip
    add("--statistics", action="store_true", help="count the returns of people in the scans, by distance, instead of"
        " tracking them")  # fmt: skip
    add("--nobody", action="store_true", help="each position is false: nobody is in the bag")
    add("--match-scans", action="store_true", help="estimate the motion of the scanner of a recording")
    add("--no-map", action="store_true", help="do not tell the detector the walls of the stage")
    add("--out", type=Path, metavar="DIR", help="folder for tracks.csv, scores.json and tracks.png")
    add("--plot", type=Path, metavar="FILE", help="PNG of the tracks of the first run and tracker")
    add_video(parser)
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Track people in all runs, print the scores and draw the plot."""
    from crowdbot.core import InputError

    if options.reach is not None and not options.reach > 0.0:
        raise InputError(f"--reach {options.reach} m must be above 0")
    if (options.video is not None) + (options.source is not None) + options.scenes != 1:
        raise InputError("give a SOURCE, --scenes or --video, and only one of them")
    if options.video is not None:
        _refuse(options, OF_SCANS, "--{} is for scans, not for --video")
        return track_from_video(options)
    check_no_file_options(options, "--video with --truth")
    _refuse(options, OF_VIDEO, "--{} is for --video")
    options.reach = options.reach or REACH
    if options.starts < 1:
        raise InputError(f"--starts {options.starts} must be at least 1")
    if (options.match_scans or options.nobody) and (options.scenes or not is_annotated(options.source)):
        raise InputError("--match-scans and --nobody are for recorded scans; trials and episodes know both")
    if options.match_scans and options.statistics:
        raise InputError("--match-scans is for trackers; --statistics do not depend on the motion of the scanner")
    if options.statistics and not options.scenes:
        _refuse(options, OF_TRACKS, "--{} is for tracks; --statistics track nobody")
        return print_statistics(options)
    if not options.scenes:
        return score_annotated(options) if is_annotated(options.source) else _track_source(options)
    _refuse(options, OF_ONE_SOURCE, "--scenes has no --{}; track the scenes one by one for it")
    for name, (source, trial) in SCENES.items():
        print(f"scene {name}: crowdbot track {source} " + (f"--trial '{trial[0]}'" if trial else ""))
        options.source, options.trial = source, trial
        _track_source(options)
    return 0


def _track_source(options: argparse.Namespace) -> int:
    """Track people in a trial or an episode, print the scores and draw the plot."""
    from crowdbot.core import explain_write_errors
    from crowdbot.evaluation import plot_tracks

    options.detector = options.detector or ["lidar-clusters"]
    runs, logs = _runs(options)
    tables = _tables(options, runs)
    downstream = score_downstream(options, runs) if options.predictor else {}
    summary = _summary(options, logs, tables) | ({"prediction": _prediction(downstream)} if downstream else {})
    files = []
    if options.out is not None:
        tracks: dict[tuple[str, int | None], tuple[Tracks, ...]] = {
            (label, run.log.seed): run.tracks for label, some in runs.items() for run in some
        }
        files = write_results(options.out, tracks, summary)
    for plot in plots(options):
        with explain_write_errors(plot):
            files.append(plot_tracks(next(iter(runs.values()))[0], plot))
    if options.json:
        print_json(summary)
        return 0
    for part, table in tables.items():
        _print(options, logs, part, table)
    print_downstream(downstream)
    for file in files:
        print(file)
    return 0


def _refuse(options: argparse.Namespace, names: tuple[str, ...], sentence: str) -> None:
    """Raise :class:`InputError` for an option that would be ignored."""
    from crowdbot.core import InputError

    for name in names:
        value = getattr(options, name)
        if not (value is None or value is False or value in ("", []) or (name == "starts" and value == 1)):
            raise InputError(sentence.format(name.replace("_", "-")))


def _prediction(downstream: dict[str, Any]) -> dict[str, Any]:
    """Return the scores of predictors for the output of ``--json``."""
    return {
        label: {
            name: {given: _as_json(input_topic) for given, input_topic in inputs.items()}
            for name, inputs in predictors.items()
        }
        for label, predictors in downstream.items()
    }


def _runs(options: argparse.Namespace) -> tuple[dict[str, list[TrackingRun]], list[ReadingLog]]:
    """Return the runs of each detector with each tracker, and the readings of the first detector."""
    from crowdbot.evaluation import track_people

    detectors, trackers = chosen_detectors(options), chosen_trackers(options)
    runs: dict[str, list[TrackingRun]] = {}
    first: list[ReadingLog] = []
    read: dict[tuple[type, ...], list[ReadingLog]] = {}
    with progress(options.json) as report:
        for name, detector in detectors.items():
            if detector.reads not in read:
                read[detector.reads] = reading_logs(options, options.source, detector, report)
            logs = read[detector.reads]
            first = first or logs
            for label, tracker in trackers.items():
                key = label if len(detectors) == 1 else f"{name}, {label}"
                runs[key] = [track_people(log, detector, tracker, not options.no_map) for log in logs]
    return runs, first


def _tables(options: argparse.Namespace, runs: dict[str, list[TrackingRun]]) -> dict[str, Table]:
    """Return the scores by part of the people, then by tracker; the part of all people is empty."""
    from crowdbot.evaluation import estimate_scores, estimate_strata

    if options.by is None:
        return {"": {name: estimate_scores(some, options.reach) for name, some in runs.items()}}
    tables: dict[str, Table] = {}
    for name, some in runs.items():
        for part, scores in estimate_strata(some, options.by, options.reach).items():
            tables.setdefault(part, {})[name] = scores
    return tables


def _as_json(scores: dict[str, Any]) -> dict[str, Any]:
    json = {}
    for name, score in scores.items():
        is_record = dataclasses.is_dataclass(score) and not isinstance(score, type)
        json[name] = dataclasses.asdict(score) if is_record else score._asdict()
    return json


def _summary(options: argparse.Namespace, logs: list[ReadingLog], tables: dict[str, Table]) -> dict[str, Any]:
    parts = {part: {name: _as_json(item) for name, item in table.items()} for part, table in tables.items()}
    return {
        "source": logs[0].name,
        "seeds": [log.seed for log in logs],
        "sensor": logs[0].sensor,
        "readings": sum(len(log.rows) for log in logs),
        "detector": ", ".join(options.detector),
        "map": not options.no_map,
        "reach": options.reach,
        "scores": parts if options.by else parts[""],
    }


def _print(options: argparse.Namespace, logs: list[ReadingLog], part: str, table: Table) -> None:
    """Print one table; with many trackers, each is a row."""
    from crowdbot.metrics import TRACKING_SCORES

    count = sum(len(log.rows) for log in logs)
    title = f"{logs[0].name}, {logs[0].sensor}: {', '.join(options.detector)}, {count} readings"
    title += f"; {options.by} {part}" if options.by else ""
    caption = f"mean over {len(logs)} runs"
    caption += " and 95 % interval by bootstrap over runs" if len(logs) > 1 else ""
    words = {name: name.replace("_", " ") for name in TRACKING_SCORES}
    if len(table) > MOST_COLUMNS:
        units = {name: f" [{unit}]" if unit else "" for name, unit in TRACKING_SCORES.items()}
        head = ["tracker", *(words[name] + units[name] for name in MAIN_SCORES)]
        rows = [[name, *(str(scores[item]) for item in MAIN_SCORES)] for name, scores in table.items()]
    else:
        head = ["score", *table, "unit"]
        rows = [[words[item], *(str(scores[item]) for scores in table.values()), unit]
                for item, unit in TRACKING_SCORES.items()]  # fmt: skip
    print_table(title, head, rows, f"{caption}; reach {options.reach:g} m")


SCENES: dict[str, tuple[str, list[str]]] = {
    "1 low density": ("two-way", ["density=0.15"]),
    "2 high density": ("two-way", ["density=0.6"]),
    "3 occlusion": ("block", ["people=30"]),
    "4 noise": ("crossing-flows", ["robot[1]/sensor[1]/noise=gaussian(0.05)"]),
    "5 moving robot": ("crossing-flows", []),
}
"""Trials of the tables of results, with their parameters."""
REACH = 0.5
"""Largest distance of a person and the matching track [m], by default."""
OF_VIDEO = ("camera", "odometry", "start", "steps", "truth")
OF_SCANS = (
    "seed", "sensor", "starts", "duration", "trial", "trust", "by", "statistics", "nobody", "match_scans", "no_map",
)  # fmt: skip
OF_TRACKS = ("tracker", "motion", "by", "predictor", "out", "plot")
OF_ONE_SOURCE = ("out", "plot", "trial", "json", "statistics")
"""Options of a video, of scans, of tracks, and of one source."""
MOST_COLUMNS = 4
"""Number of trackers up to which all scores are shown, as rows of the table."""
MAIN_SCORES = ("mota", "motp", "idf1", "hota", "switches", "latency", "kept_through_occlusion")
"""Scores of a table of many trackers."""

"""``crowdbot track --video FILE``: people in the video of a robot's camera, tracked and predicted in metres."""

from __future__ import annotations

import argparse
import csv
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crowdbot.cli.output import print_json, print_table, progress
from crowdbot.cli.recordings import add_file_options, check_no_file_options, check_parts, recording

from .results_folder import plots, write_results
from .tracker_choice import chosen_detectors, chosen_trackers

if TYPE_CHECKING:
    from crowdbot.cli.parser import CommandParser
    from crowdbot.evaluation import VideoRun


REACH, FAR = 1.0, 10.0
"""Largest distance of a person and a track [m], and of people who must be found [m], by default."""
STEPS = 8
"""Number of rows of a forecast, by default."""


def add_video(parser: CommandParser) -> None:
    """Declare the options."""
    group = parser.add_rare_group("video instead of SOURCE, and recording of --truth")
    add = group.add_argument
    add("--video", type=Path, metavar="FILE", help="video of a camera on a robot")
    add("--camera", type=Path, metavar="FILE", help="calibration: camera_info of ROS as YAML, with the place on the"
        " robot under mount: x, y, z, roll, pitch, yaw")  # fmt: skip
    add("--odometry", type=Path, metavar="FILE", help="CSV of the robot: time, x, y, heading")
    add("--start", type=float, metavar="SECONDS", help="time of the first frame (default: first time of --odometry)")
    add("--steps", type=int, metavar="N", help="rows of 0.4 s of a forecast (default: 8)")
    add("--truth", type=Path, metavar="FILE", help="recording of the true people, such as a CSV with id, time, x,"
        " y, on the clock of --odometry (default: no scores)")  # fmt: skip
    add_file_options(group, agents="all")


def track_from_video(options: argparse.Namespace) -> int:
    """Track and predict the people in a video, print the scores and write the files."""
    from crowdbot.cli.schemes import build_predictor
    from crowdbot.core import InputError, explain_write_errors
    from crowdbot.evaluation import plot_video_run, read_camera, read_odometry, read_true_paths, track_video

    if options.camera is None or options.odometry is None:
        raise InputError("--video needs --camera and --odometry")
    options.detector = options.detector or ["lidar-clusters"]
    if (
        len(options.tracker) > 1
        or len(options.detector) > 1
        or len(options.motion) > 1
        or len(options.predictor or []) > 1
    ):
        raise InputError("--video takes one detector, tracker, motion model and predictor")
    steps = STEPS if options.steps is None else options.steps
    if steps < 1:
        raise InputError(f"--steps {steps} must be at least 1")
    detector: Any = next(iter(chosen_detectors(options).values()))
    tracker = next(iter(chosen_trackers(options).values()))
    if options.truth is None:
        check_no_file_options(options, "--truth")
        truth = None
    else:
        check_parts(options, [options.truth])
        truth = read_true_paths(recording(options, options.truth))
    with progress(options.json) as report:
        run = track_video(
            options.video, read_camera(options.camera), read_odometry(options.odometry), detector, tracker,
            build_predictor((options.predictor or ["constant-velocity"])[0], None, {}), steps, options.start,
            lambda share: report("track video", share),
        )  # fmt: skip
    scores = {} if truth is None else run.scores(truth, options.reach or REACH, FAR)
    summary = {
        "video": options.video.name,
        "frames": len(run.time),
        "detections": sum(len(detection) for detection in run.detections),
        "tracks": len({who for track in run.tracks for who in track.ids.tolist()}),
        "scores": scores,
    }
    files = []
    if options.out is not None:
        files = [*write_results(options.out, {("", None): run.tracks}, summary), _write_forecasts(run, options.out)]
    for plot in plots(options):
        with explain_write_errors(plot):
            files.append(plot_video_run(run, plot, truth))
    if options.json:
        print_json(summary)
    else:
        _print(options, summary, files)
    return 0


def _print(options: argparse.Namespace, summary: dict[str, Any], files: Sequence[Path]) -> None:
    print(
        f"{summary['video']}: {summary['frames']} frames, {summary['detections']} detections of"
        f" {options.detector[0]}, {summary['tracks']} tracks"
    )
    if summary["scores"]:
        rows = [[name.replace("_", " "), f"{value:.3g}"] for name, value in summary["scores"].items()]
        caption = (
            f"people up to {FAR:g} m who are in the image and not behind others; reach {options.reach or REACH:g} m;"
        )
        print_table("scores", ("score", "value"), rows, f"{caption} errors in m")
    for file in files:
        print(file)


def _write_forecasts(run: VideoRun, folder: Path) -> Path:
    """Write the forecasts and return the file."""
    from crowdbot.core import explain_write_errors

    path = folder / "forecasts.csv"
    with explain_write_errors(path), path.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["time", "id", "ahead", "x", "y"])
        for forecast in run.forecasts:
            for row, ahead in enumerate(forecast.ahead):
                for a, who in enumerate(forecast.ids.tolist()):
                    place = forecast.position[row, a]
                    table.writerow([f"{forecast.time:.3f}", who, f"{ahead:g}", f"{place[0]:.3f}", f"{place[1]:.3f}"])
    return path

"""``crowdbot demo``: a demonstration on built-in data, with a report."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from .output import add_json, print_json, print_metrics, print_table, progress


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--out", type=Path, default=Path("demo"), metavar="DIR", help="output folder (default: demo)")
    parser.add_argument("--seed", type=int, help="random seed (default: from the trial)")
    parser.add_argument("--force", action="store_true", help="overwrite the results of an earlier run")
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Run a trial, predict its people, write the report."""
    from crowdbot.core import explain_write_errors
    from crowdbot.evaluation import run_demo

    begin = time.perf_counter()
    with progress(options.json) as report, explain_write_errors(options.out):
        done = run_demo(options.out, seed=options.seed, progress=report, force=options.force)
    seconds = time.perf_counter() - begin
    if options.json:
        print_json({**done.as_dict(), "wall_seconds": seconds})
        return 0
    episode = done.episode
    print_metrics(f"{episode.trial.name}, seed {episode.seed}: {episode.outcome}", episode.metrics)
    print_table(
        "prediction of the people near the robot, next 4.8 s",
        ("predictor", *done.scores[0].columns),
        [(score.predictor, *score.cells()) for score in done.scores],
        caption=done.caption,
    )
    print(f"recorded  {done.episode_file}")
    print(f"report    {done.report_file}   (open it in a browser)")
    print(f"took      {seconds:.1f} s")
    return 0

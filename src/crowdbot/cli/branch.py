"""``crowdbot branch EPISODE.mcap --at T``: continue a recorded episode from a given time with other settings."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from .output import add_json, print_warnings, progress
from .run import print_run
from .settings import add_places, add_settings, parse_settings


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("episode", metavar="EPISODE.mcap", type=Path, help="recorded episode")
    add("--at", type=float, required=True, metavar="T", help="time to continue from, in s")
    add_settings(parser, "values by path: duration=60, robot/navigator/type=orca, robot[NAME]/goal/x=3")
    add("--seed", type=int, help="seed of new random streams (default: continue the recorded streams)")
    add("--out", type=Path, metavar="DIR", help="record to DIR/episode.mcap")
    add("--force", action="store_true", help="overwrite an existing file")
    add_places(parser)
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Run the branch."""
    from crowdbot.recording import branch

    begin = time.perf_counter()
    with print_warnings(), progress(options.json) as report:
        done = branch(
            options.episode,
            options.at,
            seed=options.seed,
            changes=parse_settings(options.set),
            out=None if options.out is None else options.out / "episode.mcap",
            force=options.force,
            folder=options.folder,
            trust=options.trust,
            progress=lambda share: report("branch", share),
        )
    return print_run(done, options, time.perf_counter() - begin)

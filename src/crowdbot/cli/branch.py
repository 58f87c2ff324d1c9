"""``crowdbot branch EPISODE.mcap --at T``: continue a recorded episode from a given time with other values."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from .output import add_json, progress, spoken_warnings
from .replay import add_places
from .run import print_run
from .schemes import assignments


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    add = parser.add_argument
    add("episode", metavar="EPISODE.mcap", type=Path)
    add("--at", type=float, required=True, metavar="T", help="recorded time to continue from [s]")
    add(
        "--set",
        nargs="+",
        default=[],
        metavar="PATH=VALUE",
        help="values by path in the XML of the trial: duration=60, robot/navigator/type=orca, robot[NAME]/goal/x=3",
    )
    add("--seed", type=int, help="seed of new random streams from then on (default: continue the old ones)")
    add("--out", type=Path, metavar="DIR", help="record to DIR/episode.mcap")
    add("--force", action="store_true", help="overwrite an existing file")
    add_places(parser)
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Run the branch."""
    from crowdbot.recording import branch

    begin = time.perf_counter()
    with spoken_warnings(), progress(options.json) as report:
        done = branch(
            options.episode,
            options.at,
            seed=options.seed,
            changes=assignments(options.set),
            out=None if options.out is None else options.out / "episode.mcap",
            force=options.force,
            folder=options.folder,
            trust=options.trust,
            progress=lambda share: report("branch", share),
        )
    return print_run(done, options, time.perf_counter() - begin)

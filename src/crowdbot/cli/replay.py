"""``crowdbot replay EPISODE.mcap``: run a recorded episode again and check its digest."""

from __future__ import annotations

import argparse
from pathlib import Path

from .output import add_json, print_json, print_warnings, progress
from .settings import add_places


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("episode", metavar="EPISODE.mcap", type=Path, help="recorded episode")
    parser.add_argument(
        "--begin",
        type=float,
        default=0.0,
        metavar="T",
        help="check from the latest keyframe up to this time on, in s (default: the whole episode)",
    )
    add_places(parser)
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Replay; the status is 1 if the digests differ."""
    from crowdbot.recording import replay

    with print_warnings(), progress(options.json) as report:
        done = replay(
            options.episode,
            folder=options.folder,
            trust=options.trust,
            begin=options.begin,
            progress=lambda share: report("replay", share),
        )
    if options.json:
        print_json(done.as_dict())
    else:
        print(done)
    return 0 if done.equal else 1

"""``crowdbot repair EPISODE.mcap``: complete the episode file of a run that was killed."""

from __future__ import annotations

import argparse
from pathlib import Path

from .output import add_json, print_json


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("episodes", metavar="EPISODE.mcap", type=Path, nargs="+")
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Repair each file in place."""
    from crowdbot.recording import repair

    found = {str(path): repair(path) for path in options.episodes}
    if options.json:
        print_json(found)
        return 0
    for path, end in found.items():
        print(f"{path}: {'is whole, nothing to do' if end is None else f'has its end now, at {end:g} s'}")
    return 0

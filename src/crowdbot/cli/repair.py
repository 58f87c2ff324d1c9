"""``crowdbot repair EPISODE.mcap``: repair the episode file of a killed run."""

from __future__ import annotations

import argparse
from pathlib import Path

from .output import add_json, print_json


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("episodes", metavar="EPISODE.mcap", type=Path, nargs="+", help="episode files")
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Repair each file in place."""
    from crowdbot.recording import repair

    found = {str(path): repair(path) for path in options.episodes}
    if options.json:
        print_json(found)
        return 0
    for path, end in found.items():
        print(f"{path}: {'complete, nothing to repair' if end is None else f'repaired, ends at {end:g} s'}")
    return 0

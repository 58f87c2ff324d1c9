"""``crowdbot list KIND``: what is built in."""

from __future__ import annotations

import argparse

from .output import add_json, print_json, print_table


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("kind", metavar="KIND", nargs="?", help="models, predictors, trials, ...; none lists all kinds")
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Print the names with one line about each."""
    from crowdbot.benchmark import catalogue

    kinds = catalogue(options.kind)
    if options.json:
        print_json(kinds)
        return 0
    for kind, entries in kinds.items():
        print_table(kind, ("name", "about"), [*entries.items()], words=2)
    return 0

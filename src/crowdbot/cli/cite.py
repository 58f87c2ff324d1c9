"""``crowdbot cite NAME``: print the references of built-in names."""

from __future__ import annotations

import argparse

from .output import add_json, print_json


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("names", metavar="NAME", nargs="*", help="built-in names (default: crowdbot itself)")
    parser.add_argument("--bibtex", action="store_true", help="print BibTeX entries")
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Print the references."""
    from crowdbot.catalogue import papers

    found = {name: papers(name) for name in options.names or ["crowdbot"]}
    if options.json:
        print_json({name: [str(paper) for paper in list_] for name, list_ in found.items()})
        return 0
    for name, list_ in found.items():
        for paper in list_:
            print(paper.bibtex() if options.bibtex else f"{name}: {paper}")
    return 0

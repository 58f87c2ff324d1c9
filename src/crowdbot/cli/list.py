"""``crowdbot list KIND``: what is built in."""

from __future__ import annotations

import argparse

from .output import add_json, print_json, print_table


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("kind", metavar="KIND", nargs="?", help="models, predictors, trials, ...; none lists all kinds")
    parser.add_argument("name", metavar="NAME", nargs="?", help="of a built-in trial: lists its parameters")
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Print the names with one line about each."""
    from crowdbot.benchmark import builtin_names

    if options.name is not None:
        return _parameters(options)
    kinds = builtin_names(options.kind)
    if options.json:
        print_json(kinds)
        return 0
    for kind, entries in kinds.items():
        print_table(kind, ("name", "about"), [*entries.items()], words=2)
    return 0


def _parameters(options: argparse.Namespace) -> int:
    """Print what can be set of a built-in trial."""
    from crowdbot.core import InputError, did_you_mean
    from crowdbot.trials import PRESETS

    preset = PRESETS.get(options.name)
    if options.kind != "trials" or preset is None:
        near = did_you_mean(options.name, PRESETS)
        raise InputError(f"{options.name!r} is no built-in trial with parameters{near}; see crowdbot list trials")
    rows = {name: str(option) for name, option in preset.options.items()}
    if options.json:
        print_json({preset.name: rows})
        return 0
    print_table(
        f"{preset.name}: {preset.about}", ("parameter", "about, and what it is by itself"), [*rows.items()], words=2
    )
    return 0

"""``crowdbot list KIND``: list built-in names."""

from __future__ import annotations

import argparse
import dataclasses

from .output import add_json, print_json, print_table


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "kind", metavar="KIND", nargs="?", help="kind, such as models, predictors or trials (default: all kinds)"
    )
    parser.add_argument("name", metavar="NAME", nargs="?", help="built-in trial: its parameters and scenarios")
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Print names and one-line descriptions."""
    from crowdbot.catalogue import builtin_names

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
    """Print the parameters of a built-in trial, and the cards of its scenarios."""
    from crowdbot.core import InputError, did_you_mean
    from crowdbot.trials import PRESETS

    if options.kind != "trials":
        raise InputError(
            f"crowdbot list {options.kind} takes no name, {options.name!r} was given;"
            f" crowdbot list {options.kind} lists all, crowdbot cite {options.name} prints references"
        )
    preset = PRESETS.get(options.name)
    if preset is None:
        near = did_you_mean(options.name, PRESETS)
        raise InputError(f"{options.name!r} is not a built-in trial with parameters{near}; see crowdbot list trials")
    rows = {name: str(option) for name, option in preset.options.items()}
    if options.json:
        print_json({preset.name: rows, "scenarios": [dataclasses.asdict(card) for card in preset.cards]})
        return 0
    print_table(f"{preset.name}: {preset.about}", ("parameter", "description and default"), [*rows.items()], words=2)
    for card in preset.cards:
        lines = {
            "command": f"crowdbot run {card.command(preset.name)}",
            "setup": card.setup,
            "robot": card.robot,
            "success": card.success,
            "metrics": ", ".join(card.metrics),
            "not shown": card.lacks,
        }
        print_table(f"{card.name} (Francis et al. 2025, doi:10.1145/3700599)", ("", ""), [*lines.items()], words=2)
    return 0

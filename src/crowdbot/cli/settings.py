"""``--set NAME=VALUE``: parameters of built-in trials, and values in any trial by their paths."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from crowdbot.trials import Trial

__all__ = ["add_robots", "add_settings", "add_world", "robots", "select_variant", "settings"]

WORLDS = ("planar", "physics")


def add_settings(parser: argparse._ActionsContainer) -> None:
    """Add the option ``--set``."""
    parser.add_argument(
        "--set",
        dest="settings",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="parameter of a built-in trial (density=0.5) or value by its path (spawner[1]/count=20); repeatable",
    )


def add_robots(parser: argparse._ActionsContainer) -> None:
    """Add the option ``--robots``."""
    parser.add_argument(
        "--robots",
        default="",
        metavar="LIST",
        help="robot types or robot folders, separated by commas, each with its own body, drive and sensors instead of"
        " the first robot of the trial (default: own)",
    )


def robots(options: argparse.Namespace) -> list[str]:
    """Return the robot types; an empty name is the robot of the trial."""
    return [name.strip() for name in options.robots.split(",")]


def add_world(parser: argparse._ActionsContainer) -> None:
    """Add the option ``--world``."""
    parser.add_argument(
        "--world",
        metavar="NAME",
        help="planar (discs in the plane) or physics (bodies with contact forces) (default: from the trial)",
    )


def settings(options: argparse.Namespace) -> dict[str, str]:
    """Return the values by name.

    Raises:
        InputError: a setting is not of the form NAME=VALUE, or a name is given twice.
    """
    from crowdbot.core import InputError, did_you_mean

    found: dict[str, str] = {}
    for text in options.settings:
        name, equals, value = text.partition("=")
        if not (name.strip() and equals):
            raise InputError(f"--set {text!r} must be NAME=VALUE, such as density=0.5")
        if name.strip() in found:
            raise InputError(f"--set {name.strip()} is given twice")
        found[name.strip()] = value.strip()
    world = getattr(options, "world", None)
    if world is not None:
        if "world" in found:
            raise InputError(f"--world {world} and --set world={found['world']} conflict; give one of them")
        if world not in WORLDS:
            raise InputError(f"--world {world} must be {' or '.join(WORLDS)}{did_you_mean(world, WORLDS)}")
        found["world"] = world
    return found


def select_variant(trial: Trial, variant: int | None) -> Trial:
    """Return a trial, or the given variant (from 1) of a trial with sweeps.

    Raises:
        InputError: the variant does not exist, or is required but not given.
    """
    from crowdbot.core import InputError
    from crowdbot.trials import expand_sweeps

    if variant is None and not trial.sweeps:
        return trial
    variants = expand_sweeps(trial)
    if variant is None:
        raise InputError(
            f"{trial.name} has {len(variants)} variants in its sweeps; run one of them with --variant 1 to"
            f" {len(variants)} (crowdbot check lists them)"
        )
    if not trial.sweeps or not 1 <= variant <= len(variants):
        raise InputError(f"--variant {variant}: {trial.name} has {len(variants) if trial.sweeps else 'no'} variants")
    return variants[variant - 1]

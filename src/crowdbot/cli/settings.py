"""Options that several commands share: ``--set``, ``--seeds``, ``--robots`` and ``--world``, declared once."""

from __future__ import annotations

import argparse
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from .parser import SETTING, Options

if TYPE_CHECKING:
    from crowdbot.trials import Trial


WORLDS = ("planar", "physics")
TRIAL_VALUES = "parameters of a built-in trial (density=0.5) or values by path (spawner[1]/count=20)"


def add_settings(parser: Options, values: str = TRIAL_VALUES, option: str = "--set") -> None:
    """Add the option ``--set``, see :func:`parse_settings`.

    Args:
        parser: parser or group.
        values: what the command sets.
        option: name of the option.
    """
    parser.add_argument(option, action="append", default=[], metavar=SETTING, help=f"{values}; one or several")


def parse_settings(words: Iterable[str], option: str = "--set") -> dict[str, str]:
    """Return the values by name.

    Raises:
        InputError: a word is not of the form NAME=VALUE, or a name is given twice.

    >>> parse_settings(["density=0.5", "spawner[1]/count=20"])
    {'density': '0.5', 'spawner[1]/count': '20'}
    """
    from crowdbot.core import InputError

    values: dict[str, str] = {}
    for word in words:
        name, equals, value = word.partition("=")
        if not (name.strip() and equals):
            raise InputError(f"{option} {word!r} must be NAME=VALUE, such as density=0.5")
        if name.strip() in values:
            raise InputError(f"{option} {name.strip()} is given twice")
        values[name.strip()] = value.strip()
    return values


def add_places(parser: Options) -> None:
    """Add the options for the location of trial files of a recorded episode."""
    parser.add_argument(
        "--folder",
        type=Path,
        metavar="DIR",
        help="folder of the trial files (default: the folder of the episode)",
    )
    parser.add_argument(
        "--trust",
        action="store_true",
        help="allow code from the episode, code that differs from the recorded code, and files outside the folder",
    )


def add_seeds(parser: Options, default: str) -> None:
    """Add the option ``--seeds``, see :func:`crowdbot.evaluation.parse_seeds`; ``default`` is for the help."""
    parser.add_argument(
        "--seeds", metavar="SEEDS", help=f"seed 7, seeds 0:100 (0 to 99) or 3,5,10:20 (default: {default})"
    )


def add_robots(parser: Options) -> None:
    """Add the option ``--robots``."""
    parser.add_argument(
        "--robots",
        default="",
        metavar="LIST",
        help="robot types or robot folders, separated by commas, each with its own body, drive and sensors instead of"
        " the first robot of the trial (default: own)",
    )


def add_world(parser: Options) -> None:
    """Add the option ``--world``."""
    parser.add_argument(
        "--world",
        metavar="NAME",
        help="planar (discs in the plane) or physics (bodies with contact forces) (default: from the trial)",
    )


def settings(options: argparse.Namespace) -> dict[str, str]:
    """Return the values of ``--set`` and ``--world`` for a trial.

    Raises:
        InputError: see :func:`parse_settings`, or the world is unknown or is given twice.
    """
    from crowdbot.core import InputError, did_you_mean

    result = parse_settings(options.set)
    world = getattr(options, "world", None)
    if world is not None:
        if "world" in result:
            raise InputError(f"--world {world} and --set world={result['world']} conflict; give one of them")
        if world not in WORLDS:
            raise InputError(f"--world {world} must be {' or '.join(WORLDS)}{did_you_mean(world, WORLDS)}")
        result["world"] = world
    return result


def load_settings_trial(source: str, values: Mapping[str, str], trust: bool = False) -> Trial:
    """Load the trial of a command with its values.

    A type names a robot folder or code in the working folder, as all other options do, or else in the folder of the
    trial. Naming it allows it, also outside the folder of the trial, and allows nothing else.
    """
    from crowdbot.trials import apply_values, load_trial

    path = Path(source)
    given = {key: _seen_from(path.parent, value) for key, value in values.items() if key.endswith("/type")}
    named = {key: value for key, value in given.items() if value != values[key]}
    if not named or not path.is_file():
        return load_trial(source, values, trust=trust)
    trial = load_trial(source, trust=trust)
    return apply_values(trial, {**values, **named}, place=trial.name, trust=trust or {*named.values()})


def _seen_from(folder: Path, value: str) -> str:
    """Return the address of a robot folder or of code in the working folder as seen from another folder."""
    name, colon, rest = value.partition(":")
    path, here = Path(name).resolve(), Path.cwd().resolve()
    known = path.is_file() if colon else (path / "robot.xml").is_file()
    if not known or folder.resolve() == here or not path.is_relative_to(here):
        return value
    return f"{Path(os.path.relpath(path, folder.resolve())).as_posix()}{colon}{rest}"


def load_variant(options: argparse.Namespace) -> Trial:
    """Load the trial of a command, or the variant of ``--variant`` (from 1) of a trial with sweeps.

    Raises:
        InputError: the variant does not exist, or is required but not given.
    """
    from crowdbot.core import InputError
    from crowdbot.trials import expand_sweeps, remarks_at_end

    with remarks_at_end():
        trial = load_settings_trial(options.trial, settings(options), options.trust)
        number: int | None = options.variant
        if number is None and not trial.sweeps:
            return trial
        variants = expand_sweeps(trial)
        if number is None:
            raise InputError(
                f"{trial.name} has {len(variants)} variants in its sweeps; run one of them with --variant 1 to"
                f" {len(variants)} (crowdbot check lists them)"
            )
        if not trial.sweeps or not 1 <= number <= len(variants):
            count = len(variants) if trial.sweeps else "no"
            raise InputError(f"--variant {number}: {trial.name} has {count} variants")
        return variants[number - 1]

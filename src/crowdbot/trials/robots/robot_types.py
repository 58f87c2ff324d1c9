"""Types of robots: built-in robots, and robot folders next to a trial."""

from __future__ import annotations

import functools
from pathlib import Path

from crowdbot import world
from crowdbot.core import InputError, RobotError, did_you_mean, reads_only
from crowdbot.trials.fields import quote_value
from crowdbot.world import builtin_robots


def robot_folder_of(name: str, folder: Path | None, trust: bool) -> Path | None:
    """Return the robot folder next to the trial, None for a built-in robot.

    Raises:
        InputError: there is no robot of this name, or its folder lies outside the folder of the trial.
    """
    root = folder or Path.cwd()
    known = builtin_robots()
    try:
        place = (root / name).resolve()
        there = (place / "robot.xml").is_file()
    except (OSError, ValueError, RuntimeError):
        there = False
    if there and not trust and not place.is_relative_to(root.resolve()):
        raise InputError(
            f"type={quote_value(name)}: the robot lies outside {root.resolve()}; move its folder there, or pass"
            " --trust to allow it"
        )
    if there:
        return place
    if name in known:
        return None
    raise InputError(
        f"type={quote_value(name)} is not a robot{did_you_mean(name, known)}: no folder {name[:60]!r} with a robot.xml"
        f" is in {root.resolve()}; built-in robots are {', '.join(known)}"
    )


def robot_of_type(name: str, folder: Path | None, trust: bool) -> world.Robot:
    """Return the robot of a type.

    Raises:
        InputError: there is no such robot, or its folder has errors.
    """
    place = robot_folder_of(name, folder, trust)
    if place is None:
        return _load_builtin(name)
    return _load_folder(place, trust, (place / "robot.xml").stat().st_mtime_ns, reads_only())


@functools.cache
def _load_builtin(name: str) -> world.Robot:
    return world.Robot.load(_assets(name))


def _assets(name: str) -> Path:
    import importlib.resources

    return Path(str(importlib.resources.files("crowdbot").joinpath("assets", "robots", name)))


@functools.lru_cache(maxsize=16)
def _load_folder(place: Path, trust: bool, stamp: int, described: bool) -> world.Robot:
    try:
        return world.Robot.load(place, trust=trust)
    except RobotError as error:
        more = f" (and {len(error.problems) - 1} more; see crowdbot check)" if len(error.problems) > 1 else ""
        raise InputError(f"type={quote_value(place.name)}: {error.problems[0]}{more}") from None

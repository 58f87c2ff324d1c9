"""``crowdbot check TRIAL|ROBOT``: report all errors in trials, experiments and robots."""

from __future__ import annotations

import argparse
import dataclasses
import math
import types
from pathlib import Path
from typing import Any

from .output import add_json, print_json
from .settings import add_settings, load_settings_trial, settings

MOST_LINES = 20
MOST_VALUES = 4
"""Largest number of values of a field, such as the elevations of a lidar, that are printed one by one."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "names",
        metavar="FILE|NAME",
        nargs="+",
        help="trials, experiments, URDF files, robot folders or built-in names",
    )
    parser.add_argument("--trust", action="store_true", help="allow code and files outside the folder of each file")
    parser.add_argument(
        "--package",
        metavar="NAME=FOLDER",
        action="append",
        default=[],
        help="folder for package://NAME/ in URDF files",
    )
    add_settings(parser)
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Check each file; return 2 if one has errors."""
    from crowdbot.core import without_running_code

    packages = _packages(options.package)
    found: dict[str, dict[str, Any]] = {}
    with without_running_code():
        for name in options.names:
            row = _robot(name, options.trust, packages) if _is_robot(name) else _trial(name, options)
            found[name] = {"valid": not row["problems"], **row}
    if options.json:
        print_json(found)
    else:
        for name, row in found.items():
            _print(name, row)
    return 2 if any(row["problems"] for row in found.values()) else 0


def _packages(words: list[str]) -> dict[str, Path]:
    from crowdbot.core import InputError

    packages = {}
    for word in words:
        name, sign, folder = word.partition("=")
        if not (name and sign and Path(folder).is_dir()):
            raise InputError(f"--package {word!r} must be NAME=FOLDER with an existing folder")
        packages[name] = Path(folder)
    return packages


def _is_robot(name: str) -> bool:
    """Return whether a name is a robot: by extension, by content, or a built-in robot."""
    from crowdbot.world import builtin_robots

    path = Path(name)
    if path.suffix in (".urdf", ".xacro") or path.name == "robot.xml":
        return True
    if path.is_dir() and ((path / "robot.xml").exists() or any(path.glob("*.urdf"))):
        return True
    return name in builtin_robots() and not path.is_file()


def _trial(name: str, options: argparse.Namespace) -> dict[str, Any]:
    from crowdbot.core import InputError, TrialError
    from crowdbot.experiments import is_experiment, load_experiment
    from crowdbot.trials import (
        blind_remarks,
        builtin_trials,
        expand_sweeps,
        passage_remarks,
        robot_lines,
        trial_remarks,
    )

    if Path(name).is_dir():
        return {"problems": [f"{name} is a folder without robot.xml; give a trial, an experiment, a URDF or a robot"]}
    try:
        if is_experiment(name):
            load_experiment(name, trust=options.trust)
            return {"problems": []}
        if not Path(name).exists() and not Path(name).suffix and name not in builtin_trials():
            return {"problems": [_missing(name)]}
        trial = load_settings_trial(name, settings(options), options.trust)
    except TrialError as error:
        return {"problems": list(error.problems)}
    except InputError as error:
        return {"problems": [str(error)]}
    variants = [sweep.name for sweep in expand_sweeps(trial)] if trial.sweeps else []
    return {
        "problems": [],
        "robots": robot_lines([(trial.name, trial.robots)]),
        "remarks": [*trial_remarks(trial), *passage_remarks(trial), *blind_remarks(trial)],
        "variants": variants,
    }


def _missing(name: str) -> str:
    """Return that nothing has a name, with the nearest name of a trial, a robot or a robot folder."""
    from crowdbot.core import did_you_mean
    from crowdbot.trials import builtin_trials
    from crowdbot.world import builtin_robots

    known = [*builtin_trials(), *builtin_robots(), *(path.parent.name for path in Path().glob("*/robot.xml"))]
    return f"there is no trial, experiment, robot, file or folder {name!r:.200}{did_you_mean(name, known)}"


def _robot(name: str, trust: bool, packages: dict[str, Path]) -> dict[str, Any]:
    from crowdbot import sensors, world
    from crowdbot.core import InputError, RobotError
    from crowdbot.world import Robot, describe, read_urdf

    try:
        if Path(name).suffix in (".urdf", ".xacro"):
            return {"problems": [], "robot": describe(read_urdf(name, packages=packages))}
        robot = Robot.load(name, trust=trust)
    except RobotError as error:
        return {"problems": list(error.problems)}
    except InputError as error:
        return {"problems": [str(error)]}
    found = describe(robot.model, robot.posture) | {
        "footprint": robot.footprint.tolist(),
        "drive": _part_values(robot.drive, world.Drive, world),
        "latency": robot.latency,
        "sensors": {mount.name: _part_values(mount.sensor, sensors.Sensor, sensors) for mount in robot.mounts},
    }
    return {"problems": [], "robot": found, "remarks": list(robot.weak_motors)}


def _part_values(part: Any, contract: type, room: types.ModuleType) -> dict[str, Any]:
    """Return the type of a drive or a sensor, and its values with their units by the names of robot.xml."""
    from crowdbot.core import builtin_classes, builtin_name, field_units

    kind = type(part)
    units = field_units((kind, *builtin_classes(room, contract).values()))
    values = {
        field.name.replace("_", "-"): {"value": _plain(getattr(part, field.name)), "unit": units.get(field.name, "")}
        for field in dataclasses.fields(part)
    }
    known = builtin_classes(room, contract).get(builtin_name(kind, contract)) is kind
    return {"type": builtin_name(kind, contract) if known else kind.__name__, "values": values}


def _plain(value: Any) -> Any:
    """Return numbers, texts and lists of these as they are, and other values as the text that robot.xml has."""
    if isinstance(value, tuple | list):
        return [_plain(item) for item in value]
    return value if value is None or isinstance(value, bool | int | float | str) else str(value)


def _part_line(part: dict[str, Any]) -> str:
    """Return type and values of a drive or a sensor; what is empty or without a limit is left out."""
    words = [
        f"{name} {_text(row['value'])} {row['unit']}".rstrip()
        for name, row in part["values"].items()
        if row["value"] not in ([], "", None, math.inf)
    ]
    return f"{part['type']}{': ' if words else ''}{', '.join(words)}"


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, list) and len(value) > MOST_VALUES:
        return f"{len(value)} values from {_text(value[0])} to {_text(value[-1])}"
    return " ".join(map(_text, value)) if isinstance(value, list) else str(value)


def _print(name: str, row: dict[str, Any]) -> None:
    for problem in row["problems"]:
        print(problem)
    if "robot" in row:
        _print_robot(row["robot"])
    count = len(row["problems"])
    verdict = f"{count} error{'s' if count != 1 else ''}" if count else "OK"
    print(f"{Path(name).name}: {verdict}")
    for line in row.get("robots", ()):
        print(f"  {line}")
    for remark in row.get("remarks", ()):
        print(f"  note: {remark}")
    for k, variant in enumerate(row.get("variants", ()), 1):
        print(f"  {k:4d}  {variant}")


def _print_robot(row: dict[str, Any]) -> None:
    kinds = ", ".join(f"{count} {kind}" for kind, count in row["joint_kinds"].items()) or "none"
    x, y, z = row["center_of_mass"]
    moments = " ".join(f"{row['inertia'][k][k]:.4g}" for k in range(3))
    print(f"{row['name']}: root {row['root']}")
    print(f"  links   {row['links']}: {row['links_with_mass']} with mass, {row['links_that_touch']} with colliders")
    print(f"  joints  {row['joints']}: {kinds}; {row['joints_that_mimic']} mimic another joint")
    print(f"  mass    {row['mass']:.4g} kg, centre at {x:.3f} {y:.3f} {z:.3f} m, inertia {moments} kg m2")
    if row["footprint"]:
        size = " x ".join(f"{side:.3f}" for side in row["size"])
        print(f"  size    {size} m, footprint of {len(row['footprint'])} corners")
    else:
        print("  size    unknown: the robot has no colliders")
    print(f"  meshes  {len(row['meshes'])} read, {row['convex_pieces']} convex pieces")
    if "drive" in row:
        print(f"  drive   {_part_line(row['drive'])}; latency {row['latency']:g} s")
        for name, sensor in row["sensors"].items():
            print(f"  sensor  {name}: {_part_line(sensor)}")
    for kind in ("replaced", "repaired", "ignored", "noted"):
        for line in row[kind][:MOST_LINES]:
            print(f"  {kind:<8} {line}")
        if len(row[kind]) > MOST_LINES:
            print(f"  {kind:<8} ... and {len(row[kind]) - MOST_LINES} more (--json lists all)")

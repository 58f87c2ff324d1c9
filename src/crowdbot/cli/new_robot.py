"""``crowdbot new robot FILE``: convert a URDF or xacro file to a robot folder."""

from __future__ import annotations

import argparse
import re
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from crowdbot.world import RobotFolder

__all__ = ["add_robot_options", "convert_robot", "is_robot_file"]

ENDINGS = (".urdf", ".xacro", ".xml", ".gazebo")
MOST_ROWS = 60


def add_robot_options(parser: argparse.ArgumentParser) -> None:
    """Declare the options of a robot from a file."""
    group = parser.add_argument_group("robot from a URDF or xacro file")
    group.add_argument("--out", type=Path, metavar="DIR", help="robot folder to write (default: name of the robot)")
    for option, metavar, text in (
        ("--package", "NAME=FOLDER", "folder of a package that the file names"),
        ("--arg", "NAME:=VALUE", "argument of the xacro file"),
        ("--env", "NAME=VALUE", "environment variable of the xacro file"),
    ):
        group.add_argument(option, metavar=metavar, action="append", default=[], help=text)
    group.add_argument("--base", default="", metavar="KIND", help="kind of base (default: recognized)")


def is_robot_file(path: Path) -> bool:
    """Return whether a path is an existing robot file."""
    return path.is_file() and path.suffix.lower() in ENDINGS


def convert_robot(options: argparse.Namespace) -> int:
    """Write the robot folder and a trial, and print what was recognized."""
    from crowdbot.core import InputError
    from crowdbot.world import Robot, import_robot

    out = options.out or Path(_robot_name(options.file))
    if not re.fullmatch(r"[A-Za-z][\w-]*", out.name, re.ASCII):
        raise InputError(f"{out.name!r} is not a valid robot name; give --out with letters, digits, - and _")
    trial = out.parent / f"{out.name}-hall.xml"
    for path in (out, trial):
        if path.exists() and not options.force:
            raise InputError(f"{path} already exists; give another --out, or --force to replace it")
    if not out.parent.is_dir():
        raise InputError(f"the folder {out.parent} of {out.name} does not exist")
    packages = {name: Path(folder) for name, folder in _pairs(options.package, "=", "--package").items()}
    for name, folder in packages.items():
        if not folder.is_dir():
            raise InputError(f"--package {name}={folder} must name an existing folder")
    made = import_robot(
        options.file,
        out.name,
        packages=packages,
        arguments=_pairs(options.arg, ":=", "--arg"),
        environment=_pairs(options.env, "=", "--env"),
        kind=options.base,
    )
    _write_folder(out, made)
    robot = Robot.load(out)
    _write_text(trial, _trial(out.name, robot.radius))
    _print(made)
    print(f"\ncheck it    crowdbot check {out}")
    print(f"look at it  crowdbot render {trial} --out {out.name}.png")
    print(f"run it      crowdbot run {trial}")
    return 0


def _robot_name(path: Path) -> str:
    name = path.name.partition(".")[0]
    return re.sub(r"[^\w-]", "_", name, flags=re.ASCII)


def _pairs(words: list[str], sign: str, option: str) -> dict[str, str]:
    from crowdbot.core import InputError

    found = {}
    for word in words:
        name, has, value = word.partition(sign)
        if not (name and has):
            raise InputError(f"{option} {word!r} must be NAME{sign}VALUE")
        found[name] = value
    return found


def _write_folder(out: Path, made: RobotFolder) -> None:
    """Write the folder beside its place first, so that no half of it remains after an error."""
    from crowdbot.core import InputError

    part = out.with_name(out.name + ".part")
    try:
        shutil.rmtree(part, ignore_errors=True)
        part.mkdir()
        for name, path in made.copies.items():
            (part / name).parent.mkdir(exist_ok=True)
            shutil.copyfile(path, part / name)
        for name, text in made.texts.items():
            (part / name).write_text(text, encoding="utf-8")
        if out.is_dir() and not out.is_symlink():
            if not (out / "robot.xml").is_file():
                raise InputError(f"{out} is not a robot folder and is not replaced; give another --out")
            shutil.rmtree(out)
        part.replace(out)
    except OSError as error:
        raise InputError(f"cannot write {out}: {error.strerror or error}") from None
    finally:
        shutil.rmtree(part, ignore_errors=True)
    print(f"wrote {out}")


def _write_text(path: Path, text: str) -> None:
    from crowdbot.core import InputError

    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"cannot write {path}: {error.strerror or error}") from None
    print(f"wrote {path}")


def _print(made: RobotFolder) -> None:
    rows = [("what", "value", "from", "change it with"), *made.guesses[:MOST_ROWS]]
    widths = [max(len(row[k]) for row in rows) for k in range(3)]
    print()
    for row in rows:
        print("  ".join([*(row[k].ljust(min(widths[k], 48)) for k in range(3)), row[3]]).rstrip())
    if len(made.guesses) > MOST_ROWS:
        print(f"and {len(made.guesses) - MOST_ROWS} more")
    if made.remarks:
        print(f"\n{len(made.remarks)} remarks:")
        for remark in made.remarks[:20]:
            print(f"  - {remark}")


def _trial(name: str, radius: float) -> str:
    """Return a trial with the robot and five people in a hall."""
    width = 6.0 + 4.0 * radius
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<trial name="{name}-hall" duration="20">
  <stage walkable="0,0 16,0 16,{width:g} 0,{width:g}"/>
  <crowd type="orca"/>
  <agent name="ann" x="14" y="{0.5 * width:g}" goal="1,{0.5 * width:g}"/>
  <agent name="ben" x="13" y="{0.25 * width:g}" goal="1,{0.25 * width:g}"/>
  <agent name="eva" x="12" y="{0.75 * width:g}" goal="1,{0.75 * width:g}"/>
  <agent name="tom" x="8" y="1" goal="8,{width - 1:g}"/>
  <agent name="zoe" x="9" y="{width - 1:g}" goal="9,1"/>
  <robot type="{name}" x="{1.0 + radius:g}" y="{0.5 * width:g}" sensor-rates="nearest">
    <goal x="{15.0 - radius:g}" y="{0.5 * width:g}"/>
    <navigator type="orca"/>
  </robot>
</trial>
"""

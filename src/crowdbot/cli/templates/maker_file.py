"""``crowdbot new robot FILE``: a maker's robot file becomes a robot folder and a trial."""

from __future__ import annotations

import argparse
import math
import re
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crowdbot.cli.output import add_json, note, print_json
from crowdbot.cli.settings import settings

if TYPE_CHECKING:
    from crowdbot.cli.parser import CommandParser
    from crowdbot.world import DriveTest, Guess, Robot, RobotFolder


ENDINGS = (".urdf", ".xacro", ".xml", ".sdf")
MOST_ROWS = 60
MOST_REMARKS = 20
WIDTH = 48
NAMES_AND_NUMBERS = re.compile(r"'[^']*'|\S*[/\d]\S*")
"""What differs between remarks of one kind: quoted names, files with lines, and numbers."""


def add_robot_options(parser: CommandParser) -> None:
    """Declare the options of a robot from a file."""
    group = parser.add_rare_group("robot from a URDF, xacro or SDF file")
    group.add_argument("--out", type=Path, metavar="DIR", help="robot folder to write (default: name of the robot)")
    for option, metavar, text in (
        ("--package", "NAME=FOLDER", "folder of a package that the file names"),
        ("--arg", "NAME:=VALUE", "argument of the xacro file"),
        ("--env", "NAME=VALUE", "environment variable of the xacro file"),
    ):
        group.add_argument(option, metavar=metavar, action="append", default=[], help=text)
    group.add_argument(
        "--controllers",
        type=Path,
        metavar="FILE",
        action="append",
        default=[],
        help="YAML file with parameters of ROS controllers (default: named by the robot file, or in its package)",
    )
    group.add_argument("--base", default="", metavar="KIND", help="kind of base (default: recognized)")
    group.add_argument("--yes", action="store_true", help="confirm all values of the table without a question")
    add_json(parser)


def is_robot_file(path: Path) -> bool:
    """Return whether a path is a robot file to convert, not the name of a new robot folder.

    Raises:
        InputError: the path ends as a robot file, but there is none, or it is another file.
    """
    from crowdbot.core import InputError

    if path.suffix.lower() not in ENDINGS:
        if path.is_file():
            raise InputError(f"{path} is no robot file; its name must end with one of {', '.join(ENDINGS)}")
        return False
    if not path.is_file():
        raise InputError(f"there is no robot file {path}")
    return True


def convert_robot(options: argparse.Namespace) -> int:
    """Write the robot folder and a trial, and print what was recognized."""
    from crowdbot.core import InputError
    from crowdbot.world import Robot, drive_tests

    out = options.out or Path(_robot_name(options.file))
    if not re.fullmatch(r"[A-Za-z][\w-]*", out.name, re.ASCII):
        raise InputError(f"{out.name!r} is not a valid robot name; give --out with letters, digits, - and _")
    trial = out.parent / f"{out.name}-hall.xml"
    for path in (out, trial):
        if path.exists() and not options.force:
            raise InputError(f"{path} already exists; give another --out, or --force to replace it")
    if not out.parent.is_dir():
        raise InputError(f"the folder {out.parent} of {out.name} does not exist")
    made, confirmed = _confirm(options, out.name)
    _write_folder(out, made)
    robot = Robot.load(out)
    _write_text(trial, _hall(out.name, robot))
    tests = drive_tests(robot)
    if options.json:
        print_json(_summary(made, out, trial, confirmed) | {"drives": [test._asdict() for test in tests]})
        return 0
    print(f"wrote {out}\nwrote {trial}")
    _print_drives(tests)
    print(f"\ncheck it    crowdbot check {out}")
    print(f"look at it  crowdbot render {trial} --out {out.name}.png")
    print(f"run it      crowdbot run {trial}")
    print(f"film it     crowdbot render {trial} --out {out.name}.mp4")
    return 0


def _confirm(options: argparse.Namespace, name: str) -> tuple[RobotFolder, bool]:
    """Return the robot folder and whether its values are confirmed; ask at a terminal until they are.

    Raises:
        InputError: a value is invalid, or the user leaves.
    """
    from crowdbot.core import InputError

    values = settings(options)
    made = _import(options, name, values)
    confirmed = options.yes or not any(guess.open for guess in made.guesses)
    if options.json:
        return made, confirmed
    _print_table(made)
    if confirmed or not (sys.stdin.isatty() and sys.stdout.isatty()):
        if not confirmed:
            note("values marked with ? are not from the file; change them with --set NAME=VALUE, confirm with --yes")
        return made, confirmed
    while True:
        try:
            answer = input("\nEnter confirms all values, NAME=VALUE changes one, q leaves: ").strip()
        except (EOFError, KeyboardInterrupt):
            answer = "q"
        if answer in ("q", "quit"):
            raise InputError("nothing was written")
        if not answer:
            return made, True
        try:
            changed = values | _pairs([answer], "=", "the answer")
            made, values = _import(options, name, changed), changed
            _print_table(made)
        except InputError as error:
            print(error)


def _import(options: argparse.Namespace, name: str, values: dict[str, str]) -> RobotFolder:
    from crowdbot.core import InputError
    from crowdbot.world import import_robot

    packages = {name: Path(folder) for name, folder in _pairs(options.package, "=", "--package").items()}
    for package, folder in packages.items():
        if not folder.is_dir():
            raise InputError(f"--package {package}={folder} must name an existing folder")
    return import_robot(
        options.file,
        name,
        packages=packages,
        arguments=_pairs(options.arg, ":=", "--arg"),
        environment=_pairs(options.env, "=", "--env"),
        kind=options.base,
        controllers=options.controllers,
        values=values,
    )


def _robot_name(path: Path) -> str:
    """Return the name of a file as the name of a robot, which begins with a letter."""
    name = re.sub(r"[^\w-]", "_", path.name.partition(".")[0], flags=re.ASCII)
    return re.sub(r"^[^A-Za-z]+", "", name) or "robot"


def _pairs(words: list[str], sign: str, option: str) -> dict[str, str]:
    from crowdbot.core import InputError

    pairs = {}
    for word in words:
        name, has, value = word.partition(sign)
        if not (name and has):
            raise InputError(f"{option} {word[:80]!r} must be NAME{sign}VALUE")
        pairs[name.strip()] = value.strip()
    return pairs


def _write_folder(out: Path, made: RobotFolder) -> None:
    """Write the folder beside its place first, so that no half of it remains after an error."""
    from crowdbot.core import InputError

    part = out.with_name(out.name + ".part")
    try:
        shutil.rmtree(part, ignore_errors=True)
        part.mkdir()
        for name, path in made.copies.items():
            (part / name).parent.mkdir(exist_ok=True, parents=True)
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


def _write_text(file: Path, text: str) -> None:
    from crowdbot.core import InputError

    try:
        file.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError(f"cannot write {file}: {error.strerror or error}") from None


def _print_table(made: RobotFolder) -> None:
    """Print the table, those values first that are to be confirmed."""
    guesses = _join_alike(sorted(made.guesses, key=lambda guess: not guess.open))
    rows = [("", "what", "value", "from", "change it with")]
    rows += [_row(guess) for guess in guesses[:MOST_ROWS]]
    widths = [max(len(row[k]) for row in rows) for k in range(4)]
    for row in rows:
        print("  ".join([*(row[k].ljust(min(widths[k], WIDTH)) for k in range(4)), row[4]]).rstrip())
    if len(guesses) > MOST_ROWS:
        print(f"and {len(guesses) - MOST_ROWS} more, in import.json of the robot folder")
    if made.remarks:
        print(f"\n{len(made.remarks)} remarks:")
        kinds: dict[str, list[str]] = {}
        for remark in made.remarks:
            kinds.setdefault(NAMES_AND_NUMBERS.sub("", remark), []).append(remark)
        for alike in list(kinds.values())[:MOST_REMARKS]:
            print(f"  - {alike[0]}{f' ({len(alike) - 1} more like it)' if len(alike) > 1 else ''}")
        left = sum(len(alike) for alike in list(kinds.values())[MOST_REMARKS:])
        if left or len(made.remarks) > len(kinds):
            print(f"  - {f'and {left} more; ' if left else ''}all remarks are in import.json of the robot folder")
    print()


def _print_drives(tests: Sequence[DriveTest]) -> None:
    """Print the speeds that the robot reaches, and what is wrong with its motion."""
    worlds = {"planar": "in the plane", "physics": "in the physics world"}
    after = ("after 2 s ", *("" for _ in tests))
    speeds = [
        f"{round(test.speed, 2) + 0.0:.2f} m/s {when}{worlds[test.world]}"
        for when, test in zip(after, tests, strict=False)
    ]
    print(f"drives: {', '.join(speeds)}")
    for test in tests:
        if test.problem:
            print(f"warning: {worlds[test.world]}, {test.problem}")


def _join_alike(guesses: Sequence[Guess]) -> list[Guess]:
    """Return the values with one row for three or more joints or links with the same value from the same source."""
    alike: dict[tuple[str, ...], list[Guess]] = {}
    for guess in guesses:
        what, _, name = guess.what.rpartition(" ")
        alike.setdefault((what or name, *guess[1:]), []).append(guess)
    joined: list[Guess] = []
    for rows in alike.values():
        many = len(rows) > 2
        joined += [rows[0]._replace(what=f"{rows[0].what} and {len(rows) - 1} more")] if many else rows
    return joined


def _row(guess: Guess) -> tuple[str, str, str, str, str]:
    source = f"{guess.status}: {guess.source}" if guess.open else guess.source
    return ("?" if guess.open else "", guess.what, guess.value, source, guess.change)


def _summary(made: RobotFolder, out: Path, trial: Path, confirmed: bool) -> dict[str, Any]:
    return {
        "folder": str(out),
        "trial": str(trial),
        "kind": made.kind,
        "mass": made.mass,
        "confirmed": confirmed,
        "table": [guess._asdict() for guess in made.guesses],
        "remarks": list(made.remarks),
    }


def _hall(name: str, robot: Robot) -> str:
    """Return a trial with the robot and people who walk up and down a hall that it crosses at its own speed."""
    radius, speed = robot.radius, float(getattr(robot.drive, "max_speed", 1.0))
    width = 6.0 + 4.0 * radius
    length = min(18.0, max(9.0, math.ceil(4.0 + 2.0 * radius + 24.0 * speed)))
    begin, end = 2.5 + radius, length - 1.0 - radius
    duration = max(20.0, min(600.0, math.ceil(1.5 * (end - begin) / max(speed, 0.01) + 5.0)))
    back, high = 1.4 + 1.5 * radius, 1.0 + radius
    zones = [f"{x:g},1 {x + 1:g},1 {x + 1:g},{width - 1:g} {x:g},{width - 1:g}" for x in (1.0, length - 2.0)]
    west, east = (f'<zone points="{zone}" aim="random"/>' for zone in zones)
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<trial name="{name}-hall" duration="{duration:g}">
  <stage walkable="0,0 {length:g},0 {length:g},{width:g} 0,{width:g}"/>
  <crowd type="orca"/>
  <journey name="west" then="again">{west}{east}</journey>
  <journey name="east" then="again">{east}{west}</journey>
  <agent name="ann" x="{length - 2:g}" y="{0.5 * width:g}" journey="west" body="woman"/>
  <agent name="ben" x="{length - 3:g}" y="{0.3 * width:g}" journey="west" body="man"/>
  <agent name="eva" x="{length - 4:g}" y="{0.7 * width:g}" journey="west" body="woman"/>
  <agent name="tom" x="{0.5 * length:g}" y="1" journey="east" body="man"/>
  <agent name="zoe" x="{0.5 * length + 1:g}" y="{width - 1:g}" journey="east" body="woman"/>
  <robot name="{name}" type="{name}" x="{begin:g}" y="{0.5 * width:g}" sensor-rates="nearest">
    <goal x="{end:g}" y="{0.5 * width:g}"/>
    <navigator type="orca"/>
  </robot>
  <camera name="behind" robot="{name}" x="{-back:g}" z="{high:g}" pitch="{math.atan2(0.6 * high, back + 1.0):.3g}"/>
</trial>
"""

"""Import robots of many makers, drive them in both worlds, and compare them with data sheets.

    python studies/makers_robots.py CHECKOUTS --keep OUT --page docs/results/makers-robots.md

CHECKOUTS holds a clone of each repository of ``makers_robots.toml`` at its commit, as CHECKOUTS/OWNER/NAME; a robot
whose repository is missing is a row that says so, with the commands that fetch it. Each robot goes through ``crowdbot
new robot FILE --yes --json``. OUT receives the robot folders and the result of each robot as JSON; the same command
continues there, also after Ctrl-C. The pair of ``[together]`` then crosses a hall in one trial of the physics world.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from checkouts import BRIEF, call, check_fields, missing_file, read_toml, write_page
from crowdbot.cli.output import progress
from crowdbot.core import CrowdbotError, InputError, explain_write_errors
from crowdbot.simulation import simulate
from crowdbot.trials import load_trial

LIST = Path(__file__).with_suffix(".toml")
FIELDS = {"name", *BRIEF, "arguments", "packages", "base", "speed", "mass", "source"}
NEAR = 0.2
"""Largest relative difference from a data sheet that is no miss."""
ARRIVED = 0.3
"""Distance from its goal [m] at which a robot has arrived."""
HEAD = """# Robots of other makers

{count} robot files of makers, as `crowdbot new robot FILE --yes` reads them, beside the makers' data sheets. Apart from
the folders of other packages, nothing is given by hand. Made by

```
{command}
```

`CHECKOUTS` has the repositories at the commits below. *Speed* and *mass* are those of the robot folder; `?` marks a
value that the import guesses or doubts, so that its table asks for it. *Plane* and *physics* are the speeds after two
seconds of full speed ahead; `!` marks a warning. Empty cells: no figure of the maker was found.
"""
TOGETHER = """<trial name="together" duration="{duration:g}" step="0.02" world="physics" seed="1">
  <stage walkable="-9,-5 9,-5 9,5 -9,5"/>
  <crowd type="orca"/>
  <robot name="first" type="{first}" x="-6" y="1.5"><goal x="5" y="1.5"/><navigator type="orca"/></robot>
  <robot name="second" type="{second}" x="6" y="-1.5" heading="180">
    <goal x="-5" y="-1.5"/><navigator type="orca"/>
  </robot>
</trial>
"""
GOALS = ((5.0, 1.5), (-5.0, -1.5))
DURATION = 60.0


class MakerRobot(NamedTuple):
    """A robot file of a maker and what the maker says of the robot.

    Fields:
        name: name of the robot.
        repository, commit, file: ``OWNER/NAME`` on GitHub, commit, and path there.
        arguments: xacro arguments.
        packages: paths ``OWNER/NAME/FOLDER`` of other packages by name.
        base, speed, mass, source: kind of base, maximum speed [m/s] and mass [kg] of the data sheet, and what it is.
    """

    name: str
    repository: str
    commit: str
    file: str
    arguments: dict[str, str] = {}  # noqa: RUF012, never changed
    packages: dict[str, str] = {}  # noqa: RUF012, never changed
    base: str = ""
    speed: float | None = None
    mass: float | None = None
    source: str = ""

    @property
    def folder(self) -> str:
        """Name of its robot folder."""
        return re.sub(r"\W+", "-", self.name).strip("-").lower()


def read_robots(file: Path = LIST) -> tuple[list[MakerRobot], tuple[str, str]]:
    """Return the robots of a TOML file, and the names of the pair that shares a trial.

    Raises:
        InputError: the file cannot be read, or a robot lacks a field or has an unknown one.
    """
    table = read_toml(file)
    robots: list[MakerRobot] = []
    for row in table.get("robot", []):
        place = f"{file}: the robot {str(row.get('name', len(robots) + 1))!r}"
        check_fields(row, ("name", *BRIEF), FIELDS, place)
        robots.append(MakerRobot(**row))
    pair = tuple(table.get("together", {}).get("robots", ()))
    names = [robot.name for robot in robots]
    if len(pair) != 2 or not set(pair) <= set(names):
        raise InputError(f"{file}: 'robots' of [together] must be two of {', '.join(names)}")
    return robots, (pair[0], pair[1])


def import_robot(robot: MakerRobot, checkouts: Path, keep: Path) -> dict[str, Any]:
    """Return what the command ``new robot`` says of a robot, or ``{"refused": REASON}``."""
    file = checkouts / robot.repository / robot.file
    if not file.is_file():
        return {"refused": missing_file(file, checkouts, robot.repository, robot.commit)}
    words = ["new", "robot", str(file), "--out", str(keep / robot.folder), "--yes", "--json", "--force"]
    for key, value in robot.arguments.items():
        words += ["--arg", f"{key}:={value}"]
    for name, path in robot.packages.items():
        words += ["--package", f"{name}={checkouts / path}"]
    code, told, wrong = call(words)
    if code:
        return {"refused": wrong.strip().replace(f"{checkouts}/", "").removeprefix("crowdbot: ")}
    return dict(json.loads(told))


def drive_together(first: str, second: str, keep: Path) -> dict[str, Any]:
    """Return how near two robot folders of ``keep`` come to their goals in one trial of the physics world [m]."""
    file = keep / "together.xml"
    with explain_write_errors(file):
        file.write_text(TOGETHER.format(first=first, second=second, duration=DURATION), encoding="utf-8")
    episode = simulate(load_trial(file))
    ends = []
    for agent, goal in zip(episode.robots, GOALS, strict=True):
        away = np.linalg.norm(episode.position[:, agent] - np.array(goal), axis=1)
        arrived = np.flatnonzero(away < ARRIVED)
        ends.append({
            "nearest": round(float(away.min()), 3),
            "seconds": round(float(episode.times[arrived[0]]), 2) if len(arrived) else None,
        })  # fmt: skip
    return {"robots": [first, second], "outcome": episode.outcome, "ends": ends}


def guess_of(result: dict[str, Any], what: str) -> dict[str, str]:
    """Return a row of the table of an import, empty if there is none."""
    return next((row for row in result.get("table", ()) if row["what"] == what), {})


def misses(robot: MakerRobot, result: dict[str, Any]) -> list[str]:
    """Return in what a robot differs from its data sheet or does not drive, as sentences."""
    if "refused" in result:
        return [f"refused: {result['refused']}"]
    found = []
    if robot.base and robot.base != result["kind"]:
        found.append(
            f"base {result['kind']} ({guess_of(result, 'kind of base')['source']}), the maker has {robot.base}"
        )
    for what, value, sheet, unit in (
        ("max-speed", _speed(result), robot.speed, "m/s"), ("mass", float(result["mass"]), robot.mass, "kg"),
    ):  # fmt: skip
        if sheet is not None and abs(value - sheet) > NEAR * sheet:
            row = guess_of(result, what)
            found.append(f"{what} {value:.3g} {unit} ({row['status']}: {row['source']}), the maker has {sheet:g}")
    for test in result["drives"]:
        if test["problem"]:
            cause = next((f": {remark}" for remark in result["remarks"] if remark.startswith("the effort of")), "")
            where = "plane" if test["world"] == "planar" else "physics world"
            found.append(f"in the {where}, {test['problem']}{cause}")
    return found


def _speed(result: dict[str, Any]) -> float:
    return float(guess_of(result, "max-speed")["value"].split()[0])


def page(robots: Sequence[MakerRobot], results: dict[str, dict[str, Any]], pair: dict[str, Any], command: str) -> str:
    """Return the page as Markdown."""
    rows = [["robot", "base", "maker", "speed [m/s]", "maker", "mass [kg]", "maker", "plane", "physics"]]
    rows += [_row(robot, results[robot.name]) for robot in robots if robot.name in results]
    done = [robot for robot in robots if "refused" not in results.get(robot.name, {"refused": ""})]
    upright = [robot for robot in done if not any(test["problem"] for test in results[robot.name]["drives"])]
    parts = [HEAD.format(count=len(rows) - 1, command=command).strip()]
    parts.append(f"{len(upright)} of {len(rows) - 1} drive in both worlds without a warning.")
    parts += [
        "## Table",
        _table(rows),
        "## Misses",
        f"Differences of more than {100 * NEAR:.0f} %, and what does not drive:",
    ]
    listed = [(robot.name, misses(robot, results[robot.name])) for robot in robots if robot.name in results]
    parts.append("\n".join(f"* {name}: {'; '.join(found)}." for name, found in listed if found) or "None.")
    lost = [name for name, result in results.items() if any("mesh file" in text and "is missing" in text
                                                            for text in result.get("remarks", ()))]  # fmt: skip
    if lost:
        parts.append(
            f"Meshes were missing in the checkouts of {'; '.join(lost)}: for contacts, such links have the box of equal"
            " inertia."
        )
    parts += ["## Two robots in one physics trial", _together(pair)]
    parts += ["## Files and data sheets", _table([["robot", "file", "data sheet"], *map(_origin, robots)])]
    return "\n\n".join(parts) + "\n"


def _row(robot: MakerRobot, result: dict[str, Any]) -> list[str]:
    sheet = ["" if value is None else f"{value:g}" for value in (robot.speed, robot.mass)]
    if "refused" in result:
        return [robot.name, "refused", robot.base, "", sheet[0], "", sheet[1], "", ""]
    cells = []
    for what, text in (
        ("kind of base", result["kind"]), ("max-speed", f"{_speed(result):.3g}"), ("mass", f"{result['mass']:.3g}"),
    ):  # fmt: skip
        doubt = guess_of(result, what).get("status") in ("guess", "doubtful")
        cells.append(f"{text} ?" if doubt else text)
    drives = {test["world"]: f"{test['speed']:.2f}{' !' if test['problem'] else ''}" for test in result["drives"]}
    ends = [drives.get("planar", ""), drives.get("physics", "")]
    return [robot.name, cells[0], robot.base, cells[1], sheet[0], cells[2], sheet[1], *ends]


def _origin(robot: MakerRobot) -> list[str]:
    url = f"https://github.com/{robot.repository}/blob/{robot.commit}/{robot.file}"
    return [robot.name, f"[{robot.repository}@{robot.commit[:8]}]({url})", robot.source]


def _together(pair: dict[str, Any]) -> str:
    if not pair:
        return "Not run: one of the two robots was refused."
    told = []
    for name, end in zip(pair["robots"], pair["ends"], strict=True):
        when = (
            f"reaches its goal after {end['seconds']:g} s" if end["seconds"] is not None else "does not reach its goal"
        )
        told.append(f"`{name}` {when} (nearest {end['nearest']:g} m)")
    return (
        f"With their meshes, both cross a hall in opposite directions: {', '.join(told)}. Outcome: {pair['outcome']}."
    )


def _table(rows: Sequence[Sequence[str]]) -> str:
    lines = [rows[0], ["---"] * len(rows[0]), *rows[1:]]
    return "\n".join(f"| {' | '.join(cell.replace('|', '/') for cell in line)} |" for line in lines)


def measure(robots: Sequence[MakerRobot], checkouts: Path, keep: Path, pair: tuple[str, str], again: bool) -> Any:
    """Return the results by name and that of the pair, from ``keep`` or new; Ctrl-C returns what is done."""
    results: dict[str, dict[str, Any]] = {}
    together: dict[str, Any] = {}
    with progress() as report:
        try:
            for number, robot in enumerate(robots):
                report(f"robot {robot.name}", number / len(robots))
                file = keep / f"{robot.folder}.json"
                if file.is_file() and not again:
                    results[robot.name] = json.loads(file.read_text(encoding="utf-8"))
                    continue
                results[robot.name] = import_robot(robot, checkouts, keep)
                if "refused" not in results[robot.name]:
                    file.write_text(json.dumps(results[robot.name], indent=1) + "\n", encoding="utf-8")
                report(f"robot {robot.name}", 1.0)
            folders = [robot.folder for name in pair for robot in robots if robot.name == name]
            if all("refused" not in results[name] for name in pair):
                together = drive_together(folders[0], folders[1], keep)
        except KeyboardInterrupt:
            print(f"stopped; {len(results)} robots are done, the same command continues", file=sys.stderr)
    return results, together


def main(words: Sequence[str] | None = None) -> int:
    """Import the robots, and print or write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("checkouts", type=Path, metavar="CHECKOUTS", help="folder of the repositories, as OWNER/NAME")
    add("--list", type=Path, default=LIST, metavar="FILE.toml", help="robots and data sheets (default: %(default)s)")
    add("--keep", type=Path, required=True, metavar="OUT", help="existing folder of robot folders and results")
    add("--again", action="store_true", help="import all robots again")
    add("--page", type=Path, metavar="FILE.md", help="page (default: standard output)")
    add("--json", action="store_true", help="print the results as JSON instead of Markdown")
    options = parser.parse_args(words)
    for folder in (options.checkouts, options.keep):
        if not folder.is_dir():
            parser.error(f"there is no folder {folder}")
    try:
        robots, pair = read_robots(options.list)
        results, together = measure(robots, options.checkouts, options.keep, pair, options.again)
        if options.json:
            told = {robot.name: {"misses": misses(robot, results[robot.name]), **results[robot.name]}
                    for robot in robots if robot.name in results}  # fmt: skip
            print(json.dumps({"robots": told, "together": together}, indent=1))
            return 0
        text = page(
            robots, results, together, "python studies/makers_robots.py CHECKOUTS --keep OUT --page makers-robots.md"
        )
        write_page(text, options.page)
    except CrowdbotError as error:
        parser.error(str(error))
    return 0


if __name__ == "__main__":
    sys.exit(main())

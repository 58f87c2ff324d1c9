"""Measurement of drives over robots, time steps and manoeuvres; robots may come from the files of their makers."""

from __future__ import annotations

import contextlib
import re
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from crowdbot.benchmark.speed.timing import environment
from crowdbot.world import Robot, builtin_robots, import_robot

from .figures import DriveFigures, compare_traces
from .traces import DriveTrace, Manoeuvre, Run, TraceStore, manoeuvres


@contextlib.contextmanager
def maker_robot(file: Path) -> Iterator[tuple[Robot, str]]:
    """Import a robot as ``crowdbot new robot FILE --yes`` does, and yield it with its kind of base.

    Its folder exists only inside the context.

    Args:
        file: URDF, xacro or SDF file of a whole robot.

    Raises:
        RobotError: the file has errors, or has no mass.
        InputError: the file is missing, or a controller file beside it cannot be read.

    >>> from importlib.resources import files
    >>> with maker_robot(files("crowdbot") / "assets/robots/turtlebot2/turtlebot2.urdf") as (robot, kind):
    ...     print(robot.name, kind)
    turtlebot2 differential
    """
    name = re.sub(r"[^\w-]", "_", file.name.partition(".")[0], flags=re.ASCII).lstrip("_-0123456789") or "robot"
    with tempfile.TemporaryDirectory() as place:
        made = import_robot(file, name)
        folder = Path(place) / name
        folder.mkdir()
        for path, source in made.copies.items():
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, folder / path)
        for path, text in made.texts.items():
            (folder / path).write_text(text, encoding="utf-8")
        yield Robot.load(folder), made.kind


STEPS = (0.001, 0.002, 0.005, 0.01, 0.02)
"""Time steps of the engine [s]."""
BARRED = (0.002, 0.005, 0.01)
"""Time steps [s] at which :data:`DRIVE_BARS` hold."""
DRIVE_BARS: Mapping[str, float] = {
    "overshoot": 0.05, "steady_error": 0.02, "acceleration": 1.1, "turn_acceleration": 1.1, "path_error": 0.02,
    "heading_error": 0.02,
}  # fmt: skip
"""Largest figures over the grid of a robot."""
STRAIGHT = 0.2
"""Largest heading change [rad] beside the planar one, alone in a hall."""
REGULAR = ("grid", "straight", "ramp", "sine", "weave")
"""Manoeuvres on a floor with normal friction."""


@dataclass(frozen=True)
class DriveRow:
    """Figures of one robot at one time step.

    Fields:
        robot: name of the robot.
        base: actuation in the physics world, ``wheels`` or ``planar`` (pulled); of other makers, the kind of base.
        step: time step of the engine [s].
        grid: largest figures over the grid of speeds.
        others: figures by manoeuvre.
    """

    robot: str
    base: str
    step: float
    grid: DriveFigures
    others: dict[str, DriveFigures]

    @property
    def failures(self) -> tuple[str, ...]:
        """Names of the figures that exceed their bars, of falls, and of heading changes."""
        found = [name for name, most in DRIVE_BARS.items() if getattr(self.grid, name) > most]
        regular = [self.grid, *(self.others[name] for name in REGULAR if name in self.others)]
        if any(item.fallen for item in regular):
            found.append("fall")
        if any(item.heading_change > STRAIGHT for item in regular[1:]):
            found.append("heading_change")
        return tuple(found)

    def as_dict(self) -> dict[str, Any]:
        """Return the row as plain values."""
        others = {name: other.as_dict() for name, other in self.others.items()}
        words = {"robot": self.robot, "base": self.base, "step": self.step}
        return {**words, "grid": self.grid.as_dict(), "others": others, "failures": list(self.failures)}


@dataclass(frozen=True)
class DriveReport:
    """Result of the drive laboratory.

    Fields:
        machine: processor, system and versions.
        rows: figures by robot and time step.
        traces: manoeuvres with both motions by robot, at the time step nearest to 5 ms, for plots.
        makers: figures of robots of other makers, on the quick grid; their base is the kind of base.
    """

    machine: str
    rows: tuple[DriveRow, ...]
    traces: dict[str, tuple[tuple[Manoeuvre, DriveTrace, DriveTrace], ...]]
    makers: tuple[DriveRow, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """Return machine, bars and rows as plain values."""
        rows, makers = [row.as_dict() for row in self.rows], [row.as_dict() for row in self.makers]
        return {"machine": self.machine, "bars": dict(DRIVE_BARS), "rows": rows, "makers": makers}


def measure_drives(
    robots: Sequence[str] | None = None,
    *,
    steps: Sequence[float] | None = None,
    quick: bool = False,
    makers: Sequence[Path] = (),
    keep: Path | None = None,
    report: Callable[[str, float], None] | None = None,
) -> DriveReport:
    """Drive robots alone in an empty hall, in the plane and in the physics world, and compare the motions.

    Args:
        robots: built-in names or folders of robots (default: all built-in robots).
        steps: time steps of the engine [s] (default: 1, 2, 5, 10 and 20 ms, or 5 ms if quick). The whole grid is driven
            at 2, 5 and 10 ms, the quick one at others.
        quick: three speeds and short manoeuvres.
        makers: robot files of other makers, imported as by ``crowdbot new robot FILE --yes``, and driven over the
            quick grid at the steps for which the bars hold.
        keep: folder of the motions by robot and time step; those that it has are not measured again (default: none).
        report: called with the robot and the share that is done.

    Raises:
        RobotError: a robot does not exist or has errors.
        InputError: a time step does not divide 20 ms.
        MissingExtra: mujoco is not installed.
        OutputError: a file in ``keep`` cannot be written.

    >>> row = measure_drives(["differential"], quick=True).rows[0]
    >>> row.failures, row.grid.overshoot < 0.05
    ((), True)
    """
    steps = tuple(steps) if steps else (0.005,) if quick else STEPS
    loaded = [Robot.load(name) for name in (builtin_robots() if robots is None else robots)]
    shown = min(steps, key=lambda step: abs(step - 0.005))
    store = TraceStore(keep)
    found = tuple(_measure_makers(store, makers, [step for step in steps if step in BARRED] or list(steps), report))
    rows, traces = [], {}
    for number, robot in enumerate(loaded):
        for k, step in enumerate(steps):
            if report is not None:
                report("drives", (number + k / len(steps)) / len(loaded))
            few = quick or all(abs(step - item) > 1e-9 for item in BARRED)
            runs = store.runs(robot, step, manoeuvres(robot, few))
            rows.append(_row(robot, step, runs))
            if step == shown:
                traces[robot.name] = runs
    if report is not None:
        report("drives", 1.0)
    return DriveReport(environment(), tuple(rows), traces, found)


def _measure_makers(
    store: TraceStore, files: Sequence[Path], steps: Sequence[float], report: Callable[[str, float], None] | None
) -> Iterator[DriveRow]:
    for number, file in enumerate(files):
        with maker_robot(Path(file)) as (robot, kind):
            for step in steps:
                if report is not None:
                    report(f"drives of {robot.name}", number / len(files))
                grid = [manoeuvre for manoeuvre in manoeuvres(robot, quick=True) if manoeuvre.name in REGULAR]
                yield replace(_row(robot, step, store.runs(robot, step, grid)), base=kind)


def _row(robot: Robot, step: float, runs: Sequence[Run]) -> DriveRow:
    grid, others = DriveFigures(), {}
    for item, physics, plane in runs:
        found = compare_traces(robot.drive, item, physics, plane)
        if item.name == "grid":
            grid = grid.worst(found)
        else:
            others[item.name] = found
    return DriveRow(robot.name, robot.base, step, grid, others)

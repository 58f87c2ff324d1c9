"""Documentation page of the drive laboratory."""

from __future__ import annotations

from pathlib import Path

from crowdbot.core import explain_write_errors

from .figures import DriveFigures
from .laboratory import BARRED, DRIVE_BARS, REGULAR, STEPS, STRAIGHT, DriveReport, DriveRow
from .plots import plot_drives

__all__ = ["DRIVE_COLUMNS", "grid_cells", "write_drives_page"]

DRIVE_COLUMNS = (
    ("overshoot", "overshoot [%]"), ("steady_error", "steady [%]"), ("acceleration", "acc. [%]"),
    ("turn_acceleration", "turn acc. [%]"), ("path_error", "path [%]"), ("heading_error", "heading [rad/rad]"),
    ("stop_error", "stop [mm]"), ("tilt", "tilt [rad]"),
)  # fmt: skip
"""Figures of the grid with their headers in tables."""
SCALES = {"overshoot": 100.0, "steady_error": 100.0, "acceleration": 100.0, "turn_acceleration": 100.0,
          "path_error": 100.0, "stop_error": 1000.0}  # fmt: skip
DIGITS = {"acceleration": 0, "turn_acceleration": 0, "heading_error": 4, "stop_error": 1, "tilt": 4}
HEAD = """# Drives in the physics world

A robot drives alone in an empty hall, in the plane and in the physics world, with the same commands. The plane moves it
exactly as its drive says. Made by

```
{command}
```

Grid: speeds and turn rates of -100, -50, 0, 50 and 100 % of the limits of the drive in all combinations, for
omnidirectional robots also sideways. Each is a step from rest, held for 2 s, and a stop. The tables have the largest
figure over the grid. *Overshoot* and *steady* error are shares of the speed asked for (at least of a tenth of the
limit); *acc.* and *turn acc.* the largest accelerations over 0.04 s by those declared, or by the planar one if that is
larger (a skid-steer base slides outwards); overshoot is measured in the same way; *path* the largest distance from the
planar position by the distance driven; *heading* the largest difference by the angle turned; *stop* the difference of
the stop distances; *tilt* the largest angle from the vertical. At 1 and 20 ms, only full speed, full turn rate and both
are driven.

Bars at 2, 5 and 10 ms: overshoot {overshoot:.0f} %, steady error {steady:.0f} %, accelerations {acc:.0f} % of the
declared ones, path {path:.0f} %, heading {heading:g} rad per rad, at most {straight:g} rad of heading change beside the
planar one, no fall."""


def write_drives_page(report: DriveReport, file: Path, command: str = "crowdbot bench drives") -> list[Path]:
    """Write a Markdown page, with its plots in a folder of the same name, and return all files.

    Args:
        report: result of the laboratory.
        file: the page; its folder must exist.
        command: command to show on the page.

    Raises:
        OutputError: a file cannot be written.
    """
    folder = file.with_suffix("")
    with explain_write_errors(file):
        folder.mkdir(parents=True, exist_ok=True)
        plots = plot_drives(report, folder)
        file.write_text(_page(report, folder.name, command), encoding="utf-8")
    return [file, *plots]


def grid_cells(figures: DriveFigures) -> list[str]:
    """Return the figures of a grid as cells for :data:`DRIVE_COLUMNS`.

    >>> grid_cells(DriveFigures(overshoot=0.0123, tilt=0.001))
    ['1.23', '0.00', '0', '0', '0.00', '0.0000', '0.0', '0.0010']
    """
    return [f"{SCALES.get(name, 1.0) * getattr(figures, name):.{DIGITS.get(name, 2)}f}" for name, _ in DRIVE_COLUMNS]


def _page(report: DriveReport, folder: str, command: str) -> str:
    bars = {name: 100.0 * most for name, most in DRIVE_BARS.items()}
    head = HEAD.format(
        command=command,
        overshoot=bars["overshoot"],
        steady=bars["steady_error"],
        acc=bars["acceleration"],
        path=bars["path_error"],
        heading=DRIVE_BARS["heading_error"],
        straight=STRAIGHT,
    )
    parts = [head, _verdict(report), f"Machine: {report.machine}."]
    parts += ["## Over the grid", _rows_table("base", report.rows)]
    parts += ["## Step to full speed and turn rate, and stop", f"![Steps]({folder}/steps.png)"]
    parts += ["## Paths of the grid and of swerves", f"![Paths]({folder}/paths.png)"]
    if len({row.step for row in report.rows}) > 1:
        parts += ["## Time steps", f"![Largest errors over the time step]({folder}/time-steps.png)", DASHED]
    parts += ["## Straight, ramp, sine and swerves", _other_table(report), OTHERS]
    parts += ["## Slippery floor", f"![Turn rate in swerves]({folder}/slip.png)", SLIP, "## How it works", HOW]
    if report.makers:
        parts += ["## Robots of other makers", MAKERS]
        parts += [_rows_table("kind of base", report.makers), _misses(report.makers)]
    return "\n\n".join(parts) + "\n"


MAKERS = """Robots from files that cannot ship, as `crowdbot new robot FILE --yes` reads them, with the quick grid: full
speed, full turn rate, and both. Limits of a base that its file does not give are guesses of the import."""
DASHED = "Dashed: the bar. Wheels are servos with a time constant of 10 ms, or two steps if that is longer."
OTHERS = """Heading change is the difference of the sums of all changes of heading. *straight*: full speed for 10 s and
a stop; *ramp*: from rest to full speed in 10 s; *sine*: half speed, turn rate of half the limit like a sine of 4 s;
*weave*: full speed, half the largest turn rate, other side every second."""
SLIP = """The same swerves with a tenth of the friction: wheels slip, and the robot no longer follows. Bases that are
pulled (`base="planar"`) have no tyres and do not slip."""
HOW = """* A driven wheel is a servo within the torque of its motor. The solver finds the torques of the motors and the
  forces of the tyres together, so servos are stable at all time steps and with wheels in the air.
* Tyres touch the floor in one point and are firm; a tyre bears friction times load in any direction. The friction is
  that of the tyre times that of the floor. Castors glide without friction. Their own turning is not simulated.
* Tyres of skid-steer bases slide by Coulomb's law, against their slip at the end of each step.
* A planar base is moved by forces at its centre of mass: those of the commanded acceleration, and a correction of the
  velocity error with the same time constant as wheels. They are limited to 4 N and 1.5 N m for each kg.
* Robots feel contacts with mass and motor torque only: nothing else holds them on their paths.
* Qolo carries a standing driver, and its wheels would lift in fast curves: its drive limits speed times turn rate to
  1 m/s2 (assumed), in the plane as well."""


def _verdict(report: DriveReport) -> str:
    barred = [row for row in report.rows if any(abs(row.step - step) < 1e-9 for step in BARRED)]
    failed = [f"{row.robot} at {1000.0 * row.step:g} ms ({', '.join(row.failures)})" for row in barred if row.failures]
    if failed:
        return f"Not within the bars: {'; '.join(failed)}."
    names = len({row.robot for row in barred})
    return f"All figures of {names} {'robots' if names != 1 else 'robot'} are within the bars."


def _misses(rows: tuple[DriveRow, ...]) -> str:
    """Return a sentence about the figures of other makers' robots beyond the bars."""
    words = {"overshoot": "overshoot", "steady_error": "steady error", "acceleration": "acceleration",
             "turn_acceleration": "turn acceleration", "path_error": "path", "heading_error": "heading",
             "heading_change": "heading change", "fall": "fall"}  # fmt: skip
    missed: dict[str, list[str]] = {}
    for row in rows:
        for name in row.failures:
            found = missed.setdefault(row.robot, [])
            found += [words[name]] if words[name] not in found else []
    within = len({row.robot for row in rows}) - len(missed)
    listed = "; ".join(f"{robot}: {', '.join(found)}" for robot, found in missed.items())
    said = f"Within all bars at all steps: {within} {'robots' if within != 1 else 'robot'}."
    return said + (f" Beyond a bar at some step: {listed}." if listed else "")


def _rows_table(base: str, rows: tuple[DriveRow, ...]) -> str:
    head = ["robot", base, "step [ms]", *(title for _, title in DRIVE_COLUMNS)]
    return _table(head, [[row.robot, row.base, f"{1000.0 * row.step:g}", *grid_cells(row.grid)] for row in rows])


def _other_table(report: DriveReport) -> str:
    """Return the other manoeuvres at the time step nearest to 5 ms."""
    steps = {row.step for row in report.rows} or set(STEPS)
    shown = min(steps, key=lambda step: abs(step - 0.005))
    names = [*REGULAR[1:], "slip"]
    head = ["robot", *(f"{name}: path [%]" for name in names), *(f"{name}: heading change [rad]" for name in names)]
    return _table(head, [_other_cells(row, names) for row in report.rows if row.step == shown])


def _other_cells(row: DriveRow, names: list[str]) -> list[str]:
    paths = [f"{100.0 * row.others[name].path_error:.2f}" for name in names]
    return [row.robot, *paths, *(f"{row.others[name].heading_change:.3f}" for name in names)]


def _table(head: list[str], rows: list[list[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)

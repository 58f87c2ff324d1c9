"""Figures of a drive: its motion in the physics world, compared with the plane."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, fields
from typing import Any

import numpy as np

from crowdbot.typing import Floats
from crowdbot.world import Drive

from .traces import SAMPLE, DriveTrace, Manoeuvre

SLOPE = 2
"""Samples over which accelerations are measured: 0.04 s."""
STEADY = 1.0
"""Last part [s] of a held speed, over which the steady error is measured."""
SMALL = 0.1
"""Errors of speeds are shares of the speed asked for, or of this share of the limit if that is larger."""
NOISE = 0.05
"""Accelerations [m/s2], [rad/s2] are compared with at least this: a car that drives straight turns by rounding only."""
FALLEN = math.radians(30.0)
"""A robot that leans more has fallen [rad]."""


DRIVE_COLUMNS = (
    ("overshoot", "overshoot [%]"), ("steady_error", "steady [%]"), ("acceleration", "acc. [%]"),
    ("turn_acceleration", "turn acc. [%]"), ("path_error", "path [%]"), ("heading_error", "heading [rad/rad]"),
    ("stop_error", "stop [mm]"), ("tilt", "tilt [rad]"),
)  # fmt: skip
"""Figures of the grid with their headers in tables."""
SCALES = {"overshoot": 100.0, "steady_error": 100.0, "acceleration": 100.0, "turn_acceleration": 100.0,
          "path_error": 100.0, "stop_error": 1000.0}  # fmt: skip
DIGITS = {"acceleration": 0, "turn_acceleration": 0, "heading_error": 4, "stop_error": 1, "tilt": 4}


@dataclass(frozen=True)
class DriveFigures:
    """Figures of one manoeuvre, or the largest of several.

    Fields:
        overshoot: largest excess over the speed asked for, or over the planar one if that is larger, a share of the
            speed asked for.
        steady_error: error of the mean speed in the last second, a share.
        acceleration: largest acceleration over 0.04 s by the declared one, or by the planar one if that is larger: a
            skid-steer base slides sideways in a curve, in the plane as well.
        turn_acceleration: the same of the turn rate.
        path_error: largest distance from the planar position by the distance driven (at least 1 m).
        heading_error: largest difference from the planar heading [rad], by the angle turned (at least 1 rad).
        heading_change: difference from the planar sum of heading changes [rad].
        stop_distance: distance from the order to stop until rest [m].
        stop_error: difference from the planar stop distance [m].
        tilt: largest angle from the vertical [rad].
    """

    overshoot: float = 0.0
    steady_error: float = 0.0
    acceleration: float = 0.0
    turn_acceleration: float = 0.0
    path_error: float = 0.0
    heading_error: float = 0.0
    heading_change: float = 0.0
    stop_distance: float = 0.0
    stop_error: float = 0.0
    tilt: float = 0.0

    def worst(self, other: DriveFigures) -> DriveFigures:
        """Return the larger of each figure.

        >>> DriveFigures(tilt=0.1).worst(DriveFigures(overshoot=0.2)).tilt
        0.1
        """
        return DriveFigures(*(max(getattr(self, field.name), getattr(other, field.name)) for field in fields(self)))

    @property
    def fallen(self) -> bool:
        """Whether the robot has fallen."""
        return self.tilt > FALLEN

    def as_dict(self) -> dict[str, Any]:
        """Return the figures by name."""
        return asdict(self)


def grid_cells(figures: DriveFigures) -> list[str]:
    """Return the figures of a grid as cells for :data:`DRIVE_COLUMNS`.

    >>> grid_cells(DriveFigures(overshoot=0.0123, tilt=0.001))
    ['1.23', '0.00', '0', '0', '0.00', '0.0000', '0.0', '0.0010']
    """
    return [f"{SCALES.get(name, 1.0) * getattr(figures, name):.{DIGITS.get(name, 2)}f}" for name, _ in DRIVE_COLUMNS]


def compare_traces(drive: Drive, manoeuvre: Manoeuvre, physics: DriveTrace, plane: DriveTrace) -> DriveFigures:
    """Return the figures of a manoeuvre.

    Args:
        drive: motion model with the declared limits.
        manoeuvre: what was asked for.
        physics, plane: motion in the two worlds.

    >>> from crowdbot.world import Robot
    >>> from crowdbot.benchmark import manoeuvres, trace_planar
    >>> robot = Robot.load("differential")
    >>> first = manoeuvres(robot, quick=True)[0]
    >>> plane = trace_planar(robot, first.commands, 0.02)
    >>> figures = compare_traces(robot.drive, first, plane, plane)
    >>> figures.overshoot, figures.path_error, round(figures.acceleration, 3), round(figures.stop_distance, 2)
    (0.0, 0.0, 1.0, 0.49)
    """
    held = manoeuvre.held
    over, steady = (
        _speed_errors(drive, physics.twist[:held], plane.twist[:held], manoeuvre.commands[0].left != 0.0)
        if manoeuvre.name == "grid"
        else (0, 0)
    )
    push, spin = _accelerations(drive, physics, plane)
    away = np.hypot(*(physics.position - plane.position).T)
    driven, turned = _length(plane.position), _total(plane.heading)
    stop = stop_error = 0.0
    if held < len(physics.heading):
        stop = _length(physics.position[held - 1 :])
        stop_error = abs(stop - _length(plane.position[held - 1 :]))
    return DriveFigures(
        overshoot=over,
        steady_error=steady,
        acceleration=push,
        turn_acceleration=spin,
        path_error=float(away.max()) / max(driven, 1.0),
        heading_error=float(np.abs(physics.heading - plane.heading).max()) / max(turned, 1.0),
        heading_change=abs(_total(physics.heading) - turned),
        stop_distance=stop,
        stop_error=stop_error,
        tilt=float(physics.tilt.max()),
    )


def _limits(drive: Drive) -> Floats:
    top, most = getattr(drive, "max_speed", 1.0), getattr(drive, "max_turn_rate", 1.0)
    return np.array([top, top, most], dtype=np.float64)


def _speed_errors(drive: Drive, moved: Floats, planar: Floats, sideways: bool) -> tuple[float, float]:
    """Return the overshoot and the steady error of forward speed and turn rate, and of left speed if it is asked."""
    goal = planar[-1]
    scale = np.maximum(np.abs(goal), SMALL * _limits(drive))
    sign = np.where(goal < 0.0, -1.0, 1.0)
    known = np.where(goal != 0.0, np.maximum((planar * sign).max(axis=0), np.abs(goal)), np.abs(planar).max(axis=0))
    excess = np.where(goal != 0.0, (moved * sign).max(axis=0), np.abs(moved).max(axis=0)) - known
    mean = moved[-round(STEADY / SAMPLE) :].mean(axis=0)
    asked = [0, 1, 2] if sideways else [0, 2]
    over, steady = np.maximum(excess, 0.0) / scale, np.abs(mean - goal) / scale
    return float(over[asked].max()), float(steady[asked].max())


def _accelerations(drive: Drive, physics: DriveTrace, plane: DriveTrace) -> tuple[float, float]:
    """Return the largest linear and angular acceleration by those declared, or by those in the plane."""
    found = []
    for name, part in (("max_acceleration", slice(0, 2)), ("max_turn_acceleration", slice(2, 3))):
        most = max(float(getattr(drive, name, 0.0)), _slope(plane, part))
        found.append(_slope(physics, part) / max(most, NOISE))
    return found[0], found[1]


def _slope(trace: DriveTrace, part: slice) -> float:
    rows = np.concatenate([np.zeros((1, 3)), trace.twist])[:, part]
    if len(rows) <= SLOPE:
        return 0.0
    return float(np.linalg.norm(rows[SLOPE:] - rows[:-SLOPE], axis=1).max()) / (SLOPE * SAMPLE)


def _length(position: Floats) -> float:
    return float(np.hypot(*np.diff(position, axis=0).T).sum()) if len(position) > 1 else 0.0


def _total(heading: Floats) -> float:
    return float(np.abs(np.diff(heading, prepend=0.0)).sum())

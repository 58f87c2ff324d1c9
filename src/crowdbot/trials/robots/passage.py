"""Passages that are too narrow for the disc of a robot, but wide enough for its outline."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crowdbot.core import InputError, Walls
from crowdbot.navigation import PathPlanner

if TYPE_CHECKING:
    from crowdbot.trials.robot import RobotSpec
    from crowdbot.trials.trial import Trial


PRECISION = 0.001
"""Precision [m] of the width of a passage."""


def passage_remarks(trial: Trial) -> tuple[str, ...]:
    """Return a sentence for each robot of a trial that cannot reach its goal although its outline fits.

    The planar world treats a robot as a disc. If walls leave the disc no path from start to goal, but a disc as wide as
    the outline of the robot has one, the narrowest passage on the way of the robot is the reason.

    >>> from crowdbot.trials import load_trial
    >>> [line[:71] for line in passage_remarks(load_trial("doorway", {"robot/type": "wheelchair"}))]
    ['the narrowest passage on the way of the robot is 0.95 m wide: less than']
    """
    robots = [robot for robot in trial.robots if robot.type and not robot.ghost and robot.mirror is None]
    if trial.world != "planar" or not robots:
        return ()
    walls = trial.stage.as_walls()
    found = []
    for robot in robots:
        width = _narrowest(trial, walls, robot)
        if width is None:
            continue
        name = "the robot" if len(trial.robots) == 1 else f"robot {robot.name!r}"
        found.append(
            f"the narrowest passage on the way of {name} is {width:.2f} m wide: less than the diameter of its disc,"
            f" {2.0 * robot.radius:.2f} m, and more than the width of its outline, {_outline(robot):.2f} m. In the"
            " planar world a robot is a disc, so it cannot reach its goal, although its outline fits through."
        )
    return tuple(found)


def _narrowest(trial: Trial, walls: Walls, robot: RobotSpec) -> float | None:
    """Return the width [m] of the passage that the outline of a robot fits and its disc does not, or None."""
    fits, fails = 0.5 * _outline(robot), robot.radius
    if fits >= fails or _has_path(walls, robot, fails) or not _has_path(walls, robot, fits):
        return None
    while fails - fits > 0.5 * PRECISION:
        middle = 0.5 * (fits + fails)
        fits, fails = (middle, fails) if _has_path(walls, robot, middle) else (fits, middle)
    beside = float(trial.stage.clearance([robot.position, robot.goal.position]).min()) - PRECISION
    return None if fits > beside else 2.0 * fits  # a wall beside start or goal is no passage


def _outline(robot: RobotSpec) -> float:
    """Return the width [m] of the outline of a robot."""
    return float(np.ptp(robot.body.footprint[:, 1]))


def _has_path(walls: Walls, robot: RobotSpec, radius: float) -> bool:
    """Return whether a disc has a path from the start to the goal of the robot."""
    try:
        PathPlanner.of(walls, radius, margin=0.0).waypoints(robot.position, robot.goal.position)
    except InputError:
        return False
    return True

"""Why a robot cannot do its task whatever its navigator does: passages too narrow for it, no sensor for people."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.core import InputError, Walls
from crowdbot.navigation import PathPlanner
from crowdbot.sensors import IMU, Bumper, Infrared, RGBCamera, Ultrasound, WheelOdometry

if TYPE_CHECKING:
    from crowdbot.trials.robot import RobotSpec
    from crowdbot.trials.trial import Trial


PRECISION = 0.001
"""Precision [m] of the width of a passage."""
SMALLEST = 0.05
"""Half of the width [m] of the smallest passage that counts."""


BLIND = (Bumper, IMU, Infrared, RGBCamera, Ultrasound, WheelOdometry)
"""Sensors whose readings show no people to navigators as :attr:`Observation.people`."""


def passage_remarks(trial: Trial) -> tuple[str, ...]:
    """Return a sentence for each robot of a trial that is wider than the narrowest passage on its way.

    The width is that of the outline across the forward axis of the robot, which drives forward through a passage.

    >>> from crowdbot.trials import load_trial
    >>> passage_remarks(load_trial("doorway", {"robot/type": "wheelchair"}))
    ()
    """
    found = []
    for robot in trial.robots:
        width = narrow_passage(trial, robot)
        if width is None:
            continue
        name = "the robot" if len(trial.robots) == 1 else f"robot {robot.name!r}"
        found.append(
            f"the narrowest passage on the way of {name} is {width:.2f} m wide: less than the width of the robot,"
            f" {2.0 * robot.body.half_width:.2f} m, so it cannot reach its goal."
        )
    return tuple(found)


def blind_remarks(trial: Trial) -> tuple[str, ...]:
    """Return a sentence for each robot with a type whose navigator cannot see the people of a trial.

    >>> from crowdbot.trials import load_trial
    >>> blind_remarks(load_trial("doorway", {"robot/type": "cuybot"}))
    ()
    """
    found = []
    for robot in trial.robots if trial.people else ():
        if not robot.type or robot.mirror is not None or robot.people != "seen":
            continue
        if all(isinstance(mount.sensor, BLIND) for mount in robot.sensors):
            name = "the robot" if len(trial.robots) == 1 else f"robot {robot.name!r}"
            own = ", ".join(mount.name for mount in robot.sensors)
            found.append(
                f"{name} has no scanner, depth camera or other sensor that shows people ({own or 'no sensor at all'}),"
                " so observation.people of its navigator is empty; add a <sensor> to its robot.xml, or set"
                " robot/people=true to test the navigator with perfect knowledge."
            )
    return tuple(found)


def narrow_passage(trial: Trial, robot: RobotSpec) -> float | None:
    """Return the width [m] of the narrowest passage on the way of a robot that is too narrow for it, or None."""
    if trial.world != "planar" or not robot.type or robot.ghost or robot.mirror is not None:
        return None
    walls = trial.stage.as_walls()
    fits, fails = SMALLEST, robot.body.half_width
    if fits >= fails or _has_path(walls, robot, fails) or not _has_path(walls, robot, fits):
        return None
    while fails - fits > 0.5 * PRECISION:
        middle = 0.5 * (fits + fails)
        fits, fails = (middle, fails) if _has_path(walls, robot, middle) else (fits, middle)
    beside = float(trial.stage.clearance([robot.position, robot.goal.position]).min()) - PRECISION
    return None if fits > beside else 2.0 * fits  # a wall beside start or goal is no passage


def _has_path(walls: Walls, robot: RobotSpec, radius: float) -> bool:
    """Return whether a disc has a path from the start to the goal of the robot."""
    try:
        PathPlanner.of(walls, radius, margin=0.0).waypoints(robot.position, robot.goal.position)
    except InputError:
        return False
    return True

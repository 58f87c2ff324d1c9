"""Checks of uneven ground and doors: the world, names of doors, and whether robots can pass."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from crowdbot.trials.ground.elements import UNEVEN, ground_of
from crowdbot.trials.robot import RobotSpec
from crowdbot.trials.trial import Trial
from crowdbot.typing import Floats
from crowdbot.world import Ground

from .flow_checks import Problems, ValidationContext, duplicate_names


def ground_problems(checked: ValidationContext) -> Iterator[Problems]:
    """Yield the problems of uneven ground, doors, and the places of robots."""
    yield duplicate_names(checked.trial.stage.doors, "door")
    yield _planar(checked.trial)
    for robot in checked.trial.robots:
        yield _raised_start(checked, robot)


def _planar(trial: Trial) -> Problems:
    if trial.world == "planar" and trial.stage.ground:
        yield trial.stage, UNEVEN


def _raised_start(checked: ValidationContext, robot: RobotSpec) -> Problems:
    """Yield a robot whose base is pulled along the floor but that starts on raised ground."""
    ground = ground_of(checked.trial.stage.ground)
    if checked.trial.world != "physics" or ground is None or robot.body.base != "planar":
        return
    if float(ground.support(robot.position, robot.radius)) > 0.0:
        yield robot, f"starts on raised ground at {robot.x:g},{robot.y:g}; a base that is pulled along the floor cannot"


def ground_remarks(trial: Trial) -> list[str]:
    """Return a sentence for every robot that cannot pass the ground on the straight way to its goal.

    A robot with a path planner drives around such ground; that there is a path is checked with its planner.
    """
    ground = ground_of(trial.stage.ground)
    if ground is None or trial.world != "physics":
        return []
    return [sentence for robot in trial.robots if (sentence := _straight_way(ground, robot))]


def _straight_way(ground: Ground, robot: RobotSpec) -> str:
    """Return a sentence about a robot without a planner whose straight way leads over ground that it cannot pass."""
    if robot.planner is not None:
        return ""
    body = robot.body
    way = np.array([robot.position, robot.goal.position])
    if not any(_crosses(way, line) for line in ground.barriers(body.max_step, body.max_slope)):
        return ""
    name = f"of type {robot.type!r}" if robot.type else "without a type"
    limits = f"{100.0 * body.max_step:.2g} cm and slopes up to {100.0 * body.max_slope:.3g} %"
    if body.base == "planar":
        limits = "0 cm, since its base is pulled along the floor"
    return (
        f"robot {robot.name!r} {name} passes steps up to {limits}, but there are higher ones on the straight way to its"
        " goal; add <planner/> to drive around them"
    )


def _crosses(way: Floats, line: Floats) -> bool:
    """Return whether a way ``[2, 2]`` meets a line ``[2, 2]`` or an outline ``[N, 2]``."""
    import shapely

    other = shapely.LineString(line) if len(line) == 2 else shapely.Polygon(line)
    return bool(shapely.intersects(shapely.LineString(way), other))

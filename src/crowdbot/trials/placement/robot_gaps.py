"""Clearances of robots at their starts and goals: to people, to other robots and to walls, by their outlines."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from crowdbot.core import InputError, UnreadableValue
from crowdbot.core.outlines import Outlines, body_gap, inscribed_radius, wall_gap
from crowdbot.trials.stage import Stage
from crowdbot.typing import Floats

if TYPE_CHECKING:
    from crowdbot.trials.robot import RobotSpec


def start_outline(robot: RobotSpec) -> Floats | None:
    """Return the outline ``[K, 2]`` of a robot in its frame [m]; None for a disc.

    A robot that cannot be read completely is a disc: another problem is reported first, and the disc holds its outline.
    """
    try:
        return robot.body.outline if robot.type and math.isfinite(robot.heading) else None
    except (UnreadableValue, InputError):
        return None


def gap_to_disc(robot: RobotSpec, place: tuple[float, float], radius: float) -> float:
    """Return the clearance [m] of a robot at its start to a disc; negative if they overlap."""
    outline = start_outline(robot)
    if outline is None:
        return math.hypot(place[0] - robot.x, place[1] - robot.y) - robot.radius - radius
    pose = (robot.x, robot.y, robot.heading, robot.radius, 0, len(outline))
    return float(body_gap(*pose, *place, 0.0, radius, 0, 0, np.ascontiguousarray(outline)))


def gap_to_robot(robot: RobotSpec, other: RobotSpec) -> float:
    """Return the clearance [m] of two robots at their starts; negative if they overlap.

    >>> from crowdbot.navigation import Straight
    >>> from crowdbot.trials import RobotGoal, RobotSpec
    >>> pair = [RobotSpec(type="cuybot", x=0, y=y, goal=RobotGoal(5, y), navigator=Straight()) for y in (0.0, 0.6)]
    >>> round(gap_to_robot(*pair), 3), round(0.6 - 2 * pair[0].radius, 3)
    (0.068, -0.182)
    """
    first, second = start_outline(robot), start_outline(other)
    if first is None and second is None:
        return gap_to_disc(robot, other.position, other.radius)
    table = Outlines.of({k: item for k, item in enumerate((first, second)) if item is not None}, 2)
    begin, middle, end = table.first.tolist()
    return float(
        body_gap(
            robot.x, robot.y, robot.heading if first is not None else 0.0, robot.radius, begin, middle,
            other.x, other.y, other.heading if second is not None else 0.0, other.radius, middle, end, table.corner,
        )
    )  # fmt: skip


def gap_to_walls(stage: Stage, robot: RobotSpec) -> float:
    """Return the clearance [m] of the outline of a robot at its start to walls and solids; inf without any."""
    outline = start_outline(robot)
    if outline is None:
        return float(stage.clearance([robot.position])[0]) - robot.radius
    corner = np.ascontiguousarray(outline)
    pose = (robot.x, robot.y, robot.heading, corner, 0, len(corner))
    return min((float(wall_gap(*pose, *wall)) for wall in stage.as_walls().segments().tolist()), default=math.inf)


def smallest_reach(robot: RobotSpec) -> float:
    """Return the radius [m] of the largest disc around the origin in the body of a robot: it needs this in any pose."""
    outline = start_outline(robot)
    return robot.radius if outline is None else max(0.0, inscribed_radius(outline))

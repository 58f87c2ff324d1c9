"""Decision, the seventh phase of a step: navigators that are due decide."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from crowdbot.simulation.joint_targets import follow_joint_targets, move_wanted_joints
from crowdbot.simulation.robot_control import RobotControl
from crowdbot.simulation.world_view import WorldView

__all__ = ["let_decide"]


def let_decide(robots: Sequence[RobotControl], around: WorldView, live: NDArray[np.bool_]) -> dict[int, Exception]:
    """Let the navigators decide that are due, move joints, and return the exceptions by environment.

    Joints follow the targets of the trial first, then those of the navigator.

    Args:
        robots: the robots.
        around: the world as sensors see it.
        live: ``[E]`` environments that decide.
    """
    ticks, common = around.world.ticks, around.world.environment_time.common_tick
    errors: dict[int, Exception] = {}
    live = live.copy()
    for robot in robots:
        if robot.robot.joints:
            failures = follow_joint_targets(robot, around.world, live)
            errors |= failures
            live[list(failures)] = False
        if common is not None and not robot.control.is_due(common):
            continue
        due = np.flatnonzero(live if common is not None else live & robot.control.is_due(ticks))
        failures = robot.decide(around, due) if len(due) else {}
        if robot.wanted:
            failures |= move_wanted_joints(robot, around.world)
        errors |= failures
        live[list(failures)] = False
    return errors

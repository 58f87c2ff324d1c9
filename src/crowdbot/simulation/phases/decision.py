"""Decision, the seventh phase of a step: navigators that are due decide."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from crowdbot.simulation.robot_control import RobotControl
from crowdbot.simulation.world_view import WorldView

__all__ = ["let_decide"]


def let_decide(robots: Sequence[RobotControl], around: WorldView, live: NDArray[np.bool_]) -> dict[int, Exception]:
    """Let the navigators decide that are due, and return the exceptions by environment.

    Args:
        robots: the robots.
        around: the world as sensors see it.
        live: ``[E]`` environments that decide.
    """
    ticks, common = around.world.ticks, around.world.environment_time.common_tick
    errors: dict[int, Exception] = {}
    live = live.copy()
    for robot in robots:
        if common is not None and not robot.control.is_due(common):
            continue
        due = np.flatnonzero(live if common is not None else live & robot.control.is_due(ticks))
        failures = robot.decide(around, due) if len(due) else {}
        errors |= failures
        live[list(failures)] = False
    return errors

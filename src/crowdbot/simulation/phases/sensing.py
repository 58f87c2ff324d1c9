"""Sensing, the sixth phase of a step: sensors that are due measure the new scene."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from crowdbot.simulation.mounted_sensor import SensorReadings
from crowdbot.simulation.robot_control import RobotControl
from crowdbot.simulation.world_view import WorldView

__all__ = ["RobotReadings", "read_sensors"]

Bools = NDArray[np.bool_]
RobotReadings = list[tuple[RobotControl, SensorReadings]]
"""Readings of several environments that arrived in one step, with their robots."""


def read_sensors(
    robots: Sequence[RobotControl], around: WorldView, live: Bools
) -> tuple[RobotReadings, dict[int, Exception]]:
    """Return the readings that arrive now, and the exceptions by environment, whose readings are left out.

    Args:
        robots: the robots.
        around: the world as sensors see it.
        live: ``[E]`` environments that sense.
    """
    ticks, common = around.world.ticks, around.world.environment_time.common_tick
    found: RobotReadings = []
    errors: dict[int, Exception] = {}
    if not live.any():
        return found, errors
    live = live.copy()
    for robot in robots:
        for sensor in [one for one in robot.sensors if common is None or one.has_work(common)]:
            able = live if robot.faults is None else robot.faults.measuring(sensor, around.world, live)
            arrived, failures = sensor.work(ticks, able, robot.agent, around)
            found += [(robot, readings) for readings in arrived]
            for e, error in failures:
                errors[e], live[e] = error, False
        if robot.faults is not None:
            robot.faults.clear_blind(robot.sensors, around.world.times)
    if errors:
        failed = ~live
        rest = ((robot, readings.without(failed)) for robot, readings in found)
        found = [(robot, readings) for robot, readings in rest if readings is not None]
    return found, errors

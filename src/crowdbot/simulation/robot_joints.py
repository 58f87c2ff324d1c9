"""Joints of a robot in all environments: their targets, and the sensors on the links that they move."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from crowdbot.world import World, free_joints, move_joint

from .mounted_sensor import LEVEL
from .robot_control import RobotControl

__all__ = ["move_robot_joint", "restore_joints", "tilt_problem"]


def move_robot_joint(control: RobotControl, world: World, environment: int, joint: str, position: float) -> None:
    """Set the target of a joint [rad or m] in one environment; it passes the checks."""
    control.joints[environment, free_joints(control.robot.body).index(joint)] = position
    move_joint(world, control.agent, joint, position, environment)
    _place_sensors(control, world, environment)


def restore_joints(control: RobotControl, world: World) -> None:
    """Apply the targets of all environments again, after the robot or its sensors were replaced."""
    for e in np.flatnonzero(~np.isnan(control.joints).all(axis=1)).tolist():
        for joint, position in _targets(control, e).items():
            move_joint(world, control.agent, joint, position, e)
        _place_sensors(control, world, e)


def tilt_problem(control: RobotControl, world: World, environment: int, joint: str, position: float) -> str:
    """Return why a sensor cannot measure with a joint at a position; empty if all can.

    A sensor that measures discs in the plane must stay level.
    """
    if world.walls_fixed:
        return ""
    joints = {**_targets(control, environment), joint: position}
    for sensor in control.sensors:
        if sensor.mount.link and not sensor.space:
            _, _, _, roll, pitch, _ = control.robot.sensor_pose(sensor.mount, joints)
            if max(abs(roll), abs(pitch)) > LEVEL:
                return (
                    f"joint {joint!r} at {position:g} would tilt the sensor {sensor.name!r}, which measures discs in"
                    ' the plane; set bodies="limbs" in the trial'
                )
    return ""


def _targets(control: RobotControl, environment: int) -> dict[str, float]:
    """Return the targets of the joints that have one in an environment."""
    row = control.joints[environment].tolist()
    return {
        name: value for name, value in zip(free_joints(control.robot.body), row, strict=True) if not math.isnan(value)
    }


def _place_sensors(control: RobotControl, world: World, environment: int) -> None:
    """Move the sensors on links; the physics world moves them itself."""
    if world.walls_fixed:
        return
    joints: Mapping[str, float] = _targets(control, environment)
    for sensor in control.sensors:
        if sensor.mount.link:
            sensor.move(environment, control.robot.sensor_pose(sensor.mount, joints))

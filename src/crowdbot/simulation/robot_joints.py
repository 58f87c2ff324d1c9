"""Joints of a robot in all environments: their targets and motion, and the sensors on the links that they move."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.trials import joint_positions
from crowdbot.world import World, check_joint, free_joints

from .mounted_sensor import LEVEL
from .robot_control import RobotControl


def move_robot_joint(control: RobotControl, world: World, environment: int, joint: str, position: float) -> None:
    """Set the target of a joint [rad or m] in one environment; it passes the checks."""
    control.joints[environment, free_joints(control.robot.body).index(joint)] = position
    world.move_joint(control.agent, joint, position, environment)
    _place_sensors(control, world, environment)


def restore_joints(control: RobotControl, world: World) -> None:
    """Apply the targets of all environments again, after the robot or its sensors were replaced."""
    for e in np.flatnonzero(~np.isnan(control.joints).all(axis=1)).tolist():
        for joint, position in control.joint_targets(e).items():
            world.move_joint(control.agent, joint, position, e)
        _place_sensors(control, world, e)


def tilt_problem(control: RobotControl, world: World, environment: int, joint: str, position: float) -> str:
    """Return why a sensor cannot measure with a joint at a position; empty if all can.

    A sensor that measures discs in the plane must stay level.
    """
    if world.walls_fixed:
        return ""
    joints = {**control.joint_targets(environment), joint: position}
    for sensor in control.sensors:
        if sensor.mount.link and not sensor.space:
            _, _, _, roll, pitch, _ = control.robot.sensor_pose(sensor.mount, joints)
            if max(abs(roll), abs(pitch)) > LEVEL:
                return (
                    f"joint {joint!r} at {position:g} would tilt the sensor {sensor.name!r}, which measures discs in"
                    ' the plane; set bodies="limbs" in the trial'
                )
    return ""


def _place_sensors(control: RobotControl, world: World, environment: int) -> None:
    """Move the sensors on links; the physics world moves them itself."""
    if world.walls_fixed:
        return
    joints = control.joint_targets(environment)
    for sensor in control.sensors:
        if sensor.mount.link:
            sensor.move(environment, control.robot.sensor_pose(sensor.mount, joints))


def follow_joint_targets(control: RobotControl, world: World, live: NDArray[np.bool_]) -> dict[int, Exception]:
    """Move the joints whose targets in the trial change now, and return the exceptions by environment.

    Args:
        control: the robot.
        world: the world.
        live: ``[E]`` environments that run.
    """
    step, posture, failures = world.clock.step_ns, control.robot.body.posture, dict[int, Exception]()
    for e in np.flatnonzero(live).tolist():
        tick = int(world.ticks[e])
        moves = joint_positions(control.robot.joints, posture, (tick - 1) * step, tick * step)
        for joint, position in moves.items():
            problem = tilt_problem(control, world, e, joint, position)
            if problem:
                failures[e] = InputError(f"robot {control.robot.name!r}: {problem}")
                break
            move_robot_joint(control, world, e, joint, position)
    return failures


def move_wanted_joints(control: RobotControl, world: World) -> dict[int, Exception]:
    """Move the joints for which the navigator has decided, within their limits; return exceptions by environment."""
    failures: dict[int, Exception] = {}
    wanted, control.wanted = control.wanted, {}
    for e, joints in wanted.items():
        try:
            for joint, position in joints.items():
                _move(control, world, e, joint, position)
        except InputError as error:
            name = control.robot.navigator.title(control.robot.name)
            failures[e] = InputError(f"{name}: {error}")
    return failures


def _move(control: RobotControl, world: World, environment: int, joint: str, position: float) -> None:
    """Move a joint to the allowed position nearest to a target; raise an InputError if there is no such joint."""
    robot = control.robot.body
    names = free_joints(robot)
    if joint in names:
        found = robot.model.joints[joint]
        position = min(max(position, found.lower), found.upper)
        if control.joints[environment, names.index(joint)] == position:
            return
    check_joint(robot, joint, position)
    if problem := tilt_problem(control, world, environment, joint, position):
        raise InputError(problem)
    move_robot_joint(control, world, environment, joint, position)

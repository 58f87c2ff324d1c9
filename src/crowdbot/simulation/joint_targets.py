"""Joints of a robot that follow the targets of the trial and of the navigator."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.trials import joint_positions
from crowdbot.world import World, check_joint, free_joints

from .robot_control import RobotControl
from .robot_joints import move_robot_joint, tilt_problem

__all__ = ["follow_joint_targets", "move_wanted_joints"]


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

"""Joints of robots that can be given a target, and checks of a target."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from crowdbot.core import InputError, did_you_mean

if TYPE_CHECKING:
    from .robot import Robot


def free_joints(robot: Robot) -> tuple[str, ...]:
    """Return the joints of a robot that can be moved to a position: all with one coordinate, except wheels.

    >>> from crowdbot.world import Robot
    >>> free_joints(Robot.load("pepper"))[:4]
    ('KneePitch', 'HipPitch', 'HipRoll', 'HeadYaw')
    """
    wheels = {name for wheel in robot.wheels for name in (wheel.joint, wheel.steering)}
    return tuple(joint.name for joint in robot.model.movable if joint.size == 1 and joint.name not in wheels)


def check_joint(robot: Robot, joint: str, position: float) -> None:
    """Raise :class:`InputError` if a robot has no such joint, or the position [rad or m] is outside its limits.

    >>> from crowdbot.world import Robot
    >>> check_joint(Robot.load("pepper"), "HeadYaw", 3.0)
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: the joint 'HeadYaw' of pepper cannot be at 3 rad; it moves from -2.08567 to \
2.08567 rad
    """
    names = free_joints(robot)
    if joint not in names:
        known = ", ".join(names[:8]) + (", ..." if len(names) > 8 else "")
        raise InputError(
            f"{robot.name} has no joint {joint!r} that can be moved{did_you_mean(joint, names)}; it has"
            f" {known or 'none'}"
        )
    found = robot.model.joints[joint]
    unit = "m" if found.kind == "prismatic" else "rad"
    if not math.isfinite(position) or not found.lower <= position <= found.upper:
        raise InputError(
            f"the joint {joint!r} of {robot.name} cannot be at {position:g} {unit}; it moves from"
            f" {found.lower:g} to {found.upper:g} {unit}"
        )

"""Wheel: a wheel of a robot that holds it on its path."""

from __future__ import annotations

import math
from dataclasses import dataclass

from crowdbot.core import InputError
from crowdbot.world.urdf import Joint

MAX_ROLLERS = 1.4
"""Largest angle [rad] of rollers: at pi / 2 the wheel could not push."""


@dataclass(frozen=True)
class Wheel:
    """A wheel that drives, steers, or rolls freely and holds the base sideways. Castors are no such wheels.

    Fields:
        joint: joint of the axle.
        radius: radius [m].
        steering: joint with a vertical axis that steers the wheel; empty without steering.
        driven: whether the wheel has a motor.
        rollers: angle [rad] from the rolling direction to the axes of the rollers on the ground, counter-clockwise seen
            from above: 0 for omnidirectional wheels, +-pi / 4 for mecanum wheels; None for a wheel without rollers.

    Raises:
        InputError: the radius is not finite and above 0, or rollers are more than 80 degrees from the rolling
            direction.

    >>> Wheel("rear_left", 0.2).driven
    True
    """

    joint: str
    radius: float
    steering: str = ""
    driven: bool = True
    rollers: float | None = None

    def __post_init__(self) -> None:
        if not 0.0 < self.radius < math.inf:
            raise InputError(f"Wheel: radius = {self.radius} m must be finite and above 0")
        if self.rollers is not None and not abs(self.rollers) <= MAX_ROLLERS:
            raise InputError(f"Wheel: rollers = {self.rollers} rad of {self.joint!r} must be at most 1.4 (80 degrees)")


def resistance(joint: Joint, speed: float) -> float:
    """Return the torque [N m] of friction and damping against a joint that turns at a speed [rad/s]."""
    return joint.friction + joint.damping * speed


def fastest(joint: Joint, effort: float) -> float:
    """Return the speed [rad/s] at which friction and damping take the whole effort [N m] of a motor.

    >>> from crowdbot.world import Robot
    >>> fastest(Robot.load("differential").model.joints["left_wheel_joint"], 1.0)
    100.0
    """
    left = max(0.0, effort - joint.friction)
    if joint.damping > 0.0:
        return left / joint.damping
    return 0.0 if left == 0.0 and joint.friction > 0.0 else math.inf


def weak_motor(joint: Joint, effort: float, speed: float) -> str:
    """Return why a motor does not turn a wheel at its speed in the physics world, or an empty string.

    Args:
        joint: axle of the wheel.
        effort: largest torque [N m] of the motor.
        speed: speed [rad/s] of the wheel at the maximum speed of the robot.

    >>> from crowdbot.world import Robot
    >>> weak_motor(Robot.load("differential").model.joints["left_wheel_joint"], 1.0, 10.0)
    ''
    """
    if effort > resistance(joint, speed) or resistance(joint, speed) <= 0.0:
        return ""
    change = f"set its effort in <limit> above {resistance(joint, speed):.4g} N m, or lower its <dynamics>"
    if effort <= joint.friction:
        why = (
            f"the effort of {effort:.4g} N m of {joint.name!r} does not exceed its friction of {joint.friction:.4g} N m"
        )
        return f"{why}: the robot cannot move in the physics world; {change}"
    share = fastest(joint, effort) / speed
    friction = f"friction of {joint.friction:.4g} N m and " if joint.friction else ""
    return (
        f"the effort of {effort:.4g} N m of {joint.name!r} reaches {100.0 * share:.2g} % of the maximum speed in the"
        f" physics world, against {friction}damping of {joint.damping:.4g} N m s/rad; {change}"
    )

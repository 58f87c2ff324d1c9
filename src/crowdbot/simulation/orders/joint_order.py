"""JointOrder: moves a joint of a robot while it runs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from crowdbot.core import InputError
from crowdbot.simulation.robot_joints import move_robot_joint, tilt_problem
from crowdbot.world import check_joint

from .order import Order


@dataclass(frozen=True, kw_only=True)
class JointOrder(Order):
    """Move a joint of a robot, such as its head, to a position, which is kept until another order replaces it.

    Sensors and cameras on the moved links move, and so does the body that sensors of other robots see. In the physics
    world, the position motor of the joint moves it with its force and speed; a joint without one moves there at its
    maximum speed and is held. In the plane, the joint is there at once. The disc of the robot stays the same.

    Fields:
        robot: name of the robot.
        joint: name of the joint in its URDF.
        position: target [rad or m].

    >>> JointOrder(robot="pepper", joint="HeadYaw", position=0.5).position
    0.5
    """

    robot: str
    joint: str
    position: float

    def check(self, simulation: Any) -> None:
        super().check(simulation)
        control = simulation.control_of(self.robot)
        try:
            if not isinstance(self.position, int | float):
                raise InputError(f"position = {self.position!r} must be a number")
            check_joint(control.robot.body, self.joint, float(self.position))
            values = (self.environment, self.joint, float(self.position))
            if problem := tilt_problem(control, simulation.world, *values):
                raise InputError(problem)
        except InputError as error:
            raise InputError(f"JointOrder: robot {self.robot!r}: {error}") from None

    def apply(self, simulation: Any) -> None:
        values = (self.environment, self.joint, float(self.position))
        move_robot_joint(simulation.control_of(self.robot), simulation.world, *values)

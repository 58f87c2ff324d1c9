"""RobotPoseOrder: a sample of the pose of a robot that is mirrored from outside."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from crowdbot.core import InputError
from crowdbot.humans import BodyPose
from crowdbot.world import give_pose

from .avatar_order import check_time
from .order import Order


@dataclass(frozen=True, kw_only=True)
class RobotPoseOrder(Order):
    """Give the pose of a robot with ``<pose source="external"/>`` at a time.

    The robot is then where its samples say at the current time, and has the velocity of their motion; in the physics
    world, what it touches feels it. A sample for the time of the next step, given before that step, has no lag.

    Fields:
        robot: name of the robot.
        time: time stamp in simulated time [s], at most 10 s ahead; None: the current time.
        x, y: position [m].
        heading: counter-clockwise from +x [rad].

    Raises:
        InputError: a value is not finite or out of range.

    >>> RobotPoseOrder(robot="pepper", x=1, y=2, time=0.1).pose.x
    1.0
    """

    robot: str
    time: float | None = None
    x: float
    y: float
    heading: float = 0.0

    def __post_init__(self) -> None:
        try:
            pose = self.pose
        except InputError as error:
            raise InputError(f"RobotPoseOrder: {str(error).removeprefix('BodyPose: ')}") from None
        for name in ("x", "y", "heading"):
            object.__setattr__(self, name, getattr(pose, name))
        object.__setattr__(self, "time", check_time(self))

    @property
    def pose(self) -> BodyPose:
        """The pose of the sample."""
        return BodyPose(self.x, self.y, self.heading)

    def check(self, simulation: Any) -> None:
        """Raise :class:`InputError` if the robot does not take poses, or the time is too far ahead."""
        super().check(simulation)
        robot = simulation.control_of(self.robot).robot
        if robot.mirror is None or robot.mirror.source != "external":
            raise InputError(
                f'RobotPoseOrder: robot {self.robot!r} does not take poses; add <pose source="external"/> to it'
            )
        check_time(self, float(simulation.world.times[self.environment]))

    def apply(self, simulation: Any) -> None:
        """Add the sample."""
        world, e = simulation.world, self.environment
        time = float(world.times[e]) if self.time is None else self.time
        give_pose(world, f"robot/{self.robot}", time, self.pose, e)

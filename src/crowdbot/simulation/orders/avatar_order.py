"""AvatarOrder and RobotPoseOrder: samples of the pose of an avatar or of a robot that is led from outside."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from crowdbot.core import InputError, did_you_mean
from crowdbot.humans import BodyPose
from crowdbot.world import give_pose

from .order import Order, OrderTarget

AHEAD = 10.0
"""Longest time [s] by which a sample can be ahead of the current time."""
LATEST = 1e7
"""Largest time stamp [s]."""


def check_time(order: Any, now: float = math.inf) -> float | None:
    """Return the time stamp of a sample [s], None for the current time.

    Raises:
        InputError: it is not a finite number, or more than 10 s after the current time ``now`` [s].
    """
    time, name = order.time, type(order).__name__
    if time is None:
        return None
    if isinstance(time, bool) or not isinstance(time, int | float) or not abs(time) <= LATEST:
        raise InputError(f"{name}: time = {time!r} must be a finite number of seconds")
    if time > now + AHEAD:
        raise InputError(f"{name}: time = {time} s is more than {AHEAD:g} s after the current {now:g} s")
    return float(time)


@dataclass(frozen=True, kw_only=True)
class AvatarOrder(Order):
    """Give the pose of an avatar with ``source="external"`` at a time.

    The avatar is then where its samples say at the current time. A sample for the time of the next step, given before
    that step, has no lag: crowd, sensors and record of that step see it. A sample that is too late changes nothing.

    Fields:
        avatar: name of the avatar.
        time: time stamp in simulated time [s], at most 10 s ahead; None: the current time.
        x, y: position [m].
        heading: direction of the trunk [rad].
        head, left_hand, right_hand: x, y, z [m] and a quaternion w, x, y, z in the world frame; None: as in the gait.
        skeleton: the whole skeleton. See :class:`crowdbot.humans.BodyPose` for all of these.
        gaze: direction of the eyes in the frame of ``head`` (x ahead, y left, z up), a unit vector; None: not measured.
            It is recorded and moves nothing.

    Raises:
        InputError: a value is not finite or out of range, or there is a gaze without a head.

    >>> AvatarOrder(avatar="guide", x=1.0, y=2.0, time=0.1, right_hand=(1.2, 1.7, 1.6, 1, 0, 0, 0)).pose.heading
    0.0
    """

    avatar: str
    time: float | None = None
    x: float
    y: float
    heading: float = 0.0
    head: tuple[float, ...] | None = None
    left_hand: tuple[float, ...] | None = None
    right_hand: tuple[float, ...] | None = None
    skeleton: tuple[float, ...] | None = None
    gaze: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        try:
            pose = self.pose
        except InputError as error:
            raise InputError(f"AvatarOrder: {str(error).removeprefix('BodyPose: ')}") from None
        for name in ("x", "y", "heading", "head", "left_hand", "right_hand", "skeleton"):
            object.__setattr__(self, name, getattr(pose, name))
        object.__setattr__(self, "time", check_time(self))
        if self.gaze is not None:
            object.__setattr__(self, "gaze", self._unit_gaze())

    def _unit_gaze(self) -> tuple[float, ...]:
        """Return the direction of the eyes with length 1."""
        values = list(self.gaze) if isinstance(self.gaze, list | tuple | np.ndarray) else []
        if (
            len(values) != 3
            or not all(isinstance(value, int | float | np.number) for value in values)
            or self.head is None
        ):
            raise InputError(
                f"AvatarOrder: gaze = {self.gaze!r} must be 3 numbers, a direction in the frame of the head"
            )
        length = math.hypot(*(float(value) for value in values))
        if not 1e-6 <= length <= 1e6:
            raise InputError(f"AvatarOrder: gaze = {self.gaze!r} has the length {length:g}; it must be a direction")
        return tuple(float(value) / length for value in values)

    @property
    def pose(self) -> BodyPose:
        """The pose of the sample."""
        return BodyPose(self.x, self.y, self.heading, self.head, self.left_hand, self.right_hand, self.skeleton)

    def check(self, simulation: OrderTarget) -> None:
        super().check(simulation)
        known = {avatar.name: avatar.source for avatar in simulation.trial.avatars}
        if self.avatar not in known:
            raise InputError(
                f"there is no avatar {self.avatar!r}{did_you_mean(self.avatar, known)}; the trial has"
                f" {', '.join(known) or 'none'}"
            )
        if known[self.avatar] != "external":
            raise InputError(
                f'avatar {self.avatar!r} has source="{known[self.avatar]}"; only one with source="external" takes them'
            )
        check_time(self, float(simulation.world.times[self.environment]))

    def apply(self, simulation: OrderTarget) -> None:
        world, e = simulation.world, self.environment
        time = float(world.times[e]) if self.time is None else self.time
        give_pose(world, self.avatar, time, self.pose, e)


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
        super().check(simulation)
        robot = simulation.control_of(self.robot).robot
        if robot.mirror is None or robot.mirror.source != "external":
            raise InputError(
                f'RobotPoseOrder: robot {self.robot!r} does not take poses; add <pose source="external"/> to it'
            )
        check_time(self, float(simulation.world.times[self.environment]))

    def apply(self, simulation: Any) -> None:
        world, e = simulation.world, self.environment
        time = float(world.times[e]) if self.time is None else self.time
        give_pose(world, f"robot/{self.robot}", time, self.pose, e)

"""Legged base: a walking robot as a planar base, without steps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crowdbot.core import Pose, Twist, check_number

from .drive import Drive, Twists, check_limits, check_step, integrate_twist
from .wheeled import limit_twists

NO_WHEELS = np.zeros((0, 3))


@dataclass(frozen=True)
class LeggedDrive(Drive):
    """A walking robot as a planar base: it moves and turns in every direction, slower sideways than ahead.

    The gait is not simulated: legs keep their posture, feet glide, and the height of the base is constant. In the
    physics world the base is moved directly. Velocities are inside the ellipse with the half axes ``max_speed`` and
    ``max_side_speed``; a command outside is shortened.

    Fields:
        max_speed: maximum speed forwards and backwards [m/s].
        max_side_speed: maximum lateral speed [m/s], at most ``max_speed``.
        max_turn_rate: maximum turn rate [rad/s].
        max_acceleration: maximum acceleration vector length [m/s2].
        max_turn_acceleration: maximum angular acceleration [rad/s2].

    Raises:
        InputError: a limit is not finite and above 0, or ``max_side_speed`` exceeds ``max_speed``.

    >>> drive = LeggedDrive(max_speed=1.0, max_side_speed=0.5, max_acceleration=10.0)
    >>> _, twist = drive.step(Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(), 1), Twist(0.0, 0.0, left=2.0), dt=0.5)
    >>> twist.at(0)
    Twist(forward=0.0, turn=0.0, left=0.5)
    """

    max_speed: float = 1.0
    max_side_speed: float = 0.5
    max_turn_rate: float = 1.0
    max_acceleration: float = 1.0
    max_turn_acceleration: float = 2.0

    def __post_init__(self) -> None:
        check_limits(self)
        check_number("LeggedDrive", "max_side_speed", self.max_side_speed, "m/s", exclusive_min=0.0, max=self.max_speed)

    def step(self, pose: Pose, twist: Twists, command: Twist | Twists, dt: float) -> tuple[Pose, Twists]:
        check_step(dt)
        after = limit_twists(
            twist,
            Twists.of(command, len(pose.heading)),
            matrix=NO_WHEELS,
            max_wheel_speed=1.0,
            sideways=self.max_side_speed / self.max_speed,
            speeds=(self.max_speed, self.max_turn_rate),
            changes=(self.max_acceleration * dt, self.max_turn_acceleration * dt),
        )
        return integrate_twist(pose, after, dt), after

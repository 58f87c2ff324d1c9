"""A drive that steers: front wheels turn, rear wheels roll, as a car's do."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError, Pose, Twist, check_number

from .drive import Drive, Floats, Twists, check_step, integrate_twist

__all__ = ["AckermannDrive", "SteeredTwists"]


@dataclass(frozen=True)
class SteeredTwists(Twists):
    """The twist of a car and how far its front wheels are turned: ``steering`` ``[E]`` [rad], left is positive."""

    steering: Floats


@dataclass(frozen=True)
class AckermannDrive(Drive):
    """A car, as its bicycle: the middle of the rear axle is the robot's origin and never moves sideways.

    A command asks for a speed and a turn rate; the wheels steer to ``atan(wheelbase * turn / forward)``, as fast as
    they can, and stay as they are when the command asks for neither. So the car cannot turn on the spot; the turn rate
    that it reaches follows from speed and steering. The steering, which nobody observes, is carried along in the twist
    that :meth:`step` returns; a plain :class:`Twists` stands for wheels that fit it.

    Fields:
        max_speed: forwards and backwards [m/s].
        max_acceleration: speeding up and braking [m/s2].
        max_steering: largest angle of the (middle of the) front wheels [rad].
        max_steering_rate: [rad/s].
        wheelbase: from rear to front axle [m].

    Raises:
        InputError: a limit is not finite or not above 0, or the steering is not below a right angle.

    >>> drive = AckermannDrive(max_acceleration=10.0, max_steering_rate=10.0)
    >>> _, twist = drive.step(Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(), 1), Twist(1.0, 9.0), dt=0.1)
    >>> round(twist.at(0).turn, 6) == round(math.tan(drive.max_steering) / drive.wheelbase, 6)
    True
    """

    max_speed: float = 1.5
    max_acceleration: float = 1.0
    max_steering: float = 0.6
    max_steering_rate: float = 1.0
    wheelbase: float = 0.6

    def __post_init__(self) -> None:
        units = {"max_speed": "m/s", "max_acceleration": "m/s2", "max_steering_rate": "rad/s", "wheelbase": "m"}
        for name, unit in units.items():
            check_number("AckermannDrive", name, getattr(self, name), unit, exclusive_min=0.0)
        if not 0.0 < self.max_steering < math.pi / 2:
            raise InputError(f"AckermannDrive: max_steering = {self.max_steering} rad must be above 0 and below pi / 2")

    @property
    def turning_radius(self) -> float:
        """Smallest radius of the circle of its origin [m]."""
        return self.wheelbase / math.tan(self.max_steering)

    @property
    def max_turn_rate(self) -> float:
        """Largest turn rate, at full speed and steering [rad/s]."""
        return self.max_speed / self.turning_radius

    def step(self, pose: Pose, twist: Twists, command: Twist | Twists, dt: float) -> tuple[Pose, Twists]:
        """Return pose and twist ``dt`` [s] later; see :class:`AckermannDrive`."""
        wanted = Twists.of(command, len(pose.heading))
        check_step(dt)
        now = twist.steering if isinstance(twist, SteeredTwists) else self._fitting(twist)
        asked = np.where((wanted.forward == 0.0) & (wanted.turn == 0.0), now, self._fitting(wanted))
        change = self.max_steering_rate * dt
        steering = np.clip(np.clip(asked, -self.max_steering, self.max_steering), now - change, now + change)
        speed = np.clip(wanted.forward, -self.max_speed, self.max_speed)
        push = self.max_acceleration * dt
        forward = np.clip(speed, twist.forward - push, twist.forward + push)
        turn = forward * np.tan(steering) / self.wheelbase
        after = SteeredTwists(forward, turn, np.zeros_like(forward), steering)
        return integrate_twist(pose, after, dt), after

    def _fitting(self, twist: Twists) -> Floats:
        """Return the steering ``[E]`` [rad] that gives this turn rate at this speed; backwards, it mirrors."""
        backwards = np.where(twist.forward < 0.0, -1.0, 1.0)
        return np.asarray(np.arctan2(self.wheelbase * twist.turn * backwards, np.abs(twist.forward)))

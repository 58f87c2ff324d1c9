"""Steered bases: Ackermann drive (front wheels, as in a car) and tricycle drive (one wheel steers and drives)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError, Pose, Twist, check_number, storable
from crowdbot.typing import Floats

from .drive import Drive, Twists, check_step, integrate_twist


@storable
@dataclass(frozen=True)
class SteeredTwists(Twists):
    """Twist of a car with its steering angle: ``steering`` ``[E]`` [rad], left is positive."""

    steering: Floats


@dataclass(frozen=True)
class AckermannDrive(Drive):
    """Bicycle model of a car. The origin is the centre of the rear axle, which does not move sideways.

    The wheels steer towards ``atan(wheelbase * turn / forward)`` of the command, limited by the steering rate, and keep
    their angle if the command is zero. The turn rate follows from speed and steering angle; the car cannot turn on the
    spot. The twist returned by :meth:`step` contains the steering angle; for a plain :class:`Twists`, the angle is
    computed from the twist.

    Fields:
        max_speed: maximum speed, forwards and backwards [m/s].
        max_acceleration: maximum acceleration and deceleration [m/s2].
        max_steering: maximum steering angle of the (virtual central) front wheel [rad].
        max_steering_rate: maximum steering rate [rad/s].
        wheelbase: distance between the axles [m].

    Raises:
        InputError: a limit is not finite or not above 0, or ``max_steering`` is not below pi / 2.

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
        """Minimum turning radius of the origin [m]."""
        return self.wheelbase / math.tan(self.max_steering)

    @property
    def max_turn_rate(self) -> float:
        """Maximum turn rate [rad/s], at maximum speed and steering angle."""
        return self.max_speed / self.turning_radius

    def motion(self, steering: float) -> Twist:
        """Return the twist per 1 m/s of the rear axle at a steering angle [rad]."""
        return Twist(1.0, math.tan(steering) / self.wheelbase)

    def rolling(self, twist: Twist | Twists, steering: Floats) -> Floats:
        """Return the signed speed ``[E]`` [m/s] of the rear axle."""
        return np.asarray(twist.forward)

    def step(self, pose: Pose, twist: Twists, command: Twist | Twists, dt: float) -> tuple[Pose, Twists]:
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
        """Return the steering angle ``[E]`` [rad] of a twist; mirrored for backward motion."""
        backwards = np.where(twist.forward < 0.0, -1.0, 1.0)
        return np.asarray(np.arctan2(self.wheelbase * twist.turn * backwards, np.abs(twist.forward)))


ACROSS = 1e-9
"""Smaller cosines of the steering angle are rounding errors: the wheel is across the base."""


@dataclass(frozen=True)
class TricycleDrive(Drive):
    """Tricycle, as in forklifts and floor scrubbers. The origin is the centre of the free axle.

    A wheel at ``x = wheelbase`` steers to the angle ``s`` and rolls at the speed ``v`` [m/s]: the base moves at
    ``forward = v cos(s)`` and ``turn = v sin(s) / wheelbase``. Back: ``s = atan2(turn * wheelbase, forward)``, and
    ``v = hypot(forward, turn * wheelbase)``; the wheel rolls backwards instead of steering beyond 90 degrees. With a
    steering angle of 90 degrees the base turns on the spot. While the wheel still steers, it rolls at the share
    ``cos`` of the remaining angle, and not so fast that the base moves ahead faster than asked: it waits until it is
    across before it turns the base on the spot. A command for a tighter curve than possible keeps its forward speed.

    Source: R. Siegwart, I. Nourbakhsh, Introduction to Autonomous Mobile Robots, 3.3; tricycle_controller of
    ros2_controllers.

    Fields:
        max_speed: maximum speed of the steered wheel over the ground [m/s].
        max_acceleration: maximum acceleration and deceleration of that wheel [m/s2].
        max_steering: maximum steering angle [rad], at most pi / 2.
        max_steering_rate: maximum steering rate [rad/s].
        wheelbase: distance from the steered wheel to the free axle [m].

    Raises:
        InputError: a limit is not finite or not above 0, or ``max_steering`` is above pi / 2.

    >>> drive = TricycleDrive(max_acceleration=10.0, max_steering_rate=20.0, max_steering=math.pi / 2, wheelbase=0.5)
    >>> _, twist = drive.step(Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(), 1), Twist(0.0, 1.0), dt=0.1)
    >>> round(twist.at(0).turn, 6), round(twist.at(0).forward, 6)
    (1.0, 0.0)
    """

    max_speed: float = 1.0
    max_acceleration: float = 1.0
    max_steering: float = 1.2
    max_steering_rate: float = 1.5
    wheelbase: float = 0.6

    def __post_init__(self) -> None:
        units = {"max_speed": "m/s", "max_acceleration": "m/s2", "max_steering_rate": "rad/s", "wheelbase": "m"}
        for name, unit in units.items():
            check_number("TricycleDrive", name, getattr(self, name), unit, exclusive_min=0.0)
        if not 0.0 < self.max_steering <= math.pi / 2:
            raise InputError(
                f"TricycleDrive: max_steering = {self.max_steering} rad must be above 0 and at most pi / 2"
            )

    @property
    def turning_radius(self) -> float:
        """Minimum turning radius of the origin [m]; 0 if the base turns on the spot."""
        return self.wheelbase / math.tan(self.max_steering) if self.max_steering < math.pi / 2 else 0.0

    @property
    def max_turn_rate(self) -> float:
        """Maximum turn rate [rad/s], at maximum speed and steering angle."""
        return self.max_speed * math.sin(self.max_steering) / self.wheelbase

    def motion(self, steering: float) -> Twist:
        """Return the twist per 1 m/s of the steered wheel at a steering angle [rad]."""
        return Twist(math.cos(steering), math.sin(steering) / self.wheelbase)

    def rolling(self, twist: Twist | Twists, steering: Floats) -> Floats:
        """Return the signed speed ``[E]`` [m/s] of the steered wheel over the ground."""
        return np.asarray(np.cos(steering) * twist.forward + np.sin(steering) * self.wheelbase * twist.turn)

    def step(self, pose: Pose, twist: Twists, command: Twist | Twists, dt: float) -> tuple[Pose, Twists]:
        wanted = Twists.of(command, len(pose.heading))
        check_step(dt)
        now = twist.steering if isinstance(twist, SteeredTwists) else self._goal(twist, np.zeros_like(twist.forward))
        asked = self._goal(wanted, now)
        change = self.max_steering_rate * dt
        steering = np.clip(asked, now - change, now + change)
        along = np.hypot(wanted.forward, self.wheelbase * wanted.turn)
        backwards = np.cos(asked) * wanted.forward + np.sin(asked) * self.wheelbase * wanted.turn < 0.0
        if self.max_steering < math.pi / 2:  # a curve that is too tight keeps its forward speed
            tight = np.abs(wanted.turn) * self.wheelbase > np.abs(wanted.forward) * math.tan(self.max_steering)
            along = np.where(tight, np.abs(wanted.forward) / math.cos(self.max_steering), along)
        goal = np.minimum(along, self.max_speed) * np.cos(asked - steering) * np.where(backwards, -1.0, 1.0)
        ahead = np.abs(wanted.forward) / np.maximum(np.cos(steering), ACROSS)
        goal = np.where(steering == asked, goal, np.clip(goal, -ahead, ahead))
        push = self.max_acceleration * dt
        before = self.rolling(twist, now)
        speed = np.clip(goal, before - push, before + push)
        after = SteeredTwists(
            speed * np.cos(steering), speed * np.sin(steering) / self.wheelbase, np.zeros_like(speed), steering
        )
        return integrate_twist(pose, after, dt), after

    def _goal(self, twist: Twists, now: Floats) -> Floats:
        """Return the steering angle ``[E]`` [rad] of a twist; on the spot, that nearest to the angles ``now``."""
        tip = self.wheelbase * twist.turn
        sign = np.where(twist.forward < 0.0, -1.0, 1.0)
        angle = np.arctan2(sign * tip, np.abs(twist.forward))
        angle = np.where((twist.forward == 0.0) & (tip * now < 0.0), -angle, angle)
        still = (twist.forward == 0.0) & (twist.turn == 0.0)
        return np.clip(np.where(still, now, angle), -self.max_steering, self.max_steering)

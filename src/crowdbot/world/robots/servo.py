"""Velocity servo with lag, and the delay of commands."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError, Pose, Twist, check_number

from .drive import Drive, Twists, check_limits, check_step, integrate_twist

__all__ = ["CommandDelay", "Pending", "VelocityServo"]

NEAR = 1e-9
"""Tolerance [m/s, rad/s] within which a velocity has reached its command."""


@dataclass(frozen=True)
class VelocityServo(Drive):
    """A base with a velocity controller: the twist approaches the command exponentially, within limits.

    Fields:
        max_speed: maximum speed in any direction [m/s].
        max_turn_rate: maximum turn rate [rad/s].
        max_acceleration: maximum acceleration vector length [m/s2].
        max_turn_acceleration: maximum angular acceleration [rad/s2].
        time_constant: time constant of the lag [s], in which an error falls to 37 %.
        sideways: whether the ``left`` part of a command is applied.

    Raises:
        InputError: a limit is not finite or not above 0.

    >>> servo = VelocityServo(time_constant=0.5, max_acceleration=100.0)
    >>> _, twist = servo.step(Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(), 1), Twist(1.0, 0.0), dt=0.5)
    >>> round(twist.at(0).forward, 3)
    0.632
    """

    max_speed: float = 1.0
    max_turn_rate: float = 1.5
    max_acceleration: float = 1.0
    max_turn_acceleration: float = 3.0
    time_constant: float = 0.1
    sideways: bool = False

    def __post_init__(self) -> None:
        check_limits(self)
        check_number("VelocityServo", "time_constant", self.time_constant, "s", exclusive_min=0.0)

    def step(self, pose: Pose, twist: Twists, command: Twist | Twists, dt: float) -> tuple[Pose, Twists]:
        """Return pose and twist ``dt`` [s] later; see :class:`VelocityServo`."""
        wanted = Twists.of(command, len(pose.heading))
        check_step(dt)
        left = wanted.left if self.sideways else np.zeros_like(wanted.left)
        length = np.maximum(np.hypot(wanted.forward, left), 1e-300)
        share = np.minimum(1.0, self.max_speed / length)
        goal = np.stack([wanted.forward * share, left * share], axis=-1)
        turning = np.clip(wanted.turn, -self.max_turn_rate, self.max_turn_rate)
        gain = -math.expm1(-dt / self.time_constant)
        now = np.stack([twist.forward, twist.left], axis=-1)
        error = goal - now
        push = error * gain
        size = np.maximum(np.hypot(push[:, 0], push[:, 1]), 1e-300)
        push *= np.minimum(1.0, self.max_acceleration * dt / size)[:, None]
        velocity = np.where(np.abs(error) < NEAR, goal, now + push)
        twisting = turning - twist.turn
        change = self.max_turn_acceleration * dt
        turn = np.where(np.abs(twisting) < NEAR, turning, twist.turn + np.clip(twisting * gain, -change, change))
        after = Twists(np.ascontiguousarray(velocity[:, 0]), turn, np.ascontiguousarray(velocity[:, 1]))
        return integrate_twist(pose, after, dt), after


class Pending(NamedTuple):
    """A delayed command and the time [s] until it takes effect."""

    wait: float
    command: Twist | Twists


@dataclass(frozen=True)
class CommandDelay:
    """Delay between a command and the wheels.

    A step uses the command in force at its start; the latency is therefore rounded up to whole steps. The caller stores
    the pending commands.

    Fields:
        latency: delay [s].

    >>> delay, pending, now = CommandDelay(0.2), (), Twist()
    >>> for _ in range(3):
    ...     pending, now = delay.step(pending, now, Twist(1.0, 0.0), dt=0.1)
    ...     print(now.forward, len(pending))
    0.0 1
    0.0 2
    1.0 2
    """

    latency: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.latency < math.inf:
            raise InputError(f"CommandDelay: latency = {self.latency} s must be finite and at least 0")

    def step(
        self, pending: tuple[Pending, ...], now: Twist | Twists, command: Twist | Twists, dt: float
    ) -> tuple[tuple[Pending, ...], Twist | Twists]:
        """Return the pending commands after a step of ``dt`` [s], and the command in force during the step.

        Args:
            pending: result of the previous step, initially empty.
            now: command in force before the step, initially ``Twist()``.
            command: new command at the start of the step.
            dt: time step [s].

        Raises:
            InputError: ``dt`` is not positive.
        """
        check_step(dt)
        waiting = [*pending, Pending(self.latency, command)]
        while waiting and waiting[0].wait <= 1e-9:
            now = waiting.pop(0).command
        return tuple(Pending(one.wait - dt, one.command) for one in waiting), now

"""Velocity servo with lag, and the delay of commands."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError, Pose, Twist, check_number, kernel, storable
from crowdbot.typing import Floats

from .drive import Drive, Twists, check_limits, check_step, integrate_twist

NEAR = 1e-9
"""Tolerance [m/s, rad/s] within which a velocity has reached its command."""


@kernel
def _approach(
    forward: Floats, turn: Floats, left: Floats, wanted: Floats, wanted_turn: Floats, wanted_left: Floats,
    sideways: bool, top: float, most: float, push: float, spin: float, gain: float, out: Floats,
) -> None:  # fmt: skip
    """Write the twists ``[3, E]`` that approach the commands by a share ``gain``, within limits."""
    for e in range(len(forward)):
        aside = wanted_left[e] if sideways else 0.0
        share = min(1.0, top / max(math.hypot(wanted[e], aside), 1e-300))
        goal_x, goal_y = wanted[e] * share, aside * share
        error_x, error_y = goal_x - forward[e], goal_y - left[e]
        push_x, push_y = error_x * gain, error_y * gain
        share = min(1.0, push / max(math.hypot(push_x, push_y), 1e-300))
        out[0, e] = goal_x if abs(error_x) < NEAR else forward[e] + push_x * share
        out[2, e] = goal_y if abs(error_y) < NEAR else left[e] + push_y * share
        turning = min(max(wanted_turn[e], -most), most)
        twisting = turning - turn[e]
        change = min(max(twisting * gain, -spin), spin)
        out[1, e] = turning if abs(twisting) < NEAR else turn[e] + change


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
        wanted = Twists.of(command, len(pose.heading))
        check_step(dt)
        gain = -math.expm1(-dt / self.time_constant)
        columns = np.empty((3, len(pose.heading)))
        now = (twist.forward, twist.turn, twist.left, wanted.forward, wanted.turn, wanted.left)
        limits = (float(self.max_speed), float(self.max_turn_rate))
        changes = (self.max_acceleration * dt, self.max_turn_acceleration * dt)
        _approach(*now, self.sideways, *limits, *changes, gain, columns)
        after = Twists.of_columns(columns)
        return integrate_twist(pose, after, dt), after


@storable
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
        return tuple(Pending(item.wait - dt, item.command) for item in waiting), now

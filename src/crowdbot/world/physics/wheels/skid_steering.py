"""Control of skid steering: wheel speeds follow the measured slip."""

from __future__ import annotations

import math
from dataclasses import dataclass

from crowdbot.core import Twist
from crowdbot.world.robots.drives.drive import Twists
from crowdbot.world.robots.drives.skid_steer import SkidSteerDrive
from crowdbot.world.robots.robot import Robot

__all__ = ["SlipControl", "SlipState"]

LAG = 0.05
"""Time [s] by which the base follows its wheels."""
RATE = 3.0
"""Rate [1/s] of the estimate of the slip."""
QUIET = 0.1
"""Turn rate [rad/s] below which slip is hardly estimated."""
MOST = 2.5
"""Maximum of the estimated factor, and of its inverse."""

SlipState = tuple[float, float, float, float]
"""Factor of the difference of the sides, offset [m] of the centre of turning, and forward speed [m/s] and turn rate
[rad/s] expected by now."""


@dataclass(frozen=True)
class SlipControl:
    """Wheel speeds of a skid-steer base from its own velocity, as a controller with a gyro and odometry sets them.

    The sides of the base turn about their instantaneous centres of rotation, which depend on friction and loads. The
    control estimates them while the base turns: the slip factor ``k`` (effective track divided by track) and the offset
    ``c`` of their middle, both relative to the balance of forces of :meth:`SkidSteerDrive.slide`. For a command
    ``(v, w)``, the sides get the speeds of that balance with ``k`` times their difference, and ``c w`` added to both.
    Both are corrected by the error of the twist, by a least-mean-squares step with the rate ``RATE``. The factor begins
    with 1 and stays within ``1 / MOST`` and ``MOST``. The velocity is that of the engine, without noise.

    Source: A. Mandow et al., Experimental kinematics for wheeled skid-steer mobile robots, IROS 2007; J. Pentzer et
    al., Model-based prediction of skid-steer robot kinematics using online estimation of track instantaneous centers of
    rotation, Journal of Field Robotics 31(3), 2014.

    Fields:
        drive: the drive.

    >>> control = SlipControl(SkidSteerDrive(track=0.4, wheelbase=0.4))
    >>> state = control.step(control.first, Twist(0.0, 1.0), Twist(), 0.005)
    >>> turning = Twists.of(Twist(0.0, 1.0), 1)
    >>> state[0] > 1.0, round(control.wheels(control.first, turning, turning, 0.005).turn, 2)
    (True, 2.0)
    """

    drive: SkidSteerDrive

    @classmethod
    def of(cls, robot: Robot) -> SlipControl | None:
        """Return the control of a robot, None for one that does not skid."""
        drive = robot.drive
        if robot.base != "wheels" or not isinstance(drive, SkidSteerDrive):
            return None
        return cls(drive)

    @property
    def first(self) -> SlipState:
        """State before the first step."""
        return (1.0, 0.0, 0.0, 0.0)

    def step(self, state: SlipState, wanted: Twist, found: Twist, dt: float) -> SlipState:
        """Return the new state.

        Args:
            state: state before the step.
            wanted: twist that the base is to have.
            found: its twist.
            dt: time step [s].
        """
        factor, offset, forward, turn = state
        gain = -math.expm1(-dt / LAG)
        forward, turn = forward + gain * (wanted.forward - forward), turn + gain * (wanted.turn - turn)
        share = RATE * dt * turn / (turn * turn + QUIET * QUIET)
        factor += factor * share * (turn - found.turn)
        offset += share * (forward - found.forward)
        factor, most = min(max(factor, 1.0 / MOST), MOST), self.drive.track
        offset = min(max(offset, -most), most)
        return (factor, offset, forward, turn)

    def wheels(self, state: SlipState, old: Twists, new: Twists, dt: float) -> Twist:
        """Return the twist for which the wheels turn without slip, so that the base has another one with it.

        Args:
            state: the estimate.
            old, new: twists of the base before and after the step, E = 1.
            dt: time step [s].
        """
        factor, offset, _, _ = state
        left, right, _ = self.drive.slide(old, new, dt)[0].tolist()
        middle = 0.5 * (left + right) + offset * float(new.turn[0])
        return Twist(middle, factor * (right - left) / self.drive.track)

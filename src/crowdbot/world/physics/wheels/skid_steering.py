"""Control of skid steering: wheel speeds follow the measured slip."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crowdbot.core import Twist
from crowdbot.typing import Floats
from crowdbot.world.physics.robots.wheel_servo import lag
from crowdbot.world.robots.drives.skid_slide import GRAVITY, rims_of
from crowdbot.world.robots.drives.skid_steer import SkidSteerDrive
from crowdbot.world.robots.robot import Robot

RATE = 3.0
"""Rate [1/s] of the estimate of the slip."""
RETURN = 0.025
"""Time [s] in which an error of the twist is corrected where the tyres slide."""
GAIN = 2.0
"""Largest correction of the wheels by an error of the twist."""
LEAST = 0.06
"""Slip [m/s] that the wheels may have beyond ``MOST`` times that of a steady turn."""
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
        tires: ``[W, 5]`` places and levers of the driven wheels, see :func:`rims_of`.
        gyration: squared radius of gyration about the vertical [m2].
        weight: weight of the robot [N].
    """

    drive: SkidSteerDrive
    tires: Floats
    gyration: float
    weight: float

    @classmethod
    def of(cls, robot: Robot) -> SlipControl | None:
        """Return the control of a robot, None for one that does not skid."""
        drive = robot.drive
        if robot.base != "wheels" or not isinstance(drive, SkidSteerDrive):
            return None
        whole, poses = robot.model.inertial(robot.posture), robot.model.poses(robot.posture)
        joints = [robot.model.joints[wheel.joint] for wheel in robot.wheels if wheel.driven]
        places = np.array([(poses[joint.parent] @ joint.origin)[:2, 3] for joint in joints])
        middle, count = np.array([drive.wheels_x, 0.0]), len(places)
        tires = np.concatenate([places - middle, np.full((count, 1), 1.0 / count), places - whole.center[:2]], axis=1)
        return cls(drive, tires, float(whole.tensor[2, 2]) / whole.mass, GRAVITY * whole.mass)

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
        gain = -math.expm1(-dt / lag(dt))
        forward, turn = forward + gain * (wanted.forward - forward), turn + gain * (wanted.turn - turn)
        share = RATE * dt * turn / (turn * turn + QUIET * QUIET)
        factor += factor * share * (turn - found.turn)
        offset += share * (forward - found.forward)
        factor, most = min(max(factor, 1.0 / MOST), MOST), self.drive.track
        offset = min(max(offset, -most), most)
        return (factor, offset, forward, turn)

    def wheels(self, state: SlipState, old: Twist, new: Twist, found: Twist, loads: Floats, dt: float) -> Twist:
        """Return the twist for which the wheels turn without slip, so that the base has another one with it.

        Args:
            state: the estimate.
            old, new: twists that the base is to have before and after the step.
            found: its twist.
            loads: normal forces ``[W]`` [N] of the driven wheels; all 0 before the first step.
            dt: time step [s].
        """
        factor, offset, forward, turn = state
        drive, tires = self.drive, self.tires
        if loads.any():
            tires = tires.copy()
            tires[:, 2] = loads / self.weight
        grip = drive.friction * GRAVITY
        half = 0.5 * drive.track * drive.slip_factor * new.turn
        most = MOST * (abs(half) + LEAST)
        out = np.array([new.forward - half, new.forward + half])
        now = np.array([new.forward, new.turn, found.left + found.turn * drive.wheels_x])
        change = np.array([(new.forward - old.forward) / dt, (new.turn - old.turn) / dt])
        rims_of(now, change, tires, grip, self.gyration, most, out)
        slip = abs(half - 0.5 * drive.track * new.turn) + 0.5 * drive.wheelbase * abs(new.turn)
        gain = min(slip / (grip * RETURN), GAIN)
        middle = 0.5 * (out[0] + out[1]) + offset * new.turn + gain * (forward - found.forward)
        push = gain * drive.slip_factor * (turn - found.turn)
        return Twist(float(middle), float(factor * (out[1] - out[0]) / drive.track + push))

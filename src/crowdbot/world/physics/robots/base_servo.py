"""Forces that move a planar base along its commanded velocity."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from crowdbot.typing import Floats
from crowdbot.world.physics.engine import engine
from crowdbot.world.robots.drives.drive import Twists
from crowdbot.world.robots.robot import Robot

from .wheel_servo import lag

BASE_MOTORS = ("base_forward", "base_left", "base_turn")
"""Actuators of a planar base."""


class BaseForces:
    """Forces on a planar base: those of the commanded acceleration, and a correction of the velocity error.

    The forces are found before the contacts of a step, so a person in the way feels mass and motor force of the robot
    and no stiffness of the integrator.

    Args:
        robot: description of the robot.
        step: time step of the engine [s].
    """

    def __init__(self, robot: Robot, step: float) -> None:
        whole = robot.model.inertial(robot.posture)
        self._mass, self._turning = whole.mass, float(whole.tensor[2, 2])
        self._x, self._y = float(whole.center[0]), float(whole.center[1])
        self._step, self._lag = step, lag(step)

    @staticmethod
    def weigh(model: Any, data: Any, rows: list[int], heading: float) -> tuple[float, float, float]:
        """Return the masses ahead and aside [kg] and the inertia [kg m2] that the base feels at once.

        A body on soft joints, as the hips of Pepper, follows later.

        Args:
            model, data: model and data of the engine.
            rows: velocities of the base in the engine: x, y and turn rate.
            heading: heading of the base [rad].
        """
        unit, found = np.zeros((3, model.nv)), np.zeros((3, model.nv))
        unit[range(3), rows] = 1.0
        mj = engine()
        here = mj.MjData(model)  # the inertia of a new state is not known before its first step
        here.qpos[:] = data.qpos
        mj.mj_kinematics(model, here)
        mj.mj_comPos(model, here)
        mj.mj_makeM(model, here)
        mj.mj_factorM(model, here)
        mj.mj_solveM(model, here, found, unit)
        loose = np.linalg.inv(found[:, rows])
        cos, sin = math.cos(heading), math.sin(heading)
        turned = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
        ahead, aside, spin = np.diag(turned.T @ loose @ turned).tolist()
        return ahead, aside, spin

    def forces(
        self, old: Twists, new: Twists, velocity: Floats, heading: float, quick: tuple[float, float, float]
    ) -> tuple[float, float, float]:
        """Return forward force [N], left force [N] and torque [N m] for the next engine step.

        Args:
            old, new: commanded twists before and after the step, E = 1.
            velocity: velocity ``[3]`` of the base in the world: x, y [m/s], turn rate [rad/s].
            heading: heading [rad].
            quick: what the base feels at once, see :meth:`weigh`.
        """
        ahead, aside, spin = float(old.forward[0]), float(old.left[0]), float(old.turn[0])
        goal_ahead, goal_aside, goal_spin = float(new.forward[0]), float(new.left[0]), float(new.turn[0])
        vx, vy, turning = velocity.tolist()
        cos, sin = math.cos(heading), math.sin(heading)
        error_ahead, error_aside = ahead - cos * vx - sin * vy, aside - cos * vy + sin * vx
        bend, shrink = (
            math.sin(goal_spin * self._step) / self._step,
            (math.cos(goal_spin * self._step) - 1.0) / self._step,
        )
        twist = (spin - turning) / self._lag
        slow_ahead = shrink * goal_ahead - bend * goal_aside + error_ahead / self._lag
        slow_aside = bend * goal_ahead + shrink * goal_aside + error_aside / self._lag
        slow_ahead -= twist * self._y + turning * turning * self._x
        slow_aside += twist * self._x - turning * turning * self._y
        push, side, torque = self._mass * slow_ahead, self._mass * slow_aside, self._turning * twist
        torque += self._x * side - self._y * push
        mass_ahead, mass_aside, inertia = quick
        push += mass_ahead * (goal_ahead - ahead) / self._step
        side += mass_aside * (goal_aside - aside) / self._step
        return push, side, torque + inertia * (goal_spin - spin) / self._step


def release_base_motors(model: Any, prefix: str) -> None:
    """Make the actuators of a planar base plain forces, for :class:`BaseForces`."""
    for name in BASE_MOTORS:
        motor = int(model.actuator(prefix + name).id)
        model.actuator_gainprm[motor, 0] = 1.0
        model.actuator_biasprm[motor] = 0.0

"""Speed control of wheels and their steering, solved together with the contacts of their tyres."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from crowdbot.world.physics.engine import engine

LAG = 0.01
"""Time constant [s] of a wheel servo (assumed: a motor controller with a bandwidth of 16 Hz); at least two steps."""
STIFF = (0.9999, 0.9999, 1.0, 0.5, 2.0)
"""Solver impedance: the torque reaches the limit of the motor at a negligible error."""


class WheelServos:
    """Servos that hold wheels and steering joints at their commanded speeds, with at most the torque of the motors.

    A motor that is an actuator of the engine is either unstable with light wheels (explicit integration) or changes
    velocities after the tyre forces have been found (implicit integration), and the tyres slip. Here each servo is a
    friction constraint about the commanded speed, limited by the torque of the motor: the solver finds the torques of
    motors and the forces of tyres together. The friction of a joint takes its part of the torque; a motor that is not
    stronger does not turn it.

    Args:
        model: model of the engine; the motors of the wheels are replaced in it.
        torques: largest torque [N m] by actuator name, which is also the name of the joint.
    """

    def __init__(self, model: Any, torques: Mapping[str, float]) -> None:
        mj = engine()
        rows = [
            (int(model.joint(name).dofadr[0]), int(model.actuator(name).id), most) for name, most in torques.items()
        ]
        self.lag = lag(model.opt.timestep)
        rows.sort()
        self._turns = np.ones(len(rows))
        for k, (dof, motor, most) in enumerate(rows):
            model.actuator_gainprm[motor], model.actuator_biasprm[motor] = 0.0, 0.0
            friction = float(model.dof_frictionloss[dof])  # of the joint, which the motor has to overcome
            if most <= friction and friction > 0.0:
                self._turns[k] = 0.0
            else:
                model.dof_frictionloss[dof] = most - friction
            model.dof_solref[dof] = 2.0 * self.lag / STIFF[1], 1.0
            model.dof_solimp[dof] = STIFF
        rubbing = np.flatnonzero(model.dof_frictionloss > 0.0)
        self._rows = np.searchsorted(rubbing, [dof for dof, _, _ in rows])
        self._motors = np.array([motor for _, motor, _ in rows], dtype=np.int64)
        self._mj = mj

    def apply(self, data: Any) -> None:
        """Set the speeds that the wheels approach in this step, between ``mj_step1`` and ``mj_step2``."""
        if len(self._rows):
            data.efc_aref[data.ne + self._rows] += self._turns * data.ctrl[self._motors] / self.lag


def lag(step: float) -> float:
    """Return the time constant [s] of a wheel servo in an engine with this step [s]."""
    return max(LAG, 2.0 * step)

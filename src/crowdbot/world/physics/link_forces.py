"""Drag and kinematic links of robots in the engine."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .engine import engine
from .robot_body import RobotBody

__all__ = ["LinkForces"]

Floats = NDArray[np.float64]
UNLIMITED = 10.0
"""Speed [m/s or rad/s] of a kinematic joint whose motor has no maximum speed (assumed)."""


class LinkForces:
    """Drag and kinematic joints of the links of robots; call :meth:`begin` and :meth:`end` around an engine step.

    Links fixed to each other share one body in the engine; their drags add up, weighted by nothing but their own mass.

    Args:
        bodies: bodies of the robots.
        step: time step of the engine [s].
    """

    def __init__(self, bodies: Iterable[RobotBody], step: float) -> None:
        self.step = step
        self._drags: list[tuple[int, float, float]] = []
        self._joints: list[tuple[RobotBody, str, int, int, int, float]] = []
        self._next: list[tuple[int, int, float, float]] = []
        for body in bodies:
            for link in body.robot.links:
                index = int(body._model.site(body.prefix + link.name).bodyid[0])
                if link.drag or link.angular_drag:
                    self._drags.append((index, link.drag, link.angular_drag))
                if link.kinematic:
                    self._joints.append(self._joint(body, link.name))

    def __bool__(self) -> bool:
        """Return whether a link has a drag or is kinematic."""
        return bool(self._drags or self._joints)

    def _joint(self, body: RobotBody, link: str) -> tuple[RobotBody, str, int, int, int, float]:
        above = next(joint for joint in body.robot.model.joints.values() if joint.child == link)
        joint = body._model.joint(body.prefix + above.name)
        mj = engine()
        motor = int(mj.mj_name2id(body._model, mj.mjtObj.mjOBJ_ACTUATOR, body.prefix + above.name))
        if motor >= 0 and body._model.actuator_biasprm[motor, 1] == 0.0:
            motor = -1  # no position motor
        speed = above.motor.velocity if 0.0 < above.motor.velocity < math.inf else UNLIMITED
        return body, body.prefix + above.name, int(joint.qposadr[0]), int(joint.dofadr[0]), motor, speed

    def begin(self, model: Any, data: Any) -> None:
        """Apply drag, and set position and speed of kinematic joints, before an engine step."""
        if self._drags:
            self._apply_drags(model, data)
        self._next = []
        for body, name, place, dof, motor, fastest in self._joints:
            now = float(data.qpos[place])
            goal = float(data.ctrl[motor]) if motor >= 0 else body._held.get(name, now)
            speed = min(max((goal - now) / self.step, -fastest), fastest)
            data.qvel[dof] = speed
            self._next.append((place, dof, now + speed * self.step, speed))

    def end(self, data: Any) -> None:
        """Put kinematic joints where they move to, after an engine step."""
        for place, dof, position, speed in self._next:
            data.qpos[place], data.qvel[dof] = position, speed

    def _apply_drags(self, model: Any, data: Any) -> None:
        for index in {row[0] for row in self._drags}:
            data.xfrc_applied[index] = 0.0
        for index, drag, angular in self._drags:
            turn = data.ximat[index].reshape(3, 3)
            spin, move = data.cvel[index, :3], data.cvel[index, 3:]
            away = data.xipos[index] - data.subtree_com[model.body_rootid[index]]
            velocity = move + np.cross(spin, away)
            inertia = turn @ np.diag(model.body_inertia[index]) @ turn.T
            data.xfrc_applied[index, :3] -= self._rate(drag) * model.body_mass[index] * velocity
            data.xfrc_applied[index, 3:] -= self._rate(angular) * inertia @ spin

    def _rate(self, drag: float) -> float:
        """Return the rate with which an explicit step decays as the exact solution."""
        return -math.expm1(-drag * self.step) / self.step

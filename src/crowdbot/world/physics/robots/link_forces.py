"""Drag, kinematic links and held joints of robots in the engine."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np

from crowdbot.world.physics.engine import engine

from .robot_body import RobotBody

UNLIMITED = 10.0
"""Speed [m/s or rad/s] of a kinematic or held joint whose motor has no maximum speed (assumed)."""


class _MovedJoint(NamedTuple):
    """A joint that is put where it moves to: body, rows in the engine, position motor or -1, and maximum speed."""

    body: RobotBody
    place: int
    dof: int
    motor: int
    fastest: float

    @classmethod
    def of(cls, model: Any, body: RobotBody, name: str) -> _MovedJoint:
        """Return a joint of a robot."""
        mj, above = engine(), body.robot.model.joints[name]
        joint = model.joint(body.prefix + name)
        motor = int(mj.mj_name2id(model, mj.mjtObj.mjOBJ_ACTUATOR, body.prefix + name))
        if motor >= 0 and model.actuator_biasprm[motor, 1] == 0.0:
            motor = -1  # no position motor
        speed = above.motor.velocity if 0.0 < above.motor.velocity < math.inf else UNLIMITED
        return cls(body, int(joint.qposadr[0]), int(joint.dofadr[0]), motor, speed)


class LinkForces:
    """Drag, kinematic joints and held joints of robots.

    Kinematic joints, and joints without a position motor that have a target, move to it at up to their maximum speed
    and have this speed in contacts. In each engine step, call :meth:`note` before the motors get their commands, then
    :meth:`begin`, and :meth:`end` after it. Links fixed to each other are one body, to which each drag applies.

    Args:
        model: model of the engine.
        bodies: bodies of the robots.
        step: time step of the engine [s].
    """

    def __init__(self, model: Any, bodies: Iterable[RobotBody], step: float) -> None:
        self.step, self._model, self._bodies = step, model, tuple(bodies)
        self._drags: list[tuple[int, float, float]] = []
        self._joints: dict[str, _MovedJoint] = {}
        self._held: dict[str, tuple[_MovedJoint, float]] = {}
        self._next: list[tuple[int, int, float, float]] = []
        for body in self._bodies:
            for link in body.robot.links:
                index = int(model.site(body.prefix + link.name).bodyid[0])
                if link.drag or link.angular_drag:
                    self._drags.append((index, link.drag, link.angular_drag))
                if link.kinematic:
                    above = next(joint for joint in body.robot.model.joints.values() if joint.child == link.name)
                    self._joints[body.prefix + above.name] = _MovedJoint.of(model, body, above.name)

    def __bool__(self) -> bool:
        """Return whether a link has a drag or is kinematic, or a joint is held."""
        return bool(self._drags or self._joints or any(body.held for body in self._bodies))

    def note(self, data: Any) -> None:
        """Note where held joints are, before their bodies put them at their targets."""
        self._held = {}
        for body in self._bodies:
            for name in body.held:
                joint = self._joints.get(name) or _MovedJoint.of(self._model, body, name.removeprefix(body.prefix))
                self._held[name] = (joint, float(data.qpos[joint.place]))

    def begin(self, model: Any, data: Any) -> None:
        """Apply drag, and set position and speed of kinematic and held joints, before an engine step."""
        if self._drags:
            self._apply_drags(model, data)
        self._next = []
        for name in sorted(self._joints.keys() | self._held.keys()):
            joint, now = self._held.get(name) or (self._joints[name], float(data.qpos[self._joints[name].place]))
            goal = float(data.ctrl[joint.motor]) if joint.motor >= 0 else joint.body.held.get(name, now)
            speed = min(max((goal - now) / self.step, -joint.fastest), joint.fastest)
            data.qpos[joint.place], data.qvel[joint.dof] = now, speed
            self._next.append((joint.place, joint.dof, now + speed * self.step, speed))

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

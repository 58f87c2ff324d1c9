"""Robots whose pose comes from outside, in the engine: they keep to their path with the velocity of their motion."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from crowdbot.core import Scene, Twist, wrap_angle
from crowdbot.typing import Floats
from crowdbot.world.physics.engine import engine
from crowdbot.world.robots.drives.drive import Twists

from .robot_body import RobotBody

STILL = 1e-12
"""Change of velocity [m/s or rad/s] that needs no correction."""


class MirroredRobots:
    """Robots of one step of a physics world that are moved along the path to their new pose.

    Their base is kinematic: at each engine step it has the pose on this path and the velocity of the motion, which
    contacts do not change. So what a robot hits feels its speed. A robot stays upright at its height. Driven wheels
    roll with it.

    Args:
        bodies: bodies of these robots by agent.
        before, after: scenes with their poses at the start and at the end of the step, E = 1.
        dt: time step of the world [s].

    Attributes:
        twists: twist of each robot during the step.
    """

    def __init__(self, bodies: Mapping[int, RobotBody], before: Scene, after: Scene, dt: float) -> None:
        self.dt = dt
        self.twists: dict[int, Twists] = {}
        self._bases: list[_MirroredBase] = []
        for agent, body in bodies.items():
            start = (*before.position[0, agent].tolist(), float(before.heading[0, agent]))
            end = (*after.position[0, agent].tolist(), float(after.heading[0, agent]))
            base = _MirroredBase(body, start, end, dt)
            self._bases.append(base)
            self.twists[agent] = Twists.of(base.twist, 1)

    def go(self, share: float) -> None:
        """Put the robots where they are at this fraction of the step."""
        for base in self._bases:
            base.go(share * self.dt)


class _MirroredBase:
    """Base of one robot that moves from one pose x, y [m], heading [rad] to another in a time [s]."""

    def __init__(
        self, body: RobotBody, start: tuple[float, float, float], end: tuple[float, float, float], dt: float
    ) -> None:
        turn = wrap_angle(end[2] - start[2])
        self.start, self.turn = start, turn / dt
        self.vx, self.vy = (end[0] - start[0]) / dt, (end[1] - start[1]) / dt
        heading = start[2] + 0.5 * turn
        cos, sin = math.cos(heading), math.sin(heading)
        self.twist = Twist(cos * self.vx + sin * self.vy, self.turn, cos * self.vy - sin * self.vx)
        self._body, self._height = body, body.height
        self._wheels = body.robot.wheel_speeds(self.twist)

    def go(self, time: float) -> None:
        """Set pose and velocity at a time [s] after the start."""
        x, y, heading = self.start[0] + time * self.vx, self.start[1] + time * self.vy, self.start[2] + time * self.turn
        self._body.put(x, y, heading, (self.vx, self.vy, self.turn), self._height)
        self._body.turn_joints(self._wheels)


class KinematicBase:
    """Base of a robot that keeps its velocity in contacts.

    Within an engine step the base has the mass of the robot, so that contact forces are those of this mass. Setting the
    velocity of the base afterwards would leave the momentum of the contact in the joints above it: a torso on a soft
    knee would swing forward at several times the speed of the robot. Therefore the velocity is restored by an impulse
    on the base, which all joints feel.

    Args:
        model: model of the engine.
        data: data of the engine.
        prefix: prefix of the names of the robot.
    """

    def __init__(self, model: Any, data: Any, prefix: str) -> None:
        names = {model.joint(k).name for k in range(model.njnt)}
        planar = [f"{prefix}base_{axis}" for axis in ("x", "y", "yaw")]
        if f"{prefix}base" in names:
            first = int(model.joint(f"{prefix}base").dofadr[0])
            self._dofs = np.arange(first, first + 6)
        else:
            self._dofs = np.array([int(model.joint(name).dofadr[0]) for name in planar], dtype=np.int64)
        self._own = np.flatnonzero(model.dof_treeid == model.dof_treeid[self._dofs[0]])
        self._data = data
        self._wanted = np.zeros(len(self._dofs))

    def note(self) -> None:
        """Note the velocity of the base before an engine step."""
        self._wanted = self._data.qvel[self._dofs].copy()

    def restore(self, model: Any) -> None:
        """Restore the velocity of the base after an engine step with contacts."""
        lack = self._wanted - self._data.qvel[self._dofs]
        if float(np.max(np.abs(lack))) < STILL:
            return
        own, base = self._own, np.searchsorted(self._own, self._dofs)
        unit = np.zeros((len(own), len(base)))
        unit[base, np.arange(len(base))] = 1.0
        response = np.linalg.solve(self._inertia(model), unit)
        self._data.qvel[own] += response @ np.linalg.solve(response[base], lack)
        self._data.qvel[self._dofs] = self._wanted

    def _inertia(self, model: Any) -> Floats:
        """Return the inertia of the robot in the engine step, in which damped and driven joints are stiff."""
        data, mj = self._data, engine()
        whole, stiff = np.zeros((len(self._own), model.nv)), np.zeros((model.nv, model.nv))
        unit = np.zeros(model.nv)
        for row, dof in enumerate(self._own):
            unit[dof] = 1.0
            mj.mj_mulM(model, data, whole[row], unit)
            unit[dof] = 0.0
        pattern = model if hasattr(model, "D_rownnz") else data  # before MuJoCo 3.3 it is part of the data
        stiff[np.repeat(np.arange(model.nv), pattern.D_rownnz), pattern.D_colind] = data.qDeriv
        found = whole[:, self._own] - model.opt.timestep * stiff[np.ix_(self._own, self._own)]
        return np.asarray(0.5 * (found + found.T))


def kinematic_bases(
    model: Any, data: Any, bodies: Mapping[int, RobotBody], agents: Iterable[int]
) -> list[KinematicBase]:
    """Return the bases of the robots among ``bodies`` whose pose comes from outside."""
    return [KinematicBase(model, data, bodies[agent].prefix) for agent in agents if agent in bodies]

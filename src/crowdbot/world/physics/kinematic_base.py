"""Kinematic bases of mirrored robots: contacts change neither their velocity nor that of the body on them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.world.physics.robots.robot_body import RobotBody

from .engine import engine

__all__ = ["KinematicBase", "kinematic_bases"]

Floats = NDArray[np.float64]
STILL = 1e-12
"""Change of velocity [m/s or rad/s] that needs no correction."""


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

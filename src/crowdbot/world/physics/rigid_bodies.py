"""Rigid bodies that are simulated together: robots, props, and bodies of people."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from crowdbot.core import InputError, Storage
from crowdbot.typing import Floats
from crowdbot.world.physics.robots.link_forces import LinkForces
from crowdbot.world.physics.robots.robot_body import RobotBody

from .engine import engine
from .engine_models import BodyDesign, compile_bodies


class RigidBodies:
    """Robots and props with an engine state of their own.

    Args:
        design: content of the engine model.
        known: bodies of robots that continue, by agent; others are new.
        settled: start with robots at rest on the floor; False: the caller sets the state, see :func:`copy_state`.

    Attributes:
        compiled: the compiled model.
        data: state of the engine.
        robots: bodies of the robots by agent.
    """

    storage = Storage(constants=("compiled", "data"), properties=("engine",))

    def __init__(
        self, design: BodyDesign, known: Mapping[int, RobotBody] | None = None, *, settled: bool = True
    ) -> None:
        self.compiled = compile_bodies(design)
        self.data = copy.copy(self.compiled.rest_state if settled else self.compiled.first)
        self.robots: dict[int, RobotBody] = {}
        for start in design.robots:
            prefix = self.compiled.built.prefixes[start.agent]
            body = (known or {}).get(start.agent)
            if body is None:
                body = RobotBody(self.compiled.base, self.data, start.robot, prefix, design.step)
            else:
                body.bind(self.compiled.base, self.data)
            self.robots[start.agent] = body

    @property
    def design(self) -> BodyDesign:
        """Content of the engine model."""
        return self.compiled.design

    @property
    def engine(self) -> Floats:
        """State of the engine as one vector; its frames are computed after a change."""
        mj, model = engine(), self.compiled.base
        state = np.zeros(mj.mj_stateSize(model, mj.mjtState.mjSTATE_INTEGRATION))
        mj.mj_getState(model, self.data, state, mj.mjtState.mjSTATE_INTEGRATION)
        return state

    @engine.setter
    def engine(self, state: Floats) -> None:
        """Set the state of the engine.

        Raises:
            InputError: a value is not finite.
        """
        if not np.isfinite(state).all():
            raise InputError("a value of the engine is not finite")
        mj = engine()
        mj.mj_setState(self.compiled.base, self.data, state, mj.mjtState.mjSTATE_INTEGRATION)

    def step_alone(self, steps: int) -> None:
        """Advance by engine steps, without people."""
        mj = engine()
        links = LinkForces(self.compiled.base, self.robots.values(), self.design.step)
        with self.compiled.borrow() as model:
            for _ in range(steps):
                links.note(self.data)
                for body in self.robots.values():
                    body.drive()
                links.begin(model, self.data)
                mj.mj_step1(model, self.data)
                self.apply_friction(model)
                self.compiled.servos.apply(self.data)
                mj.mj_step2(model, self.data)
                links.end(self.data)
                self.read_loads()
            update_frames(model, self.data)

    def apply_friction(self, model: Any) -> None:
        """Set the friction of wheels between the two halves of an engine step, see :class:`WheelFriction`."""
        for body in self.robots.values():
            if len(body.friction):
                body.friction.apply(model, self.data, body.loads)

    def read_loads(self) -> None:
        """Read the loads of wheels after an engine step."""
        for body in self.robots.values():
            if len(body.friction):
                body.loads = body.friction.smooth_loads(body.loads, self.data, body.step)

    def take_state(self, others: Sequence[RigidBodies]) -> None:
        """Copy the state of all joints and motors that one of the others has as well; frames follow."""
        for other in others:
            copy_state(other, self)
            self.data.time = other.data.time
        with self.compiled.borrow() as model:
            update_frames(model, self.data)


def update_frames(model: Any, data: Any) -> None:
    """Compute the frames and velocities of all bodies from the coordinates."""
    mj = engine()
    mj.mj_kinematics(model, data)
    mj.mj_comPos(model, data)
    mj.mj_comVel(model, data)


def copy_state(source: RigidBodies, target: RigidBodies) -> None:
    """Copy coordinates, velocities, forces and commands of joints and motors with the same names."""
    here, there = _rows(source.compiled.base), _rows(target.compiled.base)
    for name, (place, speed) in there[0].items():
        if name in here[0]:
            old_place, old_speed = here[0][name]
            target.data.qpos[place] = source.data.qpos[old_place]
            for part in ("qvel", "qacc", "qacc_warmstart", "qfrc_applied"):
                getattr(target.data, part)[speed] = getattr(source.data, part)[old_speed]
    for name, motor in there[1].items():
        if name in here[1]:
            target.data.ctrl[motor] = source.data.ctrl[here[1][name]]


def _rows(model: Any) -> tuple[dict[str, tuple[slice, slice]], dict[str, int]]:
    """Return the coordinates and velocities of each joint, and the number of each motor, by name."""
    ends = [*model.jnt_qposadr[1:].tolist(), model.nq], [*model.jnt_dofadr[1:].tolist(), model.nv]
    joints = {
        model.joint(k).name: (slice(int(model.jnt_qposadr[k]), ends[0][k]), slice(int(model.jnt_dofadr[k]), ends[1][k]))
        for k in range(model.njnt)
    }
    return joints, {model.actuator(k).name: k for k in range(model.nu)}

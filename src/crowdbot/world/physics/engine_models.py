"""Compiled engine models, shared by all worlds with the same robots and stage.

A robot with two wheels and castors at both ends of one rigid body would hang between its castors where a ramp begins,
and its wheels would spin in the air. Real robots have springs at wheels or castors. On stages with uneven ground the
contacts of castors are as soft as springs; on level stages they stay as they are, unless there are more balls and
swivel castors than driven wheels, at both ends: rigid ones would take most of the weight off the wheels, which then
slip in curves. Castor wheels that a file fixes to the base without any joint stay rigid on level stages.
"""

from __future__ import annotations

import copy
import functools
import math
import threading
from collections import OrderedDict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import Scene, Walls
from crowdbot.typing import Floats
from crowdbot.world.physics.robots.base_servo import release_base_motors
from crowdbot.world.physics.robots.robot_body import RobotBody
from crowdbot.world.physics.robots.wheel_servo import WheelServos
from crowdbot.world.robots.robot import Robot

from .contacts import GeomTable
from .engine import engine
from .mjcf_model import MjcfModel, build_mjcf_model
from .people_bodies import PeopleBodies
from .stage import PhysicsStage

TRAVEL = 0.08
"""Deflection of the springs if the castors carried the whole weight, relative to the largest distance of a castor from
the middle of the robot (assumed)."""
FIRM_TRAVEL = 0.02
"""The same on level stages."""
DAMPING = 0.7
"""Damping ratio of the springs (assumed)."""
HALF = (0.5, 0.5, 0.001, 0.5, 2.0)
"""Impedance of one half: the force then is twice stiffness over inverse weight."""
GRAVITY = 9.81
NEAR = 0.05
"""Least distance [m] of a castor from the middle for this."""


def rests_on_castors(model: Any, prefix: str, robot: Robot) -> bool:
    """Return whether a robot has more castors than driven wheels, ahead of and behind their axle.

    All are balls, or turn about joints of their own, as swivel castors do.

    Args:
        model: model of the engine.
        prefix: prefix of the names of the robot.
        robot: the robot.
    """
    own = _castors(model, prefix)
    wheels = [robot.model.joints[wheel.joint] for wheel in robot.wheels if wheel.driven]
    root = int(model.body(prefix + robot.model.root).id)
    turning = model.geom_bodyid[own] != root
    usual = bool((turning | (model.geom_type[own] == engine().mjtGeom.mjGEOM_SPHERE)).all())
    count = len({-geom if body == root else int(body) for geom, body in zip(own, model.geom_bodyid[own], strict=True)})
    if robot.base != "wheels" or count <= len(wheels) or not usual:
        return False
    poses = robot.model.poses(robot.posture)
    axle = float(np.mean([(poses[joint.parent] @ joint.origin)[0, 3] for joint in wheels]))
    data = engine().MjData(model)
    engine().mj_kinematics(model, data)
    places = (data.geom_xpos[own] - data.xpos[root]) @ data.xmat[root].reshape(3, 3)[:, 0] - axle
    return bool(places.min() < -NEAR and places.max() > NEAR)


def _castors(model: Any, prefix: str) -> list[int]:
    """Return the frictionless geoms of a robot."""
    gliding = np.flatnonzero((model.geom_condim == 1) & (model.geom_priority == 1)).tolist()
    return [geom for geom in gliding if model.geom(geom).name.startswith(prefix)]


def soften_castors(model: Any, robots: Mapping[str, Robot], travel: float = TRAVEL) -> None:
    """Give the frictionless contacts of robots with wheels the stiffness of springs.

    Springs at the end at which the centre of mass lies are longer by what its weight compresses them, so that the robot
    is level on a level floor.

    Args:
        model: model of the engine, which is changed.
        robots: robots by the prefix of their names.
        travel: deflection if the castors carried the whole weight, see :data:`TRAVEL`.
    """
    data = engine().MjData(model)
    engine().mj_kinematics(model, data)
    engine().mj_comPos(model, data)
    for prefix, robot in robots.items():
        own = _castors(model, prefix)
        if robot.base != "wheels" or not own:
            continue
        mass = robot.model.mass / len(own)
        root = int(model.body(prefix + robot.model.root).id)
        places = _places(model, data, root, own)
        far = float(np.hypot(places[:, 0], places[:, 1]).max())
        stiffness = mass * GRAVITY / (travel * max(far, NEAR))
        damping = 2.0 * DAMPING * math.sqrt(stiffness * mass)
        for geom in own:
            light = float(model.body_invweight0[model.geom_bodyid[geom], 0])
            model.geom_solref[geom] = -0.5 * stiffness * light, -0.5 * damping * light
            model.geom_solimp[geom] = HALF
        _level(model, data, robot, root, own, places[:, 0], stiffness)


def _places(model: Any, data: Any, root: int, castors: Sequence[int]) -> Floats:
    """Return the places ``[C, 3]`` [m] of castors in the frame of the root link."""
    places = np.array(model.geom_pos[castors])
    turning = model.geom_bodyid[castors] != root
    away = data.geom_xpos[castors][turning] - data.xpos[root]
    places[turning] = away @ data.xmat[root].reshape(3, 3)
    return places


def _level(
    model: Any, data: Any, robot: Robot, root: int, castors: Sequence[int], places: Floats, stiffness: float
) -> None:
    """Lower the castors that carry weight by the deflection of their springs.

    Castors that turn keep their places: their contacts begin this distance above the floor.
    """
    poses = robot.model.poses(robot.posture)
    joints = [robot.model.joints[wheel.joint] for wheel in robot.wheels if wheel.driven]
    axle = float(np.mean([(poses[joint.parent] @ joint.origin)[0, 3] for joint in joints]))
    turn = data.xmat[root].reshape(3, 3)
    ahead = float((turn.T @ (data.subtree_com[root] - data.xpos[root]))[0]) - axle
    side = np.flatnonzero((places - axle) * ahead > 0.0)
    if not len(side):
        return
    lever = float(np.mean(np.abs(places[side] - axle)))
    load = robot.model.mass * GRAVITY * min(1.0, abs(ahead) / lever) / len(side)
    for geom in np.array(castors)[side].tolist():
        if model.geom_bodyid[geom] == root:
            model.geom_pos[geom, 2] -= load / stiffness
        else:
            model.geom_margin[geom] = load / stiffness


SETTLING = 1.0
"""Time [s] for which robots settle on the floor before the start."""
KEPT = 8
"""Number of compiled models that are kept for further worlds."""


class RobotStart(NamedTuple):
    """A robot at its start: agent, description, x, y [m], heading [rad] and the command types of its joints."""

    agent: int
    robot: Robot
    x: float
    y: float
    heading: float
    motors: tuple[tuple[str, str], ...] = ()


def motors_of(agent: int, motors: Mapping[int, Mapping[str, str]] | None) -> tuple[tuple[str, str], ...]:
    """Return the command types of the joints of one robot."""
    return tuple(sorted((motors or {}).get(agent, {}).items()))


class BodyDesign(NamedTuple):
    """Everything that determines an engine model.

    Fields:
        walls: walls without the outlines of props.
        stage: stage with props.
        robots: robots by agent.
        slots: number of bodies of people.
        step: time step of the engine [s].
    """

    walls: Walls
    stage: PhysicsStage
    robots: tuple[RobotStart, ...]
    slots: int
    step: float

    @property
    def key(self) -> tuple[Any, ...]:
        """The design as a key: equal keys give equal models."""
        arrays = (self.walls.start, self.walls.end, self.walls.previous, self.walls.next, self.walls.convex)
        return (tuple(array.tobytes() for array in arrays), *self[1:])

    @property
    def scene(self) -> Scene:
        """Scene with the walls, and with the robots at their starts."""
        count = 1 + max((start.agent for start in self.robots), default=0)
        place, heading = [[0.0, 0.0]] * count, [0.0] * count
        for start in self.robots:
            place[start.agent], heading[start.agent] = [start.x, start.y], start.heading
        return Scene.of(place, heading=heading, walls=self.walls)


class CompiledBodies:
    """An engine model with its initial state; it may be shared by worlds and threads.

    An engine step needs a model of its own, since the limbs of people are part of it; :meth:`borrow` lends one.

    Args:
        design: content of the model.

    Attributes:
        built: the MJCF model.
        base: a model for constants: numbers of bodies, joints and actuators.
        first: state before the first step.
        shapes: limbs and masses of the bodies of people before they are assigned.
        geoms: bodies and parts of the geoms.
        servos: servos of the wheels, part of every step.
    """

    def __init__(self, design: BodyDesign) -> None:
        self.design = design
        robots = {start.agent: start.robot for start in design.robots}
        motors = {start.agent: dict(start.motors) for start in design.robots}
        self.built: MjcfModel = build_mjcf_model(design.scene, design.stage, robots, design.slots, motors)
        self.base = self.built.load(design.step)
        self.servos = WheelServos(self.base, self.built.torques)
        for start in design.robots:
            if start.robot.base == "planar":
                release_base_motors(self.base, self.built.prefixes[start.agent])
        named = {self.built.prefixes[agent]: robot for agent, robot in robots.items()}
        if design.stage.ground is None:
            named = {prefix: robot for prefix, robot in named.items() if rests_on_castors(self.base, prefix, robot)}
        if named:
            soften_castors(self.base, named, FIRM_TRAVEL if design.stage.ground is None else TRAVEL)
        self.first = engine().MjData(self.base)
        for start in design.robots:
            RobotBody(self.base, self.first, start.robot, self.built.prefixes[start.agent], design.step).prepare()
        self.shapes = PeopleBodies(self.base, self.first, design.slots, design.step).shapes
        self.geoms = GeomTable.of(self.base, self.built.prefixes)
        self._free, self._lock = [self.base], threading.Lock()

    def __deepcopy__(self, memo: dict[int, Any]) -> CompiledBodies:
        """Return the same object: worlds share it."""
        return self

    @contextmanager
    def borrow(self) -> Iterator[Any]:
        """Lend a model that nobody else uses in the meantime."""
        with self._lock:
            model = self._free.pop() if self._free else None
        if model is None:
            model = copy.copy(self.base)
        try:
            yield model
        finally:
            with self._lock:
                self._free.append(model)

    @functools.cached_property
    def rest_state(self) -> Any:
        """State in which the robots rest on the floor at their starts, and props at theirs."""
        mj, design, ground = engine(), self.design, self.design.stage.ground
        data = copy.copy(self.first)
        robots = [
            (RobotBody(self.base, data, start.robot, self.built.prefixes[start.agent], design.step), start)
            for start in design.robots
        ]
        with self.borrow() as model:
            PeopleBodies(self.base, data, design.slots, design.step, self.shapes).install(model)
            for body, start in robots:
                body.put(start.x, start.y, start.heading)
            mj.mj_step(model, data, round(SETTLING / design.step))
            for body, start in robots:
                # on uneven ground a robot keeps the pose in which it rests
                if ground is None or ground.is_level(start.x, start.y, start.robot.radius):
                    body.put(start.x, start.y, start.heading)
            data.time = 0.0
            mj.mj_forward(model, data)
        return data


_known: OrderedDict[Any, CompiledBodies] = OrderedDict()
_lock = threading.Lock()


def compile_bodies(design: BodyDesign) -> CompiledBodies:
    """Return the compiled model of a design; equal designs share one."""
    key = design.key
    try:
        hash(key)
    except TypeError:  # a prop that cannot be compared
        return CompiledBodies(design)
    with _lock:
        if key in _known:
            _known.move_to_end(key)
            return _known[key]
    compiled = CompiledBodies(design)
    with _lock:
        compiled = _known.setdefault(key, compiled)
        _known.move_to_end(key)
        while len(_known) > KEPT:
            _known.popitem(last=False)
    return compiled

"""Compiled engine models, shared by all worlds with the same robots and stage."""

from __future__ import annotations

import copy
import functools
import threading
from collections import OrderedDict
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, NamedTuple

from crowdbot.core import Scene, Walls
from crowdbot.world.physics.robots.base_servo import release_base_motors
from crowdbot.world.physics.robots.castor_springs import FIRM_TRAVEL, TRAVEL, rests_on_castors, soften_castors
from crowdbot.world.physics.robots.robot_body import RobotBody
from crowdbot.world.physics.robots.robot_height import is_level
from crowdbot.world.physics.robots.wheel_servo import WheelServos
from crowdbot.world.robots.robot import Robot

from .contacts import GeomTable
from .engine import engine
from .mjcf_model import MjcfModel, build_mjcf_model
from .people_bodies import PeopleBodies
from .stage import PhysicsStage

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
        mj, design = engine(), self.design
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
                if is_level(design.stage.ground, start):
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

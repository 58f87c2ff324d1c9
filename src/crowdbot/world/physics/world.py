"""A world with bodies: robots on their wheels, people who can be pushed, and forces between them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Bodies, InputError, Pose, Scene
from crowdbot.humans import People
from crowdbot.models import CrowdModel
from crowdbot.world.drive import Twists
from crowdbot.world.planar import PlanarWorld
from crowdbot.world.robot import Robot
from crowdbot.world.walk import Stepping
from crowdbot.world.world import Contact

from .camera import Camera, Images
from .chassis import Chassis
from .collisions import BodyForce, Collision, CollisionBook
from .composed import built
from .engine import engine
from .passers import Passers
from .scenery import joined
from .solids import bodies
from .stage import PhysicsStage
from .studio import Studio
from .touches import Party, Touches
from .walkers import Limbs, Walkers

__all__ = ["PhysicsWorld"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

NEAR = 0.8
"""Who comes so near [m] to a robot or to something that can be pushed, clear of its outline, takes a body."""
FAST = 3.0
"""Nobody comes nearer than by this speed [m/s] in a step."""
SETTLING = 1.0
"""Robots stand so long [s] on the floor before the beginning."""


class PhysicsWorld(PlanarWorld):
    """Robots, people, walls and props with bodies, in the engine MuJoCo; E = 1.

    The crowd is that of :class:`PlanarWorld`, all its options included, and without a touch it walks the same way to
    the last bit. Robots are driven: commands pass latency, limits and ramps of their drive to motors that turn wheels
    on a floor, or pull the base. People near a robot, or near something that can be pushed, have bodies of 17 limbs
    that walk; a push moves them off their way, and their crowd model goes on from where they are then.

    Args:
        scene: at the beginning; robots are agents with ``external=True``.
        model: how people walk.
        robots: by agent index.
        dt: time step [s], a whole number of ``physics_dt``.
        seed: of the crowd's randomness, of bodies and of ways to walk.
        stage: height of walls, floor, props and lights. The crowd walks around props that stand fast.
        people: bodies of all agents that are no robots, then of riders; None draws adults.
        riders: agents that are robots ``wheelchair`` in which somebody sits. Riders are seen; they weigh nothing, and
            nothing touches them.
        physics_dt: step of the engine [s].
        slots: how many people can have a body at a time; None: 24, or as many as there are people.
        motors: how joints of robots are commanded, by agent and joint: ``position``, ``velocity``, ``effort``.
        planar: every other argument of :class:`PlanarWorld`, by name.

    Attributes:
        chassis: the robots by agent: ``pose``, ``twist``, ``tilt``, ``joints()``, ``frame(link)``, ``command(joints)``.
        forces: of the last step, see :class:`BodyForce`.
        contacts: robots and other agents whose bodies touched during the last step; the clearance is how deep, below 0.
        left_out: how many people were near something in the last step but got no body, because all were taken.

    Raises:
        InputError: a robot is no external agent or is absent; steps do not fit; there is more than one environment.
        MissingExtra: mujoco is not installed.

    >>> from crowdbot.core import Twist
    >>> from crowdbot.models import ORCA
    >>> start = Scene.of([[0.0, 0.0], [5.0, 1.0]], goal=[[0.0, 0.0], [-5.0, 1.0]], external=[True, False])
    >>> world = PhysicsWorld(start, ORCA(), {0: Robot.load("turtlebot2")}, dt=0.1)
    >>> for _ in range(20):
    ...     scene = world.step({0: Twist(0.4, 0.0)})
    >>> world.twists[0].forward.round(2).tolist(), world.contacts
    ([0.4], ())
    """

    def __init__(
        self,
        scene: Scene,
        model: CrowdModel,
        robots: Mapping[int, Robot],
        dt: float,
        seed: int = 0,
        *,
        stage: PhysicsStage | None = None,
        people: People | None = None,
        riders: Sequence[int] = (),
        physics_dt: float = 0.005,
        slots: int | None = None,
        motors: Mapping[int, Mapping[str, str]] | None = None,
        **planar: Any,
    ) -> None:
        stage = stage or PhysicsStage()
        _checked(scene, robots, dt, physics_dt, slots)
        self._steps = round(dt / physics_dt)
        self._outlined = joined(scene.walls, stage.outlines())
        super().__init__(scene, model, {agent: robot.drive for agent, robot in robots.items()}, dt, seed, **planar)
        persons = np.array([a for a in range(scene.shape[1]) if a not in robots], dtype=np.int64)
        self.stage, self.physics_dt = stage, physics_dt
        self.walkers = Walkers(self.scene, persons, people, seed, riders)
        self.left_out = 0
        self.forces: tuple[BodyForce, ...] = ()
        self._touched: dict[tuple[int, int], float] = {}
        self._studio: Studio | None = None
        self._compose(robots, min(len(persons), 24) if slots is None else slots, motors)

    @property
    def collisions(self) -> tuple[Collision, ...]:
        """Every collision so far, by first touch."""
        return self._book.collisions

    def pose(self, robot: int) -> Pose:
        """Return where a robot is, E = 1."""
        return Pose(self.scene.position[:, robot].copy(), self.scene.heading[:, robot].copy())

    def command(self, robot: int, joints: Mapping[str, float]) -> None:
        """Send values to the motors of a robot's joints; they hold until the next ones.

        Raises:
            InputError: the agent is no robot, a joint has no motor or is a wheel, or a value is not finite.
        """
        self.carrier(robot).command(joints)

    def carrier(self, robot: int) -> Chassis:
        """Return the body of a robot.

        Raises:
            InputError: the agent is no robot.
        """
        if robot not in self.chassis:
            raise InputError(f"agent {robot} is no robot; robots are {sorted(self.chassis) or 'none'}")
        return self.chassis[robot]

    def render(self, camera: Camera, *, rgb: bool = True, depth: bool = False, segmentation: bool = False) -> Images:
        """Return what a camera sees now, people with their skins; no screen is needed.

        Raises:
            InputError: there is no way to draw here, or the camera is on no robot or no link.
        """
        return self.studio.images(camera, rgb=rgb, depth=depth, segmentation=segmentation)

    @property
    def studio(self) -> Studio:
        """Draws the world as it is now; of use for cameras of :mod:`crowdbot.sensors`, see :meth:`Studio.render`."""
        if self._studio is None:
            robots = {agent: chassis.robot for agent, chassis in self.chassis.items()}
            self._studio = Studio.of_engine(self.built, robots, self.stage, self.walkers, self.scene)
        self._studio.show_engine(self.scene, self.data.qpos)
        return self._studio

    def limbs(self) -> Limbs:
        """Return the capsules of all people as they stand now."""
        return self.walkers.limbs(self.scene.active[0])

    def bodies(self, skins: int | None = None) -> Bodies:
        """Return what range sensors see, as it is now; ``skins`` is a level of detail, see :func:`bodies`."""
        frames = {agent: chassis.frames() for agent, chassis in self.chassis.items()}
        robots = {agent: chassis.robot for agent, chassis in self.chassis.items()}
        moved = {number: self.prop(number) for number in self._movable}
        return bodies(self.scene, self.walkers, robots, self.stage, frames=frames, props=moved, skins=skins)

    def seen(self, skins: int | None = None) -> Scene:
        """Return the scene with the bodies and the height of the walls, for range sensors.

        >>> start = Scene.of([[0.0, 0.0], [2.0, 0.0]], heading=[0.0, 0.0], external=[True, False])
        >>> from crowdbot.models import ORCA
        >>> from crowdbot.sensors import Lidar2D
        >>> world = PhysicsWorld(start, ORCA(), {0: Robot.load("turtlebot2")}, dt=0.1)
        >>> scan = Lidar2D(rays=1).measure(world.seen().without(0), world.pose(0).to_spatial(1.2))
        >>> scan.hit.tolist(), bool(1.7 < scan.ranges[0, 0] < 2.0)
        ([[1]], True)
        """
        return self.scene.replace(bodies=self.bodies(skins), wall_height=self.stage.wall_height)

    def prop(self, number: int) -> Floats:
        """Return the frame ``[4, 4]`` of a prop of the stage in the world."""
        body = self.data.body(f"prop{number}")
        found = np.eye(4)
        found[:3, :3], found[:3, 3] = body.xmat.reshape(3, 3), body.xpos
        return found

    def _compose(self, robots: Mapping[int, Robot], slots: int, motors: Any) -> None:
        self._mj = engine()
        self.built = built(self.scene, self.stage, robots, slots, motors)
        self.engine_model = self.built.load(self.physics_dt)
        self.data = self._mj.MjData(self.engine_model)
        both = self.engine_model, self.data
        prefixes = self.built.prefixes
        self.chassis = {a: Chassis(*both, robot, prefixes[a], self.physics_dt) for a, robot in sorted(robots.items())}
        self._passers = Passers(*both, slots, self.physics_dt)
        agent_of = self._passers.agent
        self._touches = Touches(*both, prefixes, lambda slot: int(agent_of[slot]), lambda: self._passers.swing)
        heading_of = lambda agent: float(self.scene.heading[0, agent])  # noqa: E731
        self._book = CollisionBook(self.physics_dt, self._mass_of, self.walkers.limb_mass, heading_of)
        self._movable = [k for k, prop in enumerate(self.stage.props) if prop.movable]
        self._settle()

    def _settle(self) -> None:
        """Let robots come to rest on the floor, and put them where they begin."""
        for agent in self.chassis:
            self._put(agent, self.scene)
        self._mj.mj_step(self.engine_model, self.data, round(SETTLING / self.physics_dt))
        for agent in self.chassis:
            self._put(agent, self.scene)
        self.data.time = 0.0
        self._mj.mj_forward(self.engine_model, self.data)

    def _put(self, agent: int, scene: Scene) -> None:
        x, y = scene.position[0, agent]
        self.chassis[agent].put(float(x), float(y), float(scene.heading[0, agent]))
        self._at = {**getattr(self, "_at", {}), agent: (float(x), float(y), float(scene.heading[0, agent]))}

    def _walked(self, before: Scene) -> Stepping[tuple[Scene, Scene]]:
        earlier, crowd = yield from super()._walked(before.replace(walls=self._outlined))
        return earlier.replace(walls=before.walls), crowd.replace(walls=before.walls)

    def _settled(self, earlier: Scene, after: Scene) -> Scene:
        """Push people apart as the plane does, but leave robots to the engine."""
        if self.contact is None:
            return after
        present = after.active.copy()
        present[:, list(self.chassis)] = False
        walls, robots = after.walls, after.active
        settled = super()._settled(earlier, after.replace(active=present, walls=self._outlined))
        return settled.replace(active=robots, walls=walls)

    def _driven(self, before: Scene, after: Scene, asked: Mapping[int, Twists]) -> Scene:
        """Run the engine for a step of the world, and return the scene with what it moved."""
        for agent, chassis in self.chassis.items():
            if self._at[agent] != (*before.position[0, agent].tolist(), float(before.heading[0, agent])):
                self._put(agent, before)
            chassis.ask(asked[agent])
        gait, ends = self._prepared(before, after)
        end = self.clock.time  # the clock is at the end of this step already
        self._touched = {}
        for k in range(self._steps):
            self._substep((k + 1) / self._steps, end - (self._steps - 1 - k) * self.physics_dt)
        self.forces = self._book.forces(self._steps)
        scene, moved = self._read(before, after)
        if moved or len(self.walkers.agents) > len(self.walkers.afoot):  # who rides is where the robot came to
            gait, ends = self.walkers.stepped(scene, self.dt), None
        self.walkers.take(gait, ends)
        return scene

    def _prepared(self, before: Scene, after: Scene) -> tuple[Any, Floats | None]:
        """Give bodies to those near something, and return how everyone stands after the step."""
        gait = self.walkers.stepped(after, self.dt)
        ends = self.walkers.ends_of(gait)
        if len(self._passers.agent):
            self._embody(before)
            way = (after.position[0] - before.position[0]) / self.dt
            there = self.walkers.agents
            limbs = np.zeros((2, before.shape[1], *ends.shape[1:]))
            for k, (scene, points) in enumerate(((before, self.walkers.ends), (after, ends))):
                limbs[k, there] = points - np.tile(_lifted(scene.position[0, there]), 2)[:, None]
            self._passers.begin(before.position[0], way, limbs[0], limbs[1], self.dt)
        return gait, ends

    def _embody(self, scene: Scene) -> None:
        """Give bodies to those who may touch something in this step, the nearest first."""
        persons = self.walkers.afoot
        persons = persons[scene.active[0, persons]]
        nearest = np.full(len(persons), np.inf)
        mass = np.ones(len(persons))
        ahead = np.ones(len(persons), dtype=np.bool_)
        looks = np.stack([np.cos(scene.heading[0, persons]), np.sin(scene.heading[0, persons])], axis=-1)
        for x, y, radius, weight in self._movers():
            away = np.array([x, y]) - scene.position[0, persons]
            gap = np.sqrt(np.sum(away * away, axis=1)) - radius
            closer = gap < nearest
            nearest[closer], mass[closer] = gap[closer], weight
            ahead[closer] = np.sum(away * looks, axis=1)[closer] >= 0.0
        near = np.flatnonzero(nearest < NEAR + FAST * self.dt)
        near = near[np.lexsort((persons[near], nearest[near]))]
        rows = self.walkers.row[persons[near]]
        self.left_out = self._passers.take(
            persons[near], self.walkers.people.mass[rows], self.walkers.radius[rows], mass[near], ahead[near]
        )

    def _movers(self) -> list[tuple[float, float, float, float]]:
        """Return x, y, radius [m] and mass [kg] of what people can run into."""
        found = []
        for chassis in self.chassis.values():
            ((x, y),) = chassis.pose.position.tolist()
            found.append((x, y, chassis.robot.radius, chassis.mass))
        for number in self._movable:
            x, y, _ = self.data.body(f"prop{number}").xpos.tolist()
            ring = self.stage.props[number]
            found.append((x, y, math.sqrt(0.5) * getattr(ring, "size", 1.0), ring.weight))
        return found

    def _substep(self, share: float, time: float) -> None:
        for chassis in self.chassis.values():
            chassis.drive()
        self._passers.go(share)
        self._mj.mj_step1(self.engine_model, self.data)
        self._touches.look()
        self._mj.mj_step2(self.engine_model, self.data)
        touches = self._touches.read()
        self._passers.stepped(touches)
        self._book.add(time, touches)
        for touch in touches:
            if touch.first.kind == "robot" and touch.second.kind in ("robot", "person"):
                pair = (touch.first.number, touch.second.number)
                self._touched[pair] = max(self._touched.get(pair, 0.0), touch.depth)

    def _read(self, before: Scene, after: Scene) -> tuple[Scene, bool]:
        """Return the scene with robots as they are and people where they were pushed, and whether anyone was."""
        position, velocity, heading = after.position.copy(), after.velocity.copy(), after.heading.copy()
        self._mj.mj_kinematics(self.engine_model, self.data)
        self._mj.mj_comPos(self.engine_model, self.data)
        self._mj.mj_comVel(self.engine_model, self.data)
        for agent, chassis in self.chassis.items():
            pose, twist = chassis.pose, chassis.twist
            self.twists[agent] = twist
            position[0, agent], heading[0, agent] = pose.position[0], pose.heading[0]
            velocity[0, agent] = twist.velocity(pose.heading)[0]
            self._at[agent] = (*pose.position[0].tolist(), float(pose.heading[0]))
        pushed, places, speeds = self._passers.end()
        position[0, pushed], velocity[0, pushed] = places, speeds
        return after.replace(position=position, velocity=velocity, heading=heading), len(pushed) > 0

    def _touching(self, before: Scene, after: Scene) -> tuple[Contact, ...]:
        return tuple(sorted(Contact(0, *pair, -depth) for pair, depth in self._touched.items()))

    def _mass_of(self, party: Party) -> float:
        if party.kind == "robot":
            return self.chassis[party.number].mass
        if party.kind == "person":
            return float(self.walkers.people.mass[self.walkers.row[party.number]])
        return self.stage.props[party.number].weight if party.kind == "prop" else math.inf


def _lifted(place: Floats) -> Floats:
    return np.column_stack([place, np.zeros(len(place))])


def _checked(scene: Scene, robots: Mapping[int, Robot], dt: float, physics_dt: float, slots: int | None) -> None:
    if scene.shape[0] != 1:
        raise InputError(f"a physics world has one environment, the scene has {scene.shape[0]}; take PlanarWorld")
    if not 1e-4 <= physics_dt <= 0.02:
        raise InputError(f"physics_dt = {physics_dt} s must be from 0.0001 to 0.02 s; 0.005 s is usual")
    if not math.isfinite(dt) or dt < physics_dt or abs(dt / physics_dt - round(dt / physics_dt)) > 1e-6:
        raise InputError(f"the time step {dt} s must be a whole number of steps of the engine, {physics_dt} s")
    if slots is not None and (isinstance(slots, bool) or not isinstance(slots, int) or not 0 <= slots <= 1000):
        raise InputError(f"slots = {slots!r} must be a whole number from 0 to 1000")
    for agent, robot in robots.items():
        if not isinstance(robot, Robot):
            raise InputError(f"robots[{agent}] is a {type(robot).__name__}; give a Robot, as Robot.load('turtlebot2')")
        if 0 <= agent < scene.shape[1] and not scene.active[0, agent]:
            raise InputError(f"robot {robot.name} of agent {agent} is absent (active=False); robots are always there")

"""World with rigid bodies and contact forces, simulated by MuJoCo."""

from __future__ import annotations

import copy
import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Bodies, InputError, Pose, Scene, SpatialPose, Storage, Walls, wrap_angle
from crowdbot.humans import People
from crowdbot.models import CrowdModel
from crowdbot.typing import Floats, Ints
from crowdbot.world.crowd.ghosts import hide_ghosts
from crowdbot.world.doors.doors import Doors
from crowdbot.world.ground.ground import Ground
from crowdbot.world.physics.robots.mirrored_robots import MirroredRobots
from crowdbot.world.planar import PlanarWorld
from crowdbot.world.pushes import acting_pushes, keep_pushes
from crowdbot.world.rendering.camera import CameraImages, SceneCamera
from crowdbot.world.rendering.renderer import Renderer
from crowdbot.world.robots.drives.drive import Twists
from crowdbot.world.robots.mount import MountPlacement
from crowdbot.world.robots.robot import Robot
from crowdbot.world.robots.robot import spatial as spatial_pose
from crowdbot.world.world import Contact

from .balance.fall import Fall
from .balance.falling_people import FallingPeople
from .balance.force_pushes import ForcePushes
from .balance.recovery import CENTER
from .colliders import scene_bodies
from .contact_events import BodyContactEvent, BodyContactTracker, ContactForce
from .contacts import ContactBody
from .engine import engine
from .engine_models import RobotStart, motors_of
from .mjcf_model import MjcfModel, base_height
from .people_bodies import PeopleBodies
from .people_motion import LimbCapsules, PeopleMotion
from .rider import seat_rider
from .robots.mirrored_robots import kinematic_bases
from .robots.robot_body import RobotBody
from .scenery import add_rings, outline_props
from .stage import AbsentProp, PhysicsStage, PropBody, new_prop_name, prop_number, without_prop, without_prop_name
from .world_bodies import WorldBodies

if TYPE_CHECKING:
    from crowdbot.world.crowd.source import PeopleSource

LEVEL = 1.34
UPSTAIRS, DOWNSTAIRS = 0.610 / LEVEL, 0.694 / LEVEL
"""Horizontal speed on stairs over that on level ground: 0.610 m/s up, 0.694 m/s down and 1.34 m/s (U. Weidmann,
Transporttechnik der Fussgänger, IVT ETH Zürich, 1993)."""
STEEPNESS, BEST = 3.5, 0.05
"""Speed on a slope s is exp(-3.5 abs(s + 0.05)) (W. Tobler, Three presentations on geographical analysis and modeling,
NCGIA report 93-1, 1993). It is divided by the speed on level ground; nobody walks faster downhill."""
STRIDE = 0.7
"""Distance [m] over which the slope is measured: the length of a step, so that a threshold is no hill."""


def walking_speed_factor(ground: Ground, position: Floats, velocity: Floats) -> Floats:
    """Return the speed ``[...]`` of people relative to that on level ground, from 0 to 1.

    Args:
        ground: the ground.
        position: ``[..., 2]`` [m].
        velocity: ``[..., 2]``, of any length; it gives the direction.

    >>> from crowdbot.world.ground.part import GroundPart
    >>> ramp = Ground((GroundPart(0.0, 0.0, length=4.0, width=2.0, rear=0.0, front=0.4),))
    >>> walking_speed_factor(ramp, np.zeros((2, 2)), np.array([[1.0, 0.0], [-1.0, 0.0]])).round(3).tolist()
    [0.705, 1.0]
    """
    speed = np.sqrt(np.sum(velocity * velocity, axis=-1, keepdims=True))
    half = 0.5 * STRIDE * velocity / np.maximum(speed, 1e-9)
    rise = (ground.height(position + half) - ground.height(position - half)) / STRIDE
    factor = np.minimum(1.0, np.exp(-STEEPNESS * (np.abs(rise + BEST) - BEST)))
    _, stairs = ground.gradient(position)
    on_stairs = np.where(rise > 0.0, UPSTAIRS, np.where(rise < 0.0, DOWNSTAIRS, 1.0))
    return np.where(stairs, on_stairs, factor)


def slow_people(scene: Scene, ground: Ground) -> Scene:
    """Return the scene in which people on ramps and stairs have lower preferred and largest speeds."""
    factor = np.where(scene.external, 1.0, walking_speed_factor(ground, scene.position, scene.velocity))
    return scene.replace(preferred_speed=scene.preferred_speed * factor, max_speed=scene.max_speed * factor)


NEAR = 0.8
"""A person within this clearance [m] of a robot or a movable prop gets a body in the engine."""
FAST = 3.0
"""Largest assumed closing speed [m/s] within one step."""
SLOTS = 24
"""Default of the largest number of people with a body in the engine."""
MORE = 4
"""Number of bodies in the engine that are added at a time."""
Mover = tuple[float, float, float, float, bool]


class PhysicsWorld(PlanarWorld):
    """Planar crowd with rigid bodies for robots, nearby people, walls and props (MuJoCo); E = 1.

    The crowd supports all options of :class:`PlanarWorld` and is bit-identical to it until the first contact. Commands
    of a robot pass its latency and the limits and ramps of its drive; motors then turn its wheels or pull its base.
    People near a robot or a movable prop have walking bodies of 17 limbs. A push displaces them, and the crowd model
    continues from the new position.

    Args:
        scene: initial scene; robots are agents with ``external=True``.
        model: crowd model.
        robots: robots by agent index.
        dt: time step [s], a whole number of ``physics_dt``.
        seed: seed of the crowd, of body shapes and of gaits.
        stage: wall height, floor, props and lights. The crowd avoids fixed props.
        people: bodies of all agents except robots, followed by riders; None samples adults.
        riders: agents with the seat of a ``wheelchair`` that carry a rider. A rider is a rigid part of the robot, with
            mass and contacts; what another robot does to a rider, it does to a person.
        physics_dt: time step of the engine [s].
        slots: number of people that can have a body at the same time (default: 24, or the number of people if smaller).
        motors: command type of robot joints by agent and joint: ``position``, ``velocity`` or ``effort``.
        balance: whether pushed people brace, step and fall; otherwise they stay upright.
        get_up: time [s] after which people who have fallen get up; None: they stay on the floor.
        planar: other arguments of :class:`PlanarWorld`.

    Attributes:
        robot_bodies: :class:`RobotBody` by agent, with ``pose``, ``twist``, ``tilt``, ``joints()``, ``frame(link)`` and
            ``command(joints)``.
        forces: contact forces of the last step, see :class:`ContactForce`.
        contacts: pairs of a robot and another agent in contact during the last step; their clearance is negative.
        skipped_people: people who needed a body in the last step when all slots were in use.

    Raises:
        InputError: a robot is absent or not external, ``dt`` is not a multiple of ``physics_dt``, or E > 1.
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

    people: PeopleMotion
    falling: FallingPeople | None
    rigid: WorldBodies
    stage: PhysicsStage
    _renderers: dict[bool, Renderer]
    _prop_names: list[str]
    _at: dict[int, tuple[float, float, float]]
    _outlined: Walls
    _plane: tuple[Scene, Scene] | None
    _slots_fixed: bool

    people_shape = "limbs"
    walls_fixed = True
    storage = Storage(
        constants=("stage", "physics_dt", "_steps", "_outlined", "_plane", "_renderers", "_prop_names", "_slots_fixed"),
    )  # fmt: skip

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
        balance: bool = False,
        get_up: float | None = 5.0,
        **planar: Any,
    ) -> None:
        stage = stage or PhysicsStage()
        check_arguments(scene, robots, dt, physics_dt, slots)
        self._slots_fixed = slots is not None
        self._steps = round(dt / physics_dt)
        self._outlined = add_rings(scene.walls, stage.outlines())
        if stage.doors and planar.get("doors") is None:
            planar["doors"] = Doors(stage.doors, pushed=True)
        super().__init__(scene, model, {agent: robot.drive for agent, robot in robots.items()}, dt, seed, **planar)
        persons = np.array([a for a in range(scene.shape[1]) if a not in robots], dtype=np.int64)
        self.stage, self.physics_dt = stage, physics_dt
        self._prop_names = [f"prop{number}" for number in range(len(stage.props))]
        self.people = PeopleMotion(self.scene, persons, people, seed, riders, stage.ground)
        self.falling = FallingPeople(self.people, scene.shape[1], get_up) if balance else None
        self._plane = None
        self.skipped_people = 0
        self.forces: tuple[ContactForce, ...] = ()
        self._touched: dict[tuple[int, int], float] = {}
        self._renderers = {}
        self._compose(robots, min(len(persons), SLOTS) if slots is None else slots, motors)

    @property
    def contact_events(self) -> tuple[BodyContactEvent, ...]:
        return self._contact_tracker.contact_events

    @property
    def falls(self) -> tuple[Fall, ...]:
        return () if self.falling is None else self.falling.falls

    @property
    def people_motions(self) -> list[PeopleMotion]:
        return [self.people]

    def limbs(self) -> LimbCapsules:
        """Return the current limb capsules of all people."""
        return self.people.limbs(self.scene.active[0])

    def sensor_pose(self, robot: int, mount: MountPlacement, spatial: bool) -> Pose | SpatialPose:
        if not (spatial or mount.link):
            return super().sensor_pose(robot, mount, spatial)
        body = self.robot_body(robot)
        found = spatial_pose(body.frame(mount.link or body.robot.model.root) @ mount.origin)
        return found if spatial else found.planar

    def wall_clearance(self, robot: int) -> Floats:
        """Return minus the largest overlap [m] with walls and fixed props in the last step, infinity without contact.

        See :class:`World`.
        """
        if robot in self.ghosts:
            return np.array([math.inf])
        depth = [force.depth for force in self.forces if force.first == ("robot", robot) and self._fixed(force.second)]
        return np.array([-max(*depth, 1e-9) if depth else math.inf])

    def plane_scene(self, environment: int | None = None) -> Scene:
        if self._plane is None or self._plane[0] is not self.scene:
            self._plane = (self.scene, hide_ghosts(self.scene, self.ghosts).replace(walls=self._outlines()))
        return self._plane[1]

    def embody(
        self,
        robots: Mapping[int, Robot],
        stage: PhysicsStage,
        people: People,
        *,
        riders: Sequence[int] = (),
        activity: Sequence[str] = (),
        walls: Walls | None = None,
        seed: int = 0,
    ) -> None:
        # start the activities of people; their bodies, robots and stage are those of the constructor
        self._begin_activity(activity)

    def pose_people(self) -> None:
        """Do nothing: a step moves the bodies of people."""

    def bodies(self, skins: int | None = None, only: Ints | None = None) -> Bodies:
        """Return the current shapes for range sensors; ``skins`` is a level of detail, see :func:`scene_bodies`."""
        frames = {agent: robot_bodies.frames() for agent, robot_bodies in self.rigid.main.robots.items()}
        robots = {agent: robot_bodies.robot for agent, robot_bodies in self.rigid.main.robots.items()}
        moved = {number: self.prop(number) for number in self._movable}
        scene = hide_ghosts(self.scene, self.ghosts)
        doors = None if self.doors is None else self.doors.signed_share
        return scene_bodies(
            scene, self.people, robots, self.stage, frames=frames, props=moved, doors=doors, skins=skins, only=only
        )

    def body_scene(self, skins: int | None = None, environment: int = 0, avatars: bool = False) -> Scene:
        scene = hide_ghosts(self.scene, self.ghosts)
        only = self.avatars.people if avatars and self.avatars is not None else None
        return scene.replace(bodies=self.bodies(skins, only), wall_height=self.stage.wall_height)

    def _outlines(self) -> Walls:
        if not self._movable:
            return self._outlined
        return outline_props(self.scene.walls, self.stage, {number: self.prop(number) for number in self._movable})

    def _fixed(self, party: ContactBody) -> bool:
        if party.kind == "wall":
            return party.number >= 0 or self.stage.doors[-1 - party.number].opening != "push"
        return bool(party.kind == "prop" and not self.stage.props[party.number].movable)

    def _after_latency(self, robot: int, command: Twists) -> Twists:
        return command  # RobotBody applies the delay, in engine steps

    def _compose(self, robots: Mapping[int, Robot], slots: int, motors: Any) -> None:
        place, heading = self.scene.position[0].tolist(), self.scene.heading[0].tolist()
        starts = {
            a: RobotStart(a, self._with_rider(a, robot), place[a][0], place[a][1], heading[a], motors_of(a, motors))
            for a, robot in sorted(robots.items())
        }
        walls = self.scene.walls
        self.rigid = WorldBodies(walls, self.stage, starts, self.ghosts, slots, self.physics_dt)
        self.rigid.people.led = self._led_people(self.scene)
        self.rigid.people.balance = None if self.falling is None else self.falling.balance
        self._contact_tracker = BodyContactTracker(self.physics_dt, self._mass_of, self._limb_mass_of, self._heading_of)
        self._at = {a: (start.x, start.y, start.heading) for a, start in starts.items()}

    def _put(self, agent: int, scene: Scene) -> None:
        body, ground = self.robot_bodies[agent], self.stage.ground
        self._at[agent] = (*scene.position[0, agent].tolist(), float(scene.heading[0, agent]))
        height = None if ground is None else base_height(ground, scene, agent, body.robot)
        body.put(*self._at[agent], height=height)

    def _step_crowd(self, before: Scene) -> tuple[Scene, Scene]:
        start = before.replace(walls=self._outlined)
        if self.falling is not None:
            start = self.falling.add_obstacles(start)
        if self.stage.ground is None:
            earlier, crowd = super()._step_crowd(start)
            kept = {"walls": before.walls, "external": before.external}
            return earlier.replace(**kept), crowd.replace(**kept)
        earlier, crowd = super()._step_crowd(slow_people(start, self.stage.ground))
        kept = {name: getattr(before, name) for name in ("walls", "external", "preferred_speed", "max_speed")}
        return earlier.replace(**kept), crowd.replace(**kept)

    def _show_leaves(self, doors: Doors) -> None:
        self._outlined = doors.update_walls(self._outlined)
        self._plane = None

    def _people_path(self, environment: int) -> str:
        return "people"

    def finish_restore(self) -> None:
        with self.rigid.engine_steps():
            pass  # computes the frames of all bodies, and gives the models the limbs of people as after a step
        for ghost in self.rigid.ghosts.values():
            ghost.step_alone(0)
        super().finish_restore()

    def _fixed_walls(self, scene: Scene) -> Walls:
        return self._outlined

    def _resolve_overlaps(self, earlier: Scene, after: Scene) -> Scene:
        """Resolve overlaps of people as in the plane; robots are left to the engine."""
        if self.contact is None:
            return after
        present = after.active.copy()
        present[:, list(self.robot_bodies)] = False
        if self.falling is not None:
            present &= ~self.falling.balance.down
        walls, robots = after.walls, after.active
        resolve_overlaps = super()._resolve_overlaps(earlier, after.replace(active=present, walls=self._outlined))
        return resolve_overlaps.replace(active=robots, walls=walls)

    def _step_robots(self, before: Scene, after: Scene, asked: Mapping[int, Twists]) -> Scene:
        """Run the engine for a step of the world, and return the scene with the moved bodies."""
        end = float(self.environment_time.age)  # the time is already at the end of this step
        if self.falling is not None:
            after = self.falling.lead(before, after, end, self.dt)
            self.people.fallen = self.falling.poses(self.people, after, end)
        led = self._mirrored_robots(before, after)
        for agent, robot_bodies in self.robot_bodies.items():
            at_rest = (*before.position[0, agent].tolist(), float(before.heading[0, agent]))
            if self._at[agent] != at_rest and agent not in led.twists:
                self._put(agent, before)
            robot_bodies.ask(led.twists.get(agent, asked[agent]))
        self._people_bodies.pushes = ForcePushes(after, self.ids, self.physics_dt)
        gait, ends = self._prepared(before, after)
        self._touched = {}
        self.rigid.reader.led = frozenset([*led.twists, *self.rigid.people.led.tolist()])
        bases = kinematic_bases(self.engine_model, self.data, self.rigid.main.robots, led.twists)
        with self.rigid.engine_steps():
            for k in range(self._steps):
                led.go(k / self._steps)
                for base in bases:
                    base.note()
                self._substep((k + 1) / self._steps, end - (self._steps - 1 - k) * self.physics_dt)
                for base in bases if self.rigid.reader.touching else ():
                    base.restore(self.rigid.model)
            led.go(1.0)
        for ghost in self.rigid.ghosts.values():
            if self.doors is not None:
                self.doors.turn_leaves(ghost.compiled.base, ghost.data, 1.0, self.dt)
            ghost.step_alone(self._steps)
            if led.twists:
                led.go(1.0)
                ghost.step_alone(0)  # the frames follow
        if self.doors is not None:
            self.doors.read_leaves(self.rigid.main.compiled.base, self.data)
        self.forces = self._contact_tracker.forces(self._steps)
        scene, moved = self._read(before, after)
        scene = self._lead_robots(before, after, scene)
        for agent in led.twists:
            self._at[agent] = (*scene.position[0, agent].tolist(), float(scene.heading[0, agent]))
        if moved or len(self.people.agents) > len(self.people.afoot):  # riders follow their robots
            gait, ends = self.people.next_state(scene, self.dt), None
        self.people.take(gait, ends)
        if self.falling is not None:
            assert isinstance(self.seed, int), "an environment has one seed"
            self.falling.update(self.people, scene, end, self.seed)
        return keep_pushes(scene, self.ids, self.dt, self._people_bodies.unsettled())

    def _mirrored_robots(self, before: Scene, after: Scene) -> MirroredRobots:
        """Return the motion of the robots whose pose comes from outside."""
        led = () if self.avatars is None else self.avatars.robots
        bodies = {agent: body for agent, body in self.robot_bodies.items() if agent in led}
        return MirroredRobots(bodies, before, after, self.dt)

    def _prepared(self, before: Scene, after: Scene) -> tuple[Any, Floats | None]:
        """Assign bodies to people near movers, and return the states of people after the step."""
        gait = self.people.next_state(after, self.dt)
        ends = self.people.ends_of(gait)
        if len(self._people_bodies.agent):
            self._people_bodies.led = self._led_people(before)
            self._embody(before)
            way = (after.position[0] - before.position[0]) / self.dt
            start, end = self.people.relative_ends(before), self.people.relative_ends(after, ends)
            self._people_bodies.begin(before.position[0], way, start, end, self.dt, before.heading[0])
        return gait, ends

    def _embody(self, scene: Scene) -> None:
        """Assign bodies to people who may come into contact in this step, nearest first."""
        persons = self.people.afoot
        persons = persons[scene.active[0, persons]]
        led = () if self.avatars is None else self.avatars.robots
        found = movers(self.rigid.main.robots, self.stage, self._movable, self.data, led)
        near, mass, ahead, firm = people_near(scene, persons, found, NEAR + FAST * self.dt)
        near = add_unsteady(scene, persons, near, self._wanting(scene), NEAR + FAST * self.dt)
        rows = self.people.row[persons[near]]
        people = self.people.people
        self.skipped_people = self._people_bodies.take(
            persons[near], people.mass[rows], self.people.radius[rows], CENTER * people.height[rows], mass[near],
            ahead[near], firm[near],
        )  # fmt: skip

    def _substep(self, share: float, time: float) -> None:
        mj, model, data, reader = engine(), self.rigid.model, self.data, self.rigid.reader
        if self.rigid.links:
            self.rigid.links.note(data)
        for robot_bodies in self.rigid.main.robots.values():
            robot_bodies.drive()
        self._people_bodies.go(share)
        if self.rigid.links:
            self.rigid.links.begin(model, data)
        if self.doors is not None:
            self.doors.turn_leaves(model, data, share, self.dt)
        mj.mj_step1(model, data)
        self.rigid.main.apply_friction(model)
        self.rigid.main.compiled.servos.apply(data)
        reader.look()
        mj.mj_step2(model, data)
        if self.rigid.links:
            self.rigid.links.end(data)
        self.rigid.main.read_loads()
        contacts = reader.read()
        self._people_bodies.register_contacts(contacts)
        self._contact_tracker.add(time, contacts)
        for contact in contacts:
            if contact.first.kind == "robot" and contact.second.kind in ("robot", "person"):
                pair = (contact.first.number, contact.second.number)
                pair = (min(pair), max(pair)) if pair[1] in self.robot_bodies else pair  # a rider belongs to a robot
                self._touched[pair] = max(self._touched.get(pair, 0.0), contact.depth)

    def _read(self, before: Scene, after: Scene) -> tuple[Scene, bool]:
        """Return the scene with simulated robots and pushed people, and whether anyone was pushed."""
        position, velocity, heading = after.position.copy(), after.velocity.copy(), after.heading.copy()
        for agent, robot_bodies in self.robot_bodies.items():
            pose, twist = robot_bodies.pose, robot_bodies.twist
            self.twists[agent] = twist
            position[0, agent], heading[0, agent] = pose.position[0], pose.heading[0]
            velocity[0, agent] = twist.velocity(pose.heading)[0]
            self._at[agent] = (*pose.position[0].tolist(), float(pose.heading[0]))
        pushed, places, speeds = self._people_bodies.end()
        position[0, pushed], velocity[0, pushed] = places, speeds
        return after.replace(position=position, velocity=velocity, heading=heading), len(pushed) > 0

    def _find_contacts(self, before: Scene, after: Scene) -> tuple[Contact, ...]:
        return tuple(sorted(Contact(0, *pair, -depth) for pair, depth in self._touched.items()))

    @property
    def robot_bodies(self) -> dict[int, RobotBody]:
        """Bodies of the robots by agent."""
        return self.rigid.robots

    @property
    def engine_model(self) -> Any:
        """The ``mujoco.MjModel``, shared with other worlds of the same stage and robots; not to be changed."""
        return self.rigid.main.compiled.base

    @property
    def data(self) -> Any:
        """The ``mujoco.MjData`` of all bodies that can touch each other."""
        return self.rigid.main.data

    @property
    def mjcf(self) -> MjcfModel:
        """The MJCF model."""
        return self.rigid.main.compiled.built

    @property
    def _people_bodies(self) -> PeopleBodies:
        return self.rigid.people

    @property
    def _movable(self) -> list[int]:
        return [k for k, prop in enumerate(self.stage.props) if prop.movable]

    def _wanting(self, scene: Scene) -> Ints:
        """Return the people who need a body although nothing may be near them: out of balance, or pushed."""
        pushed = acting_pushes(scene, self.ids)
        return pushed if self.falling is None else np.union1d(self.falling.wanting(), pushed)

    def _push_people(self, earlier: Scene, crowd: Scene) -> Scene:
        # the engine applies the forces
        return crowd

    def command(self, robot: int, joints: Mapping[str, float]) -> None:
        """Set the commands of joint motors of a robot; they stay in force until changed.

        Raises:
            InputError: the agent is not a robot, a joint has no motor or is a wheel, or a value is not finite.
        """
        self.robot_body(robot).command(joints)

    def move_joint(self, robot: int, joint: str, position: float, environment: int = 0) -> None:
        self.robot_body(robot).hold(joint, position)

    def robot_body(self, robot: int) -> RobotBody:
        """Return the body of a robot.

        Raises:
            InputError: the agent is not a robot.
        """
        if robot not in self.robot_bodies:
            raise InputError(f"agent {robot} is not a robot; robots are {sorted(self.robot_bodies) or 'none'}")
        return self.robot_bodies[robot]

    def render(
        self, camera: SceneCamera, *, rgb: bool = True, depth: bool = False, segmentation: bool = False
    ) -> CameraImages:
        """Return the current images of a camera, with the skins of people. No display is needed.

        Raises:
            InputError: no OpenGL backend works, or the robot or link of the camera is unknown.
        """
        return self.renderer.images(camera, rgb=rgb, depth=depth, segmentation=segmentation)

    @property
    def renderer(self) -> Renderer:
        # renderer of the current state with ghosts, for films
        return self._shown(bool(self.rigid.ghosts))

    def environment_renderer(self, environment: int) -> Renderer:
        # renderer without ghosts, for cameras of crowdbot.sensors
        return self._shown(False)

    def _shown(self, ghosts: bool) -> Renderer:
        """Return the renderer of the current state, with ghosts or without."""
        whole = self.rigid.picture() if ghosts else self.rigid.main
        scene = self.scene if ghosts else hide_ghosts(self.scene, self.ghosts)
        if ghosts not in self._renderers:
            robots = {agent: body.robot for agent, body in whole.robots.items()}
            self._renderers[ghosts] = Renderer.of_physics(whole.compiled.built, robots, self.stage, self.people, scene)
        self._renderers[ghosts].show_engine(scene, whole.data.qpos)
        return self._renderers[ghosts]

    def prop(self, number: int) -> Floats:
        """Return the frame ``[4, 4]`` of a prop in the world."""
        if not 0 <= number < len(self.stage.props) or isinstance(self.stage.props[number], AbsentProp):
            raise InputError(f"there is no prop {number}; the stage has {len(self.stage.props)}")
        body = self.data.body(f"prop{number}")
        result = np.eye(4)
        result[:3, :3], result[:3, 3] = body.xmat.reshape(3, 3), body.xpos
        return result

    def change_bodies(self, robots: Mapping[int, Robot], stage: PhysicsStage, walls: Walls | None = None) -> None:
        # replace the descriptions of robots: sensors, posture and latency; the stage stays.
        for agent, robot in robots.items():
            if agent not in self.drives or agent in self.robot_bodies:
                self.robot_body(agent).robot = self._with_rider(agent, robot)

    def _with_rider(self, agent: int, robot: Robot) -> Robot:
        """Return the robot of an agent with its rider, if it has one."""
        people = self.people
        if agent not in people.agents[len(people.afoot) :]:
            return robot
        return seat_rider(robot, people.people, int(people.row[agent]))

    def copy(self) -> Self:
        """Return an independent world in the same state, on a free clock."""
        shared: list[Any] = [engine(), self.stage, self.router, self.people.people, self.people.gait, self.model]
        shared += [body.robot for body in self.robot_bodies.values()]
        shared += [start.robot for start in self.rigid.starts.values()]
        shared += [part.compiled.base for part in self.rigid.parts]
        shared.append(self.rigid.reader.geoms)
        renderers, self._renderers = self._renderers, {}
        known = {id(item): item for item in shared} | {id(part.data): copy.copy(part.data) for part in self.rigid.parts}
        try:
            other = copy.deepcopy(self, known)
        finally:
            self._renderers = renderers
        other.environment_time.follow()
        return other

    def reconfigure(self, scene: Scene, sources: Sequence[PeopleSource], seed: Any = None, **how: Any) -> None:
        super().reconfigure(scene, sources, seed, **how)
        if sorted(self.rigid.ghosts) != sorted(agent for agent in self.ghosts if agent in self.robot_bodies):
            self.rigid.change(ghosts=self.ghosts)
            self._forget()

    def place_robot(
        self, agent: int, robot: Robot, place: tuple[float, float, float], ghost: bool, environments: Sequence[int]
    ) -> None:
        place = (float(place[0]), float(place[1]), wrap_angle(float(place[2])))
        if environments:
            starts = {**self.rigid.starts, agent: RobotStart(agent, robot, *place)}
            self.rigid.change(starts=starts, ghosts=[*self.rigid.ghosts, *([agent] if ghost else [])])
            self._at[agent] = place
        self._start_robot(agent, robot, place, ghost, environments)
        if self.falling is not None:
            self.falling.grow(self.people, self.scene.shape[1])
        self._forget()

    def remove_robot(self, agent: int, environments: Sequence[int] | None = None) -> None:
        chosen = self._environments_with(agent, environments)
        self.rigid.change(starts={item: start for item, start in self.rigid.starts.items() if item != agent})
        self._take_away(agent, chosen)
        self._forget()

    @property
    def prop_names(self) -> list[str]:
        return self._prop_names

    def add_prop(self, prop: PropBody, name: str = "") -> str:
        name = new_prop_name(self._prop_names, name)
        self._change_stage(dataclasses.replace(self.stage, props=(*self.stage.props, prop)))
        self._prop_names = [*self._prop_names, name]
        return name

    def remove_prop(self, name: str) -> None:
        number = prop_number(self._prop_names, name)
        self._change_stage(without_prop(self.stage, number))
        self._prop_names = without_prop_name(self._prop_names, number)

    def has_other_robots(self, robots: Sequence[int]) -> bool:
        return super().has_other_robots(robots) or sorted(self.rigid.starts) != list(robots)

    def has_other_props(self, props: Sequence[PropBody]) -> bool:
        now = self.stage.props
        if self._prop_names != [f"prop{number}" for number in range(len(props))] or len(now) != len(props):
            return True
        try:
            return bool(now != props)
        except ValueError:  # props of other classes may not be comparable; their names are as at the start
            return False

    def change_walls(self, walls: Walls) -> None:
        """Replace the walls, without the outlines of props; see :class:`World`."""
        self.rigid.change(walls=walls)
        self.scene = self.scene.replace(walls=walls)
        self._outlined = add_rings(walls, self.stage.outlines())
        self._forget()

    def embody_person(self, agent: int, environment: int) -> None:
        self.people.grow(self.scene.shape[1], [agent])
        if self.falling is not None:
            self.falling.grow(self.people, self.scene.shape[1])
        wanted = min(SLOTS, len(self.people.afoot))
        if wanted > self.rigid.slots and not self._slots_fixed:
            self.rigid.change(slots=min(SLOTS, self.rigid.slots + MORE))
        self._forget()

    def _change_stage(self, stage: PhysicsStage) -> None:
        self.rigid.change(stage=stage)
        self.stage, self._outlined = stage, add_rings(self.scene.walls, stage.outlines())
        self._forget()

    def _forget(self) -> None:
        """Drop what was derived from the old bodies."""
        self._renderers, self._plane = {}, None

    def _led_people(self, scene: Scene) -> Ints:
        """Return the agents whose motion comes from outside: avatars, and people on recorded tracks."""
        led = np.zeros(0, dtype=np.int64) if self.avatars is None else self.avatars.agents
        if self.script is None:
            return led
        return np.union1d(led, np.flatnonzero(self.script.follower_mask(scene)[0]))

    def _heading_of(self, agent: int) -> float:
        return float(self.scene.heading[0, agent])

    def _limb_mass_of(self, agent: int, limb: str, point: Floats, normal: Floats) -> float:
        return self.people.limb_mass(agent, limb, point, normal, self._people_bodies.limb_ends(agent))

    def _mass_of(self, party: ContactBody) -> float:
        if party.kind == "robot":
            return self.robot_bodies[party.number].mass
        if party.kind == "person":
            return float(self.people.people.mass[self.people.row[party.number]])
        if (
            party.kind == "wall"
            and party.number < 0
            and (leaf := self.stage.doors[-1 - party.number]).opening == "push"
        ):
            return leaf.mass
        return self.stage.props[party.number].weight if party.kind == "prop" else math.inf


def check_arguments(scene: Scene, robots: Mapping[int, Robot], dt: float, physics_dt: float, slots: int | None) -> None:
    """Raise :class:`InputError` if the arguments of a physics world are not allowed."""
    if scene.shape[0] != 1:
        raise InputError(f"a physics world has one environment, the scene has {scene.shape[0]}; use PlanarWorld")
    if not 1e-4 <= physics_dt <= 0.02:
        raise InputError(f"physics_dt = {physics_dt} s must be from 0.0001 to 0.02 s; a typical value is 0.005 s")
    if not math.isfinite(dt) or dt < physics_dt or abs(dt / physics_dt - round(dt / physics_dt)) > 1e-6:
        raise InputError(f"dt = {dt} s must be a multiple of physics_dt = {physics_dt} s")
    if slots is not None and (isinstance(slots, bool) or not isinstance(slots, int) or not 0 <= slots <= 1000):
        raise InputError(f"slots = {slots!r} must be a whole number from 0 to 1000")
    for agent, robot in robots.items():
        if not isinstance(robot, Robot):
            raise InputError(
                f"robots[{agent}] is a {type(robot).__name__}; give a Robot such as Robot.load('turtlebot2')"
            )
        if 0 <= agent < scene.shape[1] and not scene.active[0, agent]:
            raise InputError(f"robot {robot.name} of agent {agent} is absent (active=False); robots must be active")


def people_near(
    scene: Scene, persons: NDArray[np.int64], movers: Sequence[Mover], reach: float
) -> tuple[NDArray[np.int64], Floats, NDArray[np.bool_], NDArray[np.bool_]]:
    """Return the people near a robot or a movable prop, the nearest first; E = 1.

    Args:
        scene: with positions and headings.
        persons: ``[P]`` agents that are people.
        movers: x, y, radius [m], mass [kg] of each robot and movable prop, and whether contacts cannot move it.
        reach: largest distance between a person and the outline of a mover [m].

    Returns:
        ``[N]`` indices into ``persons``; ``[P]`` mass of the nearest mover [kg]; ``[P]`` whether it is ahead; ``[P]``
        whether contacts cannot move it.
    """
    nearest = np.full(len(persons), np.inf)
    mass = np.ones(len(persons))
    ahead, firm = np.ones(len(persons), dtype=np.bool_), np.zeros(len(persons), dtype=np.bool_)
    looks = np.stack([np.cos(scene.heading[0, persons]), np.sin(scene.heading[0, persons])], axis=-1)
    for x, y, radius, weight, led in movers:
        away = np.array([x, y]) - scene.position[0, persons]
        gap = np.sqrt(np.sum(away * away, axis=1)) - radius
        closer = gap < nearest
        nearest[closer], mass[closer], firm[closer] = gap[closer], weight, led
        ahead[closer] = np.sum(away * looks, axis=1)[closer] >= 0.0
    near = np.flatnonzero(nearest < reach)
    near = near[np.lexsort((persons[near], nearest[near]))]
    return near, mass, ahead, firm


def add_unsteady(
    scene: Scene, persons: NDArray[np.int64], near: NDArray[np.int64], unsteady: NDArray[np.int64], reach: float
) -> NDArray[np.int64]:
    """Return who needs a body: people out of balance first, then those near movers, then those near the former.

    Args:
        scene: with positions.
        persons: ``[P]`` agents that are people.
        near: indices into ``persons`` of those near movers, by decreasing priority.
        unsteady: agents out of balance.
        reach: largest distance [m] of people whom they may touch.
    """
    own = np.flatnonzero(np.isin(persons, unsteady))
    if not len(own):
        return near
    away = scene.position[0, persons[:, None]] - scene.position[0, persons[own]][None]
    gap = np.sqrt(np.sum(away * away, axis=-1)).min(axis=1)
    close = np.flatnonzero(gap < reach)
    close = close[np.lexsort((persons[close], gap[close]))]
    wanted = np.concatenate([own, near, close])
    return wanted[np.sort(np.unique(wanted, return_index=True)[1])]


def movers(
    robots: Mapping[int, RobotBody], stage: PhysicsStage, movable: Sequence[int], data: Any, led: Sequence[int] = ()
) -> list[Mover]:
    """Return x, y, radius [m] and mass [kg] of robots, movable props and pushed doors, and whether they are firm.

    Contacts cannot move what is firm.

    Args:
        robots: bodies of the robots by agent.
        stage: stage with the props.
        movable: numbers of the movable props.
        data: data of the engine.
        led: agents of robots whose pose comes from outside.
    """
    found = []
    for agent, body in robots.items():
        ((x, y),) = body.pose.position.tolist()
        found.append((x, y, body.robot.radius, body.mass, agent in led))
    for number in movable:
        x, y, _ = data.body(f"prop{number}").xpos.tolist()
        prop = stage.props[number]
        found.append((x, y, math.sqrt(0.5) * getattr(prop, "size", 1.0), prop.weight, False))
    for k, leaf in enumerate(stage.doors):
        if leaf.opening == "push":  # the leaf, and the place where it is when closed
            x, y, _ = data.body(f"door{k}").xipos.tolist()
            closed = leaf.line(0.0).mean(axis=0).tolist()
            found += [(a, b, 0.5 * leaf.width, leaf.mass, False) for a, b in ((x, y), closed)]
    return found

"""Planar world: a crowd model moves people, drives move robots."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import FreeClock, InputError, Pose, RandomStreams, Scene, SpatialPose, Storage, Twist, Walls
from crowdbot.core.outlines import Outlines
from crowdbot.metrics import step_outline_wall_clearance, step_wall_clearance
from crowdbot.models import CrowdModel, Mixture
from crowdbot.models.mixture import MODEL
from crowdbot.typing import Floats
from crowdbot.world.robots.drives.drive import Drive, Twists
from crowdbot.world.robots.drives.servo import CommandDelay, Pending

from .crowd.contact import ContactModel
from .crowd.environment_rows import resize_scene, works_in_batches
from .crowd.ghosts import hide_ghosts, show_ghosts
from .crowd.journey import JOURNEY, JourneyAssignment
from .crowd.limits import CrowdLimits
from .crowd.people_flow import PeopleFlow, environment_seeds
from .crowd.portal import Exit, Portal
from .crowd.replay import ReplayedPeople
from .crowd.routing import WAY, Router
from .crowd.source import PeopleSource
from .crowd.wall_crossing import ContactSurfaces, stop_at_walls
from .crowd.waypoint import Zone
from .doors.motion import ONE_ENVIRONMENT, move_doors, show_doors
from .environment_time import EnvironmentTime
from .planar_live_changes import (
    keep_added_robots,
    new_prop_name,
    prop_number,
    props_of,
    put_robot_at,
    remove_robot_at,
    replace_walls,
    robot_environments,
    without_last,
)
from .planar_phases import (
    check_commands,
    contact_surfaces,
    exchange_people,
    find_contacts,
    initial_twist,
    move_people,
    move_robots,
    resolve_overlaps,
    show_crowd,
    step_models,
)
from .pushes import PUSH, drift_people, without_drift
from .robots.mount import MountPlacement
from .world import Contact, World

if TYPE_CHECKING:
    from crowdbot.humans import People

    from .crowd.avatars import Avatars
    from .doors.doors import Doors
    from .physics.kinematic_bodies import KinematicBodies
    from .physics.stage import PhysicsStage, PropBody
    from .reactions.robot_reactions import RobotReactions
    from .rendering.renderer import Renderer
    from .robots.robot import Robot


CHANGEABLE = (
    "model", "drives", "latency", "robot_margin", "router", "contact", "limits", "exits", "heading_jitter", "substeps",
    "ghosts",
)  # fmt: skip
"""Arguments that :meth:`PlanarWorld.reconfigure` can change."""


@dataclass
class PlanarWorld(World):
    """People as discs and robots as discs or convex outlines in the plane, E environments at once.

    People and robots move simultaneously: each reacts to the positions of the others at the start of the step. To the
    crowd model, robots are external agents. Without ``contact`` there are no forces between bodies: overlaps are
    reported in :attr:`contacts`, but not resolved. People whose path crosses a wall stop there; a robot driven into a
    wall passes through it. The crowd has its own random stream, which sensors and navigators do not affect. Arguments
    after ``robot_margin`` are off by default.

    Args:
        scene: initial scene; robots are agents with ``external=True``.
        model: crowd model.
        drives: drive of each robot by agent index.
        dt: time step [s].
        seed: seed of the crowd, or one for each environment; a single seed gives environment e the seed ``seed + e``.
            An environment equals a world with only this environment and its seed.
        leave_radius: distance to the goal [m] below which people leave; None: they stay. Robots never leave.
        robot_margin: margin that people add to the radius of a robot [m]. Crowd models pass discs at zero clearance:
            without a margin, ORCA people touch a robot that stands still.
        router: guides people around walls to their goals.
        contact: resolution of overlaps between people after a step.
        limits: limits of speed and acceleration, applied after the model.
        journeys: sequences of goals; they replace the goals of the scene.
        sources: sources of new people, who take the slots of absent agents.
        exits: zones in which people leave; robots stay.
        portals: zones that transfer people to another zone, as new people.
        script: agents that follow recorded tracks; to the crowd model they are external.
        heading_jitter: largest constant offset of the direction of a person [rad], which resolves head-on deadlocks.
        substeps: crowd steps per step of the world; robots move straight during them.
        ids: identities ``[A]`` or ``[E, A]``, which determine random numbers of each person (default: 0 to A - 1).
        latency: delay of the commands of a robot [s], by agent (default 0), see :class:`CommandDelay`.
        ghosts: robots that drive, but are absent to people, sensors and other robots, and have no contacts.
        avatars: people and robots whose pose comes from outside; to the crowd model they are external.
        reactions: reactions of people to robots, on top of the crowd model.
        doors: doors, whose leaves are walls; E = 1.
        outlines: convex outline ``[K, 2]`` [m] of robots in their frame, by agent, see :attr:`Robot.outline`; for
            contacts with people, robots and walls. Others are discs. To the crowd model every robot is a disc.

    Attributes:
        environment_time: time of each environment, with the clock.
        twists: current twist of each robot.
        slots: ``[E]`` number of agents of each environment; further ones only pad the arrays.
        contacts: pairs of a robot and another agent with negative clearance during the last step (straight motion).
        ids: current identities ``[E, A]``; new people have new identities.
        added_robots: agents of robots that were added while the world runs.

    Raises:
        InputError: a drive has no agent or its agent is not external, a goal is unreachable, or a value is not
            allowed.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.world import DifferentialDrive
    >>> start = Scene.of([[0.0, 0.0], [5.0, 1.0]], goal=[[0.0, 0.0], [-5.0, 1.0]], external=[True, False])
    >>> world = PlanarWorld(start, ORCA(), {0: DifferentialDrive()}, dt=0.1)
    >>> scene = world.step({0: Twist(1.0, 0.0)})
    >>> scene.time, scene.position[0].round(2).tolist()
    (0.1, [[0.01, 0.0], [4.87, 1.0]])
    """

    people_shape: ClassVar[str] = "discs"
    walls_fixed: ClassVar[bool] = False
    added_robots = frozenset[int]()

    scene: Scene
    model: CrowdModel
    drives: Mapping[int, Drive]
    dt: float
    seed: int | Sequence[int] = 0
    leave_radius: float | None = None
    robot_margin: float = 0.1
    router: Router | None = None
    contact: ContactModel | None = None
    limits: CrowdLimits | None = None
    journeys: JourneyAssignment | None = None
    sources: Sequence[PeopleSource] = ()
    exits: Sequence[Exit | Zone] = ()
    portals: Sequence[Portal] = ()
    script: ReplayedPeople | None = None
    heading_jitter: float = 0.0
    substeps: int = 1
    ids: Any = None
    latency: Mapping[int, float] = field(default_factory=dict)
    ghosts: Sequence[int] = ()
    avatars: Avatars | None = None
    reactions: RobotReactions | None = None
    doors: Doors | None = None
    outlines: Mapping[int, Floats] = field(default_factory=dict)
    environment_time: EnvironmentTime = field(init=False)
    twists: dict[int, Twists] = field(init=False)
    contacts: tuple[Contact, ...] = field(init=False, default=())
    storage = Storage(
        constants=(
            "model", "drives", "dt", "seed", "leave_radius", "robot_margin", "router", "contact", "limits",
            "journeys", "sources", "exits", "portals", "script", "heading_jitter", "substeps", "latency", "ghosts",
            "reactions", "joined", "outlines", "_models", "_segments", "_surfaces", "_plain_router", "_outline_table",
        ),
    )  # fmt: skip

    def __post_init__(self) -> None:
        self._check()
        self.twists = {robot: initial_twist(self.scene, robot) for robot in sorted(self.drives)}
        seeds = environment_seeds(self.seed, self.scene.shape[0])
        self.environment_time = EnvironmentTime.of(FreeClock(self.dt), self.scene.time, len(seeds))
        self._rngs = RandomStreams(seeds, "crowd")
        self._models: list[CrowdModel] | None = None
        self.joined = True
        self._traffic = PeopleFlow.of(self.scene, self.model, seeds, self.ids, self.router, self.journeys, self.sources)
        self.ids = self._traffic.ids
        external = self.scene.external
        self.scene = self.scene if self.script is None else self.script.start(self.scene)
        self.scene = self.scene if self.avatars is None else self.avatars.place(self.scene, 0.0)
        self.scene = self._traffic.start(self._with_replayed_external(self.scene))
        self.scene = self.scene if self.reactions is None else self.reactions.start(self.scene, self._traffic)
        self.scene = self.scene.replace(external=external)
        self._surfaces: ContactSurfaces | None = None
        self._bodies: list[KinematicBodies] | None = None
        self.slots = np.full(len(seeds), self.scene.shape[1], dtype=np.int64)
        self._previous = self.scene
        self._segments: tuple[Walls, Floats] | None = None
        self._delayed: dict[int, tuple[tuple[Pending, ...], Twist | Twists]] = {}
        self._plain_router = self.router
        self._outline_table: Outlines | None = None
        if self.doors is not None:
            show_doors(self)

    def step(self, commands: Mapping[int, Twist | Twists]) -> Scene:
        asked = self._checked(commands)
        if self.doors is not None:
            move_doors(self, self.environment_time.age)
        self._previous, external = self.scene, self.scene.external
        before = self._with_replayed_external(self.scene)
        self.clock.advance()
        elapsed = self.environment_time.age
        earlier, crowd = self._step_crowd(hide_ghosts(without_drift(before), self.ghosts))
        crowd = self._push_people(earlier, crowd)
        if self.avatars is not None:
            earlier, before, crowd = self.avatars.move(self, earlier, before, crowd, elapsed)
        after = self._step_robots(before, crowd, asked)
        after = self._finish_motion(earlier, after)
        after = after.replace(external=external, time=self.environment_time.now)
        after = after if self.script is None else self.script.place(after, elapsed)
        after = after if self.avatars is None else self.avatars.place(self.avatars.hold(after), elapsed)
        after.check()
        self.contacts = self._find_contacts(before, after)
        exits = (self.leave_radius, self.exits, self.portals)
        after = exchange_people(before, after, *exits, self._traffic, elapsed)
        after = show_ghosts(after, self.ghosts, before)
        self.scene = after if after.external is external else after.replace(external=external)
        return self.scene

    def reconfigure(self, scene: Scene, sources: Sequence[PeopleSource], seed: int | None = None, **how: Any) -> None:
        """Change parameters of the running world. Positions are kept; random numbers continue unless a seed is given.

        Args:
            scene: replaces the current scene, with the same agents; its time is the current time.
            sources: new sources, same number and same journeys.
            seed: new seed of the random numbers.
            how: new values of model, drives, latency, robot_margin, router, contact, limits, exits, heading_jitter or
                substeps.

        Raises:
            InputError: the parameter cannot change in a running world, or a value is not allowed.
        """
        how = keep_added_robots(self, how)
        for name in how:
            if name not in CHANGEABLE:
                raise InputError(f"{name} cannot change in a running world; these can: {', '.join(CHANGEABLE)}")
        if scene.shape != self.scene.shape or sorted(how.get("drives", self.drives)) != sorted(self.drives):
            raise InputError("the number of agents and the robots cannot change in a running world")
        forgotten = set() if how.get("router", self.router) is self.router else {WAY}
        model = how.get("model", self.model)
        if type(model) is not type(self.model):
            forgotten |= {*self.model.memory_at_start} - {MODEL, JOURNEY, WAY}
        for name, value in how.items():
            setattr(self, name, value)
        self._plain_router = how.get("router", self._plain_router)
        if "model" in how:
            self._models = None
        self._check()
        self._traffic.reconfigure(self.router, sources, seed)
        if self._traffic.mixture is not None and isinstance(model, Mixture):
            self._traffic.mixture = model
        self.sources = sources
        memory = {name: value for name, value in scene.memory.items() if name not in forgotten}
        self.scene = scene.replace(time=self.scene.time, memory=memory)
        if self.doors is not None:
            show_doors(self, bool(forgotten))
        if seed is not None:
            self.seed = seed
            self._rngs = RandomStreams(self._traffic.seeds.tolist(), "crowd")

    @property
    def has_own_walls(self) -> bool:
        return self.walls_fixed or self.doors is not None

    @property
    def waiting_count(self) -> NDArray[np.int64]:
        return self._traffic.waiting_count

    def pose(self, robot: int) -> Pose:
        return Pose(self.scene.position[:, robot].copy(), self.scene.heading[:, robot].copy())

    def sensor_pose(self, robot: int, mount: MountPlacement, spatial: bool) -> Pose | SpatialPose:
        (x, y, z, roll, pitch, yaw), base = mount.placed, self.pose(robot)
        return base.to_spatial(0.0).offset(x, y, z, roll, pitch, yaw) if spatial else base.offset(x, y, yaw)

    def wall_clearance(self, robot: int) -> Floats:
        if robot in self.ghosts:
            return np.full(len(self.slots), math.inf)
        walls = self.scene.walls
        if self._segments is None or self._segments[0] is not walls:
            self._segments = (walls, walls.segments())
        before, now = self._previous.position[:, robot], self.scene.position[:, robot]
        radius = self.scene.radius[:, robot]
        if robot not in self.outlines:
            return step_wall_clearance(before, now, radius, self._segments[1])
        turn, turned = self._previous.heading[:, robot], self.scene.heading[:, robot]
        return step_outline_wall_clearance(before, turn, now, turned, radius, self.outlines[robot], self._segments[1])

    def _agent_outlines(self) -> Outlines | None:
        """Return the outlines of the agents for kernels; None if all are discs."""
        if not self.outlines:
            return None
        agents = self.scene.shape[1]
        if self._outline_table is None or len(self._outline_table.first) != agents + 1:
            self._outline_table = Outlines.of(self.outlines, agents)
        return self._outline_table

    def plane_scene(self, environment: int | None = None) -> Scene:
        return hide_ghosts(self.scene if environment is None else self.environment_scene(environment), self.ghosts)

    def body_scene(self, skins: int | None = None, environment: int = 0, avatars: bool = False) -> Scene:
        scene = hide_ghosts(self.environment_scene(environment), self.ghosts)
        only = self.avatars.people if avatars and self.avatars is not None else None
        return self._embodied(environment).scene(scene, skins, only)

    @property
    def renderer(self) -> Renderer:
        return self._embodied(0).renderer(self.environment_scene(0))

    def environment_renderer(self, environment: int) -> Renderer:
        return self._embodied(environment).renderer(hide_ghosts(self.environment_scene(environment), self.ghosts))

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
        from .physics.kinematic_bodies import KinematicBodies

        if (count := len(self.slots)) > 1:
            raise InputError(f"bodies are added to one environment at a time; this world has {count}")
        self._bodies = [KinematicBodies(self.scene, robots, stage, people, riders=riders, walls=walls, seed=seed)]
        self.people, self._bodies[0].doors = self._bodies[0].people, self.doors
        self._begin_activity(activity)

    def change_bodies(self, robots: Mapping[int, Robot], stage: PhysicsStage, walls: Walls | None = None) -> None:
        for bodies in self._bodies or ():
            bodies.robots, bodies.stage, bodies.walls = {**bodies.robots, **robots}, stage, walls

    def pose_people(self) -> None:
        for e, bodies in enumerate(self._bodies or ()):
            bodies.people.walk(self.environment_scene(e), self.dt)

    def _begin_activity(self, activity: Sequence[str]) -> None:
        if self.people is not None and set(activity) - {"walk"}:
            self.people.begin(self.scene, activity)

    def _embodied(self, environment: int) -> KinematicBodies:
        if self._bodies is None:
            raise InputError("the world has no bodies of people and robots: call World.embody first")
        return self._bodies[environment]

    def environment_scene(self, environment: int) -> Scene:
        slots = int(self.slots[environment])
        one = self.scene if len(self.slots) == 1 else self.scene.environment(environment)
        return one if slots == one.shape[1] else resize_scene(one, slots)

    def _with_replayed_external(self, scene: Scene) -> Scene:
        """Return the scene with replayed people and avatars as external agents."""
        scene = scene if self.avatars is None else self.avatars.hold(scene)
        known = None if self.script is None else self.script.follower_mask(scene)
        return scene if known is None else scene.replace(external=scene.external | known)

    def _step_crowd(self, before: Scene) -> tuple[Scene, Scene]:
        """Return the scenes before and after the last substep of the crowd."""
        start = show_crowd(before, self._traffic, self.heading_jitter, list(self.twists), self.robot_margin)
        resolve, radius = self._finish_motion, before.radius
        step: Callable[[Scene, float], Scene] = self._step_model
        if self.reactions is not None:
            start, step = self.reactions.apply(start, step, sorted(self.twists), radius, self._traffic, self.dt)
        earlier, crowd = move_people(start, step, resolve, self.limits, self.dt, self.substeps, radius)
        own = {"radius": before.radius, "goal": before.goal, "preferred_velocity": before.preferred_velocity}
        own |= {"preferred_speed": before.preferred_speed, "robot": None}
        return earlier, crowd.replace(**own, memory={**earlier.memory, **crowd.memory})

    def _step_model(self, scene: Scene, dt: float) -> Scene:
        models = self._models or (self.model,)
        whole = len(models) == 1 or (self.joined and works_in_batches(self.model))
        return step_models(scene, dt, models, self._rngs, self.model if whole else None)

    def _finish_motion(self, earlier: Scene, after: Scene) -> Scene:
        """Return the scene after a substep with overlaps resolved, in which nobody has crossed a wall."""
        return self._stop_at_walls(earlier, self._resolve_overlaps(earlier, after))

    def _stop_at_walls(self, earlier: Scene, after: Scene) -> Scene:
        return stop_at_walls(earlier, after, self.dt / self.substeps, self._fixed_walls(after))

    def _fixed_walls(self, scene: Scene) -> Walls:
        """Return the walls that stop people."""
        return scene.walls

    def _resolve_overlaps(self, earlier: Scene, after: Scene) -> Scene:
        if self.contact is None:
            return after
        self._surfaces = contact_surfaces(after, self._surfaces)
        dt, outlines = self.dt / self.substeps, self._agent_outlines()
        return resolve_overlaps(earlier, after, self.contact, dt, self._surfaces, outlines)

    def _check(self) -> None:
        check_arguments(
            self.scene, self.drives, self.robot_margin, self.leave_radius, self.heading_jitter, self.substeps
        )
        if self.doors is not None and self.scene.shape[0] > 1:
            raise InputError(ONE_ENVIRONMENT)

    def _checked(self, commands: Mapping[int, Twist | Twists]) -> dict[int, Twists]:
        asked = check_commands(commands, self.twists, self.scene.active)
        return {robot: self._after_latency(robot, command) for robot, command in asked.items()}

    def _after_latency(self, robot: int, command: Twists) -> Twists:
        """Return the command in force during the next step."""
        if (latency := self.latency.get(robot, 0.0)) == 0.0:
            return command
        pending, now = self._delayed.get(robot, ((), Twist()))
        self._delayed[robot] = CommandDelay(latency).step(pending, now, command, self.dt)
        return Twists.of(self._delayed[robot][1], self.scene.shape[0])

    def _step_robots(self, before: Scene, after: Scene, asked: Mapping[int, Twists]) -> Scene:
        scene, self.twists = move_robots(before, after, self.drives, self.twists, asked, self.dt)
        return scene if self.avatars is None else self._lead_robots(before, after, scene)

    def _lead_robots(self, before: Scene, led: Scene, after: Scene) -> Scene:
        """Return the scene with the robots whose pose comes from outside where they are led."""
        if self.avatars is None:
            return after
        scene, twists = self.avatars.lead_robots(before, led, after, self.dt)
        self.twists = {**self.twists, **twists}
        return scene

    def _find_contacts(self, before: Scene, after: Scene) -> tuple[Contact, ...]:
        return find_contacts(before, after, list(self.twists), self.ghosts, self._agent_outlines())

    def _push_people(self, earlier: Scene, crowd: Scene) -> Scene:
        """Return the scene after the motion by pushes in a step of the crowd."""
        if PUSH not in crowd.memory:
            return crowd
        return drift_people(self._stop_at_walls(earlier, crowd), self.ids, self.dt)

    def remove_robot(self, agent: int, environments: Sequence[int] | None = None) -> None:
        remove_robot_at(self, agent, robot_environments(self, agent, environments))

    def place_robot(
        self, agent: int, robot: Robot, place: tuple[float, float, float], ghost: bool, environments: Sequence[int]
    ) -> None:
        put_robot_at(self, agent, robot, place, ghost, environments)
        for bodies in self._bodies or ():
            bodies.robots = {**bodies.robots, agent: robot}
            bodies.forget_renderer()

    def embody_person(self, agent: int, environment: int) -> None:
        """Give a new person a body, in a world with bodies."""
        for bodies in (self._bodies or [])[environment : environment + 1]:
            bodies.people.grow(self.scene.shape[1], [agent])
            bodies.forget_renderer()

    def add_prop(self, prop: PropBody, name: str = "") -> str:
        from .physics.scenery import add_rings, prop_outline

        names, outlines = props_of(self)
        name, ring = new_prop_name(names, name), prop_outline(prop)
        for bodies in self._bodies or ():
            bodies.walls = self.scene.walls if bodies.walls is None else bodies.walls
            bodies.stage = dataclasses.replace(bodies.stage, props=(*bodies.stage.props, prop))
            bodies.forget_renderer()
        self._prop_outlines = ([*names, name], [*outlines, ring])
        replace_walls(self, add_rings(self.scene.walls, (ring,)))
        return name

    def remove_prop(self, name: str) -> None:
        from .physics.scenery import remove_ring
        from .physics.stage import without_prop

        names, outlines = props_of(self)
        number = prop_number(names, name)
        walls = remove_ring(self.scene.walls, outlines[number])
        for bodies in self._bodies or ():
            bodies.stage = without_prop(bodies.stage, number)
            bodies.forget_renderer()
        left = without_last([*names[:number], "", *names[number + 1 :]])
        self._prop_outlines = (left, outlines[: len(left)])
        replace_walls(self, walls)


def check_arguments(
    scene: Scene,
    drives: Mapping[int, Drive],
    robot_margin: float,
    leave_radius: float | None,
    heading_jitter: float,
    substeps: int,
) -> None:
    """Raise :class:`InputError` if an argument of a planar world is not allowed."""
    agents = scene.shape[1]
    for robot in drives:
        if not 0 <= robot < agents:
            raise InputError(f"a drive is given for agent {robot}, but the scene has agents 0 to {agents - 1}")
        if not np.all(scene.external[:, robot]):
            raise InputError(f"agent {robot} has a drive but is not external: set external=True for robots")
    if not 0.0 <= robot_margin < math.inf:
        raise InputError(f"robot_margin {robot_margin} m must be finite and at least 0")
    if leave_radius is not None and not 0.0 < leave_radius < math.inf:
        raise InputError(f"leave_radius {leave_radius} m must be finite and above 0, or None")
    if not 0.0 <= heading_jitter <= math.pi:
        raise InputError(f"heading_jitter {heading_jitter} rad must be from 0 to pi")
    if isinstance(substeps, bool) or not isinstance(substeps, int) or not 1 <= substeps <= 10_000:
        raise InputError(f"substeps = {substeps!r} must be a whole number from 1 to 10000")

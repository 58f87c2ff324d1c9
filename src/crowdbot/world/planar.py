"""Planar world: a crowd model moves people, drives move robots."""

from __future__ import annotations

import copy
import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import (
    FreeClock,
    InputError,
    MissingExtra,
    Pose,
    RandomStreams,
    Scene,
    SpatialPose,
    StateError,
    Storage,
    Twist,
    Walls,
    tree,
    wrap_angle,
)
from crowdbot.core.outlines import Outlines
from crowdbot.metrics import step_outline_wall_clearance, step_wall_clearance
from crowdbot.models import CrowdModel, Mixture
from crowdbot.models.mixture import MODEL
from crowdbot.typing import Floats, Ints
from crowdbot.world.robots.drives.drive import Drive, Twists
from crowdbot.world.robots.drives.servo import CommandDelay

from .crowd.contact import ContactModel
from .crowd.environment_rows import (
    Delayed,
    align_delays,
    align_scenes,
    align_twists,
    join_models,
    pad_ids,
    resize_scene,
    with_common_time,
)
from .crowd.ghosts import hide_ghosts, show_ghosts
from .crowd.journey import JOURNEY, JourneyAssignment
from .crowd.limits import CrowdLimits
from .crowd.people_flow import PeopleFlow, environment_seeds
from .crowd.portal import Exit, Portal
from .crowd.replay import ReplayedPeople
from .crowd.routing import WAY, Router, fresh
from .crowd.source import PeopleSource
from .crowd.wall_crossing import ContactSurfaces, stop_at_walls
from .crowd.waypoint import Zone
from .environment_time import EnvironmentTime
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
    from .physics.people_motion import PeopleMotion
    from .physics.stage import PhysicsStage, PropBody
    from .reactions.robot_reactions import RobotReactions
    from .rendering.renderer import Renderer
    from .robots.robot import Robot


CHANGEABLE = (
    "model", "drives", "latency", "robot_margin", "router", "contact", "limits", "exits", "heading_jitter", "substeps",
    "ghosts",
)  # fmt: skip
"""Arguments that :meth:`PlanarWorld.reconfigure` can change."""
MOST_AGENTS = 1_000_000
"""Largest number of agents of a stored state that is restored."""
ONE_ENVIRONMENT = (
    "a planar world with doors has one environment, since its walls are those of all; join several worlds with"
    " join_worlds"
)


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
        reactions: reactions of people to robots, and behaviour trees, on top of the crowd model.
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
            "_changed_props",
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
        self._changed_props: tuple[list[str], list[Floats]] | None = None
        self.slots = np.full(len(seeds), self.scene.shape[1], dtype=np.int64)
        self._previous = self.scene
        self._segments: tuple[Walls, Floats] | None = None
        self._delayed: Delayed = {}
        self._plain_router = self.router
        self._outline_table: Outlines | None = None
        self.show_doors()

    def step(self, commands: Mapping[int, Twist | Twists]) -> Scene:
        asked = self._checked(commands)
        if self.doors is not None:
            self._move_doors(self.doors)
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
        how = self._with_added_robots(how)
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
        self.show_doors(bool(forgotten))
        if seed is not None:
            self.seed = seed
            self._rngs = RandomStreams(self._traffic.seeds.tolist(), "crowd")

    @property
    def has_own_walls(self) -> bool:
        return self.walls_fixed or self.doors is not None

    @property
    def waiting_count(self) -> NDArray[np.int64]:
        return self._traffic.waiting_count

    @property
    def people_motions(self) -> list[PeopleMotion]:
        """Bodies of people in each environment, empty without bodies."""
        return [bodies.people for bodies in self._bodies or ()]

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
            start, step = self.reactions.apply(start, step, sorted(self.twists), before, self._traffic, self.dt)
        earlier, crowd = move_people(start, step, resolve, self.limits, self.dt, self.substeps, radius)
        own = {"radius": before.radius, "goal": before.goal, "preferred_velocity": before.preferred_velocity}
        own |= {"preferred_speed": before.preferred_speed, "robot": None}
        return earlier, crowd.replace(**own, memory={**earlier.memory, **crowd.memory})

    def _step_model(self, scene: Scene, dt: float) -> Scene:
        models = self._models or (self.model,)
        whole = len(models) == 1 or (self.joined and self.model.is_batched)
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
        self._take_away(agent, self._environments_with(agent, environments))

    def place_robot(
        self, agent: int, robot: Robot, place: tuple[float, float, float], ghost: bool, environments: Sequence[int]
    ) -> None:
        self._start_robot(agent, robot, place, ghost, environments)
        for bodies in self._bodies or ():
            bodies.robots = {**bodies.robots, agent: robot}
            bodies.forget_renderer()

    def _start_robot(
        self, agent: int, robot: Robot, place: tuple[float, float, float], ghost: bool, environments: Sequence[int]
    ) -> None:
        """Make an agent without a body a robot at rest in some environments, and an absent one in the others."""
        self._add_absent_robot(agent, robot.drive, robot.latency, robot.outline)
        x, y, heading = place
        rows = list(environments)
        if rows:
            self.assign_ids(agent, rows)
        top = float(getattr(robot.drive, "max_speed", 1.0))
        values = {
            "position": (x, y), "velocity": 0.0, "heading": wrap_angle(heading),
            "goal": (x, y), "radius": robot.radius, "preferred_speed": top, "max_speed": top, "visible": not ghost,
            "group": -1,
        }  # fmt: skip
        arrays = {name: getattr(self.scene, name).copy() for name in (*values, "active")}
        for name, value in values.items():
            arrays[name][:, agent] = value
        arrays["active"][rows, agent] = True
        if ghost:
            self.ghosts = [*self.ghosts, agent]
        self.scene = self.scene.replace(**arrays)

    def _add_absent_robot(self, agent: int, drive: Drive, latency: float, outline: Floats | None) -> None:
        self.widen(agent + 1)
        self.slots[:] = np.maximum(self.slots, agent + 1)
        self.drives, self.latency = {**self.drives, agent: drive}, {**self.latency, agent: latency}
        self.twists = {**self.twists, agent: Twists.of(Twist(), len(self.slots))}
        self.added_robots = self.added_robots | {agent}
        if outline is not None:
            self.outlines = {**self.outlines, agent: outline}
            self._outline_table = None
        external = self.scene.external.copy()
        external[:, agent] = True
        self.scene = self.scene.replace(external=external)

    def _take_away(self, agent: int, environments: Sequence[int]) -> None:
        """Make a robot absent in some environments."""
        active = self.scene.active.copy()
        active[environments, agent] = False
        self.scene = self.scene.replace(active=active)
        self.rest_robot(agent, environments)

    def rest_robot(self, agent: int, environments: Sequence[int]) -> None:
        """Let a robot stand in some environments: its velocity is 0 until the next command."""
        left = ~np.isin(np.arange(len(self.slots)), environments)
        twist = self.twists[agent]
        still = Twists(*(np.where(left, part, 0.0) for part in (twist.forward, twist.turn, twist.left)))
        self.twists = {**self.twists, agent: still}

    def match_robots(self, other: PlanarWorld) -> None:
        """Make robots that were added to one of two worlds of a trial absent robots of the other.

        Raises:
            InputError: a person has the place of such a robot.
        """
        for item, two in ((self, other), (other, self)):
            for agent in sorted(item.added_robots - two.added_robots):
                if agent < two.scene.shape[1] and two.scene.active[:, agent].any():
                    raise InputError(f"agent {agent} is a robot in one environment and a person in another")
                latency, outline = item.latency.get(agent, 0.0), item.outlines.get(agent)
                two._add_absent_robot(agent, item.drives[agent], latency, outline)

    def _with_added_robots(self, how: dict[str, Any]) -> dict[str, Any]:
        """Return new parameters that leave the robots unchanged that were added while the world runs."""
        kept = self.added_robots
        if not kept:
            return how
        rest: dict[str, Any] = {}
        for name in ("drives", "latency"):
            if name in how:
                rest[name] = {agent: getattr(self, name)[agent] for agent in kept} | dict(how[name])
        if "ghosts" in how:
            rest["ghosts"] = [*how["ghosts"], *(agent for agent in self.ghosts if agent in kept)]
        return {**how, **rest}

    def widen(self, agents: int) -> None:
        """Add absent agents to all environments, and bodies of people, so that each has at least ``agents``."""
        if agents > self.scene.shape[1]:
            self.scene, self._previous = resize_scene(self.scene, agents), resize_scene(self._previous, agents)
            self._traffic.ids = pad_ids(self._traffic.ids, agents)
            self.ids = self._traffic.ids
            self._set_models(self._each_model())
        for people in self.people_motions:
            people.grow(agents)

    def assign_ids(self, agent: int, environments: Sequence[int]) -> None:
        """Give a new person or robot the next identity in some environments."""
        rows = list(environments)
        self._traffic.ids[rows, agent] = self._traffic.following[rows]
        self._traffic.following[rows] += 1

    def next_id(self, environment: int) -> int:
        """Return the identity that the next person or robot of an environment gets."""
        return int(self._traffic.following[environment])

    def embody_person(self, agent: int, environment: int) -> None:
        """Give a new person a body, in a world with bodies."""
        for bodies in (self._bodies or [])[environment : environment + 1]:
            bodies.people.grow(self.scene.shape[1], [agent])
            bodies.forget_renderer()

    def move_joint(self, robot: int, joint: str, position: float, environment: int = 0) -> None:
        if self._bodies is not None:
            bodies = self._bodies[environment]
            bodies.joints = {**bodies.joints, robot: {**bodies.joints.get(robot, {}), joint: position}}

    @property
    def prop_names(self) -> list[str]:
        return self._props()[0]

    def add_prop(self, prop: PropBody, name: str = "") -> str:
        from .physics.scenery import add_rings, prop_outline
        from .physics.stage import new_prop_name

        names, outlines = self._props()
        name, ring = new_prop_name(names, name), prop_outline(prop)
        for bodies in self._bodies or ():
            bodies.walls = self.scene.walls if bodies.walls is None else bodies.walls
            bodies.stage = dataclasses.replace(bodies.stage, props=(*bodies.stage.props, prop))
            bodies.forget_renderer()
        self._changed_props = ([*names, name], [*outlines, ring])
        self._replace_walls(add_rings(self.scene.walls, (ring,)))
        return name

    def remove_prop(self, name: str) -> None:
        from .physics.scenery import remove_ring
        from .physics.stage import prop_number, without_prop, without_prop_name

        names, outlines = self._props()
        number = prop_number(names, name)
        walls = remove_ring(self.scene.walls, outlines[number])
        for bodies in self._bodies or ():
            bodies.stage = without_prop(bodies.stage, number)
            bodies.forget_renderer()
        left = without_prop_name(names, number)
        self._changed_props = (left, outlines[: len(left)])
        self._replace_walls(walls)

    def _props(self) -> tuple[list[str], list[Floats]]:
        """Return names and outlines of the props by number."""
        from .physics.scenery import prop_outline

        if self._changed_props is not None:
            return self._changed_props
        props = self._bodies[0].stage.props if self._bodies else ()
        return [f"prop{k}" for k in range(len(props))], [prop_outline(prop) for prop in props]

    def has_other_props(self, props: Sequence[PropBody]) -> bool:
        """Return whether props were added or removed, so that they are not those of the start."""
        return self._changed_props is not None

    def _replace_walls(self, walls: Walls) -> None:
        """Replace the walls in the scenes before and after the last step."""
        self.scene, self._previous = self.scene.replace(walls=walls), self._previous.replace(walls=walls)

    def _move_doors(self, doors: Doors) -> None:
        """Move the doors by a step that begins now."""
        before = [*doors.blocked, *doors.side.tolist()]
        doors.advance(self.scene, float(np.ravel(self.environment_time.age)[0]), self.dt)
        self.show_doors(before != [*doors.blocked, *doors.side.tolist()])

    def show_doors(self, new_paths: bool = True) -> None:
        """Set walls and paths by the doors, if there are any; ``new_paths`` forgets the paths that people follow."""
        if self.doors is None:
            return
        self._show_leaves(self.doors)
        base = self._plain_router
        if base is None:
            return
        self.router = self._traffic.router = self.doors.router(base)
        if new_paths and WAY in self.scene.memory:
            self.scene = self.scene.replace(memory={**self.scene.memory, WAY: fresh(self.scene.shape)})

    def _show_leaves(self, doors: Doors) -> None:
        walls = doors.update_walls(self.scene.walls)
        if walls is not self.scene.walls:
            self._replace_walls(walls)

    def has_other_robots(self, robots: Sequence[int]) -> bool:
        """Return whether robots were added or removed, so that their agents are not those of the start."""
        return bool(self.added_robots)

    def add_stored_people(self, state: Mapping[str, Any], path: str) -> None:
        """Add the slots and bodies of people who were added before a state was stored below a path."""
        stored = state.get(f"{path}/_traffic/ids")
        agents = stored.shape[1] if isinstance(stored, np.ndarray) and stored.ndim == 2 else 0
        if self.scene.shape[1] < agents <= MOST_AGENTS:
            self.widen(agents)
        for e, people in enumerate(self.people_motions):
            afoot = state.get(f"{path}/{self._people_path(e)}/afoot")
            for agent in afoot[len(people.afoot) :].tolist() if isinstance(afoot, np.ndarray) else ():
                self.embody_person(agent, e)

    def _people_path(self, environment: int) -> str:
        """Return the path below which the bodies of people are stored."""
        return f"_bodies/{environment}/people"

    def finish_restore(self) -> None:
        """Derive what a stored state leaves out, after its values were set.

        Raises:
            StateError: the arrays of people do not fit together.
        """
        self.show_doors(new_paths=False)
        for scene in (self.scene, self._previous):
            for name, array in scene.memory.items():
                if not isinstance(name, str) or not isinstance(array, np.ndarray) or array.shape[:2] != scene.shape:
                    raise StateError(f"the memory {name!r} of people has no row for each person")
            scene.check()

    @classmethod
    def of_environments(cls, scene: Scene, models: Sequence[CrowdModel], slots: Ints, **how: Any) -> PlanarWorld:
        """Return a world of E environments that can have different crowd models and numbers of agents.

        Args:
            scene: initial scene of E environments.
            models: crowd model of each environment.
            slots: ``[E]`` number of agents of each environment; further ones are absent and external.
            how: other arguments of :class:`PlanarWorld`.

        >>> from crowdbot.models import ORCA
        >>> scene = Scene.of([[[0.0, 0.0]], [[1.0, 0.0]]])
        >>> models = [ORCA(), ORCA(time_horizon=1.0)]
        >>> PlanarWorld.of_environments(scene, models, np.array([1, 1]), drives={}, dt=0.1).slots.tolist()
        [1, 1]
        """
        world = cls(scene, models[0], **how)
        world.slots = slots
        if len(models) > 1:
            world._set_models(list(models))
        return world

    @classmethod
    def join(cls, worlds: Sequence[PlanarWorld]) -> PlanarWorld:
        """Return one world with the environments of several worlds of a trial, on the clock of the first.

        Worlds with fewer agents are padded with absent ones. The worlds must not be used any more.

        >>> from crowdbot.models import ORCA
        >>> parts = [PlanarWorld(Scene.of([[float(k), 0.0]]), ORCA(), {}, dt=0.1, seed=k) for k in range(3)]
        >>> PlanarWorld.join(parts).step({}).position[:, 0].tolist()
        [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]
        """
        first = worlds[0]
        if len(worlds) == 1:
            return first
        if first.doors is not None:
            raise InputError(ONE_ENVIRONMENT)
        whole = copy.copy(first)
        for world in worlds[1:]:
            world.environment_time.follow(first.clock)
        models = [model for world in worlds for model in world._each_model()]
        whole._set_environments(tree.join(cls._environments_of(worlds)), models)
        if first._bodies is not None:
            whole._bodies = [bodies for world in worlds for bodies in world._bodies or ()]
        return whole

    def select(self, environments: Sequence[int] | Ints) -> PlanarWorld:
        """Return an independent world with some environments; an environment may be selected more than once."""
        index = np.asarray(environments, dtype=np.int64)
        some = copy.copy(self)
        models = self._each_model()
        some._set_environments(tree.take(self._environments_of([self])[0], index), [models[e] for e in index])
        some.environment_time.follow()
        some.doors = None if self.doors is None else self.doors.copy()
        if self._bodies is not None:
            some._bodies = [self._bodies[e].copy() for e in index]
            for bodies in some._bodies:
                bodies.doors = some.doors
            some.people = some._bodies[0].people if len(index) else None
        return some

    def put(self, environments: Sequence[int] | Ints, other: PlanarWorld) -> None:
        """Replace some environments by those of another world of the trial, which must not be used any more."""
        self.match_robots(other)
        index = np.asarray(environments, dtype=np.int64)
        if self.doors is not None:
            self.scene = self.scene.replace(walls=other.scene.walls)
            self.doors, self.router = other.doors, other.router
        other.environment_time.follow(self.clock)
        models, new = list(self._each_model()), other._each_model()
        for k, e in enumerate(index.tolist()):
            models[e] = new[k]
            if self._bodies is not None and other._bodies is not None:
                self._bodies[e] = other._bodies[k]
        if self._bodies is not None:
            self.people = self._bodies[0].people
        changed = any(model is not self.model for model in models)
        whole, rows = self._environments_of([self, other])
        self._set_environments(tree.put(whole, index, rows, len(self.slots)), models if changed else None)

    def undo_point(self) -> Callable[[], None]:
        """Return a function that takes back the next step."""
        kept = {name: getattr(self, name) for name in ("scene", "_previous", "contacts")}
        twists, delayed, tick = dict(self.twists), dict(self._delayed), self.clock.tick
        ids, following = self._traffic.ids.copy(), self._traffic.following.copy()
        rngs = None if self.model.is_batched else tree.take(self._rngs, slice(None))

        def undo() -> None:
            self._rngs = rngs or self._rngs
            for name, value in kept.items():
                setattr(self, name, value)
            self.twists, self._delayed, self.clock.tick = twists, delayed, tick
            self._traffic.ids[:], self._traffic.following[:] = ids, following

        return undo

    def step_one_by_one(self, commands: Mapping[int, Twist | Twists]) -> tuple[PlanarWorld, dict[int, Exception]]:
        """Advance each environment alone; return the world, and the exceptions of environments that lose their agents.

        The world itself must not be used any more.
        """
        parts, errors, count = [], {}, len(self.slots)
        wide = {robot: Twists.of(command, count) for robot, command in commands.items()}
        for e in range(count):
            index = np.array([e])
            part = self.select(index)
            try:
                part.step({robot: tree.take(command, index) for robot, command in wide.items()})
            except MissingExtra:
                raise
            except Exception as error:  # told to the caller
                errors[e] = error
                part.scene = part.scene.replace(active=np.zeros_like(part.scene.active))
            parts.append(part)
        clock = self.clock
        clock.advance()
        whole = PlanarWorld.join(parts)
        whole.clock = clock
        return whole, errors

    def _each_model(self) -> list[Any]:
        return self._models if self._models is not None else [self.model] * len(self.slots)

    def _set_models(self, models: list[Any]) -> None:
        """Set the model of each environment, as one model if a call for all equals a call for each."""
        joined = join_models(models, self.scene.shape[1])
        self._models = models
        self.joined = joined is not None
        self.model = models[0] if joined is None else joined

    @staticmethod
    def _environments_of(worlds: Sequence[PlanarWorld]) -> list[dict[str, Any]]:
        """Fields with environments of worlds, as trees of one structure: padded, with equally many pending commands."""
        scenes, before = [world.scene for world in worlds], [world._previous for world in worlds]
        if len(worlds) > 1:
            scenes, before = align_scenes(scenes), align_scenes(before)
        delays = align_delays([world._delayed for world in worlds], [len(world.slots) for world in worlds])
        twists = {robot: align_twists([world.twists[robot] for world in worlds]) for robot in worlds[0].twists}
        return [
            world._environment_fields(scenes[k], before[k], {robot: row[k] for robot, row in twists.items()}, delays[k])
            for k, world in enumerate(worlds)
        ]

    def _environment_fields(
        self, scene: Scene, previous: Scene, twists: dict[int, Twists], delayed: Delayed
    ) -> dict[str, Any]:
        """Return the fields with environments, of which those of the arguments fit to other worlds."""
        contacts = tree.objects([()] * len(self.slots))
        for contact in self.contacts:
            contacts[contact.environment] += (contact,)
        flow = dataclasses.replace(self._traffic, ids=pad_ids(self._traffic.ids, scene.shape[1]))
        return {
            "scene": scene, "_previous": previous, "_traffic": flow, "twists": twists, "_delayed": delayed,
            "contacts": contacts, "slots": self.slots, "avatars": self.avatars,
            "environment_time": self.environment_time, "_rngs": self._rngs,
        }  # fmt: skip

    def _set_environments(self, state: dict[str, Any], models: list[Any] | None) -> None:
        """Set the fields with environments, and the model of each environment if it changes."""
        scene = self.scene
        for name, value in state.items():
            setattr(self, name, value)
        self.ids = self._traffic.ids
        self.contacts = tuple(item._replace(environment=e) for e, row in enumerate(state["contacts"]) for item in row)
        self.scene = with_common_time(self.scene, scene)
        self._previous = with_common_time(self._previous, scene).replace(walls=self.scene.walls)
        if models is not None:
            self._set_models(models)


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

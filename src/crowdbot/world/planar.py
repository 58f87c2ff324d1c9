"""Planar world: a crowd model moves people, drives move robots."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Clock, FreeClock, InputError, Pose, Scene, SpatialPose, Twist, Walls, stream
from crowdbot.metrics import swept_distance, wall_clearance
from crowdbot.models import CrowdModel, Mixture
from crowdbot.models.mixture import MODEL

from .crowd.contact import ContactModel, ContactSurfaces
from .crowd.journey import JOURNEY, JourneyAssignment
from .crowd.limits import CrowdLimits
from .crowd.people_flow import PeopleFlow
from .crowd.portal import PortalTransfer, apply_portals
from .crowd.replay import ReplayedPeople
from .crowd.routing import WAY, Router
from .crowd.source import PeopleSource
from .crowd.walk import CrowdStepRequest, StepGenerator
from .crowd.waypoint import PolygonZone
from .robots.drive import Drive, Twists
from .robots.mount import MountPlacement
from .robots.servo import CommandDelay, Pending
from .world import Contact, World

if TYPE_CHECKING:
    from crowdbot.humans import People

    from .physics.kinematic_bodies import KinematicBodies
    from .physics.stage import PhysicsStage
    from .rendering.renderer import Renderer
    from .robots.robot import Robot

__all__ = ["PlanarWorld"]

Floats = NDArray[np.float64]


@dataclass
class PlanarWorld(World):
    """People and robots as discs in the plane, E environments at once.

    People and robots move simultaneously: each reacts to the positions of the others at the start of the step. To the
    crowd model, robots are external agents. Without ``contact`` there are no forces between bodies: overlaps are
    reported in :attr:`contacts`, but not resolved. A robot driven into a wall passes through it. The crowd has its own
    random stream, which sensors and navigators do not affect. Arguments after ``robot_margin`` are off by default.

    Args:
        scene: initial scene; robots are agents with ``external=True``.
        model: crowd model.
        drives: drive of each robot by agent index.
        dt: time step [s].
        seed: seed of the crowd. Journeys, sources and heading offsets of environment e equal those of a world with
            only this environment and the seed ``seed + e``.
        leave_radius: distance to the goal [m] below which people leave (``active=False``); None: they stay. Robots
            never leave.
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
        heading_jitter: largest offset of the preferred direction of a person [rad], constant for each person. It
            resolves deadlocks of people who meet exactly head-on; 1e-3 is enough.
        substeps: crowd steps per step of the world; robots move straight during them.
        ids: identities ``[A]`` or ``[E, A]`` (int), which determine the random numbers of each person
            (default: 0 to A - 1).
        latency: delay of the commands of a robot [s], by agent, see :class:`CommandDelay`; 0 for robots left out.

    Attributes:
        clock: simulation clock.
        twists: current twist of each robot.
        contacts: pairs of a robot and another agent whose clearance was negative during the last step, assuming
            straight motion.
        ids: current identities ``[E, A]``; new people have new identities.

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

    scene: Scene
    model: CrowdModel
    drives: Mapping[int, Drive]
    dt: float
    seed: int = 0
    leave_radius: float | None = None
    robot_margin: float = 0.1
    router: Router | None = None
    contact: ContactModel | None = None
    limits: CrowdLimits | None = None
    journeys: JourneyAssignment | None = None
    sources: Sequence[PeopleSource] = ()
    exits: Sequence[PolygonZone] = ()
    portals: Sequence[PortalTransfer] = ()
    script: ReplayedPeople | None = None
    heading_jitter: float = 0.0
    substeps: int = 1
    ids: Any = None
    latency: Mapping[int, float] = field(default_factory=dict)
    clock: Clock = field(init=False)
    twists: dict[int, Twists] = field(init=False)
    contacts: tuple[Contact, ...] = field(init=False, default=())

    def __post_init__(self) -> None:
        self._check()
        self.clock = FreeClock(self.dt)
        self.twists = {robot: self._initial_twist(robot) for robot in sorted(self.drives)}
        self._begin = self.scene.time
        self._rng = stream(self.seed, "crowd")
        self._traffic = PeopleFlow.of(
            self.scene, self.model, self.seed, self.ids, self.router, self.journeys, self.sources
        )
        self.ids = self._traffic.ids
        external = self.scene.external
        if self.script is not None:
            self.scene = self.script.start(self.scene)
        self.scene = self._traffic.start(self._with_replayed_external(self.scene)).replace(external=external)
        self._surfaces: ContactSurfaces | None = None
        self._bodies: KinematicBodies | None = None
        self._previous = self.scene
        self._segments: tuple[Walls, Floats] | None = None
        self._delayed: dict[int, tuple[tuple[Pending, ...], Twist | Twists]] = {}

    def step_requests(self, commands: Mapping[int, Twist | Twists]) -> StepGenerator[Scene]:
        """Advance by one step and yield the steps of the crowd model; see :func:`crowdbot.world.run_step`."""
        asked = self._checked(commands)
        self._previous = self.scene
        before = self._with_replayed_external(self.scene)
        self.clock.advance()
        earlier, crowd = yield from self._step_crowd(before)
        after = self._step_robots(before, crowd, asked)
        after = self._resolve_overlaps(earlier, after).replace(external=self.scene.external)
        after = after.replace(time=self._begin + self.clock.time)
        if self.script is not None:
            after = self.script.place(after, self.clock.time)
        after.check()
        self.contacts = self._find_contacts(before, after)
        if self.leave_radius is not None:
            after = _left(after, self.leave_radius)
        for zone in self.exits:
            after = _out(after, zone)
        after = apply_portals(before, after, self.portals, self._traffic.ids, self._traffic.following)
        self.scene = self._traffic.advance(after, self.clock.time)
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
        known = (
            "model",
            "drives",
            "latency",
            "robot_margin",
            "router",
            "contact",
            "limits",
            "exits",
            "heading_jitter",
            "substeps",
        )
        for name in how:
            if name not in known:
                raise InputError(f"{name} cannot change in a running world; these can: {', '.join(known)}")
        if scene.shape != self.scene.shape or sorted(how.get("drives", self.drives)) != sorted(self.drives):
            raise InputError("the number of agents and the robots cannot change in a running world")
        forgotten = set() if how.get("router", self.router) is self.router else {WAY}
        model = how.get("model", self.model)
        if type(model) is not type(self.model):
            forgotten |= {*self.model.memory_at_start} - {MODEL, JOURNEY, WAY}
        for name, value in how.items():
            setattr(self, name, value)
        self._check()
        self._traffic.reconfigure(self.router, sources, seed)
        if self._traffic.mixture is not None and isinstance(model, Mixture):
            self._traffic.mixture = model
        self.sources = sources
        memory = {name: value for name, value in scene.memory.items() if name not in forgotten}
        self.scene = scene.replace(time=self.scene.time, memory=memory)
        if seed is not None:
            self.seed, self._rng = seed, stream(seed, "crowd")

    @property
    def waiting_count(self) -> NDArray[np.int64]:
        """Number of people waiting to enter, ``[E]``."""
        return self._traffic.waiting_count

    def pose(self, robot: int) -> Pose:
        """Return the pose of a robot in every environment."""
        return Pose(self.scene.position[:, robot].copy(), self.scene.heading[:, robot].copy())

    def sensor_pose(self, robot: int, mount: MountPlacement, spatial: bool) -> Pose | SpatialPose:
        """Return the pose of a sensor of a robot in its posture; see :class:`World`."""
        x, y, z, roll, pitch, yaw = mount.placed
        base = self.pose(robot)
        return base.to_spatial(0.0).offset(x, y, z, roll, pitch, yaw) if spatial else base.offset(x, y, yaw)

    def wall_clearance(self, robot: int) -> Floats:
        """Return the clearance ``[E]`` [m] to walls on the straight path of the last step; see :class:`World`."""
        walls = self.scene.walls
        if self._segments is None or self._segments[0] is not walls:
            self._segments = (walls, walls.segments())
        paths = np.stack([self._previous.position[:, robot], self.scene.position[:, robot]], axis=1)
        radius = self.scene.radius[:, robot].tolist()
        return np.array(
            [wall_clearance(path, size, self._segments[1])[1] for path, size in zip(paths, radius, strict=True)]
        )

    def plane_scene(self) -> Scene:
        """Return the scene; see :class:`World`. The outlines of props are always among its walls."""
        return self.scene

    def body_scene(self, skins: int | None = None) -> Scene:
        """Return the scene with bodies; see :class:`World`."""
        return self._embodied().scene(self.scene, skins)

    @property
    def renderer(self) -> Renderer:
        """Renderer of the current scene; see :class:`World`."""
        return self._embodied().renderer(self.scene)

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
        """Add bodies for sensors and cameras; see :class:`World`."""
        from .physics.kinematic_bodies import KinematicBodies

        self._bodies = KinematicBodies(self.scene, robots, stage, people, riders=riders, walls=walls, seed=seed)
        self.people = self._bodies.people
        self._begin_activity(activity)

    def change_bodies(self, robots: Mapping[int, Robot], stage: PhysicsStage, walls: Walls | None = None) -> None:
        """Replace robots and stage; see :class:`World`."""
        if self._bodies is not None:
            self._bodies.robots, self._bodies.stage, self._bodies.walls = dict(robots), stage, walls

    def pose_people(self) -> None:
        """Move the bodies of people to the current scene; see :class:`World`."""
        if self._bodies is not None:
            self._bodies.people.walk(self.scene, self.dt)

    def _begin_activity(self, activity: Sequence[str]) -> None:
        if self.people is not None and set(activity) - {"walk"}:
            self.people.begin(self.scene, activity)

    def _embodied(self) -> KinematicBodies:
        if self._bodies is None:
            raise InputError("the world has no bodies of people and robots: call World.embody first")
        return self._bodies

    def _with_replayed_external(self, scene: Scene) -> Scene:
        """Return the scene with replayed people as external agents."""
        return (
            scene if self.script is None else scene.replace(external=scene.external | self.script.follower_mask(scene))
        )

    def _step_crowd(self, before: Scene) -> StepGenerator[tuple[Scene, Scene]]:
        """Return the scenes before and after the last substep of the crowd."""
        wide = before.radius.copy()
        wide[:, list(self.twists)] += self.robot_margin
        crowd = earlier = self._traffic.desired_motion(before, self.heading_jitter).replace(radius=wide)
        h = self.dt / self.substeps
        for k in range(self.substeps):
            if k > 0:
                crowd = self._resolve_overlaps(earlier, crowd.replace(radius=before.radius)).replace(radius=wide)
            earlier = crowd
            crowd = yield CrowdStepRequest(self.model, earlier, h, self._rng)
            if self.limits is not None:
                crowd = self.limits.apply(earlier, crowd, h)
        own = {"radius": before.radius, "goal": before.goal, "preferred_velocity": before.preferred_velocity}
        return earlier, crowd.replace(**own, memory={**earlier.memory, **crowd.memory})

    def _resolve_overlaps(self, earlier: Scene, after: Scene) -> Scene:
        """Return the scene with overlaps of people resolved."""
        if self.contact is None:
            return after
        largest = float(after.radius[after.active].max(initial=0.0))
        known = self._surfaces
        if known is None or known.walls is not after.walls or known.reach < largest:
            self._surfaces = known = ContactSurfaces.of(after.walls, largest)
        return self.contact.resolve_overlaps(earlier, after, self.dt / self.substeps, known)

    def _check(self) -> None:
        agents = self.scene.shape[1]
        for robot in self.drives:
            if not 0 <= robot < agents:
                raise InputError(f"a drive is given for agent {robot}, but the scene has agents 0 to {agents - 1}")
            if not np.all(self.scene.external[:, robot]):
                raise InputError(f"agent {robot} has a drive but is not external: set external=True for robots")
        if not 0.0 <= self.robot_margin < math.inf:
            raise InputError(f"robot_margin {self.robot_margin} m must be finite and at least 0")
        if self.leave_radius is not None and not 0.0 < self.leave_radius < math.inf:
            raise InputError(f"leave_radius {self.leave_radius} m must be finite and above 0, or None")
        if not 0.0 <= self.heading_jitter <= math.pi:
            raise InputError(f"heading_jitter {self.heading_jitter} rad must be from 0 to pi")
        if isinstance(self.substeps, bool) or not isinstance(self.substeps, int) or not 1 <= self.substeps <= 10_000:
            raise InputError(f"substeps = {self.substeps!r} must be a whole number from 1 to 10000")

    def _initial_twist(self, robot: int) -> Twists:
        heading, velocity = self.scene.heading[:, robot], self.scene.velocity[:, robot]
        cos, sin = np.cos(heading), np.sin(heading)
        forward = cos * velocity[:, 0] + sin * velocity[:, 1]
        left = cos * velocity[:, 1] - sin * velocity[:, 0]
        return Twists(forward, np.zeros_like(forward), left)

    def _checked(self, commands: Mapping[int, Twist | Twists]) -> dict[int, Twists]:
        for robot in commands:
            if robot not in self.drives:
                raise InputError(
                    f"agent {robot} has a command but is not a robot; robots are {sorted(self.drives) or 'none'}"
                )
        missing = [robot for robot in self.twists if robot not in commands]
        if missing:
            raise InputError(f"robot {missing[0]} has no command; give one in every step, Twist() to stop")
        asked = {robot: Twists.of(commands[robot], self.scene.shape[0]) for robot in self.twists}
        return {robot: self._after_latency(robot, command) for robot, command in asked.items()}

    def _after_latency(self, robot: int, command: Twists) -> Twists:
        """Return the command in force during the next step."""
        latency = self.latency.get(robot, 0.0)
        if latency == 0.0:
            return command
        pending, now = self._delayed.get(robot, ((), Twist()))
        self._delayed[robot] = CommandDelay(latency).step(pending, now, command, self.dt)
        return Twists.of(self._delayed[robot][1], self.scene.shape[0])

    def _step_robots(self, before: Scene, after: Scene, asked: Mapping[int, Twists]) -> Scene:
        position, velocity, heading = after.position.copy(), after.velocity.copy(), after.heading.copy()
        for robot, command in asked.items():
            here = before.active[:, robot]
            old = Pose(before.position[:, robot].copy(), before.heading[:, robot].copy())
            pose, twist = self.drives[robot].step(old, self.twists[robot], command, self.dt)
            self.twists[robot] = twist
            position[:, robot] = np.where(here[:, None], pose.position, old.position)
            heading[:, robot] = np.where(here, pose.heading, old.heading)
            velocity[:, robot] = np.where(here[:, None], twist.velocity(heading[:, robot]), 0.0)
        return after.replace(position=position, velocity=velocity, heading=heading)

    def _find_contacts(self, before: Scene, after: Scene) -> tuple[Contact, ...]:
        found: list[Contact] = []
        for number, robot in enumerate(self.twists):
            start = before.position - before.position[:, robot : robot + 1]
            end = after.position - after.position[:, robot : robot + 1]
            gap = swept_distance(start, end) - after.radius - after.radius[:, robot : robot + 1]
            others = after.active & after.active[:, robot : robot + 1]
            others[:, list(self.twists)[: number + 1]] = False
            for e, other in np.argwhere(others & (gap < 0.0)):
                found.append(Contact(int(e), robot, int(other), float(gap[e, other])))
        return tuple(sorted(found))


def _left(scene: Scene, radius: float) -> Scene:
    away = scene.goal - scene.position
    arrived = away[..., 0] ** 2 + away[..., 1] ** 2 < radius * radius
    return scene.replace(active=scene.active & ~(arrived & ~scene.external))


def _out(scene: Scene, exit_: PolygonZone) -> Scene:
    there = exit_.contains(scene.position.reshape(-1, 2)).reshape(scene.shape)
    return scene.replace(active=scene.active & ~(there & ~scene.external))

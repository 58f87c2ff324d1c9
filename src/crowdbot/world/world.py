"""World: contract of the planar and the physics world, which move people and robots in time steps."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Clock, InputError, Pose, Scene, SpatialPose, Twist, Walls, storable
from crowdbot.world.robots.drives.drive import Twists

from .environment_time import EnvironmentTime
from .robots.mount import MountPlacement
from .robots.robot import Robot

if TYPE_CHECKING:
    from crowdbot.humans import FallPose, People

    from .crowd.source import PeopleSource
    from .physics.balance.fall import Fall
    from .physics.contact_events import BodyContactEvent, ContactForce
    from .physics.people_motion import PeopleMotion
    from .physics.stage import PhysicsStage, PropBody
    from .rendering.renderer import Renderer

FARTHEST = 1e6
"""Largest coordinate [m] of a person or robot."""


@storable
class Contact(NamedTuple):
    """A contact between a robot and another agent during a step.

    ``clearance`` [m] is the smallest clearance during the step. It is negative: the depth of the overlap.
    """

    environment: int
    robot: int
    other: int
    clearance: float


class World(ABC):
    """Moves people and robots in time steps. Code that uses a world does not depend on its kind.

    Attributes:
        people_shape: shape of people for sensors, unless a trial sets another: ``discs`` or ``limbs``.
        walls_fixed: True if the walls cannot change after construction.
        scene: current scene. A caller may replace it between two steps, for instance to remove people.
        dt: time step [s].
        environment_time: time of each environment.
        ids: ``[E, A]`` identity of the person or robot in each place.
        slots: ``[E]`` number of agents of each environment; further ones only pad the arrays.
        twists: current twist of each robot, by agent.
        contacts: contacts between robots and other agents in the last step.
        forces: contact forces in the last step; empty in a world without forces.
        people: bodies of people; None in a world whose people are discs.
    """

    people_shape: ClassVar[str]
    walls_fixed: ClassVar[bool]
    scene: Scene
    dt: float
    environment_time: EnvironmentTime
    ids: NDArray[np.int64]
    slots: NDArray[np.int64]
    twists: dict[int, Twists]
    contacts: tuple[Contact, ...]
    forces: tuple[ContactForce, ...] = ()
    people: PeopleMotion | None = None

    @abstractmethod
    def step(self, commands: Mapping[int, Twist | Twists]) -> Scene:
        """Advance by one time step and return the new scene.

        Args:
            commands: commanded twist of each robot, by agent; one for all environments or one each. The world applies
                the latency of the robot.

        Raises:
            InputError: a robot has no command, an agent with a command is not a robot, or a value is not finite.
        """

    @property
    def clock(self) -> Clock:
        """The clock that all environments share."""
        return self.environment_time.clock

    @clock.setter
    def clock(self, clock: Clock) -> None:
        """Set the clock."""
        self.environment_time.clock = clock

    @property
    def ticks(self) -> NDArray[np.int64]:
        """Number of steps of each environment since it began, ``[E]``."""
        return self.environment_time.ticks

    @property
    def times(self) -> NDArray[np.float64]:
        """Time of each environment since it began, ``[E]`` [s]."""
        return np.asarray(self.ticks * self.clock.step_ns / 1e9)

    @property
    def has_own_walls(self) -> bool:
        """Whether each environment has walls of its own, so that :meth:`plane_scene` needs the number of one."""
        return self.walls_fixed

    @property
    @abstractmethod
    def waiting_count(self) -> NDArray[np.int64]:
        """Number of people waiting to enter, ``[E]``."""

    @abstractmethod
    def environment_scene(self, environment: int) -> Scene:
        """Return the scene of one environment with its own number of agents."""

    @abstractmethod
    def environment_renderer(self, environment: int) -> Renderer:
        """Return the renderer of one environment; errors as for :attr:`renderer`."""

    def part(self, environment: int) -> tuple[Any, int]:
        """Return the world that holds an environment, and the row of the environment in it."""
        return self, environment

    def forces_of(self, environment: int) -> tuple[ContactForce, ...]:
        """Return the contact forces of the last step in one environment."""
        forces: tuple[ContactForce, ...] = self.part(environment)[0].forces
        return forces

    def contact_events_of(self, environment: int) -> tuple[BodyContactEvent, ...]:
        """Return the contact events of one environment so far, ordered by start time."""
        events: tuple[BodyContactEvent, ...] = self.part(environment)[0].contact_events
        return events

    def falls_of(self, environment: int) -> tuple[Fall, ...]:
        """Return the falls of people in one environment so far, ordered by start time; also those that go on."""
        falls: tuple[Fall, ...] = self.part(environment)[0].falls
        return falls

    def fall_poses_of(self, environment: int) -> Mapping[int, FallPose]:
        """Return the poses of people who lean, fall or lie in one environment, by agent."""
        own, row = self.part(environment)
        return {} if own.people is None else own.people.fall_poses(own.scene.active[row])

    @property
    def falls(self) -> tuple[Fall, ...]:
        """All falls of people so far; empty in a world in which nobody loses balance."""
        return ()

    @property
    def contact_events(self) -> tuple[BodyContactEvent, ...]:
        """All contact events so far, ordered by start time; empty in a world without forces."""
        return ()

    @abstractmethod
    def pose(self, robot: int) -> Pose:
        """Return the pose of a robot in every environment."""

    @abstractmethod
    def sensor_pose(self, robot: int, mount: MountPlacement, spatial: bool) -> Pose | SpatialPose:
        """Return the pose of a sensor: ``spatial`` in space, otherwise in the plane."""

    @abstractmethod
    def wall_clearance(self, robot: int) -> NDArray[np.float64]:
        """Return the smallest clearance ``[E]`` [m] between a robot and fixed objects in the last step.

        It is negative on contact. A world that measures contacts only returns infinity without contact.
        """

    @abstractmethod
    def plane_scene(self, environment: int | None = None) -> Scene:
        """Return the scene in the plane, with the outlines of props among the walls: of all environments, or of one."""

    @abstractmethod
    def body_scene(self, skins: int | None = None, environment: int = 0, avatars: bool = False) -> Scene:
        """Return the scene of one environment with the bodies of people, robots and props, for range sensors.

        Args:
            skins: level of detail of people's skins; None for capsules.
            environment: index of the environment.
            avatars: whether only avatars have a skin, and everybody else capsules.

        Raises:
            InputError: the world has no bodies, see :meth:`embody`.
        """

    @property
    @abstractmethod
    def renderer(self) -> Renderer:
        """Renderer of the current scene.

        Raises:
            MissingExtra: mujoco is not installed.
            InputError: the world has no bodies, see :meth:`embody`.
        """

    @abstractmethod
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
        """Add bodies for sensors and cameras. A world that has bodies only starts the activities of people.

        Args:
            robots: robots by agent index.
            stage: wall height, props and lights.
            people: bodies of all agents that are not robots, then of riders.
            riders: agents of the robots that carry a rider.
            activity: activity of each person; empty: all walk.
            walls: walls without the outlines of props; None: the walls of the scene.
            seed: seed of the gaits.
        """

    @abstractmethod
    def change_bodies(self, robots: Mapping[int, Robot], stage: PhysicsStage, walls: Walls | None = None) -> None:
        """Replace robots, and in a world whose walls can change the stage; arguments as in :meth:`embody`."""

    @abstractmethod
    def pose_people(self) -> None:
        """Move the bodies of people to the current scene; to be called once after each step."""

    @abstractmethod
    def reconfigure(self, scene: Scene, sources: Sequence[PeopleSource], seed: int | None = None, **how: Any) -> None:
        """Change parameters of a running world; see :meth:`PlanarWorld.reconfigure`."""

    def add_robot(
        self,
        robot: Robot,
        x: float,
        y: float,
        heading: float = 0.0,
        *,
        ghost: bool = False,
        environments: Sequence[int] | None = None,
    ) -> int:
        """Add a robot between two steps, at rest, and return its agent, which is the same in all environments.

        From then on, :meth:`step` takes a command for it. In environments without the robot, its agent is absent.
        Nothing else changes: positions, velocities, poses, random numbers and contacts of everybody else are kept to
        the last bit. The new agent comes after all others.

        Args:
            robot: the robot.
            x, y, heading: place [m] and heading [rad].
            ghost: whether the robot is absent to everybody else.
            environments: environments that get the robot (default: all).

        Raises:
            InputError: a value is not finite, an environment does not exist, or the robot cannot drive in this world.

        >>> from crowdbot.models import ORCA
        >>> from crowdbot.world import PlanarWorld, Robot
        >>> world = PlanarWorld(Scene.of([[3.0, 0.0]]), ORCA(), {}, dt=0.1)
        >>> agent = world.add_robot(Robot.load("turtlebot2"), 0.0, 1.0)
        >>> world.step({agent: Twist(0.3)}).active.tolist()
        [[True, True]]
        >>> world.remove_robot(agent)
        >>> world.step({}).active.tolist()
        [[True, False]]
        """
        place = (x, y, heading)
        check_robot_place(robot, place)
        chosen, agent = self._chosen(environments), int(self.slots.max())
        self.place_robot(agent, robot, place, ghost, chosen)
        return agent

    @abstractmethod
    def place_robot(
        self, agent: int, robot: Robot, place: tuple[float, float, float], ghost: bool, environments: Sequence[int]
    ) -> None:
        """Make an agent a robot, present at x, y [m], heading [rad] in some environments; an error changes nothing."""

    @abstractmethod
    def remove_robot(self, agent: int, environments: Sequence[int] | None = None) -> None:
        """Remove a robot between two steps; its agent stays, absent, and commands for it have no effect.

        Args:
            agent: agent of the robot.
            environments: environments that lose the robot (default: all in which it is present).

        Raises:
            InputError: the agent is not a robot that is present in these environments.
        """

    def _chosen(self, environments: Sequence[int] | None) -> list[int]:
        """Return some environments, None: all.

        Raises:
            InputError: an environment does not exist or is given twice.
        """
        count = len(self.slots)
        chosen = list(range(count)) if environments is None else [int(e) for e in environments]
        if len(set(chosen)) != len(chosen) or not all(0 <= e < count for e in chosen):
            raise InputError(f"environments = {chosen}: give each environment once, from 0 to {count - 1}")
        return chosen

    def _environments_with(self, agent: int, environments: Sequence[int] | None) -> list[int]:
        """Return the environments in which a robot is to be removed, None: all in which it is present.

        Raises:
            InputError: an environment does not exist, or the robot is not present in it.
        """
        active, robots = self.scene.active, sorted(self.twists)
        if environments is None and agent in robots:
            environments = np.flatnonzero(active[:, agent]).tolist()
        chosen = self._chosen(environments)
        if agent not in robots or not chosen or not active[chosen, agent].all():
            present = [robot for robot in robots if active[chosen or slice(None), robot].all()]
            raise InputError(f"agent {agent} is not a robot that is present; present are {present or 'none'}")
        return chosen

    @abstractmethod
    def move_joint(self, robot: int, joint: str, position: float, environment: int = 0) -> None:
        """Give a joint of a robot a target position, which is kept until it is replaced.

        In the physics world, the position motor of the joint moves it; a joint without one moves there at its maximum
        speed and is held. In the plane, the bodies of the robot for sensors and cameras are in the new posture at once;
        without bodies, nothing changes.

        Args:
            robot: agent of the robot.
            joint: name of the joint; :func:`check_joint` has passed.
            position: target [rad or m].
            environment: index of the environment.
        """

    @property
    @abstractmethod
    def prop_names(self) -> list[str]:
        """Names of the props by number; that of a removed one is empty."""

    @abstractmethod
    def add_prop(self, prop: PropBody, name: str = "") -> str:
        """Add a prop between two steps to the stage of all environments, and return its name.

        People avoid its outline. Routes of a router do not: give a new router with :meth:`reconfigure`.

        Args:
            prop: the prop.
            name: name of the prop (default: ``prop`` and its number on the stage).

        Raises:
            InputError: another prop has this name.

        >>> from crowdbot.models import ORCA
        >>> from crowdbot.world import Cube, PlanarWorld
        >>> world = PlanarWorld(Scene.of([[3.0, 0.0]]), ORCA(), {}, dt=0.1)
        >>> name = world.add_prop(Cube(1.0, 1.0, fixed=True), "box")
        >>> len(world.scene.walls)
        4
        >>> world.remove_prop("box")
        >>> len(world.scene.walls)
        0
        """

    @abstractmethod
    def remove_prop(self, name: str) -> None:
        """Remove a prop between two steps; the props of the constructor are ``prop0``, ``prop1`` and so on.

        Raises:
            InputError: there is no prop of this name.
        """


def check_robot_place(robot: Robot, place: tuple[float, float, float]) -> None:
    """Raise :class:`InputError` if a robot cannot be added at x, y [m], heading [rad]."""
    x, y, heading = place
    if not isinstance(robot, Robot):
        raise InputError(f"robot is a {type(robot).__name__}; give a Robot such as Robot.load('turtlebot2')")
    if not (math.isfinite(x) and math.isfinite(y) and max(abs(x), abs(y)) <= FARTHEST and math.isfinite(heading)):
        raise InputError(
            f"the place x = {x}, y = {y} m, heading = {heading} rad of a robot must be finite and at most"
            f" {FARTHEST:g} m away from 0"
        )

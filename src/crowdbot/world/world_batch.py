"""WorldBatch: worlds of one environment each as the environments of one world."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Clock, InputError, MissingExtra, Pose, Scene, SpatialPose, Storage, Twist, Walls, tree
from crowdbot.world.crowd.environment_rows import pad_ids, resize_scene, stack_scenes
from crowdbot.world.environment_time import EnvironmentTime
from crowdbot.world.planar_live_changes import (
    check_robot_place,
    chosen_environments,
    live_prop_names,
    match_robots,
    new_prop_name,
    robot_environments,
)
from crowdbot.world.robots.drives.drive import Twists
from crowdbot.world.robots.mount import MountPlacement
from crowdbot.world.world import Contact, World

if TYPE_CHECKING:
    from crowdbot.humans import FallPose
    from crowdbot.world.crowd.source import PeopleSource
    from crowdbot.world.rendering.renderer import Renderer
    from crowdbot.world.robots.robot import Robot

    from .physics.balance.fall import Fall
    from .physics.contact_events import BodyContactEvent, ContactForce
    from .physics.stage import PhysicsStage, PropBody

__all__ = ["WorldBatch", "worlds_of"]

T = TypeVar("T")
Ints = NDArray[np.int64]


class WorldBatch(World):
    """Environments with worlds of their own, of the same trial, on a common clock.

    Args:
        worlds: the worlds; they must not be used any more.
        clock: the common clock; None: that of the first world.
    """

    storage = Storage(constants=("dt", "_stacked"))

    def __init__(self, worlds: Sequence[Any], clock: Clock | None = None) -> None:
        first = worlds[0]
        self.worlds, self.dt = list(worlds), first.dt
        times = [world.environment_time for world in worlds]
        self.environment_time = times[0].join(times[1:])
        if clock is not None:
            self.environment_time = EnvironmentTime(
                clock, clock.tick - self.environment_time.ticks, self.environment_time.begin
            )
        for world in self.worlds:
            world.environment_time = world.environment_time.select([0])
        self._stacked: tuple[list[Scene], Scene] | None = None

    @property
    def scene(self) -> Scene:
        """Scenes of all environments; setting it changes each of them."""
        scenes = [world.scene for world in self.worlds]
        if self._stacked is None or any(one is not two for one, two in zip(self._stacked[0], scenes, strict=True)):
            self._stacked = (scenes, stack_scenes(scenes))
        return self._stacked[1]

    @scene.setter
    def scene(self, scene: Scene) -> None:
        """Change the scene of each environment."""
        for e, world in enumerate(self.worlds):
            one = resize_scene(scene.environments([e]), world.scene.shape[1])
            world.scene = one.replace(walls=world.scene.walls, time=world.scene.time)

    @property
    def ids(self) -> Ints:  # type: ignore[override]
        """Identities ``[E, A]``; further slots of shorter environments have unique negative ones."""
        agents = int(self.slots.max())
        return np.concatenate([pad_ids(world.ids, agents) for world in self.worlds])

    @property
    def slots(self) -> Ints:  # type: ignore[override]
        """Number of agents of each environment, ``[E]``."""
        return np.array([world.scene.shape[1] for world in self.worlds], dtype=np.int64)

    @property
    def twists(self) -> dict[int, Twists]:  # type: ignore[override]
        """Current twist of each robot."""
        return {robot: tree.join([world.twists[robot] for world in self.worlds]) for robot in self.worlds[0].twists}

    @property
    def contacts(self) -> tuple[Contact, ...]:  # type: ignore[override]
        """Contacts between robots and other agents in the last step."""
        return tuple(one._replace(environment=e) for e, world in enumerate(self.worlds) for one in world.contacts)

    @property
    def waiting_count(self) -> Ints:
        """Number of people waiting to enter, ``[E]``."""
        return np.concatenate([world.waiting_count for world in self.worlds])

    @property
    def has_own_walls(self) -> bool:
        """Whether each environment has walls of its own; see :class:`World`."""
        return True

    def step(self, commands: Mapping[int, Twist | Twists]) -> Scene:
        """Advance by one time step; see :class:`World`."""
        errors = self.try_step(commands)
        for error in errors.values():
            raise error
        return self.scene

    def try_step(self, commands: Mapping[int, Twist | Twists]) -> dict[int, Exception]:
        """Advance by one time step and return the exceptions by environment, which lose their agents."""
        wide = {robot: Twists.of(command, len(self.worlds)) for robot, command in commands.items()}
        self.clock.advance()

        def advance(e: int) -> Exception | None:
            index = np.array([e])
            try:
                self.worlds[e].step({robot: tree.take(one, index) for robot, one in wide.items()})
            except Exception as error:  # told to the caller
                return error
            return None

        found = self._each(advance)
        errors = {e: error for e, error in enumerate(found) if error is not None}
        for error in errors.values():
            if isinstance(error, MissingExtra):
                raise error
        for e in errors:
            scene = self.worlds[e].scene
            self.worlds[e].scene = scene.replace(active=np.zeros_like(scene.active))
        return errors

    def _each(self, work: Callable[[int], T]) -> list[T]:
        """Return the results of a function for each environment."""
        return [work(e) for e in range(len(self.worlds))]

    @abstractmethod
    def select(self, environments: Sequence[int] | Ints) -> World:
        """Return an independent world with some environments."""

    def put(self, environments: Sequence[int] | Ints, other: World) -> None:
        """Replace some environments by those of another world, which must not be used any more."""
        for world in worlds_of(other):
            match_robots(self.worlds[0], world)
        for one in self.worlds:
            match_robots(one, worlds_of(other)[0])
        for k, (e, world) in enumerate(zip(environments, worlds_of(other), strict=True)):
            self.environment_time.put([e], other.environment_time.select([k]))
            self.worlds[int(e)] = world
            world.environment_time = world.environment_time.select([0])

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
        """Add a robot, at rest on the floor; see :class:`World`."""
        check_robot_place(robot, x, y, heading)
        chosen, agent = chosen_environments(len(self.worlds), environments), int(self.slots.max())
        for e in sorted(range(len(self.worlds)), key=lambda e: e not in chosen):  # an error changes nothing
            self.worlds[e].place_robot(agent, robot, (x, y, heading), ghost, e in chosen)
        return agent

    def remove_robot(self, agent: int, environments: Sequence[int] | None = None) -> None:
        """Remove a robot and its body; see :class:`World`."""
        for e in robot_environments(self, agent, environments):
            self.worlds[e].remove_robot(agent)

    def add_prop(self, prop: PropBody, name: str = "") -> str:
        """Add a prop in all environments; see :class:`World`."""
        name = name or new_prop_name(max(map(live_prop_names, self.worlds), key=len), "")
        for world in self.worlds:
            new_prop_name(live_prop_names(world), name)
        for world in self.worlds:
            world.add_prop(prop, name)
        return name

    def remove_prop(self, name: str) -> None:
        """Remove a prop in all environments that have it; see :class:`World`."""
        holders = [world for world in self.worlds if name in live_prop_names(world)]
        for world in holders or self.worlds:
            world.remove_prop(name)

    def pose(self, robot: int) -> Pose:
        """Return the pose of a robot in every environment."""
        poses: list[Pose] = [world.pose(robot) for world in self.worlds]
        return tree.join(poses)

    def sensor_pose(self, robot: int, mount: MountPlacement, spatial: bool) -> Pose | SpatialPose:
        """Return the pose of a sensor in every environment; see :class:`World`."""
        poses: list[Pose | SpatialPose] = [world.sensor_pose(robot, mount, spatial) for world in self.worlds]
        return tree.join(poses)

    def wall_clearance(self, robot: int) -> NDArray[np.float64]:
        """Return the clearance to fixed objects ``[E]`` [m]; see :class:`World`."""
        return np.concatenate([world.wall_clearance(robot) for world in self.worlds])

    def plane_scene(self, environment: int | None = None) -> Scene:
        """Return the scene of one environment in the plane; see :class:`World`."""
        if environment is None:
            raise InputError("the outlines of props differ between environments: ask for one of them")
        found: Scene = self.worlds[environment].plane_scene()
        return found

    def body_scene(self, skins: int | None = None, environment: int = 0, avatars: bool = False) -> Scene:
        """Return the scene of one environment with bodies; see :class:`World`."""
        found: Scene = self.worlds[environment].body_scene(skins, avatars=avatars)
        return found

    def environment_scene(self, environment: int) -> Scene:
        """Return the scene of one environment."""
        found: Scene = self.worlds[environment].scene
        return found

    def environment_renderer(self, environment: int) -> Renderer:
        """Return the renderer of one environment."""
        found: Renderer = self.worlds[environment].environment_renderer(0)
        return found

    @property
    def renderer(self) -> Renderer:
        """Renderer of the first environment."""
        found: Renderer = self.worlds[0].renderer
        return found

    def forces_of(self, environment: int) -> tuple[ContactForce, ...]:
        """Return the contact forces of the last step in one environment."""
        found: tuple[ContactForce, ...] = self.worlds[environment].forces
        return found

    def contact_events_of(self, environment: int) -> tuple[BodyContactEvent, ...]:
        """Return the contact events of one environment so far."""
        found: tuple[BodyContactEvent, ...] = self.worlds[environment].contact_events
        return found

    def falls_of(self, environment: int) -> tuple[Fall, ...]:
        """Return the falls of people in one environment so far."""
        found: tuple[Fall, ...] = self.worlds[environment].falls
        return found

    def fall_poses_of(self, environment: int) -> Mapping[int, FallPose]:
        """Return the poses of people out of balance in one environment, by agent."""
        found: Mapping[int, FallPose] = self.worlds[environment].fall_poses_of(0)
        return found

    def change_bodies(self, robots: Mapping[int, Robot], stage: PhysicsStage, walls: Walls | None = None) -> None:
        """Replace robots and stage in all environments; see :class:`World`."""
        for world in self.worlds:
            world.change_bodies(robots, stage, walls)

    def reconfigure(self, scene: Scene, sources: Sequence[PeopleSource], seed: Any = None, **how: Any) -> None:
        """Change parameters of all environments; see :meth:`PlanarWorld.reconfigure`."""
        for e, world in enumerate(self.worlds):
            one = resize_scene(scene.environments([e]), world.scene.shape[1]).replace(walls=world.scene.walls)
            own = None if seed is None else (seed + e if isinstance(seed, int) else seed[e])
            world.reconfigure(one, sources, own, **how)


def worlds_of(world: World) -> list[Any]:
    """Return the worlds of a batch, or the only one.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.world import PlanarWorld
    >>> len(worlds_of(PlanarWorld(Scene.of([[0.0, 0.0], [2.0, 0.0]]), ORCA(), {}, dt=0.1)))
    1
    """
    return world.worlds if isinstance(world, WorldBatch) else [world]

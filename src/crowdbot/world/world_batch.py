"""Environments of worlds of either kind: join worlds, select environments, replace some, and step all that can."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Clock, InputError, MissingExtra, Pose, Scene, SpatialPose, Storage, Twist, Walls, tree
from crowdbot.typing import Ints
from crowdbot.world.crowd.environment_rows import pad_ids, resize_scene, stack_scenes
from crowdbot.world.planar import PlanarWorld
from crowdbot.world.robots.drives.drive import Twists
from crowdbot.world.robots.mount import MountPlacement
from crowdbot.world.world import Contact, World

if TYPE_CHECKING:
    from crowdbot.humans import People
    from crowdbot.world.crowd.source import PeopleSource
    from crowdbot.world.rendering.renderer import Renderer
    from crowdbot.world.robots.robot import Robot

    from .physics.stage import PhysicsStage, PropBody

T = TypeVar("T")


class WorldBatch(World):
    """Environments with rigid bodies or with doors, whose leaves are walls: worlds of their own on a common clock.

    Args:
        worlds: worlds of one trial; they must not be used any more.
        clock: the common clock; None: that of the first world.

    Raises:
        InputError: the walls of worlds with rigid bodies differ.
    """

    storage = Storage(constants=("dt", "_stacked"))

    def __init__(self, worlds: Sequence[PlanarWorld], clock: Clock | None = None) -> None:
        first = worlds[0]
        for world in worlds[1:] if first.walls_fixed else ():
            if not np.array_equal(world.scene.walls.segments(), first.scene.walls.segments()):
                raise InputError("environments of the physics world need the same stage; run variants of it one by one")
        self.worlds: list[PlanarWorld] = list(worlds)
        self.dt = first.dt
        times = [world.environment_time for world in worlds]
        for time in times:
            time.follow(clock or first.clock)
        self.environment_time = tree.take(tree.join(times), slice(None))
        for time in times:
            time.follow()
        self._stacked: tuple[list[Scene], Scene] | None = None

    @property
    def people_shape(self) -> str:  # type: ignore[override]
        """Shape of people for sensors."""
        return self.worlds[0].people_shape

    @property
    def walls_fixed(self) -> bool:  # type: ignore[override]
        """Whether the walls cannot change."""
        return self.worlds[0].walls_fixed

    @property
    def scene(self) -> Scene:
        """Scenes of all environments; setting it changes each of them."""
        scenes = [world.scene for world in self.worlds]
        if self._stacked is None or any(item is not two for item, two in zip(self._stacked[0], scenes, strict=True)):
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
        return tuple(
            contact._replace(environment=e) for e, world in enumerate(self.worlds) for contact in world.contacts
        )

    @property
    def waiting_count(self) -> Ints:
        return np.concatenate([world.waiting_count for world in self.worlds])

    @property
    def has_own_walls(self) -> bool:
        return True

    def step(self, commands: Mapping[int, Twist | Twists]) -> Scene:
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
                self.worlds[e].step({robot: tree.take(item, index) for robot, item in wide.items()})
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
        count = len(self.worlds)
        if not self.walls_fixed:
            return [work(e) for e in range(count)]
        with ThreadPoolExecutor(min(count, os.cpu_count() or 1)) as pool:
            return list(pool.map(work, range(count)))

    def put(self, environments: Sequence[int] | Ints, other: World) -> None:
        """Replace some environments by those of another world, which must not be used any more."""
        for world in worlds_of(other):
            self.worlds[0].match_robots(world)
        for item in self.worlds:
            item.match_robots(worlds_of(other)[0])
        other.environment_time.follow(self.clock)
        self.environment_time = tree.put(self.environment_time, np.asarray(environments), other.environment_time)
        for e, world in zip(environments, worlds_of(other), strict=True):
            self.worlds[int(e)] = world
            world.environment_time.follow()

    def place_robot(
        self, agent: int, robot: Robot, place: tuple[float, float, float], ghost: bool, environments: Sequence[int]
    ) -> None:
        for e in sorted(range(len(self.worlds)), key=lambda e: e not in environments):  # an error changes nothing
            self.worlds[e].place_robot(agent, robot, place, ghost, [0] if e in environments else [])

    def remove_robot(self, agent: int, environments: Sequence[int] | None = None) -> None:
        for e in self._environments_with(agent, environments):
            self.worlds[e].remove_robot(agent)

    def move_joint(self, robot: int, joint: str, position: float, environment: int = 0) -> None:
        self.worlds[environment].move_joint(robot, joint, position)

    @property
    def prop_names(self) -> list[str]:
        return max((world.prop_names for world in self.worlds), key=len)

    def add_prop(self, prop: PropBody, name: str = "") -> str:
        from .physics.stage import new_prop_name

        name = name or new_prop_name(self.prop_names, "")
        for world in self.worlds:
            new_prop_name(world.prop_names, name)
        for world in self.worlds:
            world.add_prop(prop, name)
        return name

    def remove_prop(self, name: str) -> None:
        holders = [world for world in self.worlds if name in world.prop_names]
        for world in holders or self.worlds:
            world.remove_prop(name)

    def pose(self, robot: int) -> Pose:
        poses: list[Pose] = [world.pose(robot) for world in self.worlds]
        return tree.join(poses)

    def sensor_pose(self, robot: int, mount: MountPlacement, spatial: bool) -> Pose | SpatialPose:
        poses: list[Pose | SpatialPose] = [world.sensor_pose(robot, mount, spatial) for world in self.worlds]
        return tree.join(poses)

    def wall_clearance(self, robot: int) -> NDArray[np.float64]:
        return np.concatenate([world.wall_clearance(robot) for world in self.worlds])

    def plane_scene(self, environment: int | None = None) -> Scene:
        if environment is None:
            raise InputError("the outlines of props differ between environments: ask for one of them")
        return self.worlds[environment].plane_scene()

    def body_scene(self, skins: int | None = None, environment: int = 0, avatars: bool = False) -> Scene:
        return self.worlds[environment].body_scene(skins, avatars=avatars)

    def environment_scene(self, environment: int) -> Scene:
        return self.worlds[environment].scene

    def environment_renderer(self, environment: int) -> Renderer:
        return self.worlds[environment].environment_renderer(0)

    @property
    def renderer(self) -> Renderer:
        return self.worlds[0].renderer

    def part(self, environment: int) -> tuple[PlanarWorld, int]:
        return self.worlds[environment], 0

    def change_bodies(self, robots: Mapping[int, Robot], stage: PhysicsStage, walls: Walls | None = None) -> None:
        for world in self.worlds:
            world.change_bodies(robots, stage, walls)

    def reconfigure(self, scene: Scene, sources: Sequence[PeopleSource], seed: Any = None, **how: Any) -> None:
        for e, world in enumerate(self.worlds):
            one = resize_scene(scene.environments([e]), world.scene.shape[1]).replace(walls=world.scene.walls)
            own = None if seed is None else (seed + e if isinstance(seed, int) else seed[e])
            world.reconfigure(one, sources, own, **how)

    def embody(self, robots: Mapping[int, Robot], stage: PhysicsStage, people: People, **options: Any) -> None:
        # refuse bodies in the plane, as they are added to one environment at a time; other worlds have bodies
        if not self.walls_fixed:
            raise InputError(f"bodies are added to one environment at a time; this world has {len(self.worlds)}")

    def pose_people(self) -> None:
        for world in self.worlds:
            world.pose_people()


def worlds_of(world: World) -> list[Any]:
    """Return the worlds of a batch, or the only one.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.world import PlanarWorld
    >>> len(worlds_of(PlanarWorld(Scene.of([[0.0, 0.0], [2.0, 0.0]]), ORCA(), {}, dt=0.1)))
    1
    """
    return world.worlds if isinstance(world, WorldBatch) else [world]


def join_worlds(worlds: Sequence[World]) -> World:
    """Return one world with the environments of several worlds of the same trial, on the clock of the first.

    The worlds must not be used any more.

    >>> from crowdbot.core import Scene
    >>> from crowdbot.models import ORCA
    >>> from crowdbot.world import PlanarWorld
    >>> parts = [PlanarWorld(Scene.of([[float(k), 0.0]]), ORCA(), {}, dt=0.1, seed=k) for k in range(3)]
    >>> join_worlds(parts).step({}).position[:, 0].tolist()
    [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]
    """
    if len(worlds) == 1:
        return worlds[0]
    if worlds[0].has_own_walls:
        return WorldBatch([item for world in worlds for item in worlds_of(world)], worlds[0].clock)
    parts: Any = worlds
    return PlanarWorld.join(parts)


def select_environments(world: World, environments: Sequence[int] | Ints) -> World:
    """Return an independent world with some environments, which may be repeated, on a free clock."""
    if isinstance(world, PlanarWorld) and not world.has_own_walls:
        return world.select(environments)
    worlds = [worlds_of(world)[int(e)] for e in environments]
    return join_worlds([world.copy() if world.walls_fixed else world.select([0]) for world in worlds])


def put_environments(world: World, environments: Sequence[int] | Ints, other: World) -> World:
    """Return the world with some environments replaced by those of another, which must not be used any more."""
    if not isinstance(world, WorldBatch) and world.walls_fixed:
        other.environment_time.follow(world.clock)
        return other
    some: Any = world
    some.put(environments, other)
    return world


def step_environments(world: World, commands: Mapping[int, Twist | Twists]) -> tuple[World, dict[int, Exception]]:
    """Advance all environments by one step; return the world, and the exceptions of environments that could not.

    An environment with an exception keeps its state, and loses its agents if there are others.

    Raises:
        MissingExtra: a package is not installed.
    """
    if isinstance(world, WorldBatch):
        return world, world.try_step(commands)
    planar: Any = world
    undo = planar.undo_point() if len(world.slots) > 1 else None
    try:
        world.step(commands)
    except MissingExtra:
        raise
    except Exception as error:  # crowd models may raise anything
        if undo is None:
            return world, {0: error}
        undo()
        return planar.step_one_by_one(commands)  # type: ignore[no-any-return]
    return world, {}

"""Environments of worlds of either kind: join worlds, select environments, replace some, and step all that can."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Clock, InputError, MissingExtra, Twist
from crowdbot.world.robots.drives.drive import Twists

from . import planar_environments as planar
from .environment_time import EnvironmentTime
from .planar import PlanarWorld
from .planar_live_changes import match_robots
from .world import World
from .world_batch import WorldBatch, worlds_of

if TYPE_CHECKING:
    from crowdbot.humans import People

    from .physics.stage import PhysicsStage
    from .physics.world import PhysicsWorld
    from .robots.robot import Robot


__all__ = ["join_worlds", "put_environments", "select_environments", "step_environments"]

Ints = NDArray[np.int64]
T = TypeVar("T")


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
    if worlds[0].walls_fixed:
        return PhysicsBatch([one for world in worlds for one in worlds_of(world)], worlds[0].clock)
    if worlds[0].has_own_walls:
        return PlanarBatch([one for world in worlds for one in worlds_of(world)], worlds[0].clock)
    parts: Any = worlds
    return planar.join_worlds(parts)


def select_environments(world: World, environments: Sequence[int] | Ints) -> World:
    """Return an independent world with some environments, which may be repeated, on a free clock."""
    anything: Any = world
    if not world.has_own_walls:
        return planar.select_environments(anything, environments)
    if isinstance(world, WorldBatch):
        return world.select(environments)
    copies = [anything.copy() if world.walls_fixed else copy_planar(anything) for _ in environments]
    return join_worlds(copies)


def put_environments(world: World, environments: Sequence[int] | Ints, other: World) -> World:
    """Return the world with some environments replaced by those of another, which must not be used any more."""
    anything: Any = world
    if isinstance(world, WorldBatch):
        world.put(environments, other)
    elif not world.walls_fixed:
        new: Any = other
        match_robots(world, other)
        planar.put_environments(anything, environments, new)
    else:
        clock = world.clock
        other.environment_time = EnvironmentTime(clock, clock.tick - other.ticks, other.environment_time.begin)
        return other
    return world


def step_environments(world: World, commands: Mapping[int, Twist | Twists]) -> tuple[World, dict[int, Exception]]:
    """Advance all environments by one step; return the world, and the exceptions of environments that could not.

    An environment with an exception keeps its state, and loses its agents if there are others.

    Raises:
        MissingExtra: a package is not installed.
    """
    anything: Any = world
    if isinstance(world, WorldBatch):
        return world, world.try_step(commands)
    undo = planar.undo_point(anything) if len(world.slots) > 1 else None
    try:
        world.step(commands)
    except MissingExtra:
        raise
    except Exception as error:  # crowd models may raise anything
        if undo is None:
            return world, {0: error}
        undo()
        return planar.step_one_by_one(anything, commands)
    return world, {}


class PhysicsBatch(WorldBatch):
    """Environments with rigid bodies: one :class:`PhysicsWorld` each, on a common clock.

    Args:
        worlds: worlds of one trial with the same walls; they must not be used any more.
        clock: the common clock; None: that of the first world.

    Raises:
        InputError: the walls differ.
    """

    people_shape = "limbs"
    walls_fixed = True

    def __init__(self, worlds: Sequence[PhysicsWorld], clock: Clock | None = None) -> None:
        for world in worlds[1:]:
            if not np.array_equal(world.scene.walls.segments(), worlds[0].scene.walls.segments()):
                raise InputError("environments of the physics world need the same stage; run variants of it one by one")
        super().__init__(worlds, clock)

    def _each(self, work: Callable[[int], T]) -> list[T]:
        count = len(self.worlds)
        with ThreadPoolExecutor(min(count, os.cpu_count() or 1)) as pool:
            return list(pool.map(work, range(count)))

    def select(self, environments: Sequence[int] | Ints) -> PhysicsWorld | PhysicsBatch:
        """Return an independent world with some environments."""
        worlds: list[PhysicsWorld] = [self.worlds[int(e)].copy() for e in environments]
        return worlds[0] if len(worlds) == 1 else PhysicsBatch(worlds)

    def embody(self, robots: Mapping[int, Robot], stage: PhysicsStage, people: People, **options: Any) -> None:
        """Do nothing: the worlds have bodies."""

    def pose_people(self) -> None:
        """Do nothing: a step moves the bodies of people."""


class PlanarBatch(WorldBatch):
    """Environments of the plane with doors: one :class:`PlanarWorld` each, since leaves are walls.

    An environment is the same as its world alone, to the last bit.
    """

    people_shape = PlanarWorld.people_shape
    walls_fixed = False

    def select(self, environments: Sequence[int] | Ints) -> PlanarWorld | PlanarBatch:
        """Return an independent world with some environments."""
        worlds = [copy_planar(self.worlds[int(e)]) for e in environments]
        return worlds[0] if len(worlds) == 1 else PlanarBatch(worlds)

    def embody(self, robots: Mapping[int, Robot], stage: PhysicsStage, people: People, **options: Any) -> None:
        """Refuse bodies, as they are added to one environment at a time."""
        raise InputError(f"bodies are added to one environment at a time; this world has {len(self.worlds)}")

    def pose_people(self) -> None:
        """Move the bodies of people to the current scene; see :class:`World`."""
        for world in self.worlds:
            world.pose_people()


def copy_planar(world: PlanarWorld) -> PlanarWorld:
    """Return an independent planar world with one environment in the same state."""
    return planar.select_environments(world, [0])

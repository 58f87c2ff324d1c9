"""PhysicsBatch: several physics worlds of one trial as the environments of one world, stepped in threads."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Clock, InputError
from crowdbot.world.world_batch import WorldBatch

if TYPE_CHECKING:
    from crowdbot.humans import People
    from crowdbot.world.robots.robot import Robot

    from .stage import PhysicsStage
    from .world import PhysicsWorld

__all__ = ["PhysicsBatch"]

T = TypeVar("T")
Ints = NDArray[np.int64]


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

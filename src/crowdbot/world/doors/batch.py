"""PlanarBatch: planar worlds with doors as the environments of one world; each has walls of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.world.planar import PlanarWorld
from crowdbot.world.planar_environments import select_environments
from crowdbot.world.world_batch import WorldBatch

if TYPE_CHECKING:
    from crowdbot.humans import People
    from crowdbot.world.physics.stage import PhysicsStage
    from crowdbot.world.robots.robot import Robot

__all__ = ["PlanarBatch", "copy_planar"]

Ints = NDArray[np.int64]


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
    return select_environments(world, [0])

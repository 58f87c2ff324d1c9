"""Bodies of people and robots at the poses of a planar scene, for sensors and cameras."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from crowdbot.core import Scene, Storage, Walls
from crowdbot.humans import People
from crowdbot.typing import Ints
from crowdbot.world.rendering.renderer import Renderer
from crowdbot.world.robots.robot import Robot

from .colliders import scene_bodies
from .people_motion import PeopleMotion
from .stage import PhysicsStage

if TYPE_CHECKING:
    from crowdbot.world.doors.doors import Doors


class KinematicBodies:
    """Bodies that follow a planar scene; contacts do not move them.

    Args:
        scene: initial scene, E = 1.
        robots: robots by agent index.
        stage: wall height, props and lights.
        people: bodies of all agents that are not robots, then of riders.
        riders: agents of the robots that carry a rider.
        walls: walls without the outlines of props; None: the walls of the scene.
        seed: seed of the gaits.

    Attributes:
        people: bodies of people.
        doors: doors of the world, whose leaves the bodies show.
        joints: joint positions of robots that differ from their posture [rad or m], by agent and name.
    """

    storage = Storage(constants=("robots", "stage", "walls", "_renderer", "doors"))

    def __init__(
        self,
        scene: Scene,
        robots: Mapping[int, Robot],
        stage: PhysicsStage,
        people: People,
        *,
        riders: Sequence[int] = (),
        walls: Walls | None = None,
        seed: int = 0,
    ) -> None:
        self.robots, self.stage, self.walls = dict(robots), stage, walls
        agents = np.array([a for a in range(scene.shape[1]) if a not in self.robots], dtype=np.int64)
        self.people = PeopleMotion(scene, agents, people, seed, riders)
        self._renderer: Renderer | None = None
        self.doors: Doors | None = None
        self.joints: Mapping[int, Mapping[str, float]] = {}

    def copy(self) -> KinematicBodies:
        """Return independent bodies in the same state."""
        other = copy.copy(self)
        other.people = copy.copy(self.people)  # its states are replaced, not changed
        other._renderer = None
        return other

    def forget_renderer(self) -> None:
        """Make the next image with a new renderer, since robots, people or props were added or removed."""
        self._renderer = None

    def scene(self, scene: Scene, skins: int | None, only: Ints | None = None) -> Scene:
        """Return the scene with bodies and wall height, see :meth:`crowdbot.world.World.body_scene`."""
        doors = self._shares()
        found = scene_bodies(
            scene, self.people, self.robots, self.stage, joints=self.joints, doors=doors, skins=skins, only=only
        )
        return scene.replace(bodies=found, walls=self._walls(scene), wall_height=self.stage.wall_height)

    def renderer(self, scene: Scene) -> Renderer:
        """Return the renderer for a scene."""
        now = scene.replace(walls=self._walls(scene))
        if self._renderer is None:
            self._renderer = Renderer(now, self.robots, self.stage, self.people)
        self._renderer.show(now, self.joints, self._shares())
        return self._renderer

    def _shares(self) -> list[float] | None:
        return None if self.doors is None else self.doors.signed_share.tolist()

    def _walls(self, scene: Scene) -> Walls:
        return scene.walls if self.walls is None else self.walls

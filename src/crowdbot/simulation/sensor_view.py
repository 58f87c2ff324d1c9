"""Surroundings: what sensors and cameras see of a simulation, in either world."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Pose, Scene, SpatialPose, Walls
from crowdbot.world import PlanarWorld

if TYPE_CHECKING:
    from crowdbot.trials import Figures, Trial
    from crowdbot.world import Chassis, PhysicsWorld, Studio, Walkers

__all__ = ["Surroundings"]

SKIN = 1
"""Level of detail of the skins that rays meet."""


class Surroundings:
    """A world as sensors see it: from above as discs, or in space with bodies, or drawn.

    Args:
        trial: with stage and robots.
        world: of either kind.
        figures: bodies and activities of people; None when nothing looks through space.
        seed: of the ways that people walk.
        skins: whether rays meet the skins of people.
    """

    def __init__(self, trial: Trial, world: PlanarWorld, figures: Figures | None, seed: int, skins: bool) -> None:
        self.trial, self.world, self._skins = trial, world, SKIN if skins else None
        self._first = trial.people
        self._physics: PhysicsWorld | None = None
        self._walkers: Walkers | None = None
        self._studio: Studio | None = None
        self._flat: tuple[Scene, Scene] | None = None
        self._space: tuple[Scene, Scene] | None = None
        if trial.world == "physics":
            physical: Any = world
            self._physics, self._walkers = physical, physical.walkers
        elif figures is not None:
            from crowdbot.world import Walkers

            robots = set(self.bodies)
            people = np.array([a for a in range(world.scene.shape[1]) if a not in robots], dtype=np.int64)
            self._walkers = Walkers(world.scene, people, figures.people, seed, figures.riders)
        if figures is not None and self._walkers is not None and set(figures.activity) - {"walk"}:
            self._walkers.begin(world.scene, figures.activity)
        self._props = [k for k, prop in enumerate(trial.stage.props) if prop.prop().movable]

    @property
    def bodies(self) -> dict[int, Any]:
        """The robots by agent."""
        return {self._first + k: robot.body for k, robot in enumerate(self.trial.robots)}

    def moved(self) -> None:
        """Let people walk on to where they are after a step; the physics world does it by itself."""
        if self._physics is None and self._walkers is not None:
            self._walkers.walk(self.world.scene, self.world.dt)

    def pose(self, agent: int) -> Pose:
        """Return where a robot is."""
        return self.world.pose(agent)

    def chassis(self, agent: int) -> Chassis | None:
        """Return the body of a robot in the physics world."""
        return None if self._physics is None else self._physics.chassis[agent]

    @property
    def flat(self) -> Scene:
        """The scene from above, with props among the walls."""
        now = self.world.scene
        if self._physics is None:
            return now
        if self._flat is None or self._flat[0] is not now:
            self._flat = (now, now.replace(walls=self._outlined()))
        return self._flat[1]

    @property
    def space(self) -> Scene:
        """The scene with bodies of people, robots and props."""
        now = self.world.scene
        if self._space is None or self._space[0] is not now:
            self._space = (now, self._posed(now))
        return self._space[1]

    def render(self, camera: Any, pose: SpatialPose) -> Mapping[str, NDArray[Any]]:
        """Return images of a camera now, as the renderer of a :class:`crowdbot.sensors.SensorView`.

        Raises:
            MissingExtra: mujoco is not installed.
        """
        return self.studio.render(camera, pose)

    @property
    def studio(self) -> Studio:
        """Who draws it, as it is now.

        Raises:
            MissingExtra: mujoco is not installed.
        """
        if self._physics is not None:
            return self._physics.studio
        from crowdbot.world import Studio

        scene = self.world.scene.replace(walls=self.trial.stage.as_walls(props=False))
        if self._studio is None:
            self._studio = Studio(scene, self.bodies, self.trial.stage.physical(), self._walkers)
        self._studio.show(scene)
        return self._studio

    def _posed(self, now: Scene) -> Scene:
        if self._physics is not None:
            return self._physics.seen(self._skins)
        from crowdbot.world import bodies

        stage = self.trial.stage
        walls = stage.as_walls(props=False) if stage.props else now.walls
        found = bodies(now, self._walkers, self.bodies, stage.physical(), skins=self._skins)
        return now.replace(bodies=found, walls=walls, wall_height=stage.wall_height)

    def _outlined(self) -> Walls:
        """Return the walls and the outlines of props where they are."""
        stage = self.trial.stage
        if not self._props:
            return stage.as_walls()
        assert self._physics is not None
        rings = list(stage.rings)
        first = len(rings) - len(stage.props)
        for k in self._props:
            matrix, prop = self._physics.prop(k), stage.props[k]
            half = 0.5 * float(getattr(prop, "size", 1.0))
            corners = half * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
            turn = np.arctan2(matrix[1, 0], matrix[0, 0])
            cos, sin = np.cos(turn), np.sin(turn)
            rings[first + k] = corners @ np.array([[cos, sin], [-sin, cos]]) + matrix[:2, 3]
        return Walls.of(rings)

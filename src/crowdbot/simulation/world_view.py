"""WorldView: the world of a simulation as seen by sensors and cameras."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from crowdbot.core import Scene, SpatialPose, Walls
from crowdbot.world import World

if TYPE_CHECKING:
    from crowdbot.trials import PeopleAppearance, Trial
    from crowdbot.world import Renderer

__all__ = ["WorldView"]

SKIN = 1
"""Level of detail of skins for ray casting."""


class WorldView:
    """A world for sensors: as discs in the plane, as bodies in space, or rendered.

    Args:
        trial: trial with stage and robots.
        world: planar or physics world.
        figures: bodies and activities of people; None if no sensor needs bodies.
        seed: seed of the gaits.
        skins: whether rays hit the skins of people.
    """

    def __init__(self, trial: Trial, world: World, figures: PeopleAppearance | None, seed: int, skins: bool) -> None:
        self.trial, self.world, self._skins = trial, world, SKIN if skins else None
        self._first = trial.people
        self._space: tuple[Scene, Scene] | None = None
        if figures is not None:
            stage = trial.stage
            world.embody(
                self.bodies,
                stage.physical(),
                figures.people,
                riders=figures.riders,
                activity=figures.activity,
                walls=_walls(trial),
                seed=seed,
            )

    @property
    def bodies(self) -> dict[int, Any]:
        """The robots by agent index."""
        return {self._first + k: robot.body for k, robot in enumerate(self.trial.robots)}

    def change(self, trial: Trial) -> None:
        """Use robots and stage of another trial."""
        self.trial = trial
        self.world.change_bodies(self.bodies, trial.stage.physical(), _walls(trial))

    @property
    def flat(self) -> Scene:
        """The planar scene, with props among the walls."""
        return self.world.plane_scene()

    @property
    def space(self) -> Scene:
        """The scene with bodies of people, robots and props."""
        now = self.world.scene
        if self._space is None or self._space[0] is not now:
            self._space = (now, self.world.body_scene(self._skins))
        return self._space[1]

    def render(self, camera: Any, pose: SpatialPose) -> Mapping[str, NDArray[Any]]:
        """Return current images of a camera, as the renderer of a :class:`crowdbot.sensors.SensorView`.

        Raises:
            MissingExtra: mujoco is not installed.
        """
        return self.studio.render(camera, pose)

    @property
    def studio(self) -> Renderer:
        """Renderer of the current world.

        Raises:
            MissingExtra: mujoco is not installed.
        """
        return self.world.renderer


def _walls(trial: Trial) -> Walls | None:
    """Return the walls without the outlines of props, None if there are no props."""
    return trial.stage.as_walls(props=False) if trial.stage.props else None

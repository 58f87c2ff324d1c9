"""WorldView: the world of a simulation as seen by sensors and cameras."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

from crowdbot.core import Pose, Scene, SpatialPose, tree
from crowdbot.world import MountPlacement, World

if TYPE_CHECKING:
    from crowdbot.world import Renderer

SKIN = 1
"""Level of detail of skins for ray casting."""


class WorldView:
    """A world for sensors: as discs in the plane, as bodies in space, or rendered.

    Args:
        world: planar or physics world.
        skins: whose skins rays hit: of ``nobody``, of ``avatars`` only, or of ``everybody``.
    """

    def __init__(self, world: World, skins: str) -> None:
        self.world, self._skins = world, None if skins == "nobody" else SKIN
        self._avatars = skins == "avatars"
        self._known: tuple[Scene, dict[tuple[str, int], Scene]] | None = None

    @property
    def flat(self) -> Scene:
        """The planar scene of all environments, with props among the walls."""
        return self.world.plane_scene()

    def flat_of(self, environment: int) -> Scene:
        """Return the planar scene of one environment."""
        if len(self.world.slots) == 1:
            return self.flat
        return self._scene("flat", environment)

    def space(self, environment: int) -> Scene:
        """Return the scene of one environment with bodies of people, robots and props."""
        return self._scene("space", environment)

    def of(self, environment: int) -> EnvironmentView:
        """Return the view of one environment, which renders images."""
        return EnvironmentView(self, environment)

    def sensor_pose(
        self, agent: int, mount: MountPlacement, spatial: bool, environment: int | None = None
    ) -> Pose | SpatialPose:
        """Return the pose of a sensor in all environments, or in one."""
        pose = self.world.sensor_pose(agent, mount, spatial)
        if environment is None or len(self.world.slots) == 1:
            return pose
        return tree.take(pose, slice(environment, environment + 1))

    def _scene(self, kind: str, environment: int) -> Scene:
        """Return a scene of the current step, computed once."""
        now = self.world.scene
        if self._known is None or self._known[0] is not now:
            self._known = (now, {})
        scenes, key = self._known[1], (kind, environment)
        if key not in scenes:
            if kind == "flat":
                scenes[key] = self.world.plane_scene(environment)
            else:
                scenes[key] = self.world.body_scene(self._skins, environment, self._avatars)
        return scenes[key]


@dataclass(frozen=True)
class EnvironmentView:
    """One environment of a world, as the renderer of a :class:`crowdbot.sensors.SensorView`."""

    around: WorldView
    environment: int

    def render(self, camera: Any, pose: SpatialPose) -> Mapping[str, NDArray[Any]]:
        """Return current images of a camera.

        Raises:
            MissingExtra: mujoco is not installed.
        """
        return self.studio.render(camera, pose)

    @property
    def studio(self) -> Renderer:
        """Renderer of the environment.

        Raises:
            MissingExtra: mujoco is not installed.
        """
        return self.around.world.environment_renderer(self.environment)

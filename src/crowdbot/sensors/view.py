"""SensorView: the input of a sensor, with scene, pose and renderer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError, Pose, Scene, SpatialPose, every, tree

from .lens import ImageSource
from .wheel_rotation import WheelRotation


@dataclass(frozen=True)
class SensorView:
    """The input of a sensor at one instant, in E environments.

    Fields:
        scene: the scene without the robot that carries the sensor.
        pose: pose of the sensor, one for each environment; planar or in space.
        renderer: renders camera images; None if there is none.
        wheels: wheels of the robot, for sensors with encoders; None if they are not known.

    >>> view = SensorView(Scene.of([[2.0, 0.0]], time=0.5), Pose.of((0.0, 0.0), 0.0))
    >>> view.time, view.environments
    (0.5, 1)
    """

    scene: Scene
    pose: Pose | SpatialPose
    renderer: ImageSource | None = None
    wheels: WheelRotation | None = None

    @property
    def time(self) -> float | NDArray[np.float64]:
        """Simulated time [s], a number or one for each environment ``[E]``."""
        return self.scene.time

    @property
    def environments(self) -> int:
        """Number of environments E."""
        return self.scene.shape[0]

    def select(self, index: ArrayLike) -> SensorView:
        """Return the view of the environments ``index``, in this order; each occurs at most once.

        Raises:
            InputError: an environment does not exist.
        """
        chosen = tree.environment_index(index, self.environments, "SensorView")
        pose = tree.take(self.pose, chosen)
        images = None if self.renderer is None else _Selection(self.renderer, chosen, self.environments)
        return SensorView(self.scene.environments(chosen), pose, images, tree.take(self.wheels, chosen))

    def check(self, sensor: str) -> None:
        """Raise :class:`InputError` if the pose is not finite or does not have one row for each environment."""
        pose = self.pose
        turn = pose.rotation if isinstance(pose, SpatialPose) else pose.heading
        if len(pose.position) != self.environments or len(turn) != self.environments:
            raise InputError(f"{sensor}: the pose has {len(pose.position)} rows for {self.environments} environments")
        if not (_is_finite(pose.position) and _is_finite(turn)):
            raise InputError(f"{sensor}: the pose of the sensor is not finite")
        if isinstance(self.time, np.ndarray) and self.time.shape != (self.environments,):
            raise InputError(
                f"{sensor}: the time has shape {list(self.time.shape)}, it must be a number or"
                f" [{self.environments}], one for each environment"
            )


def _is_finite(values: NDArray[np.float64]) -> bool:
    return every(np.isfinite(values))


@dataclass(frozen=True)
class _Selection:
    """Images of some environments of a renderer; it renders all, the others from the first pose."""

    renderer: ImageSource
    index: NDArray[np.int64]
    environments: int

    def render(self, camera: Any, pose: SpatialPose) -> Mapping[str, NDArray[Any]]:
        places = np.zeros(self.environments, dtype=np.int64)
        places[self.index] = np.arange(len(self.index))
        images = self.renderer.render(camera, tree.take(pose, places))
        return {name: np.asarray(image)[self.index] for name, image in images.items()}

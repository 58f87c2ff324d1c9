"""SensorView: the input of a sensor, with scene, pose and renderer."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError, Pose, Scene, SpatialPose

from .lens import ImageSource

__all__ = ["SensorView"]


@dataclass(frozen=True)
class SensorView:
    """The input of a sensor at one instant, in E environments.

    Fields:
        scene: the scene without the robot that carries the sensor.
        pose: pose of the sensor, one for each environment; planar or in space.
        renderer: renders camera images; None if there is none.

    >>> view = SensorView(Scene.of([[2.0, 0.0]], time=0.5), Pose.of((0.0, 0.0), 0.0))
    >>> view.time, view.environments
    (0.5, 1)
    """

    scene: Scene
    pose: Pose | SpatialPose
    renderer: ImageSource | None = None

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.scene.time

    @property
    def environments(self) -> int:
        """Number of environments E."""
        return self.scene.shape[0]

    def check(self, sensor: str) -> None:
        """Raise :class:`InputError` if the pose is not finite or does not have one row for each environment."""
        pose = self.pose
        turn = pose.rotation if isinstance(pose, SpatialPose) else pose.heading[:, None]
        if len(pose.position) != self.environments or len(turn) != self.environments:
            raise InputError(f"{sensor}: the pose has {len(pose.position)} rows for {self.environments} environments")
        if not (np.isfinite(pose.position).all() and np.isfinite(turn).all()):
            raise InputError(f"{sensor}: the pose of the sensor is not finite")

"""A perfect people tracker."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, check_number

from .lidar import Lidar2D
from .noise import Randomness, apply_noise
from .ranging import MOST_BEAMS
from .sensor import Reading, Sensor, planar_pose
from .view import SensorView

__all__ = ["GroundTruthPeople", "TrackedPeople"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class TrackedPeople(Reading):
    """Tracked agents in E environments; arrays keep the indices of the agents, NaN if not tracked.

    Fields:
        present: ``[E, A]`` whether the agent is tracked.
        position: ``[E, A, 2]`` [m] in the sensor frame, x forward and y left.
        velocity: ``[E, A, 2]`` [m/s] over the ground, along the axes of the sensor.
        radius: ``[E, A]`` [m].
        heading: ``[E, A]`` [rad] from the x axis of the sensor.
    """

    present: NDArray[np.bool_]
    position: Floats
    velocity: Floats
    radius: Floats
    heading: Floats

    def ids(self, environment: int = 0) -> list[int]:
        """Return the indices of the tracked agents."""
        return [int(a) for a in np.flatnonzero(self.present[environment])]


@dataclass(frozen=True)
class GroundTruthPeople(Sensor):
    """A perfect tracker of all agents within range, or only of the visible ones.

    An agent is visible if at least one of ``rays`` level beams of a full circle hits it. Noise is added to positions; a
    dropout loses the agent.

    Fields:
        range_max: largest distance to the centre of an agent [m].
        field_of_view: angle in which agents are tracked [rad], half to each side.
        visible_only: whether hidden agents are left out.
        rays: number of beams of the visibility test.

    Raises:
        InputError: a value is not allowed.

    >>> from crowdbot.core import Pose, Scene
    >>> scene = Scene.of([[1.0, 2.0], [1.0, 4.0]], [[0.0, 1.0], [0.0, 0.0]])
    >>> told = GroundTruthPeople().read(scene, Pose.of((1.0, 0.0), math.pi / 2))
    >>> told.ids(), told.position[0, 0].round(6).tolist(), told.velocity[0, 0].round(6).tolist()
    ([0], [2.0, 0.0], [1.0, 0.0])
    """

    range_max: float = 20.0
    field_of_view: float = 2.0 * math.pi
    visible_only: bool = True
    rays: int = 1440

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("GroundTruthPeople", "range_max", self.range_max, "m", exclusive_min=0.0)
        if not 0.0 < self.field_of_view <= 2.0 * math.pi + 1e-9:
            raise InputError(
                f"GroundTruthPeople: field_of_view = {self.field_of_view} rad must be above 0 and at most 2 pi"
            )
        check_number("GroundTruthPeople", "rays", self.rays, min=1, max=MOST_BEAMS, whole=True)

    def measure(self, view: SensorView, state: None, rng: Randomness | None = None) -> tuple[TrackedPeople, None]:
        """Return the tracked agents.

        Raises:
            InputError: the pose does not fit the scene, or noise lacks a generator.
        """
        self.check(view)
        scene, pose = view.scene, view.pose
        place = planar_pose(pose)
        absent = ~scene.active[..., None]
        away = np.where(absent, np.nan, scene.position) - place.position[:, None]
        position = _turned(away, place.heading)
        distance = np.hypot(position[..., 0], position[..., 1])
        bearing = np.abs(np.arctan2(position[..., 1], position[..., 0]))
        present = scene.active & (distance <= self.range_max) & (bearing <= 0.5 * self.field_of_view + 1e-12)
        if self.visible_only:
            present &= _circle(self.rays, self.range_max).read(scene, pose).visible_agents(scene.shape[1])
        told = apply_noise(np.where(present[..., None], position, np.nan), self.noises, rng)
        present &= np.isfinite(told).all(axis=-1)
        heading = scene.heading - place.heading[:, None]
        heading = math.pi - (math.pi - np.where(present, heading, 0.0)) % (2.0 * math.pi)
        reading = TrackedPeople(
            scene.time,
            pose,
            present,
            np.where(present[..., None], told, np.nan),
            np.where(present[..., None], _turned(np.where(absent, 0.0, scene.velocity), place.heading), np.nan),
            np.where(present, scene.radius, np.nan),
            np.where(present, heading, np.nan),
        )
        return reading, None


@functools.lru_cache(maxsize=16)
def _circle(rays: int, reach: float) -> Lidar2D:
    return Lidar2D(rays=rays, range_min=0.0, range_max=reach)


def _turned(vectors: Floats, heading: Floats) -> Floats:
    cos, sin = np.cos(heading)[:, None], np.sin(heading)[:, None]
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([cos * x + sin * y, cos * y - sin * x], axis=-1)

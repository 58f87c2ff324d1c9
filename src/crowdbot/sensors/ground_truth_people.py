"""A perfect people tracker."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, check_number, dense, kernel, storable
from crowdbot.typing import Bools, Floats

from .lidar import Lidar2D
from .noise import Randomness, apply_noise
from .ranging import MOST_BEAMS
from .sensor import Reading, Sensor, planar_pose
from .view import SensorView

FLOAT, BOOL = np.dtype(np.float64), np.dtype(np.bool_)


@storable
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
    truth: ClassVar[bool] = True
    batched = True

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
        shape = scene.shape
        pairs = (*shape, 2)
        where = dense(place.position, (shape[0], 2), FLOAT)
        active, cos, sin = dense(scene.active, shape, BOOL), np.cos(place.heading), np.sin(place.heading)
        present, told = np.empty(shape, dtype=np.bool_), np.empty(pairs)
        _locate(active, dense(scene.position, pairs, FLOAT), where, cos, sin, float(self.range_max), present, told)
        half = 0.5 * self.field_of_view + 1e-12
        if half < math.pi:
            present &= np.abs(np.arctan2(told[..., 1], told[..., 0])) <= half
        if self.visible_only:
            present &= _circle(self.rays, self.range_max).read(scene, pose).visible_agents(shape[1])
        if self.noises:
            told = apply_noise(np.where(present[..., None], told, np.nan), self.noises, rng)
            present &= np.isfinite(told).all(axis=-1)
        velocity, radius, heading = np.empty(pairs), np.empty(shape), np.empty(shape)
        _fill_rows(
            present, dense(scene.velocity, pairs, FLOAT), dense(scene.radius, shape, FLOAT),
            dense(scene.heading, shape, FLOAT), dense(place.heading, shape[:1], FLOAT), cos, sin,
            told, velocity, radius, heading,
        )  # fmt: skip
        return TrackedPeople(scene.time, pose, present, told, velocity, radius, heading), None


@kernel
def _locate(
    active: Bools, position: Floats, place: Floats, cos: Floats, sin: Floats, reach: float, present: Bools, told: Floats
) -> None:
    """Write the positions in the sensor frame, NaN for absent agents, and who is within reach."""
    for e in range(len(active)):
        for a in range(active.shape[1]):
            present[e, a] = False
            if not active[e, a]:
                told[e, a, :] = math.nan
                continue
            x, y = position[e, a, 0] - place[e, 0], position[e, a, 1] - place[e, 1]
            told[e, a, 0], told[e, a, 1] = cos[e] * x + sin[e] * y, cos[e] * y - sin[e] * x
            present[e, a] = math.hypot(told[e, a, 0], told[e, a, 1]) <= reach


@kernel
def _fill_rows(
    present: Bools, moving: Floats, size: Floats, direction: Floats, turn: Floats, cos: Floats, sin: Floats,
    told: Floats, velocity: Floats, radius: Floats, heading: Floats,
) -> None:  # fmt: skip
    """Write velocities, radii and headings in the sensor frame, and NaN for agents that are not present."""
    for e in range(len(present)):
        for a in range(present.shape[1]):
            if present[e, a]:
                x, y = moving[e, a, 0], moving[e, a, 1]
                velocity[e, a, 0], velocity[e, a, 1] = cos[e] * x + sin[e] * y, cos[e] * y - sin[e] * x
                radius[e, a] = size[e, a]
                heading[e, a] = math.pi - (math.pi - (direction[e, a] - turn[e])) % (2.0 * math.pi)
            else:
                told[e, a, :], velocity[e, a, :] = math.nan, math.nan
                radius[e, a], heading[e, a] = math.nan, math.nan


@functools.lru_cache(maxsize=16)
def _circle(rays: int, reach: float) -> Lidar2D:
    return Lidar2D(rays=rays, range_min=0.0, range_max=reach)

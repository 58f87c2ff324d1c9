"""ORCA as a navigator, within the limits of the drive."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot import models
from crowdbot.core import InputError, Paper, Scene, Twist, check_number
from crowdbot.typing import Bools, Floats

from .batch_rows import drive_numbers, rows_for_kernels
from .dynamic_window import dynamic_window_twist, dynamic_window_twists
from .goal_motion import SLOWING_TIME, holonomic_twists
from .navigator import BatchKernels, Navigator
from .observation import Observation, wall_radius
from .observation_batch import ObservationBatch
from .orca_search import choose_velocities
from .wall_arrays import wall_arrays

UNITS = {
    "speed": "m/s",
    "time_horizon": "s",
    "time_horizon_walls": "s",
    "neighbor_distance": "m",
    "max_neighbors": "",
    "reaction": "s",
}
"""Fields that must be positive."""


@dataclass(frozen=True)
class ORCANavigator(Navigator):
    """Chooses a velocity with reciprocal collision avoidance, then the best reachable twist.

    The visible people are agents with constant velocity that take their part of the avoidance (``share``). The drive
    cannot reach the chosen velocity at once: :func:`dynamic_window_twist` selects a twist within its accelerations. A
    holonomic drive moves with the chosen velocity and turns towards it.

    Fields:
        speed: largest speed [m/s], limited by the drive.
        safety: margin added to the radius of the robot [m].
        share: share of the avoidance by the robot: 0.5 (people do the other half) or 1.
        time_horizon: time horizon for people [s].
        time_horizon_walls: time horizon for walls [s].
        neighbor_distance: people farther away than this are ignored [m].
        max_neighbors: largest number of people considered.
        reaction: time to resolve an existing contact [s].

    Source: van den Berg, Guy, Lin, Manocha 2011, doi:10.1007/978-3-642-19457-3_1.

    Raises:
        InputError: a number is out of its range.

    >>> import numpy as np
    >>> from crowdbot.navigation import DriveLimits, VisiblePeople
    >>> person = VisiblePeople(np.array([[3.0, 0.1]]), np.array([[-1.0, 0.0]]), np.array([0.25]))
    >>> meeting = Observation(
    ...     pose=(0.0, 0.0, 0.0), goal=(9.0, 0.0), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.1, people=person
    ... )
    >>> ORCANavigator().act(meeting).turn < 0.0
    True
    """

    paper: ClassVar[Paper] = models.ORCA.paper
    always_returns = True

    speed: float = 1.0
    safety: float = 0.05
    share: float = 1.0
    time_horizon: float = 1.5
    time_horizon_walls: float = 1.0
    neighbor_distance: float = 6.0
    max_neighbors: int = 15
    reaction: float = 0.3

    def __post_init__(self) -> None:
        for name, unit in UNITS.items():
            check_number("ORCANavigator", name, getattr(self, name), unit, exclusive_min=0.0)
        check_number("ORCANavigator", "safety", self.safety, "m", min=0.0)
        if self.share not in (0.5, 1.0):
            raise InputError(f"ORCANavigator: share = {self.share} must be 0.5 or 1")

    def act(self, observation: Observation) -> Twist:
        # reachable twist that fits the chosen velocity best; for a holonomic drive, the velocity
        velocity = self.velocity(observation)
        if not observation.limits.holonomic:
            return dynamic_window_twist(observation, velocity, self.speed)
        pose, wish, out = np.array([observation.pose], np.float64), np.array([velocity]), np.zeros((1, 3))
        numbers = drive_numbers(observation.limits, self.speed)
        holonomic_twists(np.ones(1, np.bool_), pose, wish, numbers, float(observation.dt), out)
        return Twist(*out[0].tolist())

    def _kernels(self) -> BatchKernels | None:
        return self._decided if self._keeps(ORCANavigator, "act", "velocity", "_wish") else None

    def _decided(self, batch: ObservationBatch, out: Floats) -> Bools:
        """Write the twists of the environments with regular values, and return which they are."""
        asking = rows_for_kernels(batch, with_people=True)
        velocity = self._velocities(batch, asking)
        if batch.limits.holonomic:
            numbers = drive_numbers(batch.limits, self.speed)
            holonomic_twists(asking, batch.pose, velocity, numbers, float(batch.dt), out)
        else:
            dynamic_window_twists(batch, asking, velocity, self.speed, out)
        return asking

    def _velocities(self, batch: ObservationBatch, asking: NDArray[np.bool_]) -> Floats:
        """Return the velocities ``[N, 2]`` [m/s] chosen by ORCA in the asking environments."""
        try:
            _model(self.neighbor_distance, self.max_neighbors, self.time_horizon, self.time_horizon_walls)
        except InputError:  # each decision reports it
            asking[:] = False
        out, people, limits = np.zeros((len(batch), 2)), batch.people, batch.limits
        narrow, size = batch.radius, people.radius
        if len(batch.outline):
            narrow = np.full(len(batch), wall_radius(0.0, batch.outline))
            size = size + (batch.radius - narrow)[:, None]
        numbers = np.array(
            [
                min(self.speed, limits.max_speed),
                limits.max_acceleration,
                self.safety,
                1.0 if self.share == 1.0 else 0.5,
                self.time_horizon,
                self.time_horizon_walls,
                self.neighbor_distance,
                max(self.reaction, batch.dt),
            ]
        )
        choose_velocities(
            asking, batch.pose, batch.goal, batch.waypoint, batch.twist, narrow,
            people.position, people.velocity, size, people.seen,
            *wall_arrays(batch.walls).edges, numbers, round(self.max_neighbors), out,
        )  # fmt: skip
        return out

    def velocity(self, observation: Observation) -> tuple[float, float]:
        """Return the velocity [m/s] in the world chosen by ORCA, without the limits of the drive."""
        people = observation.people
        top = min(self.speed, observation.limits.max_speed)
        wish = self._wish(observation, top)
        external = np.full(len(people) + 1, self.share == 1.0)
        # towards walls the robot is as wide as its outline, towards people it is its circumscribed disc
        overhang = observation.radius - observation.wall_radius
        external[0] = False
        scene = Scene.of(
            _joined(observation.position, people.position),
            _joined(observation.velocity, people.velocity),
            radius=np.concatenate([[observation.wall_radius + self.safety], people.radius + overhang]),
            preferred_velocity=_joined(wish, people.velocity),
            max_speed=top,
            external=external,
            walls=observation.walls,
        )
        model = _model(self.neighbor_distance, self.max_neighbors, self.time_horizon, self.time_horizon_walls)
        vx, vy = model.velocity(scene, max(self.reaction, observation.dt))[0, 0].tolist()
        return vx, vy

    def _wish(self, observation: Observation, top: float) -> Floats:
        remaining = observation.remaining
        speed = min(top, remaining / SLOWING_TIME, observation.braking_speed(remaining))
        away = np.array(observation.waypoint) - observation.position
        return np.asarray(away * (speed / max(math.dist(observation.pose[:2], observation.waypoint), 1e-9)))


@functools.lru_cache(maxsize=64)
def _model(neighbor_distance: float, max_neighbors: int, time_horizon: float, time_horizon_walls: float) -> models.ORCA:
    return models.ORCA(neighbor_distance, max_neighbors, time_horizon, time_horizon_walls)


def _joined(own: Floats, others: Floats) -> Floats:
    return np.concatenate([own[None], others])

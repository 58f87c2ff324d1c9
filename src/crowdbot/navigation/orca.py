"""ORCA as a navigator, within the limits of the drive."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot import models
from crowdbot.core import InputError, Paper, Scene, Twist, check_number

from .dynamic_window import dynamic_window_twist
from .navigator import Navigator
from .observation import SLOWING_TIME, Observation

__all__ = ["ORCANavigator"]

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
    cannot reach the chosen velocity at once: :func:`dynamic_window_twist` selects a twist within its accelerations.

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
        """Return the reachable twist that fits the chosen velocity best."""
        return dynamic_window_twist(observation, self.velocity(observation), self.speed)

    def velocity(self, observation: Observation) -> tuple[float, float]:
        """Return the velocity [m/s] in the world chosen by ORCA, without the limits of the drive."""
        people = observation.people
        top = min(self.speed, observation.limits.max_speed)
        wish = self._wish(observation, top)
        external = np.full(len(people) + 1, self.share == 1.0)
        external[0] = False
        scene = Scene.of(
            _joined(observation.position, people.position),
            _joined(observation.velocity, people.velocity),
            radius=np.concatenate([[observation.radius + self.safety], people.radius]),
            preferred_velocity=_joined(wish, people.velocity),
            max_speed=top,
            external=external,
            walls=observation.walls,
        )
        model = models.ORCA(self.neighbor_distance, self.max_neighbors, self.time_horizon, self.time_horizon_walls)
        vx, vy = model.velocity(scene, max(self.reaction, observation.dt))[0, 0].tolist()
        return vx, vy

    def _wish(self, observation: Observation, top: float) -> NDArray[np.float64]:
        distance = observation.distance
        speed = min(top, distance / SLOWING_TIME, observation.braking_speed(distance))
        return np.asarray((np.array(observation.goal) - observation.position) * (speed / max(distance, 1e-9)))


def _joined(own: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.concatenate([own[None], others])

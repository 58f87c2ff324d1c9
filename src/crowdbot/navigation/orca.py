"""ORCA as a navigator: the model of walking people steers the robot, within the limits of its drive."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot import models
from crowdbot.core import InputError, Paper, Scene, Twist, check_number

from .navigator import Navigator
from .observation import SLOWING_TIME, Observation
from .reachable import reachable

__all__ = ["ORCA"]

UNITS = {
    "speed": "m/s",
    "time_horizon": "s",
    "time_horizon_walls": "s",
    "neighbor_distance": "m",
    "max_neighbors": "",
    "reaction": "s",
}
"""Fields that must be above 0."""


@dataclass(frozen=True)
class ORCA(Navigator):
    """Chooses the velocity of reciprocal collision avoidance, then the nearest twist that its drive can reach.

    The robot takes the people it sees for walkers who go on with their velocity and give way as much as ``share``
    leaves to them. A drive cannot take the chosen velocity at once. So the twists within reach of its accelerations are
    tried, and the one is taken that comes nearest to that velocity and touches nobody (:func:`reachable`).

    Fields:
        speed: [m/s], cut to what the drive can do.
        safety: added to the robot's radius [m].
        share: part of the avoidance that the robot takes: 0.5 trusts people to do their half, 1 trusts nobody.
        time_horizon: people are avoided for this long [s].
        time_horizon_walls: and walls for this long [s].
        neighbor_distance: people farther than this are not considered [m].
        max_neighbors: no more than so many are.
        reaction: time within which a contact that is already there should be undone [s].

    Source: van den Berg, Guy, Lin, Manocha 2011, doi:10.1007/978-3-642-19457-3_1.

    Raises:
        InputError: a number is out of its range.

    >>> import numpy as np
    >>> from crowdbot.navigation import Limits, People
    >>> person = People(np.array([[3.0, 0.1]]), np.array([[-1.0, 0.0]]), np.array([0.25]))
    >>> meeting = Observation(
    ...     pose=(0.0, 0.0, 0.0), goal=(9.0, 0.0), radius=0.3, limits=Limits(1.0, 2.0), dt=0.1, people=person
    ... )
    >>> ORCA().act(meeting).turn < 0.0
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
            check_number("navigator ORCA", name, getattr(self, name), unit, exclusive_min=0.0)
        check_number("navigator ORCA", "safety", self.safety, "m", min=0.0)
        if self.share not in (0.5, 1.0):
            raise InputError(f"navigator ORCA: share = {self.share} must be 0.5 or 1")

    def act(self, observation: Observation) -> Twist:
        """Return the twist within reach that comes nearest to the chosen velocity."""
        return reachable(observation, self.velocity(observation), self.speed)

    def velocity(self, observation: Observation) -> tuple[float, float]:
        """Return the velocity [m/s] in the world that a robot without a drive would take."""
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

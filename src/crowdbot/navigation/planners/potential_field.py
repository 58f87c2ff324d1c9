"""The artificial potential field as a navigator, within the limits of the drive."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.core import Paper, Twist, check_number
from crowdbot.navigation.goal_motion import slow_speed
from crowdbot.navigation.navigator import Navigator
from crowdbot.navigation.observation import Observation
from crowdbot.navigation.wall_arrays import wall_arrays
from crowdbot.typing import Floats

from .clearance import TINY, move_with, vectors_from_walls

UNITS = {"speed": "m/s", "damping": "1/s", "influence": "m", "wall_influence": "m", "closest": "m"}
"""Fields that must be positive."""


@dataclass(frozen=True)
class PotentialFieldNavigator(Navigator):
    """Moves down an artificial potential: the waypoint attracts, people and walls repel.

    The attraction is the velocity-limited one, ``-k_v (v - v_d)`` with v_d towards the waypoint. An obstacle at
    clearance rho below its influence rho_0 adds ``eta (1 / rho - 1 / rho_0) / rho^2`` away from it (the FIRAS
    function). The velocity approaches ``v_d + F / k_v``. The field knows only where people
    are, not where they go, and has local minima.

    Fields:
        speed: largest speed [m/s], limited by the drive.
        damping: velocity gain, k_v [1/s].
        gain: gain of the repulsion, eta [m3/s2].
        influence: clearance to people below which they repel, rho_0 [m].
        wall_influence: the same for walls [m].
        closest: smallest clearance that counts [m], which keeps the force finite in contact.

    Source: Khatib 1986, doi:10.1177/027836498600500106.

    Raises:
        InputError: a number is out of its range.

    >>> from crowdbot.navigation import DriveLimits, VisiblePeople
    >>> person = VisiblePeople(np.array([[1.2, 0.2]]), np.zeros((1, 2)), np.array([0.25]))
    >>> blocked = Observation(
    ...     pose=(0.0, 0.0, 0.0), goal=(9.0, 0.0), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.1, people=person
    ... )
    >>> bool(PotentialFieldNavigator().velocity(blocked)[1] < 0.0)
    True
    """

    paper: ClassVar[Paper] = Paper(
        "Khatib",
        1986,
        "Real-time obstacle avoidance for manipulators and mobile robots",
        "Int. J. Robotics Research 5",
        "10.1177/027836498600500106",
    )
    always_returns = True

    speed: float = 1.0
    damping: float = 2.0
    gain: float = 0.3
    influence: float = 1.5
    wall_influence: float = 0.4
    closest: float = 0.1

    def __post_init__(self) -> None:
        for name, unit in UNITS.items():
            check_number("PotentialFieldNavigator", name, getattr(self, name), unit, exclusive_min=0.0)
        check_number("PotentialFieldNavigator", "gain", self.gain, "m3/s2", min=0.0)

    def act(self, observation: Observation) -> Twist:
        return move_with(observation, self.velocity(observation), self.speed)

    def velocity(self, observation: Observation) -> Floats:
        """Return the velocity ``[2]`` [m/s] to which the field accelerates the robot."""
        towards = np.array(observation.waypoint) - observation.position
        limits = observation.limits
        top = slow_speed(min(self.speed, limits.max_speed), observation.remaining, limits.max_acceleration)
        people, walls = observation.people, wall_arrays(observation.walls).segments
        force = self._repulsion(
            observation.position - people.position, people.radius + observation.radius, self.influence
        )
        away = vectors_from_walls(observation.position[None], walls)[0]
        force += self._repulsion(away, np.full(len(away), observation.wall_radius), self.wall_influence)
        return np.asarray(towards * (top / max(float(np.hypot(*towards)), TINY)) + force / self.damping)

    def _repulsion(self, away: Floats, size: Floats, influence: float) -> Floats:
        """Return the force ``[2]`` of obstacles, for vectors from them ``[N, 2]`` and sums of radii ``[N]``."""
        distance = np.maximum(np.hypot(*away.T), TINY)
        gap = np.maximum(distance - size, min(self.closest, influence))
        force = self.gain * np.maximum(1.0 / gap - 1.0 / influence, 0.0) / gap**2
        return np.asarray(((force / distance)[:, None] * away).sum(axis=0))

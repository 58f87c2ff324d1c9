"""The social force as a navigator, within the limits of the drive."""

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

UNITS = {"speed": "m/s", "relaxation": "s", "reach": "m", "step": "s", "wall_range": "m"}
"""Fields that must be positive."""
STEEPEST = 4.0
"""Largest exponent of a force, so that an overlap keeps it finite."""


@dataclass(frozen=True)
class SocialForceNavigator(Navigator):
    """Moves with the velocity to which social forces accelerate the robot.

    With e the direction of the waypoint, v0 the speed and tau the ``relaxation``, the acceleration is
    ``(v0 e - v) / tau + f``, so that the velocity approaches ``v0 e + tau f``. Each person adds to f, for the vector d
    from the person to the robot, ``y = step (person velocity - robot velocity)`` and the sum R of the radii,

    ``w A exp((R - b) / B) (|d| + |d - y|) / (4 b) (d / |d| + (d - y) / |d - y|)`` with
    ``2 b = sqrt((|d| + |d - y|)^2 - |y|^2)``.

    ``w = lambda + (1 - lambda) (1 + cos phi) / 2`` is small for people behind. A wall adds ``A_w exp((r - d) / B_w)``
    away from its nearest point.

    Fields:
        speed: largest speed [m/s], limited by the drive.
        relaxation: time in which the velocity adapts, tau [s].
        strength: acceleration by a person in contact, A [m/s2].
        reach: distance in which it falls to 37 %, B [m].
        step: time of the relative motion, which makes the force elliptical [s].
        anisotropy: weight of people behind the robot, lambda, 0 to 1.
        wall_strength: acceleration by a wall in contact, A_w [m/s2].
        wall_range: distance in which it falls to 37 %, B_w [m].

    Source: Helbing, Molnár 1995, doi:10.1103/PhysRevE.51.4282; ellipses of relative motion: Johansson, Helbing, Shukla
    2007, doi:10.1142/S0219525907001355.

    Raises:
        InputError: a number is out of its range.

    >>> from crowdbot.navigation import DriveLimits, VisiblePeople
    >>> person = VisiblePeople(np.array([[2.0, 0.2]]), np.array([[-1.0, 0.0]]), np.array([0.25]))
    >>> meeting = Observation(
    ...     pose=(0.0, 0.0, 0.0), goal=(9.0, 0.0), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.1, people=person
    ... )
    >>> SocialForceNavigator().act(meeting).turn < 0.0
    True
    """

    paper: ClassVar[Paper] = Paper(
        "Helbing, Molnár",
        1995,
        "Social force model for pedestrian dynamics",
        "Phys. Rev. E 51",
        "10.1103/PhysRevE.51.4282",
    )
    always_returns = True

    speed: float = 1.0
    relaxation: float = 0.5
    strength: float = 4.0
    reach: float = 0.4
    step: float = 1.0
    anisotropy: float = 0.2
    wall_strength: float = 3.0
    wall_range: float = 0.15

    def __post_init__(self) -> None:
        for name, unit in UNITS.items():
            check_number("SocialForceNavigator", name, getattr(self, name), unit, exclusive_min=0.0)
        for name in ("strength", "wall_strength"):
            check_number("SocialForceNavigator", name, getattr(self, name), "m/s2", min=0.0)
        check_number("SocialForceNavigator", "anisotropy", self.anisotropy, "", min=0.0, max=1.0)

    def act(self, observation: Observation) -> Twist:
        return move_with(observation, self.velocity(observation), self.speed)

    def velocity(self, observation: Observation) -> Floats:
        """Return the velocity ``[2]`` [m/s] to which the forces accelerate the robot."""
        towards = np.array(observation.waypoint) - observation.position
        ahead = towards / max(float(np.hypot(*towards)), TINY)
        limits = observation.limits
        top = slow_speed(min(self.speed, limits.max_speed), observation.remaining, limits.max_acceleration)
        return np.asarray(top * ahead + self.relaxation * (self._people(observation, ahead) + self._walls(observation)))

    def _people(self, observation: Observation, ahead: Floats) -> Floats:
        """Return the acceleration ``[2]`` by people [m/s2]."""
        people = observation.people
        d = observation.position - people.position
        y = self.step * (people.velocity - observation.velocity)
        near, later = np.maximum(np.hypot(*d.T), TINY), np.maximum(np.hypot(*(d - y).T), TINY)
        b = 0.5 * np.sqrt(np.maximum((near + later) ** 2 - (y**2).sum(axis=1), 0.0)) + TINY
        gap = observation.radius + people.radius - b
        size = (
            self.strength
            * np.exp(np.minimum(gap / self.reach, STEEPEST))
            * np.minimum((near + later) / (4.0 * b), 10.0)
        )
        weight = self.anisotropy + (1.0 - self.anisotropy) * 0.5 * (1.0 - d @ ahead / near)
        return np.asarray(((weight * size)[:, None] * (d / near[:, None] + (d - y) / later[:, None])).sum(axis=0))

    def _walls(self, observation: Observation) -> Floats:
        """Return the acceleration ``[2]`` by walls [m/s2]."""
        away = vectors_from_walls(observation.position[None], wall_arrays(observation.walls).segments)[0]
        near = np.maximum(np.hypot(*away.T), TINY)
        steep = np.minimum((observation.wall_radius - near) / self.wall_range, STEEPEST)
        return np.asarray(((self.wall_strength * np.exp(steep) / near)[:, None] * away).sum(axis=0))

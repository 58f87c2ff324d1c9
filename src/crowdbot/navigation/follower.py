"""A navigator that keeps its distance to the person ahead, as the follower of a coordination experiment."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from crowdbot.core import Twist, check_number, wrap_angle

from .action import Action
from .navigator import Navigator
from .observation import Observation

HEADING_GAIN = 2.0
"""Gain of the correction of the heading [1/s]."""


class Place(NamedTuple):
    """Heading [rad] of the first decision, and the distance to keep [m]; 0 as long as nobody has been seen."""

    heading: float
    distance: float


@dataclass(frozen=True)
class FollowerNavigator(Navigator):
    """Moves forward and backward along its first heading so that the distance to the nearest person ahead stays.

    The speed is that of the person along the heading, times ``feedforward``, plus ``gain`` times the error of the
    distance of the centres. Without a person ahead the robot stands. It ignores walls and the goal.

    Fields:
        distance: distance of the centres to keep [m]; 0: that at the first sight of a person.
        gain: gain of the distance [1/s].
        feedforward: share of the speed of the person that is followed at once.
        sight: half of the angle in which people are ahead [deg].

    Raises:
        InputError: a number is out of its range.

    >>> from crowdbot.navigation import DriveLimits, VisiblePeople
    >>> person = VisiblePeople(np.array([[2.0, 0.0]]), np.array([[0.3, 0.0]]), np.array([0.25]))
    >>> seen = Observation(
    ...     pose=(0.0, 0.0, 0.0), goal=(9.0, 0.0), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.1, people=person
    ... )
    >>> robot = FollowerNavigator(distance=1.5, gain=1.0)
    >>> round(robot.decide(seen, robot.begin(seen))[0].twist.forward, 3)
    0.8
    """

    always_returns = True

    distance: float = 0.0
    gain: float = 1.5
    feedforward: float = 1.0
    sight: float = 45.0

    def __post_init__(self) -> None:
        check_number("FollowerNavigator", "distance", self.distance, "m", min=0.0)
        check_number("FollowerNavigator", "gain", self.gain, "1/s", exclusive_min=0.0)
        check_number("FollowerNavigator", "feedforward", self.feedforward, "", min=0.0, max=1.0)
        check_number("FollowerNavigator", "sight", self.sight, "deg", exclusive_min=0.0, max=180.0)

    def begin(self, observation: Observation) -> Place:
        return Place(observation.pose[2], self.distance)

    def act(self, observation: Observation, memory: Place) -> tuple[Action, Place]:
        turn = HEADING_GAIN * wrap_angle(memory.heading - observation.pose[2])
        most, top = observation.limits.max_turn_rate, observation.limits.max_speed
        turn = max(-most, min(most, turn))
        ahead = self._person_ahead(observation, memory.heading)
        if ahead is None:
            return Action(Twist(0.0, turn)), memory
        gap, speed = ahead
        kept = memory if memory.distance > 0.0 else Place(memory.heading, gap)
        forward = self.feedforward * speed + self.gain * (gap - kept.distance)
        return Action(Twist(max(-top, min(top, forward)), turn)), kept

    def _person_ahead(self, observation: Observation, heading: float) -> tuple[float, float] | None:
        """Return distance [m] and speed along the heading [m/s] of the nearest person ahead."""
        people, (x, y, _) = observation.people, observation.pose
        away = people.position - np.array([x, y])
        distance = np.hypot(away[:, 0], away[:, 1])
        forward = np.array([math.cos(heading), math.sin(heading)])
        seen = away @ forward > distance * math.cos(math.radians(self.sight))
        if not seen.any():
            return None
        nearest = int(np.argmin(np.where(seen, distance, math.inf)))
        return float(distance[nearest]), float(people.velocity[nearest] @ forward)

"""The time-elastic band as a navigator: the fastest band of timed points that keeps clear of people and walls."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.core import Paper, Twist, check_number
from crowdbot.navigation.goal_motion import slow_speed
from crowdbot.navigation.navigator import Navigator
from crowdbot.navigation.observation import Observation
from crowdbot.navigation.wall_arrays import wall_arrays
from crowdbot.typing import Floats

from .band_search import POINTS, BandScene, optimize_bands
from .clearance import TINY, move_with, wall_gaps

EAGER = 100.0
"""Value for unknown accelerations [m/s2]."""
STARTS = ((0.0, 1.0), (0.15, 1.0), (-0.15, 1.0), (0.35, 1.1), (-0.35, 1.1), (0.0, 1.6), (0.0, 2.5))
"""First bands: sideways bend as a share of the length, and duration as a multiple of the shortest."""
SPEED_WEIGHT, PUSH_WEIGHT, WALL_WEIGHT = 6.0, 2.0, 20.0
"""Weights of the excess of speed [s/m] and acceleration [s2/m], and of the depth in the margin of walls [1/m]."""
UNITS = {"speed": "m/s", "horizon": "s", "people": "1/m"}
"""Fields that must be positive."""


@dataclass(frozen=True)
class TimeElasticBandNavigator(Navigator):
    """Optimises a band of points in space and time to the waypoint, and drives along its beginning.

    The band has 20 equal time intervals, whose length is a variable, too. Damped least squares minimise its duration,
    the excess of speed and acceleration, the lack of ``margin`` to people, who keep their velocity, times the
    probability that they exist, and the lack of ``wall_margin``. Seven first bands, straight, bent to both sides and
    slow, lead to different sides of people and to passing before or behind them; the cheapest result counts. If even
    that band touches somebody, the robot approaches the contact only as fast as it can stop. The bands start anew at
    each decision, so the same observation gives the same decision.

    Fields:
        speed: largest speed [m/s], limited by the drive.
        horizon: time at full speed to the end of the band [s].
        margin: clearance to people that is wanted [m].
        wall_margin: clearance to walls that is wanted [m].
        people: weight of the lack of clearance to people [1/m].
        smoothness: weight of a change of the velocity [s/m].
        iterations: number of steps of the optimisation.

    Source: Roesmann, Hoffmann, Bertram 2017, doi:10.1016/j.robot.2016.11.007. There the intervals have different
    lengths, and headings are variables; here the drive follows the velocity of the band as well as it can.

    Raises:
        InputError: a number is out of its range.

    >>> from crowdbot.navigation import DriveLimits, VisiblePeople
    >>> person = VisiblePeople(np.array([[3.0, 0.1]]), np.array([[-1.0, 0.0]]), np.array([0.25]))
    >>> meeting = Observation(
    ...     pose=(0.0, 0.0, 0.0), goal=(9.0, 0.0), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.1, people=person
    ... )
    >>> TimeElasticBandNavigator().act(meeting).turn < 0.0
    True
    """

    paper: ClassVar[Paper] = Paper(
        "Roesmann, Hoffmann, Bertram",
        2017,
        "Integrated online trajectory planning and optimization in distinctive topologies",
        "Robotics and Autonomous Systems 88",
        "10.1016/j.robot.2016.11.007",
    )
    always_returns = True

    speed: float = 1.0
    horizon: float = 4.0
    margin: float = 0.5
    wall_margin: float = 0.1
    people: float = 10.0
    smoothness: float = 0.2
    iterations: int = 12

    def __post_init__(self) -> None:
        for name, unit in UNITS.items():
            check_number("TimeElasticBandNavigator", name, getattr(self, name), unit, exclusive_min=0.0)
        for name, unit in {"margin": "m", "wall_margin": "m", "smoothness": "s/m"}.items():
            check_number("TimeElasticBandNavigator", name, getattr(self, name), unit, min=0.0)
        check_number("TimeElasticBandNavigator", "iterations", self.iterations, min=1, max=1000, whole=True)

    def act(self, observation: Observation) -> Twist:
        return move_with(observation, self.velocity(observation), self.speed)

    def velocity(self, observation: Observation) -> Floats:
        """Return the velocity ``[2]`` [m/s] of the beginning of the best band."""
        limits = observation.limits
        top = min(self.speed, limits.max_speed)
        towards = np.array(observation.waypoint) - observation.position
        away = float(np.hypot(*towards))
        slow = slow_speed(top, observation.remaining, limits.max_acceleration)
        if away < TINY:
            return np.zeros(2)
        end = towards * min(1.0, self.horizon * top / away)
        scene = self._scene(observation, top)
        bands, intervals = _first_bands(end, top)
        cost = np.zeros(len(bands))
        optimize_bands(scene, bands, intervals, int(self.iterations), cost)
        best = int(np.argmin(cost))
        wish = bands[best, 1] / intervals[best]
        free = self._free_length(observation, bands[best], float(intervals[best]))
        size = max(float(np.hypot(*wish)), TINY)
        braking = math.sqrt(1.6 * min(limits.max_acceleration, EAGER) * free)
        return np.asarray(wish * (min(size, slow, braking, free / (2.0 * observation.dt)) / size))

    def _scene(self, observation: Observation, top: float) -> BandScene:
        """Return what bands must respect, with the robot at the origin."""
        here, people = observation.position, observation.people
        reach = people.radius + observation.radius + self.margin
        near = np.hypot(*(people.position - here).T) < self.horizon * (top + np.hypot(*people.velocity.T)) + reach
        push = min(observation.limits.max_acceleration, EAGER)
        weights = np.array([1.0, SPEED_WEIGHT, PUSH_WEIGHT, self.people, WALL_WEIGHT, self.smoothness])
        segments = wall_arrays(observation.walls).segments
        if len(segments):
            gaps = np.array([wall_gaps(here[None], row[None], 0.0)[0] for row in segments])
            segments = segments[gaps < self.horizon * top + observation.radius + self.wall_margin]
        return BandScene(
            observation.velocity,
            np.array([top, push]),
            people.position[near] - here,
            np.ascontiguousarray(people.velocity[near]),
            np.ascontiguousarray(reach[near]),
            np.sqrt(people.existence[near]),
            np.ascontiguousarray(segments - np.tile(here, 2)),
            float(observation.wall_radius + self.wall_margin),
            weights,
        )

    def _free_length(self, observation: Observation, band: Floats, interval: float) -> float:
        """Return the length of a band ``[POINTS + 1, 2]`` before the first contact [m]; inf without contact."""
        people, here = observation.people, observation.position
        times = interval * np.arange(1, POINTS + 1)
        away = band[1:, None] + here - people.position - times[:, None, None] * people.velocity
        meets = (np.hypot(away[..., 0], away[..., 1]) < people.radius + observation.radius).any(axis=1)
        inside = float(wall_gaps(here[None], wall_arrays(observation.walls).segments, observation.wall_radius)[0]) < 0.0
        if not inside:
            gap = wall_gaps(band[1:] + here, wall_arrays(observation.walls).segments, observation.wall_radius)
            meets |= gap < 0.0
        if not meets.any():
            return math.inf
        steps = np.hypot(*(band[1:] - band[:-1]).T)
        return float(steps[: int(np.argmax(meets))].sum())


def _first_bands(end: Floats, top: float) -> tuple[Floats, Floats]:
    """Return the first bands ``[K, POINTS + 1, 2]`` from the origin to an end [m], and their intervals ``[K]`` [s]."""
    share = np.linspace(0.0, 1.0, POINTS + 1)
    bend, slow = np.array(STARTS).T
    aside = np.array([-end[1], end[0]])
    bands = share[None, :, None] * end + (bend[:, None] * np.sin(math.pi * share))[..., None] * aside
    length = np.hypot(*np.moveaxis(bands[:, 1:] - bands[:, :-1], -1, 0)).sum(axis=1)
    return np.ascontiguousarray(bands), np.maximum(length * slow / (POINTS * top), 0.02)

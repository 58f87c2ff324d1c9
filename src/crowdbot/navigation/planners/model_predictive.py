"""Model-predictive control as a navigator: the first twist of the best plan among forecast people."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crowdbot.core import Twist, check_number
from crowdbot.navigation.navigator import Navigator
from crowdbot.navigation.observation import Observation
from crowdbot.navigation.wall_arrays import wall_arrays
from crowdbot.typing import Floats

from .clearance import robot_wall_gaps, wall_gaps
from .plan_costs import contact_probability, progress_cost, space_lack
from .rollout import roll_out

STEP = 0.2
"""Time step of plans [s]."""
WALKING = 0.5
"""Speed [m/s] from which the uncertainty of a person grows fully."""
WALL = 100.0
"""Cost of a full radius in a wall [s]."""


@dataclass(frozen=True)
class MPCNavigator(Navigator):
    """Simulates a fixed lattice of plans among forecast people, and begins the cheapest one; again at each decision.

    A plan holds a speed and a turn rate for a while, then goes on to the waypoint. The drive follows it within its
    limits. The forecast is that of the predictor of the trial; without one people keep their velocity. The cost of a
    plan, in seconds, is the sum of

    * progress: ``(mean + last remaining path) / speed`` over the horizon,
    * ``risk`` times the sum over people of the largest probability of contact, ``Phi(-(gap - margin) / sigma)`` with
      ``sigma = uncertainty + growth t min(1, pace / 0.5 m/s)``, times the probability that the person exists, as a
      weighted mean over the futures of the forecast,
    * ``comfort`` times the mean lack of ``space`` to people, as a share, whether they exist or not: otherwise the robot
      would turn aside too late, and stop before somebody who hardly exists,
    * ``smoothness`` times the change of the motion in the first step, as shares of the largest speed and turn rate,
    * the depth in walls and their margin.

    The same observation gives the same decision: the lattice is fixed, and the forecast has its own random stream from
    the time.

    Fields:
        speed: largest speed [m/s], limited by the drive.
        horizon: simulated time [s].
        risk: cost of a certain contact [s].
        margin: clearance at which a contact is as likely as not [m].
        uncertainty: standard deviation of the clearance now [m].
        growth: its growth with time for a person who walks [m/s].
        comfort: cost of no clearance during the horizon [s].
        space: clearance to people that is wanted [m].
        smoothness: cost of a full change of the twist [s].
        wall_margin: clearance to walls that is kept [m].
        samples: futures asked of the predictor.

    Raises:
        InputError: a number is out of its range.

    >>> from crowdbot.navigation import DriveLimits, VisiblePeople
    >>> person = VisiblePeople(np.array([[3.0, 0.1]]), np.array([[-1.0, 0.0]]), np.array([0.25]))
    >>> meeting = Observation(
    ...     pose=(0.0, 0.0, 0.0), goal=(9.0, 0.0), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.1, people=person
    ... )
    >>> MPCNavigator().act(meeting).turn < 0.0
    True
    """

    speed: float = 1.0
    horizon: float = 4.0
    risk: float = 20.0
    margin: float = 0.05
    uncertainty: float = 0.05
    growth: float = 0.02
    comfort: float = 1.0
    space: float = 0.4
    smoothness: float = 0.1
    wall_margin: float = 0.1
    samples: int = 1

    def __post_init__(self) -> None:
        for name, unit in {"speed": "m/s", "horizon": "s", "uncertainty": "m", "space": "m"}.items():
            check_number("MPCNavigator", name, getattr(self, name), unit, exclusive_min=0.0)
        others = {"risk": "s", "margin": "m", "growth": "m/s", "comfort": "s", "smoothness": "s", "wall_margin": "m"}
        for name, unit in others.items():
            check_number("MPCNavigator", name, getattr(self, name), unit, min=0.0)
        check_number("MPCNavigator", "samples", self.samples, min=1, whole=True)

    def act(self, observation: Observation) -> Twist:
        """Return the first twist of the cheapest plan."""
        steps = max(2, round(self.horizon / STEP))
        rollout = roll_out(observation, self.speed, steps, STEP)
        cost = progress_cost(rollout, min(self.speed, observation.limits.max_speed), self.smoothness)
        cost += self._people(observation, rollout.position)
        cost += self._walls(observation, rollout.position, rollout.heading)
        return Twist(*rollout.first[int(np.argmin(cost))].tolist())

    def _people(self, observation: Observation, position: Floats) -> Floats:
        """Return the cost ``[C]`` of people near the paths ``[C, T, 2]``."""
        T, total = position.shape[1], np.zeros(len(position))
        places, radius, weight, pace, there = self._forecast(observation, T)
        sigma = self.uncertainty + self.growth * STEP * np.arange(1, T + 1)[:, None] * pace
        for future, share in zip(places, weight.tolist(), strict=True):
            away = position[:, :, None] - future
            gap = np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2) - radius - observation.radius
            meets = contact_probability(gap, self.margin, sigma)
            lack = space_lack(gap, self.space).max(axis=2, initial=0.0)
            total += share * (self.risk * (there * meets).sum(axis=1) + self.comfort * lack.mean(axis=1))
        return total

    def _forecast(self, observation: Observation, steps: int) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """Return places ``[K, T, N, 2]`` of the people within reach, radii ``[N]``, weights ``[K]``, shares ``[N]``.

        The shares are those of the growth of the uncertainty: who stands is expected to stay. The last value are the
        probabilities ``[N]`` that the people exist.
        """
        people = observation.people
        times = STEP * np.arange(1, steps + 1)
        places = (people.position + times[:, None, None] * people.velocity)[None]
        weight = np.ones(1)
        if observation.predictor is not None and observation.tracks is not None and len(people):
            forecast = observation.forecast(seconds=self.horizon, samples=self.samples)
            places, weight = np.repeat(places, forecast.samples, axis=0), forecast.weight[0] / forecast.weight[0].sum()
            knots = forecast.dt * np.arange(forecast.steps + 1)
            column = {int(id_): k for k, id_ in enumerate(observation.tracks.ids)}
            for a, item in enumerate(people.ids.tolist()):
                if (k := column.get(item)) is None or not forecast.valid[0, k]:
                    continue  # not predicted: constant velocity
                for s, c in np.ndindex(forecast.samples, 2):
                    track = np.append(people.position[a, c], forecast.position[0, s, :, k, c])
                    places[s, :, a, c] = np.interp(times, knots, track)
        reach = self.speed * self.horizon + observation.radius + self.space + 1.0
        closest = np.hypot(*np.moveaxis(places - observation.position, -1, 0)).min(axis=(0, 1)) - people.radius
        near = closest < reach
        pace = np.minimum(np.hypot(*people.velocity[near].T) / WALKING, 1.0)
        return places[:, :, near], people.radius[near], weight, pace, people.existence[near]

    def _walls(self, observation: Observation, position: Floats, heading: Floats) -> Floats:
        """Return the cost ``[C]`` of paths ``[C, T, 2]`` with headings ``[C, T]`` in walls or in their margin."""
        segments, here = wall_arrays(observation.walls).segments, observation.position[None]
        reach = self.speed * self.horizon + self.wall_margin
        near = [wall_gaps(here, row[None], observation.radius)[0] < reach for row in segments]
        reached = segments[np.array(near, dtype=np.bool_)]
        gap = robot_wall_gaps(observation, position.reshape(-1, 2), heading.reshape(-1), reached)
        if not math.isfinite(gap[0]):
            return np.zeros(len(position))
        depth = np.maximum(self.wall_margin - gap, 0.0).reshape(position.shape[:2])
        return np.asarray(WALL / observation.radius * (depth.max(axis=1) + depth.mean(axis=1)))

"""Model-predictive control as a navigator: the first twist of the best plan among forecast people."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError, Twist, check_number
from crowdbot.data import Forecast
from crowdbot.navigation.navigator import Navigator
from crowdbot.navigation.observation import Observation
from crowdbot.navigation.wall_arrays import wall_arrays
from crowdbot.typing import Floats

from .clearance import robot_wall_gaps, wall_gaps
from .plan_costs import nearest_people, probability_of, progress_cost, space_lack
from .rollout import roll_out

STEP = 0.2
"""Time step of plans [s]."""
WALKING = 0.5
"""Speed [m/s] from which the uncertainty of a person grows fully."""
WALL = 100.0
"""Cost of a full radius in a wall [s]."""
TIE = 1e-6
"""Difference of probabilities below which plans are equally likely to touch somebody."""


class _People(NamedTuple):
    """Forecast of N people within reach in K futures and T steps."""

    place: Floats
    """``[K, T, N, 2]`` [m]."""
    radius: Floats
    """``[N]`` [m]."""
    existence: Floats
    """``[N]`` probability that a person exists."""
    weight: Floats
    """``[K]`` of the futures of all people together, sums to 1."""
    share: Floats
    """``[K, N]`` of the futures of each person, sums to 1 over K."""
    sigma: Floats
    """``[T, N]`` standard deviation of the clearance without the covariance [m]."""
    covariance: Floats
    """``[K, T, N, 2, 2]`` [m^2] around each future, or ``[K, 0, N, 2, 2]``."""


@dataclass(frozen=True)
class MPCNavigator(Navigator):
    """Simulates a fixed lattice of plans among forecast people, and begins the cheapest one; again at each decision.

    A plan holds a speed and a turn rate for a while, then goes on to the waypoint. The drive follows it within its
    limits. The forecast is that of the predictor of the trial; without one people keep their velocity. The cost of a
    plan, in seconds, is the sum of

    * progress: ``(mean + last remaining path) / speed`` over the horizon,
    * ``risk`` times the sum over people of the probability of contact: the weighted mean over the futures of the
      largest ``Phi(-(gap - margin) / sigma)``, times the probability that the person exists,
    * ``comfort`` times the mean lack of ``space`` to people, as a share, whether they exist or not: otherwise the robot
      would turn aside too late, and stop before somebody who hardly exists,
    * ``smoothness`` times the change of the motion in the first step, as shares of the largest speed and turn rate,
    * the depth in walls and their margin.

    The standard deviation of a clearance is ``sigma = uncertainty + growth t min(1, pace / 0.5 m/s)``. With
    ``mixture``, it is ``sqrt(uncertainty^2 + n' S n)``: S is the covariance around each future of
    :meth:`crowdbot.data.Forecast.mixture`, n the direction from the person to the robot, and the futures are weighted
    for each person. The disc of a contact lies in the half-plane at its edge across n, so this is a bound from above.

    With ``chance`` below 1, a plan whose probability of contact with a person is above ``chance`` is taken only if each
    other plan is above it, too, or touches a wall; then the plan of the least such probability.

    Sources: the half-plane of Zhu, Alonso-Mora 2019, doi:10.1109/LRA.2019.2893494; the sum over the components of a
    mixture of Ren, Ahn, Kamgarpour 2023, doi:10.1109/LCSYS.2022.3186269. Difference: plans of a lattice are tested, no
    optimization problem is solved.

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
        mixture: whether the predictor of the trial gives the uncertainty of the people it predicts.
        chance: largest probability of contact with each person; 1 for any.

    Raises:
        InputError: a number is out of its range; in a decision, ``mixture`` without a predictor or without covariances
            in its forecast.

    >>> from crowdbot.navigation import DriveLimits, VisiblePeople
    >>> person = VisiblePeople(np.array([[3.0, 0.1]]), np.array([[-1.0, 0.0]]), np.array([0.25]))
    >>> meeting = Observation(
    ...     pose=(0.0, 0.0, 0.0), goal=(9.0, 0.0), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.1, people=person
    ... )
    >>> MPCNavigator().act(meeting).turn < 0.0
    True
    """

    always_returns = True

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
    mixture: bool = False
    chance: float = 1.0

    def __post_init__(self) -> None:
        for name, unit in {"speed": "m/s", "horizon": "s", "uncertainty": "m", "space": "m"}.items():
            check_number("MPCNavigator", name, getattr(self, name), unit, exclusive_min=0.0)
        others = {"risk": "s", "margin": "m", "growth": "m/s", "comfort": "s", "smoothness": "s", "wall_margin": "m"}
        for name, unit in others.items():
            check_number("MPCNavigator", name, getattr(self, name), unit, min=0.0)
        check_number("MPCNavigator", "samples", self.samples, min=1, whole=True)
        check_number("MPCNavigator", "chance", self.chance, exclusive_min=0.0, max=1.0)
        if not isinstance(self.mixture, bool):
            raise InputError(f"MPCNavigator: mixture = {self.mixture!r} must be True or False")

    def act(self, observation: Observation) -> Twist:
        steps = max(2, round(self.horizon / STEP))
        rollout = roll_out(observation, self.speed, steps, STEP)
        cost = progress_cost(rollout, min(self.speed, observation.limits.max_speed), self.smoothness)
        near, contact = self._people(observation, rollout.position)
        walls, depth = self._walls(observation, rollout.position, rollout.heading)
        cost += near
        cost += walls
        if self.chance < 1.0:
            above = np.maximum(contact - self.chance, 0.0)
            above[depth > max(self.wall_margin, depth.min())] = math.inf  # no way out through a wall
            cost[above > above.min() + TIE] = math.inf
        return Twist(*rollout.first[int(np.argmin(cost))].tolist())

    def _people(self, observation: Observation, position: Floats) -> tuple[Floats, Floats]:
        """Return the cost ``[C]`` of people near the paths ``[C, T, 2]``, and the largest probability of contact."""
        people = self._forecast(observation, position.shape[1])
        (C, T), N = position.shape[:2], len(people.radius)
        total, contact = np.zeros(C), np.zeros((C, N))
        steep, gap, reach = np.empty((C, N)), np.empty((C, T)), people.radius + observation.radius
        for k, place in enumerate(people.place):
            nearest_people(position, place, reach, self.margin, people.sigma, people.covariance[k], steep, gap)
            contact += people.share[k] * probability_of(steep)
            total += people.weight[k] * (self.comfort * space_lack(gap, self.space).mean(axis=1))
        contact *= people.existence
        return total + self.risk * contact.sum(axis=1), contact.max(axis=1, initial=0.0)

    def _forecast(self, observation: Observation, steps: int) -> _People:
        """Return the people within reach; who stands is expected to stay, so the uncertainty grows with the pace."""
        people = observation.people
        times: Floats = STEP * np.arange(1.0, steps + 1.0)
        places = (people.position + times[:, None, None] * people.velocity)[None]
        weight, share = np.ones(1), np.ones((1, len(people)))
        pace = np.minimum(np.hypot(*people.velocity.T) / WALKING, 1.0)
        spread = np.zeros((1, steps if self.mixture else 0, len(people), 2, 2))
        if self.mixture and (observation.predictor is None or observation.tracks is None):
            raise InputError(
                'MPCNavigator: mixture = True, but the robot has no predictor; add <predictor type="anchor-net"/>'
                ' and tracks="3.2" to it, or leave mixture out'
            )
        if observation.predictor is not None and observation.tracks is not None and len(people):
            forecast = observation.forecast(seconds=self.horizon, samples=self.samples)
            K, column = forecast.samples, {int(id_): k for k, id_ in enumerate(observation.tracks.ids)}
            places, spread = np.repeat(places, K, axis=0), np.repeat(spread, K, axis=0)
            weight = forecast.weight[0] / forecast.weight[0].sum()
            share = np.repeat(weight[:, None], len(people), axis=1)
            at = np.array([column.get(item, -1) for item in people.ids.tolist()])
            known = np.flatnonzero(np.append(forecast.valid[0], False)[at])  # the others keep their velocity
            at, row = at[known], times / forecast.dt
            here = np.broadcast_to(people.position[known], (K, 1, len(known), 2))
            places[:, :, known] = _between(row, here, forecast.position[0][:, :, at])
            if self.mixture:
                own, around = self._mixture(forecast)
                share[:, known], pace[known] = own[:, at], 0.0
                spread[:, :, known] = _between(row, np.zeros_like(around[:, :1, at]), around[:, :, at])
        reach = self.speed * self.horizon + observation.radius + self.space + 1.0
        closest = np.hypot(*np.moveaxis(places - observation.position, -1, 0)).min(axis=(0, 1)) - people.radius
        near = closest < reach
        sigma = self.uncertainty + self.growth * STEP * np.arange(1, steps + 1)[:, None] * pace[near]
        place, covariance = np.ascontiguousarray(places[:, :, near]), np.ascontiguousarray(spread[:, :, near])
        return _People(place, people.radius[near], people.existence[near], weight, share[:, near], sigma, covariance)

    def _mixture(self, forecast: Forecast) -> tuple[Floats, Floats]:
        """Return the weights ``[K, A]`` and covariances ``[K, T, A, 2, 2]`` of a forecast."""
        try:
            mixture = forecast.mixture()
        except InputError as error:
            raise InputError(
                f"MPCNavigator: mixture = True, {error}; take a predictor with covariances, such as anchor-net or"
                " kalman, or leave mixture out"
            ) from None
        return mixture.weight[0], mixture.covariance[0]

    def _walls(self, observation: Observation, position: Floats, heading: Floats) -> tuple[Floats, Floats]:
        """Return the cost and the largest depth [m] of paths ``[C, T, 2]`` in walls or their margin, ``[C]`` each."""
        segments, here = wall_arrays(observation.walls).segments, observation.position[None]
        reach = self.speed * self.horizon + self.wall_margin
        near = [wall_gaps(here, row[None], observation.radius)[0] < reach for row in segments]
        reached = segments[np.array(near, dtype=np.bool_)]
        gap = robot_wall_gaps(observation, position.reshape(-1, 2), heading.reshape(-1), reached)
        if not math.isfinite(gap[0]):
            return np.zeros(len(position)), np.zeros(len(position))
        depth = np.maximum(self.wall_margin - gap, 0.0).reshape(position.shape[:2])
        most = depth.max(axis=1)
        return WALL / observation.radius * (most + depth.mean(axis=1)), most


def _between(row: Floats, first: Floats, later: Floats) -> Floats:
    """Return values ``[K, T, ...]`` at rows, linear between those at row 0 ``[K, 1, ...]`` and at rows 1, 2, ..."""
    known = np.concatenate([first, later], axis=1)
    low = np.minimum(row.astype(np.int64), later.shape[1] - 1)
    part = np.minimum(row - low, 1.0).reshape(-1, *[1] * (known.ndim - 2))
    return np.asarray(known[:, low] + part * (known[:, low + 1] - known[:, low]))

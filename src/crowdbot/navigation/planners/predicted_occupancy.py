"""Navigation among predicted scans: the first twist of the best plan among the returns that the scanner will get."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from crowdbot.core import Pose, Twist, check_number, kernel
from crowdbot.core.outlines import point_to_outline
from crowdbot.navigation.action import Action
from crowdbot.navigation.navigator import Navigator
from crowdbot.navigation.observation import Observation
from crowdbot.sensors import Scan, planar_pose
from crowdbot.typing import Floats

from .plan_costs import contact_probability, progress_cost, space_lack
from .rollout import roll_out

if TYPE_CHECKING:
    from crowdbot.perception import ScanForecast

STEP = 0.2
"""Time step of plans [s]."""
NOTHING = (-math.inf, None)
"""Memory before the first scan: its time, and the state of the predictor."""


@dataclass(frozen=True)
class PredictedOccupancyNavigator(Navigator):
    """Drives among the returns of predicted scans; it knows neither the people nor the walls of the observation.

    :class:`crowdbot.perception.TrackedScene` predicts the scans from the place of the robot now: people found in the
    scans walk on, other surfaces stay. The plans are those of :class:`MPCNavigator`, and so is the progress in their
    cost. To it come, with the clearance to the nearest predicted return at the same time,

    * ``risk`` times the largest probability of contact, ``Phi(-(gap - margin) / (uncertainty + growth t))``, as the
      mean over the futures,
    * ``comfort`` times the mean lack of ``space``, as a share.

    Before the first scan the robot stands.

    Fields:
        speed: largest speed [m/s], limited by the drive.
        horizon: predicted time [s].
        risk: cost of a certain contact [s].
        margin: clearance at which a contact is as likely as not [m].
        uncertainty: standard deviation of the clearance now [m].
        growth: its growth with time [m/s].
        comfort: cost of no clearance during the horizon [s].
        space: clearance that is wanted [m].
        smoothness: cost of a full change of the twist [s].
        samples: predicted futures; further ones are drawn from the uncertainty of the tracks.

    Raises:
        InputError: a number is out of its range.

    >>> PredictedOccupancyNavigator(horizon=2.0).begin(None)
    (-inf, None)
    """

    needs_scan: ClassVar[bool] = True
    always_returns = True

    speed: float = 1.0
    horizon: float = 3.0
    risk: float = 20.0
    margin: float = 0.1
    uncertainty: float = 0.05
    growth: float = 0.02
    comfort: float = 1.0
    space: float = 0.4
    smoothness: float = 0.1
    samples: int = 1

    def __post_init__(self) -> None:
        for name, unit in {"speed": "m/s", "horizon": "s", "uncertainty": "m", "space": "m"}.items():
            check_number("PredictedOccupancyNavigator", name, getattr(self, name), unit, exclusive_min=0.0)
        for name, unit in {"risk": "s", "margin": "m", "growth": "m/s", "comfort": "s", "smoothness": "s"}.items():
            check_number("PredictedOccupancyNavigator", name, getattr(self, name), unit, min=0.0)
        check_number("PredictedOccupancyNavigator", "samples", self.samples, min=1, max=100, whole=True)

    def begin(self, observation: Observation) -> tuple[float, Any]:
        return NOTHING

    def act(self, observation: Observation, memory: tuple[float, Any]) -> tuple[Action, tuple[float, Any]]:
        from crowdbot.perception import TrackedScene

        scanned, state = memory
        scan, predictor = observation.scan, TrackedScene()
        if isinstance(scan, Scan) and float(np.max(scan.time)) > scanned:
            scanned = float(np.max(scan.time))
            state = predictor.update(scan, predictor.begin() if state is None else state)
        if state is None:
            return Action(Twist()), (scanned, state)
        steps = max(2, round(self.horizon / STEP))
        ahead = observation.time - scanned + STEP * np.arange(1.0, steps + 1.0)
        here = planar_pose(state.scans[-1].pose)
        pose = Pose(np.repeat(here.position, steps, axis=0), np.repeat(here.heading, steps))
        forecast = predictor.forecast(state, ahead, pose, self.samples)
        return Action(self._twist(observation, forecast, steps)), (scanned, state)

    def _twist(self, observation: Observation, forecast: ScanForecast, steps: int) -> Twist:
        """Return the first twist of the cheapest plan among the returns of a forecast."""
        rollout = roll_out(observation, self.speed, steps, STEP)
        top = min(self.speed, observation.limits.max_speed)
        cost = progress_cost(rollout, top, self.smoothness)
        reach = top * self.horizon + observation.radius + self.space
        bearing = forecast.pose.heading[0] + forecast.angles
        ray = np.stack([np.cos(bearing), np.sin(bearing)], axis=-1)
        places, origin = np.ascontiguousarray(rollout.position), forecast.pose.position[0]
        sigma: Floats = self.uncertainty + self.growth * STEP * np.arange(1.0, steps + 1.0)
        for ranges, share in zip(forecast.ranges, forecast.weight.tolist(), strict=True):
            gap = _gaps(places, np.ascontiguousarray(ranges), ray, origin, reach) - observation.radius
            if len(observation.outline):
                corner = np.ascontiguousarray(observation.outline)
                turns = np.ascontiguousarray(rollout.heading)
                _outline_gaps(places, turns, np.ascontiguousarray(ranges), ray, origin, reach, corner, gap)
            meets, lack = contact_probability(gap, self.margin, sigma), space_lack(gap, self.space)
            cost += share * (self.risk * meets + self.comfort * lack.mean(axis=1))
        return Twist(*rollout.first[int(np.argmin(cost))].tolist())


@kernel
def _gaps(places: Floats, ranges: Floats, ray: Floats, origin: Floats, reach: float) -> Floats:
    """Return the distance ``[C, T]`` [m] of places ``[C, T, 2]`` to the nearest return at the same time.

    Args:
        places: positions of plans [m].
        ranges: ``[T, R]`` predicted ranges [m].
        ray: ``[R, 2]`` directions of the beams in the world.
        origin: the scanner [m].
        reach: returns farther from the scanner are left out [m].
    """
    C, T = places.shape[:2]
    gap = np.full((C, T), np.inf)
    x, y = np.empty(len(ray)), np.empty(len(ray))
    for t in range(T):
        count = 0
        for r in range(len(ray)):
            if ranges[t, r] <= reach:
                x[count] = origin[0] + ranges[t, r] * ray[r, 0]
                y[count] = origin[1] + ranges[t, r] * ray[r, 1]
                count += 1
        for c in range(C):
            least = np.inf
            for k in range(count):
                least = min(least, (x[k] - places[c, t, 0]) ** 2 + (y[k] - places[c, t, 1]) ** 2)
            gap[c, t] = math.sqrt(least)
    return gap


@kernel
def _outline_gaps(
    places: Floats, turns: Floats, ranges: Floats, ray: Floats, origin: Floats, reach: float, corner: Floats,
    gap: Floats,
) -> None:  # fmt: skip
    """Write the distance ``[C, T]`` [m] of an outline at places with headings ``[C, T]``; see :func:`_gaps`."""
    radius = 0.0
    for k in range(len(corner)):
        radius = max(radius, math.hypot(corner[k, 0], corner[k, 1]))
    gap[:] = np.inf
    for t in range(places.shape[1]):
        for r in range(len(ray)):
            if ranges[t, r] > reach:
                continue
            x, y = origin[0] + ranges[t, r] * ray[r, 0], origin[1] + ranges[t, r] * ray[r, 1]
            for c in range(len(places)):
                dx, dy = x - places[c, t, 0], y - places[c, t, 1]
                far = gap[c, t] + radius
                if dx * dx + dy * dy < far * far:
                    cos, sin = math.cos(turns[c, t]), math.sin(turns[c, t])
                    px, py = cos * dx + sin * dy, cos * dy - sin * dx
                    gap[c, t] = min(gap[c, t], point_to_outline(px, py, corner, 0, len(corner))[0])

"""Model-predictive path integral control as a navigator: the mean of random plans, weighted by their costs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from crowdbot.core import Paper, Twist, check_number, kernel, stream
from crowdbot.navigation.action import Action
from crowdbot.navigation.goal_motion import SLOWING_TIME, STANDING, TURN_GAIN
from crowdbot.navigation.navigator import Navigator
from crowdbot.navigation.observation import Observation
from crowdbot.navigation.wall_arrays import wall_arrays
from crowdbot.typing import Floats

from .clearance import robot_wall_gaps, wall_gaps
from .plan_costs import contact_probability, progress_cost, space_lack
from .rollout import EAGER, FASTEST_TURN, PASSED, PlanMotions

STEP = 0.2
"""Time step of plans [s]."""
KNOT = 4
"""Steps between the independent numbers of the noise, which is linear in between."""
WALKING = 0.5
"""Speed [m/s] from which the uncertainty of a person grows fully."""
WALL = 100.0
"""Cost of a full radius in a wall [s]."""


class _Start(NamedTuple):
    """State and limits of the robot for the kernel."""

    x: float
    y: float
    heading: float
    first: float
    """Forward speed, or velocity x of the world [m/s]."""
    second: float
    """Turn rate [rad/s], or velocity y of the world [m/s]."""
    way_x: float
    way_y: float
    goal_x: float
    goal_y: float
    top: float
    turn_rate: float
    acceleration: float
    turn_acceleration: float


@kernel
def _turn_to(angle: float, rate: float, acceleration: float) -> float:
    """Return the turn rate [rad/s] that turns a robot by an angle without overshoot."""
    size = abs(angle)
    return math.copysign(min(TURN_GAIN * size, rate, math.sqrt(1.6 * acceleration * size)), angle)


@kernel
def _wrapped(angle: float) -> float:
    return angle - 2.0 * math.pi * math.floor(angle / (2.0 * math.pi) + 0.5)


@kernel
def _roll_out(
    start: _Start, holonomic: bool, guided: bool, plans: Floats, step: float, position: Floats, heading: Floats,
    remaining: Floats, change: Floats,
) -> None:  # fmt: skip
    """Move the drive under plans ``[K, T, 2]``, and limit them to what it follows without passing the goal.

    Plans are twists forward, turn, or velocities x, y in the world for a holonomic drive. Those of a ``guided`` robot
    are written here: straight to the waypoint, then to the goal.
    """
    x0, y0, heading0, first0, second0, way_x, way_y, goal_x, goal_y, top, rate, push, spin = start
    beyond = math.sqrt((goal_x - way_x) ** 2 + (goal_y - way_y) ** 2)
    for k in range(len(plans)):
        x, y, angle, a, b, passed = x0, y0, heading0, first0, second0, beyond == 0.0
        for t in range(plans.shape[1]):
            dx, dy = (goal_x - x, goal_y - y) if passed else (way_x - x, way_y - y)
            distance = math.sqrt(dx * dx + dy * dy)
            left = distance if passed else distance + beyond
            slow = min(top, left / SLOWING_TIME, math.sqrt(1.6 * push * left))
            if holonomic:
                if guided:
                    plans[k, t, 0], plans[k, t, 1] = slow * dx / max(distance, 1e-9), slow * dy / max(distance, 1e-9)
                size = math.sqrt(plans[k, t, 0] ** 2 + plans[k, t, 1] ** 2)
                if size > slow:
                    plans[k, t, 0], plans[k, t, 1] = plans[k, t, 0] * slow / size, plans[k, t, 1] * slow / size
                da, db = plans[k, t, 0] - a, plans[k, t, 1] - b
                share = min(1.0, push * step / max(math.sqrt(da * da + db * db), 1e-9))
                a, b = a + share * da, b + share * db
                x, y = x + step * a, y + step * b
                if math.sqrt(a * a + b * b) > STANDING:
                    angle += step * _turn_to(_wrapped(math.atan2(b, a) - angle), rate, spin)
            else:
                if guided:
                    bearing = _wrapped(math.atan2(dy, dx) - angle) if distance > 0.0 else 0.0
                    plans[k, t, 0] = slow * max(0.0, 2.0 * math.cos(bearing) - 1.0)
                    plans[k, t, 1] = _turn_to(bearing, rate, spin)
                plans[k, t, 0] = min(max(plans[k, t, 0], 0.0), slow)
                plans[k, t, 1] = min(max(plans[k, t, 1], -rate), rate)
                a += min(max(plans[k, t, 0] - a, -push * step), push * step)
                b += min(max(plans[k, t, 1] - b, -spin * step), spin * step)
                middle = angle + 0.5 * step * b
                x, y, angle = x + step * a * math.cos(middle), y + step * a * math.sin(middle), angle + step * b
            if t == 0:
                da, db = a - first0, b - second0
                change[k] = math.sqrt(da * da + db * db) / top if holonomic else abs(da) / top + abs(db) / rate
            dx, dy = (goal_x - x, goal_y - y) if passed else (way_x - x, way_y - y)
            distance = math.sqrt(dx * dx + dy * dy)
            remaining[k, t] = distance if passed else distance + beyond
            passed = passed or distance < PASSED
            position[k, t, 0], position[k, t, 1], heading[k, t] = x, y, angle


@dataclass(frozen=True)
class MPPINavigator(Navigator):
    """Model-predictive path integral control: the mean of random plans, weighted by their costs.

    A plan is a twist for each 0.2 s (a velocity in the world for a holonomic drive), which the drive follows within
    its limits, among people at constant velocity. Plan k has the weight ``exp(-cost_k / temperature)``. The costs are
    those of :class:`MPCNavigator`, and so are the meanings of their fields. The navigator begins the mean plan, or the
    cheapest one if that costs less, and keeps it as memory for the next decision.

    Half of the plans vary the last one, half the straight way to the waypoint; both, and a stop, are among them without
    noise. The noise is normal, and linear between independent numbers every 0.8 s. Every plan has a twin with mirrored
    noise of the turn (of the velocity to the left of the robot). The random numbers follow from ``seed`` and the number
    of the decision; the seed of the trial does not change them.

    Fields:
        speed: largest speed [m/s], limited by the drive.
        horizon: simulated time [s].
        rollouts: number of pairs of random plans.
        temperature: cost difference at which a weight is 1/e [s].
        speed_noise: standard deviation of speeds [m/s].
        turn_noise: standard deviation of turn rates [rad/s].
        risk: cost of a certain contact [s].
        margin: clearance at which a contact is as likely as not [m].
        uncertainty: standard deviation of the clearance now [m].
        growth: its growth with time for a person who walks [m/s].
        comfort: cost of no clearance during the horizon [s].
        space: clearance to people that is wanted [m].
        smoothness: cost of a full change of the twist [s].
        wall_margin: clearance to walls that is kept [m].
        seed: seed of the random numbers.

    Source: Williams et al. 2018, doi:10.1109/TRO.2018.2865891, with its ``alpha = 1``, where the control cost vanishes.
    Differences: correlated and mirrored noise, plans around the straight way (Trevisan, Alonso-Mora 2024,
    doi:10.1109/LRA.2024.3397083), and the choice between mean and cheapest plan.

    Raises:
        InputError: a number is out of its range.

    >>> from crowdbot.navigation import DriveLimits, VisiblePeople
    >>> person = VisiblePeople(np.array([[3.0, 0.1]]), np.array([[-1.0, 0.0]]), np.array([0.25]))
    >>> meeting = Observation(
    ...     pose=(0.0, 0.0, 0.0), goal=(9.0, 0.0), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.1, people=person
    ... )
    >>> navigator = MPPINavigator()
    >>> action, plan = navigator.act(meeting, navigator.begin(meeting))
    >>> action.twist.turn < 0.0, plan.shape
    (True, (20, 2))
    """

    paper: ClassVar[Paper] = Paper(
        "Williams, Drews, Goldfain, Rehg, Theodorou",
        2018,
        "Information-theoretic model predictive control: Theory and applications to autonomous driving",
        "IEEE Transactions on Robotics 34(6)",
        "10.1109/TRO.2018.2865891",
    )
    always_returns = True

    speed: float = 1.0
    horizon: float = 4.0
    rollouts: int = 128
    temperature: float = 0.05
    speed_noise: float = 0.3
    turn_noise: float = 0.6
    risk: float = 20.0
    margin: float = 0.05
    uncertainty: float = 0.05
    growth: float = 0.02
    comfort: float = 1.0
    space: float = 0.4
    smoothness: float = 0.1
    wall_margin: float = 0.1
    seed: int = 0

    def __post_init__(self) -> None:
        above = {"speed": "m/s", "horizon": "s", "temperature": "s", "uncertainty": "m", "space": "m"}
        for name, unit in (above | {"speed_noise": "m/s", "turn_noise": "rad/s"}).items():
            check_number("MPPINavigator", name, getattr(self, name), unit, exclusive_min=0.0)
        others = {"risk": "s", "margin": "m", "growth": "m/s", "comfort": "s", "smoothness": "s", "wall_margin": "m"}
        for name, unit in others.items():
            check_number("MPPINavigator", name, getattr(self, name), unit, min=0.0)
        check_number("MPPINavigator", "rollouts", self.rollouts, min=1, whole=True)
        check_number("MPPINavigator", "seed", self.seed, min=0, whole=True)

    def begin(self, observation: Observation) -> Floats:
        # first plan [T, 2]: straight to the waypoint, then to the goal
        return self._guide(observation, max(2, round(self.horizon / STEP)))

    def act(self, observation: Observation, memory: Floats) -> tuple[Action, Floats]:
        plans = self._vary(observation, memory)
        cost = self._cost(observation, plans)
        weight = np.exp((cost.min() - cost) / self.temperature)
        mean = np.tensordot(weight / weight.sum(), plans, axes=1)[None]
        best = int(np.argmin(cost))
        plan = mean[0] if self._cost(observation, mean)[0] <= cost[best] else plans[best]
        times = STEP * np.arange(len(plan))
        later = np.stack([np.interp(times + observation.dt, times, column) for column in plan.T], axis=1)
        return Action(_twist(observation, plan[0])), later

    def _vary(self, observation: Observation, last: Floats) -> Floats:
        """Return the plans ``[K, T, 2]``: those without noise, then pairs around the last one and the straight one."""
        T = len(last)
        knots = np.arange(0, T + KNOT, KNOT)
        rng = stream(self.seed, "mppi", round(observation.time / observation.dt))
        raw = rng.standard_normal((self.rollouts, len(knots), 2))
        before = np.minimum(np.arange(T) // KNOT, len(knots) - 2)
        share = (np.arange(T) / KNOT - before)[None, :, None]
        noise = (1.0 - share) * raw[:, before] + share * raw[:, before + 1]
        noise *= self.speed_noise, self.speed_noise if observation.limits.holonomic else self.turn_noise
        twins = noise * (1.0, -1.0)
        if observation.limits.holonomic:
            cos, sin = math.cos(observation.heading), math.sin(observation.heading)
            rotation = np.array([[cos, sin], [-sin, cos]])
            noise, twins = noise @ rotation, twins @ rotation
        guide = self._guide(observation, T)
        half = np.arange(self.rollouts)[:, None, None] % 2 == 0
        around = np.where(half, last, guide)
        return np.concatenate([guide[None], np.zeros((1, T, 2)), last[None], around + noise, around + twins])

    def _guide(self, observation: Observation, steps: int) -> Floats:
        """Return the plan ``[T, 2]`` straight to the waypoint, then to the goal."""
        plan = np.zeros((1, steps, 2))
        self._roll_out(observation, plan, guided=True)
        return np.asarray(plan[0])

    def _cost(self, observation: Observation, plans: Floats) -> Floats:
        """Return the costs ``[K]`` [s] of plans ``[K, T, 2]``, which are limited to what the drive can do."""
        rollout = self._roll_out(observation, plans)
        cost = progress_cost(rollout, min(self.speed, observation.limits.max_speed), self.smoothness)
        cost += self._people(observation, rollout.position)
        return np.asarray(cost + self._walls(observation, rollout.position, rollout.heading))

    def _roll_out(self, observation: Observation, plans: Floats, guided: bool = False) -> PlanMotions:
        """Return the motion under plans ``[K, T, 2]``, which are limited, or written if they are ``guided``."""
        (K, T), limits = plans.shape[:2], observation.limits
        top = min(self.speed, limits.max_speed)
        twist = observation.twist
        motion = observation.velocity.tolist() if limits.holonomic else [twist.forward, twist.turn]
        numbers = (
            *observation.pose, *motion, *observation.waypoint, *observation.goal, top,
            min(limits.max_turn_rate, FASTEST_TURN), min(limits.max_acceleration, EAGER),
            min(limits.max_turn_acceleration, EAGER),
        )  # fmt: skip
        start = _Start._make(map(float, numbers))
        position, heading, remaining = np.empty((K, T, 2)), np.empty((K, T)), np.empty((K, T))
        change = np.empty(K)
        _roll_out(start, limits.holonomic, guided, plans, STEP, position, heading, remaining, change)
        return PlanMotions(plans[:, 0], position, heading, remaining, change)

    def _people(self, observation: Observation, position: Floats) -> Floats:
        """Return the cost ``[K]`` of people near the paths ``[K, T, 2]``."""
        people, times = observation.people, STEP * np.arange(1, position.shape[1] + 1)[:, None]
        places = people.position + times[..., None] * people.velocity
        away = np.hypot(*np.moveaxis(places - observation.position, -1, 0)).min(axis=0, initial=math.inf)
        near = away - people.radius < self.speed * self.horizon + observation.radius + self.space + 1.0
        pace = np.minimum(np.hypot(*people.velocity[near].T) / WALKING, 1.0)
        between = position[:, :, None] - places[:, near]
        gap = np.sqrt(between[..., 0] ** 2 + between[..., 1] ** 2) - people.radius[near] - observation.radius
        meets = contact_probability(gap, self.margin, self.uncertainty + self.growth * times * pace)
        lack = space_lack(gap, self.space).max(axis=2, initial=0.0)
        return np.asarray(self.risk * (people.existence[near] * meets).sum(axis=1) + self.comfort * lack.mean(axis=1))

    def _walls(self, observation: Observation, position: Floats, heading: Floats) -> Floats:
        """Return the cost ``[K]`` of paths ``[K, T, 2]`` with headings ``[K, T]`` in walls or in their margin."""
        segments, here = wall_arrays(observation.walls).segments, observation.position[None]
        reach = self.speed * self.horizon + self.wall_margin
        near = [wall_gaps(here, row[None], observation.radius)[0] < reach for row in segments]
        reached = segments[np.array(near, dtype=np.bool_)]
        gap = robot_wall_gaps(observation, position.reshape(-1, 2), heading.reshape(-1), reached)
        depth = np.maximum(self.wall_margin - gap, 0.0).reshape(position.shape[:2])
        return np.asarray(WALL / observation.radius * (depth.max(axis=1) + depth.mean(axis=1)))


def _twist(observation: Observation, command: Floats) -> Twist:
    """Return the twist of a command: forward, turn, or a velocity in the world for a holonomic drive."""
    first, second = command.tolist()
    if not observation.limits.holonomic:
        return Twist(first, second)
    size, heading = math.hypot(first, second), observation.heading
    turn = observation.turn_by(_wrapped(math.atan2(second, first) - heading)) if size > STANDING else 0.0
    middle = heading + 0.5 * observation.dt * turn
    cos, sin = math.cos(middle), math.sin(middle)
    return Twist(cos * first + sin * second, turn, cos * second - sin * first)

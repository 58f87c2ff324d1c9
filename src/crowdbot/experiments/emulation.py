"""Emulated people for rehearsals: how they walk, and where they look."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError, check_number, stream
from crowdbot.models import ORCA
from crowdbot.simulation import AvatarOrder, Order, Simulation
from crowdbot.trials import Avatar, Trial
from crowdbot.typing import Floats


def participant_agent(trial: Trial) -> tuple[Avatar, int]:
    """Return the avatar of the participant, the first ``external`` one, and the index of its agent.

    Agents come in the order of agents, spawners, avatars, recorded people, robots.

    Raises:
        InputError: the trial has no such avatar, or no robot.
    """
    chosen = [k for k, avatar in enumerate(trial.avatars) if avatar.source == "external"]
    if not chosen or not trial.robots:
        raise InputError(
            f"trial {trial.name!r} has {len(chosen)} avatars with the source 'external' and {len(trial.robots)} "
            "robots; at least one of each is needed"
        )
    first = len(trial.agents) + sum(spawner.count for spawner in trial.spawners)
    return trial.avatars[chosen[0]], first + chosen[0]


EYE_HEIGHT = 1.58
"""Height of the eyes [m]."""
FORWARD = 0.1
"""Distance from the axis of the body to the eyes [m]."""
FARTHEST_TURN = math.radians(60.0)
"""Largest turn of the head against the trunk [rad]."""
TURN_RATE = math.radians(150.0)
"""Speed of a turn of the head [rad/s]."""
CHEST = 1.0
"""Height at which the person looks [m]."""


class EmulatedGlances:
    """Turns the head to a robot and back, for times from exponential distributions.

    The numbers are assumptions for rehearsals, not measurements.

    Args:
        step: time step [s].
        seed: seed.
        name: name of the trial; each has its own glances.
        at_robot, ahead: mean times of looking at the robot and ahead [s].

    >>> head = EmulatedGlances(0.1, 1, "walk").pose((0.0, 0.0), 0.0, (3.0, 0.0))
    >>> [round(value, 2) for value in head[:3]]
    [0.1, 0.0, 1.58]
    """

    def __init__(self, step: float, seed: int, name: str, at_robot: float = 1.0, ahead: float = 1.0) -> None:
        self._rng, self._step = stream(seed, "glances", name), step
        self._means = {True: at_robot, False: ahead}
        self._at_robot = bool(self._rng.random() < at_robot / (at_robot + ahead))
        self._left = float(self._rng.exponential(self._means[self._at_robot]))
        self._yaw = 0.0

    def pose(
        self, place: tuple[float, float], heading: float, robot: tuple[float, float]
    ) -> tuple[float, float, float, float, float, float, float]:
        """Advance one step and return x, y, z [m] and the quaternion w, x, y, z of the head.

        Args:
            place, heading: of the trunk [m], [rad].
            robot: place of the robot [m].
        """
        self._left -= self._step
        if self._left <= 0.0:
            self._at_robot = not self._at_robot
            self._left = float(self._rng.exponential(self._means[self._at_robot]))
        away = robot[0] - place[0], robot[1] - place[1]
        bearing = math.remainder(math.atan2(away[1], away[0]) - heading, 2.0 * math.pi)
        wish = max(-FARTHEST_TURN, min(FARTHEST_TURN, bearing)) if self._at_robot else 0.0
        most = TURN_RATE * self._step
        self._yaw += max(-most, min(most, wish - self._yaw))
        down = math.atan2(EYE_HEIGHT - CHEST, max(math.hypot(*away), 0.5)) if self._at_robot else 0.0
        yaw = heading + self._yaw
        cos_yaw, sin_yaw = math.cos(0.5 * yaw), math.sin(0.5 * yaw)
        cos_down, sin_down = math.cos(0.5 * down), math.sin(0.5 * down)
        x, y = place[0] + FORWARD * math.cos(heading), place[1] + FORWARD * math.sin(heading)
        turn = (cos_yaw * cos_down, -sin_yaw * sin_down, cos_yaw * sin_down, sin_yaw * cos_down)
        return (x, y, EYE_HEIGHT, *turn)


WANDER_TIME = 2.0
"""Correlation time [s]."""


class EmulatedWander:
    """A stationary Ornstein-Uhlenbeck process with a correlation time of 2 s.

    Args:
        spread: standard deviation [m].
        step: time step [s].
        seed: seed.
        name: name of the trial; each has its own deviations.

    >>> EmulatedWander(0.0, 0.1, 1, "walk").step()
    0.0
    """

    def __init__(self, spread: float, step: float, seed: int, name: str) -> None:
        self._rng = stream(seed, "wander", name)
        self._keep = math.exp(-step / WANDER_TIME)
        self._fresh = spread * math.sqrt(1.0 - self._keep * self._keep)
        self._value = 0.0

    def step(self) -> float:
        """Advance one step and return the deviation [m]."""
        self._value = self._keep * self._value + self._fresh * float(self._rng.standard_normal())
        return self._value


ACCELERATION = 1.5
"""Largest change of the velocity [m/s2]."""
STOP = 0.3
"""Time in which the person stops at the end of the way [s]."""


@dataclass(frozen=True, kw_only=True)
class EmulatedPedestrian:
    """Walks in the heading of the first ``external`` avatar and avoids people, robots and walls with ORCA.

    Fields:
        speed: walking speed [m/s].
        way: length of the way [m].
        horizon: time within which the person avoids others [s].
        start: time at which the person sets off [s].
        margin: distance that the person keeps to others, if there is room [m].
        seed: seed of the glances.

    Raises:
        InputError: a number is out of its range.

    >>> EmulatedPedestrian.draw(3) == EmulatedPedestrian.draw(3)
    True
    """

    speed: float = 1.2
    way: float = 8.0
    horizon: float = 2.0
    start: float = 0.3
    margin: float = 0.15
    seed: int = 0

    def __post_init__(self) -> None:
        name = type(self).__name__
        check_number(name, "speed", self.speed, "m/s", exclusive_min=0.0, max=3.0)
        check_number(name, "way", self.way, "m", exclusive_min=0.0)
        check_number(name, "horizon", self.horizon, "s", exclusive_min=0.0)
        check_number(name, "start", self.start, "s", min=0.0)
        check_number(name, "margin", self.margin, "m", min=0.0)

    @classmethod
    def draw(cls, participant: int, seed: int = 0) -> EmulatedPedestrian:
        """Return a participant whose speed, horizon and start are drawn by number and seed.

        The spreads are assumptions for rehearsals, not measurements.
        """
        rng = stream(seed, "emulated pedestrian", participant)
        return cls(
            speed=float(np.clip(rng.normal(1.2, 0.12), 0.8, 1.6)),
            horizon=float(np.clip(rng.normal(2.0, 0.4), 1.0, 3.5)),
            start=float(np.clip(rng.normal(0.4, 0.15), 0.1, 1.0)),
            margin=float(np.clip(rng.normal(0.15, 0.05), 0.02, 0.4)),
            seed=int(rng.integers(2**31)),
        )

    def source(self, trial: Trial) -> PedestrianWalk:
        """Return the source of the orders of a run of the trial.

        Raises:
            InputError: the trial has no robot, or no avatar with the source ``external``.
        """
        return PedestrianWalk(self, trial)


class PedestrianWalk:
    """The walk of an emulated pedestrian in one run: a source of avatar orders."""

    def __init__(self, person: EmulatedPedestrian, trial: Trial) -> None:
        self._avatar, self._agent = participant_agent(trial)
        self._person, self._step, self._robot = person, trial.step, trial.robots[0].name
        self._glances = EmulatedGlances(trial.step, person.seed, trial.name)
        self._model = ORCA(time_horizon=person.horizon)
        assert self._avatar.x is not None
        assert self._avatar.y is not None
        self._place = np.array([self._avatar.x, self._avatar.y])
        self._ahead = np.array([math.cos(self._avatar.heading), math.sin(self._avatar.heading)])
        self._goal = self._place + person.way * self._ahead
        self._velocity, self._heading = np.zeros(2), self._avatar.heading

    def orders(self, simulation: Simulation) -> list[Order]:
        """Return the pose of the person at the next step."""
        now = simulation.tick * self._step
        wish = self._wish(simulation) if now >= self._person.start else np.zeros(2)
        change = wish - self._velocity
        most, size = ACCELERATION * self._step, float(np.hypot(*change))
        self._velocity = self._velocity + change * min(1.0, most / max(size, 1e-12))
        self._place = self._place + self._velocity * self._step
        self._turn()
        robot = simulation.world.scene.position[0, simulation.agent_of(self._robot)].tolist()
        x, y = self._place.tolist()
        head = self._glances.pose((x, y), self._heading, (robot[0], robot[1]))
        time = (simulation.tick + 1) * self._step
        return [AvatarOrder(avatar=self._avatar.name, time=time, x=x, y=y, heading=self._heading, head=head)]

    def _wish(self, simulation: Simulation) -> Floats:
        """Return the velocity that ORCA chooses for the person, who alone is moved by it [m/s]."""
        scene, k = simulation.world.environment_scene(0), self._agent
        away = self._goal - self._place
        left = float(np.hypot(*away))
        preferred = scene.velocity.copy()
        preferred[0, k] = away / max(left, 1e-9) * min(self._person.speed, left / STOP)
        place, velocity, others = scene.position.copy(), scene.velocity.copy(), np.ones_like(scene.external)
        place[0, k], velocity[0, k], others[0, k] = self._place, self._velocity, False
        top, radius = scene.max_speed.copy(), scene.radius.copy()
        top[0, k], radius[0, k] = 1.2 * self._person.speed, radius[0, k] + self._person.margin
        known = dataclasses.replace(
            scene,
            position=place,
            velocity=velocity,
            external=others,
            preferred_velocity=preferred,
            max_speed=top,
            radius=radius,
            memory={},
            bodies=None,
        )
        return np.asarray(self._model.velocity(known, self._step)[0, k])

    def _turn(self) -> None:
        """Turn the trunk towards the motion, at most 90 degrees a second."""
        if float(np.hypot(*self._velocity)) > 0.2:
            gap = math.remainder(math.atan2(self._velocity[1], self._velocity[0]) - self._heading, 2.0 * math.pi)
            most = 0.5 * math.pi * self._step
            self._heading += max(-most, min(most, gap))

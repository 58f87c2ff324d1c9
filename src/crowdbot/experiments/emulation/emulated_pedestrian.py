"""EmulatedPedestrian: a program that walks straight ahead in the place of a participant, and avoids others."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np

from crowdbot.core import check_number, stream
from crowdbot.models import ORCA
from crowdbot.simulation import AvatarOrder, Order, Simulation
from crowdbot.trials import Trial
from crowdbot.typing import Floats

from .emulated_glances import EmulatedGlances
from .participant_agent import participant_agent

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

"""EmulatedParticipant: a program that takes the place of the participant in a leader-follower trial."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError, check_number, stream
from crowdbot.experiments.emulation import EmulatedGlances, EmulatedWander
from crowdbot.simulation import AvatarOrder, Order, Simulation
from crowdbot.trials import Trial
from crowdbot.typing import Floats

from .leading import roles_of


@dataclass(frozen=True, kw_only=True)
class EmulatedParticipant:
    """Walks in the place of a participant, so that an experiment can be rehearsed without one.

    As a follower, the person repeats the motion of the robot ``delay`` seconds later with ``gain``; as a leader, the
    person goes to and fro as a sinusoid. In both roles the person wanders about the intended place. With known gain and
    delay, the analysis of an experiment can be checked.

    Fields:
        gain: motion of the follower in relation to that of the robot.
        delay: delay of the follower [s].
        wander: standard deviation about the intended place [m].
        amplitude: half of the way of the leader [m].
        period: time of the leader to and fro [s].
        cycles: number of periods of the leader.
        seed: seed of the wander.

    Raises:
        InputError: a number is out of its range.

    >>> EmulatedParticipant.draw(3, seed=1) == EmulatedParticipant.draw(3, seed=1)
    True
    """

    gain: float = 0.95
    delay: float = 0.35
    wander: float = 0.02
    amplitude: float = 0.4
    period: float = 8.0
    cycles: int = 6
    seed: int = 0

    def __post_init__(self) -> None:
        name = type(self).__name__
        check_number(name, "gain", self.gain, "", min=0.0)
        check_number(name, "delay", self.delay, "s", min=0.0)
        check_number(name, "wander", self.wander, "m", min=0.0)
        check_number(name, "amplitude", self.amplitude, "m", exclusive_min=0.0)
        check_number(name, "period", self.period, "s", exclusive_min=0.0)
        check_number(name, "cycles", self.cycles, "", min=1)

    @classmethod
    def draw(cls, participant: int, seed: int = 0) -> EmulatedParticipant:
        """Return a participant with gain, delay and leading motion drawn by number and seed.

        The spreads are assumptions for rehearsals, not measurements.
        """
        rng = stream(seed, "emulated participant", participant)
        return cls(
            gain=float(np.clip(rng.normal(0.95, 0.05), 0.7, 1.2)),
            delay=float(np.clip(rng.normal(0.35, 0.08), 0.1, 0.8)),
            amplitude=float(np.clip(rng.normal(0.4, 0.03), 0.3, 0.5)),
            period=float(np.clip(rng.normal(8.0, 0.4), 7.0, 9.0)),
            seed=int(rng.integers(2**31)),
        )

    def source(self, trial: Trial) -> EmulatedWalk:
        """Return the source of the orders of a run of the trial.

        Raises:
            InputError: it is not a leader-follower trial, or its avatar is not ``external``.
        """
        return EmulatedWalk(self, trial)


class EmulatedWalk:
    """The walk of an emulated participant in one run: a source of avatar orders."""

    def __init__(self, person: EmulatedParticipant, trial: Trial) -> None:
        roles = roles_of(trial)
        avatar = roles.participant
        if avatar.source != "external":
            raise InputError(
                f"trial {trial.name!r}: the avatar {avatar.name!r} has the source {avatar.source!r}; only an avatar "
                "with the source 'external' can be driven"
            )
        assert avatar.x is not None
        assert avatar.y is not None
        self._person, self._step, self._roles = person, trial.step, roles
        self._start = np.array([avatar.x, avatar.y])
        self._forward = np.array([math.cos(avatar.heading), math.sin(avatar.heading)])
        self._wander = EmulatedWander(person.wander, trial.step, person.seed, trial.name)
        self._glances = EmulatedGlances(trial.step, person.seed, trial.name, at_robot=3.0)
        self._seen: deque[float] = deque(maxlen=max(1, round(person.delay / trial.step)))
        self._first: Floats | None = None

    def orders(self, simulation: Simulation) -> list[Order]:
        """Return the pose of the person at the next step."""
        avatar, time = self._roles.participant, (simulation.tick + 1) * self._step
        way = (self._followed(simulation) if self._roles.robot_leads else self._led(time)) + self._wander.step()
        x, y = (self._start + way * self._forward).tolist()
        robot = simulation.world.scene.position[0, simulation.agent_of(self._roles.robot.name)].tolist()
        head = self._glances.pose((x, y), avatar.heading, (robot[0], robot[1]))
        return [AvatarOrder(avatar=avatar.name, time=time, x=x, y=y, heading=avatar.heading, head=head)]

    def _led(self, time: float) -> float:
        """Return the displacement of a leader [m]."""
        person = self._person
        angle = 2.0 * math.pi * min(time / person.period, person.cycles)
        return person.amplitude * (1.0 - math.cos(angle))

    def _followed(self, simulation: Simulation) -> float:
        """Return the displacement of a follower [m]: that of the robot before the delay, times the gain."""
        place = simulation.world.scene.position[0, simulation.agent_of(self._roles.robot.name)]
        if self._first is None:
            self._first = place.copy()
        self._seen.append(float((place - self._first) @ self._forward))
        return self._person.gain * (self._seen[0] if len(self._seen) == self._seen.maxlen else 0.0)

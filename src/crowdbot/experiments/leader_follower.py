"""The study of leaders and followers: coordination in each trial, and an emulated participant."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np

from crowdbot.core import InputError, check_number, stream
from crowdbot.metrics import coordination
from crowdbot.navigation import FollowerNavigator, SinusoidNavigator
from crowdbot.simulation import AvatarOrder, Order, Simulation
from crowdbot.trials import Avatar, RobotSpec, Trial
from crowdbot.typing import Floats

from .comparison import COLORS, EmulatedPerson, Measure, RecordedTrial, Study, TrialMeasures, read_trial_latency
from .emulation import EmulatedGlances, EmulatedWander

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Roles(NamedTuple):
    """The two of a trial, and whether the robot leads."""

    robot: RobotSpec
    participant: Avatar
    robot_leads: bool

    @property
    def leader(self) -> str:
        """``robot`` or ``participant``."""
        return "robot" if self.robot_leads else "participant"


def roles_of(trial: Trial) -> Roles:
    """Return the robot and the participant of a trial, and who leads.

    The robot leads if its navigator is ``sinusoid`` and follows if it is ``follower``.

    Raises:
        InputError: the trial does not have one robot with such a navigator and one avatar.
    """
    if len(trial.robots) != 1 or len(trial.avatars) != 1:
        raise InputError(
            f"trial {trial.name!r} has {len(trial.robots)} robots and {len(trial.avatars)} avatars; a leader-follower "
            "trial has one of each"
        )
    robot = trial.robots[0]
    if not isinstance(robot.navigator, SinusoidNavigator | FollowerNavigator):
        raise InputError(
            f"trial {trial.name!r}: the navigator of the robot {robot.name!r} is neither 'sinusoid' (it leads) nor "
            "'follower' (it follows)"
        )
    return Roles(robot, trial.avatars[0], isinstance(robot.navigator, SinusoidNavigator))


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


class LeaderFollowerStudy(Study):
    """A robot or the participant leads, the other one keeps the distance.

    In virtual reality a participant sees the robot as late as the latency of the picture, and is seen as late as that
    of the motion. ``own_lag`` is the lag without the medians of both.

    >>> LeaderFollowerStudy().measures["lag"].title
    'lag of the follower [s]'
    """

    name: ClassVar[str] = "leader-follower"
    title: ClassVar[str] = "Leader and follower"
    about: ClassVar[str] = "Displacements along the line of the two, in the first trial of each condition."
    measures: ClassVar[Mapping[str, Measure]] = MappingProxyType(
        {
            "distance": Measure("mean distance [m]", 0.1),
            "distance_sd": Measure("standard deviation of the distance [m]", 0.05),
            "lag": Measure("lag of the follower [s]", 0.1),
            "own_lag": Measure("lag of a following participant without latency of motion and picture [s]", 0.1),
            "gain": Measure("gain at the frequency of the leader [1]", 0.1),
            "phase": Measure("phase at the frequency of the leader [rad]", 0.1),
        }
    )

    def evaluate(self, recorded: RecordedTrial) -> tuple[dict[str, float], dict[str, str], dict[str, Floats]]:
        """Return the coordination of the two; the avatar is the last person before the robots.

        Raises:
            InputError: it is not a leader-follower trial, or the leader does not move.
        """
        episode, roles = recorded.episode, roles_of(recorded.trial)
        late = episode.times >= recorded.settling
        robot = episode.position[late, episode.robots[0]]
        person = episode.position[late, episode.robots[0] - 1]
        times = episode.times[late]
        leader, follower = (robot, person) if roles.robot_leads else (person, robot)
        found = coordination(times, leader, times, follower)
        values = {k: float(v) for k, v in found._asdict().items()} | _own_lag(recorded, roles, found.lag)
        axis = follower.mean(axis=0) - leader.mean(axis=0)
        axis /= max(float(np.hypot(*axis)), 1e-9)
        leading, following = ((track - track.mean(axis=0)) @ axis for track in (leader, follower))
        curves = {"times": times, "leading": leading, "following": following}
        return values, {"leader": roles.leader}, curves

    def draw(self, trials: Sequence[TrialMeasures]) -> Figure:
        import matplotlib.pyplot as plt

        first = {trial.condition: trial for trial in reversed(trials)}
        shown = [first[name] for name in dict.fromkeys(trial.condition for trial in trials)]
        figure, axes = plt.subplots(len(shown), 1, figsize=(9.0, 1.9 * len(shown)), sharex=True, squeeze=False)
        for axis, trial in zip(axes[:, 0], shown, strict=True):
            times, leading, following = (trial.curves[name] for name in ("times", "leading", "following"))
            axis.plot(times, leading, color=COLORS[0], label=f"leader ({trial.labels['leader']})")
            axis.plot(times, following, color=COLORS[1], linestyle="--", label="follower")
            axis.set_title(f"{trial.condition}, participant {trial.participant}", fontsize=9, loc="left")
            axis.set_ylabel("displacement [m]", fontsize=8)
            axis.legend(fontsize=7, loc="upper right", ncols=2)
        axes[-1, 0].set_xlabel("time [s]")
        figure.tight_layout()
        return figure

    def participant(self, number: int) -> EmulatedPerson:
        return EmulatedParticipant.draw(number)


def _own_lag(recorded: RecordedTrial, roles: Roles, lag: float) -> dict[str, float]:
    """Return the lag without measured latencies, if the participant follows and they are known."""
    latency = read_trial_latency(recorded.folder, roles.participant)
    if not roles.robot_leads or latency.motion is None or latency.picture is None:
        return {}
    return {"own_lag": lag - latency.motion - latency.picture}

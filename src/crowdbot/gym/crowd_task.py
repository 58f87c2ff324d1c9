"""The task of a learning robot in a trial, and its reward."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CrowdbotError, InputError
from crowdbot.navigation import DriveLimits
from crowdbot.simulation import Simulation
from crowdbot.trials import Trial
from crowdbot.typing import Bools, Floats, Ints

from .robot_port import RobotPort, free_robots
from .spaces import ActionForm, ObservationForm


@dataclass(frozen=True)
class Reward:
    """Terms of the reward of one control step.

    The defaults are those of CrowdNav with two changes: a reward of progress, since proximal policy optimisation learns
    to stand still from CrowdNav's own, and a collision that costs as much as the progress of 10 m.

    * Progress is shaping by the potential ``-progress * distance to the goal``: over an episode, its sum is
      ``progress * (distance at the start - distance at the end)``, whatever the path, and 0 for a robot that stands.
      Without a discount, all paths to the goal get the same sum, up to the tolerance of the goal.
    * With CrowdNav's -0.25, a collision close to the goal would be better than standing. Long et al. have 15 for an
      arrival, -15 for a collision and 2.5 per metre of progress: -1 and 1/6 for an arrival of 1.

    Sources: Chen et al. 2019, Crowd-Robot Interaction, https://arxiv.org/abs/1809.08835 (success 1, collision -0.25,
    discomfort); Ng, Harada and Russell 1999, Policy invariance under reward transformations, ICML (shaping); Long et
    al. 2018, https://arxiv.org/abs/1709.10082 (collision, progress).

    Fields:
        success, collision: added at the end of an episode.
        discomfort_distance: clearance [m] below which people feel discomfort.
        discomfort: factor [1/(m s)] of the missing clearance and the time.
        progress: factor [1/m] of the distance to the goal that the robot has gained.

    >>> arguments = np.array([0.1]), np.zeros(1, bool), np.zeros(1, bool), np.array([0.2]), 0.25
    >>> Reward().values(*arguments).round(4).tolist()
    [0.0075]
    >>> Reward(collision=-0.25, progress=0.0).values(*arguments).round(4).tolist()  # as CrowdNav
    [-0.0125]
    """

    success: float = 1.0
    collision: float = -1.0
    discomfort_distance: float = 0.2
    discomfort: float = 0.5
    progress: float = 0.1

    def values(self, clearance: Floats, success: Bools, collision: Bools, gain: Floats, dt: float) -> Floats:
        """Return the rewards ``[N]`` of a step.

        Args:
            clearance: ``[N]`` clearance to the nearest person [m].
            success, collision: ``[N]`` whether the episode has ended so.
            gain: ``[N]`` distance to the goal gained [m].
            dt: duration of the step [s].
        """
        missing = np.maximum(0.0, self.discomfort_distance - np.maximum(clearance, 0.0))
        near = np.where(success | collision, 0.0, -self.discomfort * missing * dt)
        return self.success * success + self.collision * collision + near + self.progress * gain


Arrays = dict[str, NDArray[np.float32]]


class TaskStep(NamedTuple):
    """Result of one control step in E environments.

    Fields:
        observations: arrays ``[E, ...]`` by name.
        rewards: ``[E]``.
        terminated: ``[E]`` success or collision.
        truncated: ``[E]`` the time is over.
        outcomes: outcome of each environment that has ended, otherwise empty.
    """

    observations: Arrays
    rewards: Floats
    terminated: Bools
    truncated: Bools
    outcomes: tuple[str, ...]


@dataclass
class CrowdTask:
    """A robot of a trial that takes actions in E environments, each with its own seed.

    The control period is that of the robot. The trajectory of an environment depends only on its seed and its actions.

    Args:
        trial: the trial; its robot may have any navigator, which does not decide.
        observation, action, reward: forms of observations, actions and rewards.
        robot: name of the robot (default: the first).
        posed: whether body poses are computed for rendering.

    Raises:
        InputError: the trial has no such robot, no scanner for a scan, or a drive without limits.

    >>> from crowdbot.trials import load_trial
    >>> task = CrowdTask(load_trial("circle-crossing"))
    >>> observations = task.reset([1, 2])
    >>> step = task.step(np.array([[1.0, 0.0], [0.0, 0.0]]))
    >>> observations["people"].shape, step.truncated.tolist()
    ((2, 10, 7), [False, False])
    """

    trial: Trial
    observation: ObservationForm = dataclasses.field(default_factory=ObservationForm)
    action: ActionForm = dataclasses.field(default_factory=ActionForm)
    reward: Reward = dataclasses.field(default_factory=Reward)
    robot: str = ""
    posed: bool = False
    simulation: Simulation | None = dataclasses.field(default=None, init=False, repr=False)

    def __post_init__(self) -> None:
        names = [robot.name for robot in self.trial.robots]
        if not names:
            raise InputError(f"trial {self.trial.name!r} has no robot")
        self.robot = self.robot or names[0]
        self.port = RobotPort(self.trial, self.robot, self.observation, self.action)
        self.trial = free_robots(self.trial, [self.robot])
        self.ended = np.ones(0, dtype=np.bool_)
        self._distance = np.zeros(0)

    @property
    def beams(self) -> int:
        """Number of ranges of a scan; 0 without a scanner."""
        return self.port.beams

    @property
    def longest(self) -> float:
        """Longest range of the scanner [m]; 0 without one."""
        return self.port.longest

    @property
    def dt(self) -> float:
        """Duration of a control step [s]."""
        return self.port.dt

    @property
    def limits(self) -> DriveLimits:
        """Limits of the drive."""
        return self.port.limits

    @property
    def count(self) -> int:
        """Number of environments."""
        return self._running.count

    @property
    def seeds(self) -> list[int]:
        """Seed of each environment."""
        return list(self._running.seeds)

    @property
    def _running(self) -> Simulation:
        if self.simulation is None:
            raise InputError("call reset before anything else")
        return self.simulation

    def reset(self, seeds: Sequence[int]) -> Arrays:
        """Begin with one environment for each seed, and return the observations.

        Raises:
            TrialError: people cannot be placed with a seed.
        """
        self.simulation = Simulation(self.trial, [int(seed) for seed in seeds], posed=self.posed)
        self.simulation.begin()
        self.port.attach(self.simulation)
        self.ended = np.zeros(self.count, dtype=np.bool_)
        self._distance = self.port.goal_distance()
        return self.port.observe()

    def restart(self, environments: Sequence[int] | Ints, seeds: Sequence[int]) -> Arrays:
        """Begin some environments anew with other seeds, and return the observations of all."""
        index = np.asarray(environments, dtype=np.int64)
        self._running.restart(index, [int(seed) for seed in seeds])
        self.ended[index] = False
        self.port.clear_scans(index)
        self._distance[index] = self.port.goal_distance()[index]
        return self.port.observe()

    def step(self, actions: Floats) -> TaskStep:
        """Take one action ``[E, 2]`` in each environment until the next control step.

        Environments that have ended are not counted again until they are restarted.

        Raises:
            InputError: the actions have another shape or are not finite.
            CrowdbotError: an exception in a model or a sensor.
        """
        running = self._running
        twists = self.port.twists(np.asarray(actions, dtype=np.float64))
        for _ in range(self.port.ticks):
            self.port.order(twists)
            running.advance()
            self.port.keep_scans()
        if running.failed.any():
            e = int(np.flatnonzero(running.failed)[0])
            raise CrowdbotError(f"environment {e}, seed {running.seeds[e]}: {running.failures[e]}")
        return self._judge()

    def _judge(self) -> TaskStep:
        running = self._running
        outcomes = [""] * self.count
        for e in np.flatnonzero(running.may_end() & ~self.ended).tolist():
            outcomes[e] = running.outcome(e) or ""
        success, collision = (np.array([outcome == name for outcome in outcomes]) for name in ("success", "collision"))
        over = np.array([outcome != "" for outcome in outcomes])
        distance = self.port.goal_distance()
        rewards = self.reward.values(self.port.clearance(), success, collision, self._distance - distance, self.dt)
        rewards[self.ended] = 0.0
        self._distance = distance
        self.ended |= over
        terminated = success | collision | np.array([outcome == "fall" for outcome in outcomes])
        return TaskStep(self.port.observe(), rewards, terminated, over & ~terminated, tuple(outcomes))

"""CrowdTask: a trial in E environments whose robot takes actions, without any interface of a library."""

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

from .action_form import ActionForm
from .observation_form import ObservationForm
from .reward import Reward
from .robot_port import RobotPort, free_robots

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
        success, collision = (np.array([one == name for one in outcomes]) for name in ("success", "collision"))
        over = np.array([one != "" for one in outcomes])
        distance = self.port.goal_distance()
        rewards = self.reward.values(self.port.clearance(), success, collision, self._distance - distance, self.dt)
        rewards[self.ended] = 0.0
        self._distance = distance
        self.ended |= over
        terminated = success | collision | np.array([one == "fall" for one in outcomes])
        return TaskStep(self.port.observe(), rewards, terminated, over & ~terminated, tuple(outcomes))

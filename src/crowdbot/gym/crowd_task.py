"""CrowdTask: a trial in E environments whose robot takes actions, without any interface of a library."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CrowdbotError, InputError
from crowdbot.navigation import DriveLimits, ExternalNavigator
from crowdbot.sensors import Lidar2D, Scan
from crowdbot.simulation import Simulation
from crowdbot.trials import Trial

from .action_form import ActionForm
from .observation_form import ObservationForm
from .reward import Reward

__all__ = ["CrowdTask", "TaskStep"]

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]
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
    simulation: Simulation | None = dataclasses.field(default=None, init=False, repr=False)

    def __post_init__(self) -> None:
        names = [robot.name for robot in self.trial.robots]
        if not names:
            raise InputError(f"trial {self.trial.name!r} has no robot")
        self.robot = self.robot or names[0]
        if self.robot not in names:
            raise InputError(f"trial {self.trial.name!r} has no robot {self.robot!r}; it has {', '.join(names)}")
        self.index = names.index(self.robot)
        spec = self.trial.robots[self.index]
        period = spec.control_period
        free = dataclasses.replace(spec, navigator=ExternalNavigator(timeout=math.ceil(2.0 * period) + 1.0))
        robots = tuple(free if k == self.index else one for k, one in enumerate(self.trial.robots))
        self.trial = dataclasses.replace(self.trial, robots=robots)
        self.ticks = max(1, round(period / self.trial.step))
        if not math.isclose(self.ticks * self.trial.step, period, rel_tol=1e-6):
            raise InputError(
                f"robot {self.robot!r}: the control period {period:g} s must be a multiple of the step"
                f" {self.trial.step:g} s"
            )
        mounts = [mount for mount in spec.sensors if isinstance(mount.sensor, Lidar2D)]
        self.scanner = mounts[0] if mounts else None
        if self.observation.with_scan and self.scanner is None:
            raise InputError(f"robot {self.robot!r} has no laser scanner for observation = {self.observation.form!r}")
        self.ended = np.ones(0, dtype=np.bool_)
        self._distance = np.zeros(0)
        self._scan = np.zeros((0, self.beams))

    @property
    def beams(self) -> int:
        """Number of ranges of a scan; 0 without a scanner."""
        return self.scanner.sensor.rays if self.scanner and isinstance(self.scanner.sensor, Lidar2D) else 0

    @property
    def longest(self) -> float:
        """Longest range of the scanner [m]; 0 without one."""
        return self.scanner.sensor.range_max if self.scanner and isinstance(self.scanner.sensor, Lidar2D) else 0.0

    @property
    def dt(self) -> float:
        """Duration of a control step [s]."""
        return self.ticks * self.trial.step

    @property
    def limits(self) -> DriveLimits:
        """Limits of the drive."""
        return self._running.robots[self.index].limits

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
        self.simulation = Simulation(self.trial, [int(seed) for seed in seeds])
        self.action.check(self.limits)
        self.simulation.begin()
        self.ended = np.zeros(self.count, dtype=np.bool_)
        self._scan = np.full((self.count, self.beams), self.longest)
        self._distance = self._goal_distance()
        self._keep_scans()
        return self._observe()

    def restart(self, environments: Sequence[int] | Ints, seeds: Sequence[int]) -> Arrays:
        """Begin some environments anew with other seeds, and return the observations of all."""
        index = np.asarray(environments, dtype=np.int64)
        self._running.restart(index, [int(seed) for seed in seeds])
        self.ended[index] = False
        self._scan[index] = self.longest
        self._distance[index] = self._goal_distance()[index]
        self._keep_scans()
        return self._observe()

    def step(self, actions: Floats) -> TaskStep:
        """Take one action ``[E, 2]`` in each environment until the next control step.

        Environments that have ended are not counted again until they are restarted.

        Raises:
            InputError: the actions have another shape or are not finite.
            CrowdbotError: an exception in a model or a sensor.
        """
        running, actions = self._running, np.asarray(actions, dtype=np.float64)
        if actions.shape != (self.count, 2):
            raise InputError(f"actions have the shape {actions.shape}, expected {(self.count, 2)}")
        if not np.isfinite(actions).all():
            raise InputError("actions must be finite")
        control, twists = running.robots[self.index], self.action.twists(actions, self.limits)
        for _ in range(self.ticks):
            control.command[:], control.ordered[:] = twists, running.ticks
            running.advance()
            self._keep_scans()
        if running.failed.any():
            e = int(np.flatnonzero(running.failed)[0])
            raise CrowdbotError(f"environment {e}, seed {running.seeds[e]}: {running.failures[e]}")
        return self._judge()

    def _judge(self) -> TaskStep:
        running = self._running
        outcomes = ["" if self.ended[e] else running.outcome(e) or "" for e in range(self.count)]
        success, collision = (np.array([one == name for one in outcomes]) for name in ("success", "collision"))
        over = np.array([one != "" for one in outcomes])
        distance = self._goal_distance()
        rewards = self.reward.values(self._clearance(), success, collision, self._distance - distance, self.dt)
        rewards[self.ended] = 0.0
        self._distance = distance
        self.ended |= over
        terminated = success | collision
        return TaskStep(self._observe(), rewards, terminated, over & ~terminated, tuple(outcomes))

    def _goal_distance(self) -> Floats:
        control, scene = self._running.robots[self.index], self._running.around.flat
        return np.asarray(np.hypot(*(scene.position[:, control.agent] - control.goal).T))

    def _clearance(self) -> Floats:
        """Return the clearance to the nearest person or robot ``[E]`` [m]."""
        control, scene = self._running.robots[self.index], self._running.around.flat
        away = scene.position - scene.position[:, control.agent : control.agent + 1]
        gap = np.hypot(away[..., 0], away[..., 1]) - scene.radius - scene.radius[:, control.agent : control.agent + 1]
        there = scene.active.copy()
        there[:, control.agent] = False
        return np.asarray(np.min(np.where(there, gap, np.inf), axis=1, initial=np.inf))

    def _keep_scans(self) -> None:
        """Keep the latest scan of each environment."""
        if self.scanner is None or not self.observation.with_scan:
            return
        control = self._running.robots[self.index]
        for robot, one in self._running.readings:
            if robot is control and one.name == self.scanner.name and isinstance(one.reading, Scan):
                self._scan[one.environments] = np.fmin(one.reading.ranges, self.longest)

    def _observe(self) -> Arrays:
        running = self._running
        batch = running.robots[self.index].observations(running.around, np.arange(self.count))
        return self.observation.arrays(batch, self._scan if self.observation.with_scan else None)

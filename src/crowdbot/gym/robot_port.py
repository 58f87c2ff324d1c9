"""RobotPort: one robot of a simulation that takes actions, in all environments."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.navigation import DriveLimits, ExternalNavigator
from crowdbot.sensors import Lidar2D, Scan, main_scanner
from crowdbot.simulation import RobotControl, Simulation
from crowdbot.trials import Trial
from crowdbot.typing import Floats, Ints

from .spaces import ActionForm, ObservationForm

Arrays = dict[str, NDArray[np.float32]]


def free_robots(trial: Trial, names: list[str]) -> Trial:
    """Return the trial with robots that take orders from outside instead of the decisions of their navigators."""
    robots = [
        dataclasses.replace(robot, navigator=ExternalNavigator(timeout=math.ceil(2.0 * robot.control_period) + 1.0))
        if robot.name in names
        else robot
        for robot in trial.robots
    ]
    return dataclasses.replace(trial, robots=tuple(robots))


class RobotPort:
    """Observations, commands and distances of one robot.

    Args:
        trial: the trial.
        robot: name of the robot.
        observation, action: forms of observations and actions.

    Raises:
        InputError: the trial has no such robot, its control period is no multiple of the time step, or it has no
            scanner for a scan.

    >>> from crowdbot.trials import load_trial
    >>> port = RobotPort(load_trial("circle-crossing"), "robot", ObservationForm("scan"), ActionForm())
    >>> port.beams, port.ticks
    (360, 2)
    """

    def __init__(self, trial: Trial, robot: str, observation: ObservationForm, action: ActionForm) -> None:
        names = [robot.name for robot in trial.robots]
        if robot not in names:
            raise InputError(f"trial {trial.name!r} has no robot {robot!r}; it has {', '.join(names)}")
        self.name, self.observation, self.action = robot, observation, action
        self.index = names.index(robot)
        spec = trial.robots[self.index]
        self.ticks = max(1, round(spec.control_period / trial.step))
        if not math.isclose(self.ticks * trial.step, spec.control_period, rel_tol=1e-6):
            raise InputError(
                f"robot {robot!r}: the control period {spec.control_period:g} s must be a multiple of the step"
                f" {trial.step:g} s"
            )
        self.dt = self.ticks * trial.step
        mounts = [mount for mount in spec.sensors if isinstance(mount.sensor, Lidar2D)]
        planar = ((mount.sensor, float(spec.frame_of(mount)[2, 2])) for mount in mounts)
        best = main_scanner((sensor.angles, up) for sensor, up in planar if isinstance(sensor, Lidar2D))
        self.scanner = None if best is None else mounts[best]
        if observation.with_scan and self.scanner is None:
            raise InputError(f"robot {robot!r} has no laser scanner for observation = {observation.form!r}")
        self._simulation: Simulation | None = None
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
    def simulation(self) -> Simulation:
        """The running simulation."""
        if self._simulation is None:
            raise InputError("call reset before anything else")
        return self._simulation

    @property
    def control(self) -> RobotControl:
        """State of the robot in the simulation."""
        return self.simulation.robots[self.index]

    @property
    def limits(self) -> DriveLimits:
        """Limits of the drive."""
        return self.control.limits

    def attach(self, simulation: Simulation) -> None:
        """Use a simulation that has begun."""
        self._simulation = simulation
        self.action.check(self.limits)
        self._scan = np.full((simulation.count, self.beams), self.longest)
        self.keep_scans()

    def clear_scans(self, environments: Ints) -> None:
        """Forget the scans of environments that begin again."""
        self._scan[environments] = self.longest
        self.keep_scans()

    def keep_scans(self) -> None:
        """Keep the latest scan of each environment."""
        if self.scanner is None or not self.observation.with_scan:
            return
        control = self.control
        for robot, item in self.simulation.readings:
            if robot is control and item.name == self.scanner.name and isinstance(item.reading, Scan):
                self._scan[item.environments] = np.fmin(item.reading.ranges, self.longest)

    def twists(self, actions: Floats) -> Floats:
        """Return the commands ``[E, 3]`` of actions ``[E, 2]``.

        Raises:
            InputError: the actions have another shape or are not finite.
        """
        count = self.simulation.count
        if actions.shape != (count, 2):
            raise InputError(f"actions have the shape {actions.shape}, expected {(count, 2)}")
        if not np.isfinite(actions).all():
            raise InputError("actions must be finite")
        now = self.simulation.world.twists[self.control.agent]
        twist = np.stack([now.forward, now.turn, now.left], axis=-1)
        return self.action.twists(actions, self.limits, twist, self.dt)

    def order(self, twists: Floats) -> None:
        """Command the drive in all environments."""
        self.control.command[:], self.control.ordered[:] = twists, self.simulation.ticks

    def observe(self) -> Arrays:
        """Return the observations ``[E, ...]``."""
        running = self.simulation
        batch = self.control.observations(running.around, np.arange(running.count))
        return self.observation.arrays(batch, self._scan if self.observation.with_scan else None)

    def goal_distance(self) -> Floats:
        """Return the distance to the goal ``[E]`` [m]."""
        control, scene = self.control, self.simulation.around.flat
        return np.asarray(np.hypot(*(scene.position[:, control.agent] - control.goal).T))

    def clearance(self) -> Floats:
        """Return the clearance to the nearest person or robot ``[E]`` [m]."""
        agent, scene = self.control.agent, self.simulation.around.flat
        away = scene.position - scene.position[:, agent : agent + 1]
        gap = np.hypot(away[..., 0], away[..., 1]) - scene.radius - scene.radius[:, agent : agent + 1]
        there = scene.active.copy()
        there[:, agent] = False
        return np.asarray(np.min(np.where(there, gap, np.inf), axis=1, initial=np.inf))

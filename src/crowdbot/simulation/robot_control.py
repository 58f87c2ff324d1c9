"""RobotControl: sensors, navigator and command of one robot in all environments of a simulation."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import MissingExtra, TickSchedule, Twist
from crowdbot.navigation import DriveLimits, Observation, ObservationBatch
from crowdbot.sensors import Reading
from crowdbot.trials import Mount, RobotSpec, Trial
from crowdbot.world import Twists, World

from .mounted_sensor import MountedSensor, mounted_sensors
from .world_builder import limits_of
from .world_view import WorldView

__all__ = ["RobotControl"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True)
class _Observations(ObservationBatch):
    """Observations that look the readings up when somebody asks for a single environment."""

    latest: Callable[[int], Mapping[str, Reading]]

    def environment(self, k: int) -> Observation:
        """Return the observation in one environment, with the latest readings."""
        return dataclasses.replace(super().environment(k), readings=self.latest(k))


@dataclass
class RobotControl:
    """State of one robot in E environments: sensors, memory of the navigator, and current command.

    Fields:
        robot: the robot of the trial.
        agent: its index in the scene.
        limits: limits of its drive.
        control: ticks at which the navigator decides.
        sensors: its sensors.
        command: ``[E, 3]`` current command: forward [m/s], turn [rad/s], left [m/s].
        memories: memory of the navigator in each environment; ``UNSET`` before its first decision.
        arrived: ``[E]`` whether the robot has reached its goal.
    """

    robot: RobotSpec
    agent: int
    limits: DriveLimits
    control: TickSchedule
    sensors: tuple[MountedSensor, ...]
    command: Floats
    memories: list[Any]
    begun: Bools
    arrived: Bools = field(default_factory=lambda: np.zeros(0, dtype=np.bool_))

    @classmethod
    def of(cls, trial: Trial, robot: RobotSpec, agent: int, world: World, seeds: Sequence[int]) -> RobotControl:
        """Return the state of a robot before its first decision."""
        count = len(seeds)
        return cls(
            robot,
            agent,
            limits_of(robot.drive),
            world.clock.schedule(robot.control_period),
            mounted_sensors(trial, robot, world, seeds),
            np.zeros((count, 3)),
            [None] * count,
            np.zeros(count, dtype=np.bool_),
            np.zeros(count, dtype=np.bool_),
        )

    @property
    def commands(self) -> Twists:
        """The current commands as twists."""
        return Twists.of_columns(np.ascontiguousarray(self.command.T.copy()))

    def mount(self, name: str) -> Mount:
        """Return a mounted sensor by name."""
        return next(sensor.mount for sensor in self.sensors if sensor.name == name)

    def observation(self, around: WorldView, environment: int) -> Observation:
        """Return the observation in one environment; see :meth:`observations`."""
        return self.observations(around, np.array([environment])).environment(0)

    def observations(self, around: WorldView, environments: Ints) -> ObservationBatch:
        """Return the observations in some environments: the people in the latest readings of the sensors.

        Positions and velocities are exact, as from a perfect tracker. In a world whose environments have different
        outlines of props, there must be one environment.
        """
        world = around.world
        ids, twists = world.ids, world.twists[self.agent]
        seen = np.zeros(ids.shape, dtype=np.bool_)
        for sensor in self.sensors:
            visible = sensor.visible(ids)
            if visible is not None:
                seen |= visible
        twist = np.stack([twists.forward, twists.turn, twists.left], axis=-1)
        if world.walls_fixed and len(world.slots) > 1:
            scene = around.flat_of(int(environments[0]))
            slots = scene.shape[1]
            ids, seen, twist = ids[environments, :slots], seen[environments, :slots], twist[environments]
            rows = np.zeros(1, dtype=np.int64)
        else:
            rows, scene = environments, around.flat
        return _Observations.of(
            scene,
            self.agent,
            self.limits,
            dt=self.robot.control_period,
            twist=twist,
            seen=seen,
            environments=rows,
            ids=ids,
            latest=lambda k: self._latest(int(environments[k])),
        )

    def _latest(self, environment: int) -> dict[str, Reading]:
        """Return the latest reading of each sensor that has one."""
        readings = {sensor.name: sensor.reading(environment) for sensor in self.sensors}
        return {name: reading for name, reading in readings.items() if reading is not None}

    def decide(self, around: WorldView, environments: Ints) -> dict[int, Exception]:
        """Let the navigator decide in some environments; return the exceptions of those in which it failed.

        Raises:
            MissingExtra: the navigator needs a package that is not installed.
        """
        if around.world.walls_fixed and len(environments) > 1:
            found: dict[int, Exception] = {}
            for e in environments:
                found |= self.decide(around, np.array([e]))
            return found
        navigator, name = self.robot.navigator, self.robot.name
        batch = self.observations(around, environments)
        failures: dict[int, Exception] = {}
        if not self.begun[environments].all():
            new = np.flatnonzero(~self.begun[environments])
            first = batch if len(new) == len(environments) else self.observations(around, environments[new])
            memories, failed = navigator.first_memories(first, robot=name)
            failures |= {int(new[k]): error for k, error in failed.items()}
            for k, memory in zip(new.tolist(), memories, strict=True):
                self.memories[int(environments[k])] = memory
            self.begun[environments[new]] = True
        decisions = navigator.decide_batch(batch, [self.memories[e] for e in environments], name)
        failures = decisions.failures | failures
        for error in failures.values():
            if isinstance(error, MissingExtra):
                raise error
        if not failures:
            self.command[environments] = decisions.twist
        for k, e in enumerate(environments.tolist()):
            if k not in failures:
                self.memories[e] = decisions.memories[k]
                if failures:
                    self.command[e] = decisions.twist[k]
        return {int(environments[k]): error for k, error in failures.items()}

    def ask(self, environments: int | Ints | slice, twist: Twist) -> None:
        """Set the command in some environments."""
        self.command[environments] = tuple(map(float, twist))

    def arrive(self, position: Floats) -> None:
        """Note where the robot, at positions ``[E, 2]`` [m], is at its goal."""
        x, y = self.robot.goal.position
        away = np.hypot(position[:, 0] - x, position[:, 1] - y)
        self.arrived |= away < self.robot.goal.tolerance

    def select(self, environments: Ints) -> RobotControl:
        """Return an independent state of some environments."""
        other = copy.copy(self)
        other.sensors = tuple(sensor.select(environments) for sensor in self.sensors)
        other.command = self.command[environments]
        other.memories = [copy.deepcopy(self.memories[e]) for e in environments]
        other.begun, other.arrived = self.begun[environments], self.arrived[environments]
        return other

    def put(self, environments: Ints, other: RobotControl) -> None:
        """Replace the state of some environments."""
        for mine, new in zip(self.sensors, other.sensors, strict=True):
            mine.put(environments, new)
        self.command[environments] = other.command
        for k, e in enumerate(environments.tolist()):
            self.memories[e] = other.memories[k]
        self.begun[environments], self.arrived[environments] = other.begun, other.arrived

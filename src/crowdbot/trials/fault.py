"""Fault: contract of the faults of a robot, the built-in ones, and the element of a trial that holds one."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.core.fields import NAME, attribute, check, mounted_field
from crowdbot.typing import Bools, Floats

LONG = 86_400.0
"""End of a fault that lasts until the trial ends [s]."""


@dataclass(frozen=True)
class Fault:
    """The base of all faults: something about a robot that fails from ``begin`` until before ``end``.

    A fault changes what the navigator knows or what becomes of its commands, never the true state. Its methods get one
    row for each of N environments in which it is active, so that environments can differ in its numbers.

    Fields:
        begin, end: simulated times [s].

    Raises:
        InputError: a number is out of range, or the end is not after the begin.
    """

    begin: float = 0.0
    end: float = LONG

    def __post_init__(self) -> None:
        for name in self.number_names():
            if not math.isfinite(getattr(self, name)):
                raise InputError(f"{name} = {getattr(self, name)} is not finite")
        if self.begin < 0.0:
            raise InputError(f"begin = {self.begin:g} s must be at least 0")
        if not self.end > self.begin:
            raise InputError(f"end = {self.end:g} s must be after begin = {self.begin:g} s")

    @classmethod
    def number_names(cls) -> tuple[str, ...]:
        """Return the names of the numbers, ``begin`` and ``end`` first."""
        return ("begin", "end")

    def numbers(self) -> tuple[float, ...]:
        """Return the numbers in the order of :meth:`number_names`."""
        return tuple(float(getattr(self, name)) for name in self.number_names())

    def shift_pose(self, numbers: Floats, draws: Floats) -> Floats | None:
        """Return ``[N, 3]`` the error of the estimated x, y [m] and heading [rad]; None: no error.

        Args:
            numbers: ``[N, P]`` numbers of each environment.
            draws: ``[N, 3]`` standard normal numbers, drawn once for each run.
        """
        return None

    def lose_commands(self, numbers: Floats, shares: Floats) -> Bools | None:
        """Return ``[N]`` which new commands are lost; None: none.

        Args:
            numbers: ``[N, P]`` numbers of each environment.
            shares: ``[N]`` uniform numbers, drawn for each decision.
        """
        return None

    def change_commands(self, numbers: Floats, command: Floats, radius: float) -> Floats | None:
        """Return ``[N, 3]`` the commands as the drive gets them; None: unchanged.

        Args:
            numbers: ``[N, P]`` numbers of each environment.
            command: ``[N, 3]`` forward [m/s], turn [rad/s], left [m/s].
            radius: radius of the robot [m].
        """
        return None


@dataclass(frozen=True)
class SensorFault(Fault):
    """A fault of one sensor, or of all sensors of the robot.

    Fields:
        sensor: name of the sensor; empty for all.
    """

    sensor: str = ""


@dataclass(frozen=True, kw_only=True)
class FaultSpec:
    """A fault of a robot.

    >>> from crowdbot.trials import LostCommands
    >>> FaultSpec(fault=LostCommands(begin=2.0, end=4.0)).fault.share
    1.0
    """

    name: str = attribute("", about="name in events and paths", pattern=f"({NAME})?")
    fault: Fault = mounted_field("trials", "Fault", about="fault")

    def __post_init__(self) -> None:
        check(self)


def fault_problems(faults: Sequence[Any], sensors: Sequence[Any]) -> Iterator[str]:
    """Yield the problems of the faults of a robot: unknown sensors."""
    names = [mount.name for mount in sensors]
    for fault in faults:
        sensor = getattr(fault.fault, "sensor", "")
        if sensor and sensor not in names:
            known = ", ".join(names) or "none"
            yield f"has a fault of the sensor {sensor!r}, which it lacks; its sensors are {known}"


def have_same_kinds(ours: Sequence[FaultSpec], theirs: Sequence[FaultSpec]) -> bool:
    """Return whether faults are equal except for their numbers."""
    if len(ours) != len(theirs):
        return False
    for own, other in zip(ours, theirs, strict=True):
        kind = type(own.fault)
        free = kind.number_names()
        words = [field.name for field in dataclasses.fields(kind) if field.name not in free]
        if own.name != other.name or kind is not type(other.fault):
            return False
        if any(getattr(own.fault, word) != getattr(other.fault, word) for word in words):
            return False
    return True


@dataclass(frozen=True)
class BlindSensor(SensorFault):
    """A sensor that has no reading: the navigator gets none, and does not see the people in the earlier one.

    >>> BlindSensor(begin=2.0, end=4.0).end
    4.0
    """


@dataclass(frozen=True)
class FrozenSensor(SensorFault):
    """A sensor that stops to measure: its latest reading stays, with the places and velocities of the people in it.

    >>> FrozenSensor(begin=2.0, end=4.0, sensor="scan").sensor
    'scan'
    """


LARGEST_DELAY = 60.0
"""Largest delay [s]."""


@dataclass(frozen=True)
class LateSensor(SensorFault):
    """A sensor whose readings arrive with an additional delay, in their order; people are where they were measured.

    Fields:
        delay: additional delay [s], rounded to time steps.

    Raises:
        InputError: the delay is not above 0 or is larger than 60 s.

    >>> LateSensor(delay=0.5).numbers()[2]
    0.5
    """

    delay: float = 0.5

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0.0 < self.delay <= LARGEST_DELAY:
            raise InputError(f"delay = {self.delay:g} s must be above 0 and at most {LARGEST_DELAY:g}")

    @classmethod
    def number_names(cls) -> tuple[str, ...]:
        return (*super().number_names(), "delay")


@dataclass(frozen=True)
class LocalizationJump(Fault):
    """A jump of the pose that the robot believes, by a normally distributed error that depends on the seed.

    At the end, the pose jumps back. People are seen relative to that pose, walls and goal are not.

    Fields:
        deviation: standard deviation of x and y [m].
        heading: standard deviation of the heading [rad].

    Raises:
        InputError: a standard deviation is negative.

    >>> LocalizationJump(deviation=0.5, begin=3.0).deviation
    0.5
    """

    deviation: float = 0.5
    heading: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("deviation", "heading"):
            if getattr(self, name) < 0.0:
                raise InputError(f"{name} = {getattr(self, name):g} must be at least 0")

    @classmethod
    def number_names(cls) -> tuple[str, ...]:
        return (*super().number_names(), "deviation", "heading")

    def shift_pose(self, numbers: NDArray[np.float64], draws: NDArray[np.float64]) -> NDArray[np.float64]:
        return draws * numbers[:, [2, 2, 3]]


@dataclass(frozen=True)
class LocalizationOffset(Fault):
    """An error of the pose that the robot believes; people are seen relative to that pose, walls and goal are not.

    Fields:
        x, y: error of the position in the world [m].
        heading: error of the heading [rad].

    >>> LocalizationOffset(x=0.3).numbers()
    (0.0, 86400.0, 0.3, 0.0, 0.0)
    """

    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0

    @classmethod
    def number_names(cls) -> tuple[str, ...]:
        return (*super().number_names(), "x", "y", "heading")

    def shift_pose(self, numbers: NDArray[np.float64], draws: NDArray[np.float64]) -> NDArray[np.float64]:
        return numbers[:, 2:5]


@dataclass(frozen=True)
class LostCommands(Fault):
    """Commands of the navigator that are lost: the one before stays in force.

    Fields:
        share: share of the commands that are lost, drawn from the seed.

    Raises:
        InputError: the share is not above 0 and at most 1.

    >>> LostCommands(share=0.3).share
    0.3
    """

    share: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0.0 < self.share <= 1.0:
            raise InputError(f"share = {self.share:g} must be above 0 and at most 1")

    @classmethod
    def number_names(cls) -> tuple[str, ...]:
        return (*super().number_names(), "share")

    def lose_commands(self, numbers: NDArray[np.float64], shares: NDArray[np.float64]) -> NDArray[np.bool_]:
        return shares < numbers[:, 2]


SIDES = {"left": 1.0, "right": -1.0}


@dataclass(frozen=True)
class SlippingWheel(Fault):
    """A wheel of a differential drive that slips: its side moves at ``1 - slip`` of its commanded speed.

    The command becomes the twist of the two sides, at the distance of the radius of the robot from its centre, so the
    robot drives slower and turns to the side of the wheel. Commands to the left (of omnidirectional drives) are not
    changed. Odometry measures the motion of the robot, not the turns of the wheel.

    Fields:
        side: ``left`` or ``right``.
        slip: share of the speed that is lost, above 0 to 1.

    Raises:
        InputError: the side is unknown, or the slip is not above 0 and at most 1.

    >>> forward, numbers = np.array([[1.0, 0.0, 0.0]]), np.array([[0.0, 9.0, 0.5]])
    >>> SlippingWheel(slip=0.5).change_commands(numbers, forward, 0.25)
    array([[0.75, 1.  , 0.  ]])
    """

    side: str = "left"
    slip: float = 0.3

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.side not in SIDES:
            raise InputError(f"side = {self.side!r} must be left or right")
        if not 0.0 < self.slip <= 1.0:
            raise InputError(f"slip = {self.slip:g} must be above 0 and at most 1")

    @classmethod
    def number_names(cls) -> tuple[str, ...]:
        return (*super().number_names(), "slip")

    def change_commands(
        self, numbers: NDArray[np.float64], command: NDArray[np.float64], radius: float
    ) -> NDArray[np.float64]:
        sign = SIDES[self.side]
        lost = numbers[:, 2] * (command[:, 0] - sign * radius * command[:, 1])
        changed = command.copy()
        changed[:, 0] -= 0.5 * lost
        changed[:, 1] += sign * 0.5 * lost / radius
        return changed

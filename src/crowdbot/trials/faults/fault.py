"""Fault: contract of the faults of a robot, and the element of a trial that holds one."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from crowdbot.core import InputError
from crowdbot.trials.fields import attribute, check, mounted_field
from crowdbot.trials.notation import NAME
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

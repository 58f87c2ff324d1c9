"""Drives: motion models of robot bases with limits of speed and acceleration."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError, Pose, Scene, Twist, check_number, every, kernel, storable
from crowdbot.typing import Bools, Floats

MovedAgents = tuple[Floats, Floats, Floats]
"""Positions ``[E, A, 2]`` [m], velocities ``[E, A, 2]`` [m/s] and headings ``[E, A]`` [rad] of all agents."""


@kernel
def _arc(place: Floats, heading: Floats, forward: Floats, left: Floats, turn: Floats, dt: float) -> None:
    """Move each pose along a circular arc; the direction of the chord is the heading plus half the turn."""
    for e in range(len(heading)):
        half = 0.5 * turn[e] * dt
        shrink = math.sin(half) / half if abs(half) > 1e-4 else 1.0 - half * half / 6.0
        cos, sin = math.cos(heading[e] + half), math.sin(heading[e] + half)
        place[e, 0] += (cos * forward[e] - sin * left[e]) * shrink * dt
        place[e, 1] += (sin * forward[e] + cos * left[e]) * shrink * dt
        heading[e] = math.pi - (math.pi - heading[e] - 2.0 * half) % (2.0 * math.pi)


@kernel
def _differential(
    place: Floats, heading: Floats, forward: Floats, turn: Floats, wanted: Floats, wanted_turn: Floats, top: float,
    most: float, aside: float, push: float, spin: float, dt: float, out: Floats,
) -> None:  # fmt: skip
    """Move each pose of a differential drive for ``dt``, and write the new twists."""
    for e in range(len(heading)):
        goal = min(max(wanted[e], -top), top)
        out[0, e] = min(max(goal, forward[e] - push), forward[e] + push)
        bend = min(most, aside / max(abs(goal), abs(out[0, e]), 1e-9))
        turning = min(max(wanted_turn[e], -bend), bend)
        out[1, e] = min(max(turning, turn[e] - spin), turn[e] + spin)
        out[2, e] = 0.0
    _arc(place, heading, out[0], out[2], out[1], dt)


@kernel
def _omnidirectional(
    place: Floats, heading: Floats, forward: Floats, turn: Floats, left: Floats, wanted: Floats, wanted_turn: Floats,
    wanted_left: Floats, top: float, most: float, push: float, spin: float, dt: float, out: Floats,
) -> None:  # fmt: skip
    """Move each pose of an omnidirectional drive for ``dt``, and write the new twists."""
    for e in range(len(heading)):
        ahead, aside = _shortened(wanted[e], wanted_left[e], top)
        ahead, aside = _shortened(ahead - forward[e], aside - left[e], push)
        turning = min(max(wanted_turn[e], -most), most)
        out[0, e] = forward[e] + ahead
        out[1, e] = min(max(turning, turn[e] - spin), turn[e] + spin)
        out[2, e] = left[e] + aside
    _arc(place, heading, out[0], out[2], out[1], dt)


@kernel
def _shortened(x: float, y: float, limit: float) -> tuple[float, float]:
    """Return a vector, shortened to a length."""
    share = min(1.0, limit / max(math.sqrt(x * x + y * y), 1e-300))
    return x * share, y * share


@kernel
def _world_velocity(heading: Floats, forward: Floats, left: Floats) -> Floats:
    velocity = np.empty((len(heading), 2))
    for e in range(len(heading)):
        cos, sin = math.cos(heading[e]), math.sin(heading[e])
        velocity[e, 0] = cos * forward[e] - sin * left[e]
        velocity[e, 1] = sin * forward[e] + cos * left[e]
    return velocity


@kernel
def put_robot(
    robot: int, active: NDArray[np.bool_], old_place: Floats, old_heading: Floats, place: Floats, heading: Floats,
    forward: Floats, left: Floats, out_place: Floats, out_velocity: Floats, out_heading: Floats,
) -> None:  # fmt: skip
    """Write the pose and velocity of a robot into the arrays of a scene; an absent robot stands still.

    Args:
        robot: index of the robot.
        active, old_place, old_heading: the agents ``[E, A]`` before the step.
        place, heading, forward, left: pose and twist ``[E]`` of the robot after the step.
        out_place, out_velocity, out_heading: arrays ``[E, A]`` of all agents after the step; modified in place.
    """
    for e in range(len(active)):
        if not active[e, robot]:
            out_place[e, robot, 0], out_place[e, robot, 1] = old_place[e, robot, 0], old_place[e, robot, 1]
            out_heading[e, robot] = old_heading[e, robot]
            out_velocity[e, robot, 0], out_velocity[e, robot, 1] = 0.0, 0.0
            continue
        cos, sin = math.cos(heading[e]), math.sin(heading[e])
        out_place[e, robot, 0], out_place[e, robot, 1] = place[e, 0], place[e, 1]
        out_heading[e, robot] = heading[e]
        out_velocity[e, robot, 0] = cos * forward[e] - sin * left[e]
        out_velocity[e, robot, 1] = sin * forward[e] + cos * left[e]


@kernel
def _move_differential(
    robot: int, active: Bools, old_place: Floats, old_heading: Floats, forward: Floats, turn: Floats, wanted: Floats,
    wanted_turn: Floats, top: float, most: float, aside: float, push: float, spin: float, dt: float, out: Floats,
    out_place: Floats, out_velocity: Floats, out_heading: Floats,
) -> None:  # fmt: skip
    """Move an agent with a differential drive in the arrays of a scene, and write its new twists."""
    place, heading = old_place[:, robot].copy(), old_heading[:, robot].copy()
    _differential(place, heading, forward, turn, wanted, wanted_turn, top, most, aside, push, spin, dt, out)
    put_robot(
        robot, active, old_place, old_heading, place, heading, out[0], out[2], out_place, out_velocity, out_heading
    )


@kernel
def _move_omnidirectional(
    robot: int, active: Bools, old_place: Floats, old_heading: Floats, forward: Floats, turn: Floats, left: Floats,
    wanted: Floats, wanted_turn: Floats, wanted_left: Floats, top: float, most: float, push: float, spin: float,
    dt: float, out: Floats, out_place: Floats, out_velocity: Floats, out_heading: Floats,
) -> None:  # fmt: skip
    """Move an agent with an omnidirectional drive in the arrays of a scene, and write its new twists."""
    place, heading = old_place[:, robot].copy(), old_heading[:, robot].copy()
    _omnidirectional(
        place, heading, forward, turn, left, wanted, wanted_turn, wanted_left, top, most, push, spin, dt, out
    )
    put_robot(
        robot, active, old_place, old_heading, place, heading, out[0], out[2], out_place, out_velocity, out_heading
    )


@storable
@dataclass(frozen=True)
class Twists:
    """Twist of one robot in every environment, in the frame of the robot.

    Fields:
        forward, left: linear velocity ``[E]`` [m/s].
        turn: turn rate ``[E]``, counter-clockwise [rad/s].

    >>> Twists.of(Twist(0.5, 0.1), 2).forward.tolist()
    [0.5, 0.5]
    """

    forward: Floats
    turn: Floats
    left: Floats
    _count: int | None = field(default=None, init=False, repr=False, compare=False)
    """Number of environments, once the values are checked."""

    @classmethod
    def of(cls, twist: Twist | Twists, count: int) -> Twists:
        """Create twists for ``count`` environments from one twist, or from one per environment.

        Raises:
            InputError: a value is not finite, or the number of twists is wrong.
        """
        if twist.__class__ is Twists and twist._count == count:
            return twist
        if type(twist) is Twist and type(sum(twist)) is float and math.isfinite(sum(twist)):
            columns = np.empty((3, count))
            columns[0], columns[1], columns[2] = twist
            return cls.of_columns(columns)
        twists = cls(*(_each(name, getattr(twist, name), count) for name in ("forward", "turn", "left")))
        if cls is Twists:
            object.__setattr__(twists, "_count", count)
        return twists

    @classmethod
    def of_columns(cls, columns: Floats) -> Twists:
        """Create twists from a C-contiguous array ``[3, E]`` of forward, turn and left, which must not change."""
        if not every(np.isfinite(columns)):
            return cls.of(cls(*columns), columns.shape[1])
        twists = object.__new__(cls)  # half the time of the constructor
        twists.__dict__.update(forward=columns[0], turn=columns[1], left=columns[2], _count=columns.shape[1])
        return twists

    def at(self, environment: int) -> Twist:
        """Return the twist in one environment."""
        return Twist(float(self.forward[environment]), float(self.turn[environment]), float(self.left[environment]))

    def velocity(self, heading: Floats) -> Floats:
        """Return the velocity ``[E, 2]`` [m/s] in the world for headings ``[E]`` [rad]."""
        return _world_velocity(np.ascontiguousarray(heading), self.forward, self.left)


@dataclass(frozen=True)
class Drive(ABC):
    """Contract of the motion model of a base."""

    @abstractmethod
    def step(self, pose: Pose, twist: Twists, command: Twist | Twists, dt: float) -> tuple[Pose, Twists]:
        """Return pose and twist ``dt`` [s] later.

        Args:
            pose: current positions ``[E, 2]`` [m] and headings ``[E]`` [rad].
            twist: current twist.
            command: commanded twist.
            dt: time step [s].

        Raises:
            InputError: a command is not finite or ``dt`` is not positive.
        """

    def move(self, robot: int, before: Scene, twist: Twists, command: Twists, dt: float, after: MovedAgents) -> Twists:
        """Move an agent of a scene by a step of ``dt`` [s], and return its new twist; an absent robot stands still.

        Args:
            robot: index of the agent.
            before: scene at the start of the step.
            twist, command: current and commanded twist.
            dt: time step [s].
            after: positions, velocities and headings of all agents after the step; modified in place.
        """
        old = Pose(before.position[:, robot].copy(), before.heading[:, robot].copy())
        pose, new = self.step(old, twist, command, dt)
        put_robot(
            robot, before.active, before.position, before.heading, pose.position, pose.heading, new.forward, new.left,
            *after,
        )  # fmt: skip
        return new


@dataclass(frozen=True)
class DifferentialDrive(Drive):
    """Differential drive: forward speed and turn rate; the lateral speed of a command is ignored.

    The command is clipped to the speed limits, and the change of the twist to the accelerations times ``dt``. The new
    twist is constant during the step; the path is an exact circular arc.

    Fields:
        max_speed: maximum speed, forwards and backwards [m/s].
        max_turn_rate: maximum turn rate [rad/s].
        max_acceleration: maximum acceleration and deceleration [m/s2].
        max_turn_acceleration: maximum angular acceleration [rad/s2].
        max_lateral_acceleration: maximum product of speed and turn rate [m/s2]; at high speed, the turn rate is
            reduced. A tall robot would otherwise tip over in curves.

    Raises:
        InputError: a limit is not above 0, or one other than the last is not finite.

    >>> drive = DifferentialDrive(max_speed=1.0, max_turn_rate=2.0, max_acceleration=1.0, max_turn_acceleration=4.0)
    >>> pose, twist = drive.step(Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(), 1), Twist(5.0, 0.0), dt=0.5)
    >>> twist.at(0), pose.position.tolist()
    (Twist(forward=0.5, turn=0.0, left=0.0), [[0.25, 0.0]])
    """

    max_speed: float = 1.0
    max_turn_rate: float = 1.5
    max_acceleration: float = 1.0
    max_turn_acceleration: float = 3.0
    max_lateral_acceleration: float = math.inf

    def __post_init__(self) -> None:
        check_limits(self)
        if not self.max_lateral_acceleration > 0.0:
            raise InputError(
                f"DifferentialDrive: max_lateral_acceleration = {self.max_lateral_acceleration} m/s2 must be above 0"
            )

    def step(self, pose: Pose, twist: Twists, command: Twist | Twists, dt: float) -> tuple[Pose, Twists]:
        wanted = Twists.of(command, len(pose.heading))
        check_step(dt)
        place, heading = np.array(pose.position, dtype=np.float64), np.array(pose.heading, dtype=np.float64)
        columns = np.empty((3, len(heading)))
        now = (twist.forward, twist.turn, wanted.forward, wanted.turn)
        values: Any = (place, heading, *now, *self._numbers(dt), columns)
        _differential(*values)
        return Pose(place, heading), Twists.of_columns(columns)

    def move(self, robot: int, before: Scene, twist: Twists, command: Twists, dt: float, after: MovedAgents) -> Twists:
        if type(self).step is not DifferentialDrive.step:
            return super().move(robot, before, twist, command, dt, after)
        wanted, columns = Twists.of(command, len(before.position)), np.empty((3, len(before.position)))
        check_step(dt)
        now = (twist.forward, twist.turn, wanted.forward, wanted.turn)
        start = before.active, before.position, before.heading
        values: Any = (robot, *start, *now, *self._numbers(dt), columns, *after)
        _move_differential(*values)
        return Twists.of_columns(columns)

    def _numbers(self, dt: float) -> tuple[float, ...]:
        limits = (float(self.max_speed), float(self.max_turn_rate), float(self.max_lateral_acceleration))
        return (*limits, self.max_acceleration * dt, self.max_turn_acceleration * dt, dt)


@dataclass(frozen=True)
class Omnidirectional(Drive):
    """Omnidirectional drive, as in Pepper: limits apply to the velocity vector, and separately to the turn rate.

    Fields and errors as in :class:`DifferentialDrive`.

    >>> drive = Omnidirectional(max_acceleration=10.0)
    >>> _, twist = drive.step(Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(), 1), Twist(0.0, 0.0, left=3.0), dt=0.5)
    >>> twist.at(0)
    Twist(forward=0.0, turn=0.0, left=1.0)
    """

    max_speed: float = 1.0
    max_turn_rate: float = 1.5
    max_acceleration: float = 1.0
    max_turn_acceleration: float = 3.0

    def __post_init__(self) -> None:
        check_limits(self)

    def step(self, pose: Pose, twist: Twists, command: Twist | Twists, dt: float) -> tuple[Pose, Twists]:
        wanted = Twists.of(command, len(pose.heading))
        check_step(dt)
        place, heading = np.array(pose.position, dtype=np.float64), np.array(pose.heading, dtype=np.float64)
        columns = np.empty((3, len(heading)))
        now = (twist.forward, twist.turn, twist.left, wanted.forward, wanted.turn, wanted.left)
        values: Any = (place, heading, *now, *self._numbers(dt), columns)
        _omnidirectional(*values)
        return Pose(place, heading), Twists.of_columns(columns)

    def move(self, robot: int, before: Scene, twist: Twists, command: Twists, dt: float, after: MovedAgents) -> Twists:
        if type(self).step is not Omnidirectional.step:
            return super().move(robot, before, twist, command, dt, after)
        wanted, columns = Twists.of(command, len(before.position)), np.empty((3, len(before.position)))
        check_step(dt)
        now = (twist.forward, twist.turn, twist.left, wanted.forward, wanted.turn, wanted.left)
        start = before.active, before.position, before.heading
        values: Any = (robot, *start, *now, *self._numbers(dt), columns, *after)
        _move_omnidirectional(*values)
        return Twists.of_columns(columns)

    def _numbers(self, dt: float) -> tuple[float, ...]:
        limits = (float(self.max_speed), float(self.max_turn_rate))
        return (*limits, self.max_acceleration * dt, self.max_turn_acceleration * dt, dt)


def integrate_twist(pose: Pose, twist: Twists, dt: float) -> Pose:
    """Return the exact pose after ``dt`` [s] at a constant twist: a circular arc, or a line without turning.

    >>> quarter = integrate_twist(Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(1.0, math.pi / 2), 1), 1.0)
    >>> (quarter.position * math.pi / 2).round(9).tolist(), float(quarter.heading[0]) == math.pi / 2
    ([[1.0, 1.0]], True)
    """
    place, heading = np.array(pose.position, dtype=np.float64), np.array(pose.heading, dtype=np.float64)
    _arc(place, heading, twist.forward, twist.left, twist.turn, dt)
    return Pose(place, heading)


def _each(name: str, value: ArrayLike, count: int) -> Floats:
    array = np.asarray(value, dtype=np.float64)
    if array.shape not in ((), (count,)):
        raise InputError(f"twist: {name} has shape {list(array.shape)}, it must be one number or [{count}]")
    if not np.all(np.isfinite(array)):
        raise InputError(f"twist: {name} = {array.tolist()} must be finite")
    return np.ascontiguousarray(np.broadcast_to(array, (count,)))


def check_limits(drive: Drive) -> None:
    """Raise :class:`InputError` if a speed or acceleration limit of a drive is not finite and above 0."""
    for name in ("max_speed", "max_turn_rate", "max_acceleration", "max_turn_acceleration"):
        unit = ("rad" if "turn" in name else "m") + ("/s2" if "acceleration" in name else "/s")
        check_number(type(drive).__name__, name, getattr(drive, name), unit, exclusive_min=0.0)


def check_step(dt: float) -> None:
    """Raise :class:`InputError` if a time step [s] is not finite and above 0."""
    if not 0.0 < dt < math.inf:
        raise InputError(f"time step {dt} s of a drive must be finite and above 0")

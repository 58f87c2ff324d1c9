"""WheeledDrive: bases whose twist is limited by the speeds of their wheels; mecanum and omnidirectional wheels."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError, Pose, Twist, check_number, kernel
from crowdbot.typing import Floats

from .drive import Drive, Twists, check_limits, check_step, integrate_twist


@kernel
def _limit(
    now: Floats, wanted: Floats, matrix: Floats, wheel_top: float, sideways: float, top: float, most: float,
    push: float, spin: float, out: Floats,
) -> None:  # fmt: skip
    """Write the twists ``[3, E]`` after a step towards the commands ``[3, E]``: forward, turn, left."""
    for e in range(now.shape[1]):
        ahead, turning = wanted[0, e], min(max(wanted[1, e], -most), most)
        aside = wanted[2, e] if sideways > 0.0 else 0.0
        scaled = aside / sideways if sideways > 0.0 else 0.0
        share = min(1.0, top / max(np.sqrt(ahead * ahead + scaled * scaled), 1e-300))
        ahead, aside = ahead * share, aside * share
        peak = 0.0
        for w in range(len(matrix)):
            rate = matrix[w, 0] * ahead + matrix[w, 1] * turning + matrix[w, 2] * aside
            peak = max(peak, abs(rate))
        if peak > wheel_top:
            share = wheel_top / peak
            ahead, turning, aside = ahead * share, turning * share, aside * share
        x, w, y = ahead - now[0, e], turning - now[1, e], aside - now[2, e]
        share = min(1.0, push / max(np.sqrt(x * x + y * y), 1e-300), spin / max(abs(w), 1e-300))
        out[0, e] = ahead if share == 1.0 else now[0, e] + x * share
        out[1, e] = turning if share == 1.0 else now[1, e] + w * share
        out[2, e] = aside if share == 1.0 else now[2, e] + y * share


def limit_twists(
    twist: Twists,
    wanted: Twists,
    *,
    matrix: Floats,
    max_wheel_speed: float,
    sideways: float,
    speeds: tuple[float, float],
    changes: tuple[float, float],
) -> Twists:
    """Return the twists after a step towards the commands, within all limits.

    A command outside the limits is shortened: first its velocity, then the whole twist until every wheel keeps its
    limit, so the robot follows the same curve, slower. The twist then moves along a straight line to the command. The
    wheel limits form a convex set, so they hold on the way, too.

    Args:
        twist, wanted: current twist and command.
        matrix: wheel speeds per twist ``[W, 3]``: rows are wheels, columns forward, turn, left.
        max_wheel_speed: limit of the wheel speeds [rad/s].
        sideways: maximum lateral speed as a share of the maximum speed; 0: no lateral motion.
        speeds: maximum speed [m/s] and turn rate [rad/s].
        changes: maximum change of the velocity [m/s] and of the turn rate [rad/s] in the step.
    """
    out = np.empty((3, len(twist.forward)))
    now = np.stack([twist.forward, twist.turn, twist.left])
    goal = np.stack([wanted.forward, wanted.turn, wanted.left])
    top, most = float(speeds[0]), float(speeds[1])
    _limit(now, goal, matrix, float(max_wheel_speed), float(sideways), top, most, *changes, out)
    return Twists.of_columns(out)


@dataclass(frozen=True)
class WheeledDrive(Drive):
    """Part of drives with unsteered wheels: limits of wheels, and the mapping from twists to wheel speeds and back.

    Each wheel turns at a speed that is linear in the twist: ``speeds = matrix @ (forward, turn, left)``.

    Fields:
        max_speed: maximum speed [m/s].
        max_turn_rate: maximum turn rate [rad/s].
        max_acceleration: maximum acceleration and deceleration [m/s2].
        max_turn_acceleration: maximum angular acceleration [rad/s2].
        wheel_radius: radius of the wheels [m].
        max_wheel_speed: maximum speed of a wheel [rad/s].

    Raises:
        InputError: a limit or a length is not finite and above 0.
    """

    max_speed: float = 1.0
    max_turn_rate: float = 1.5
    max_acceleration: float = 1.0
    max_turn_acceleration: float = 3.0
    wheel_radius: float = 0.1
    max_wheel_speed: float = 40.0

    sideways = 0.0
    """Whether a command can move the base sideways: 1 or 0."""

    def __post_init__(self) -> None:
        check_limits(self)
        name = type(self).__name__
        check_number(name, "wheel_radius", self.wheel_radius, "m", exclusive_min=0.0)
        check_number(name, "max_wheel_speed", self.max_wheel_speed, "rad/s", exclusive_min=0.0)

    @property
    @abstractmethod
    def matrix(self) -> Floats:
        """Wheel speeds [rad/s] per twist, ``[W, 3]``: rows are wheels, columns forward, turn, left."""

    def wheel_speeds(self, twist: Twist) -> Floats:
        """Return the speeds ``[W]`` [rad/s] of the wheels for a twist."""
        return np.asarray(self.matrix @ np.array([twist.forward, twist.turn, twist.left]))

    def twist_of(self, speeds: Floats) -> Twist:
        """Return the twist of wheel speeds ``[W]`` [rad/s]: the nearest one, if the wheels contradict each other.

        Raises:
            InputError: the number of speeds is wrong.
        """
        matrix = self.matrix
        if np.shape(speeds) != (len(matrix),):
            raise InputError(
                f"{type(self).__name__}: wheel speeds of shape {list(np.shape(speeds))} must be one for each of the"
                f" {len(matrix)} wheels"
            )
        forward, turn, left = (np.linalg.pinv(matrix) @ np.asarray(speeds, dtype=np.float64)).tolist()
        return Twist(forward, turn, left)

    def step(self, pose: Pose, twist: Twists, command: Twist | Twists, dt: float) -> tuple[Pose, Twists]:
        check_step(dt)
        after = limit_twists(
            twist,
            Twists.of(command, len(pose.heading)),
            matrix=self.matrix,
            max_wheel_speed=self.max_wheel_speed,
            sideways=self.sideways,
            speeds=(self.max_speed, self.max_turn_rate),
            changes=(self.max_acceleration * dt, self.max_turn_acceleration * dt),
        )
        return integrate_twist(pose, after, dt), after


@dataclass(frozen=True)
class MecanumDrive(WheeledDrive):
    """Mecanum drive with rollers in the usual arrangement: seen from above, their axes point along the diagonals.

    With ``reach = (wheelbase + track) / 2``, the wheel speeds are

    * front left and rear right: ``(forward - left -+ turn * reach) / wheel_radius``,
    * front right and rear left: ``(forward + left +- turn * reach) / wheel_radius``.

    Four wheels for three velocities: the speeds of real motions fulfil ``front left + front right = rear left + rear
    right``, and :meth:`twist_of` returns the mean. The limits of speed apply to the velocity vector. A command beyond
    the wheel limits is shortened to a slower one on the same curve.

    Source: H. Taheri, B. Qiao, N. Ghaeminezhad, Kinematic Model of a Four Mecanum Wheeled Mobile Robot, IJCA 113(3),
    2015.

    Fields:
        track: distance between the left and right wheels [m].
        wheelbase: distance between the front and rear wheels [m].
        max_speed, max_turn_rate, max_acceleration, max_turn_acceleration, wheel_radius, max_wheel_speed: as in
            :class:`WheeledDrive`.

    Raises:
        InputError: a limit or a length is not finite and above 0.

    >>> from crowdbot.core import Twist
    >>> MecanumDrive().wheel_speeds(Twist(0.0, 0.0, left=0.5)).tolist()
    [-5.0, 5.0, 5.0, -5.0]
    """

    track: float = 0.4
    wheelbase: float = 0.3

    sideways = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("MecanumDrive", "track", self.track, "m", exclusive_min=0.0)
        check_number("MecanumDrive", "wheelbase", self.wheelbase, "m", exclusive_min=0.0)

    @property
    def matrix(self) -> Floats:
        # wheel speeds per twist [4, 3]: front left, front right, rear left, rear right
        reach = 0.5 * (self.track + self.wheelbase)
        rows = [[1.0, -reach, -1.0], [1.0, reach, 1.0], [1.0, -reach, 1.0], [1.0, reach, -1.0]]
        return np.array(rows) / self.wheel_radius


@dataclass(frozen=True)
class OmniWheelDrive(WheeledDrive):
    """Omnidirectional wheels on a circle around the origin, as in Robotino: each rolls along the circle.

    A wheel at the angle ``a`` on a circle of the radius ``distance`` turns at
    ``(-sin(a) * forward + cos(a) * left + distance * turn) / wheel_radius``; its rollers slide along the axle, which
    points to the centre. The limits of speed apply to the velocity vector. A command beyond the wheel limits is
    shortened to a slower one on the same curve.

    Source: R. Siegwart, I. Nourbakhsh, Introduction to Autonomous Mobile Robots, 3.2.3 (Swedish 90 degree wheels).

    Fields:
        wheels: number of wheels at equal angles, at least 3.
        distance: distance of the wheels from the origin [m].
        first_angle: angle of the first wheel, from the x axis [rad].
        max_speed, max_turn_rate, max_acceleration, max_turn_acceleration, wheel_radius, max_wheel_speed: as in
            :class:`WheeledDrive`.

    Raises:
        InputError: a limit or a length is not finite and above 0, or there are fewer than 3 wheels.

    >>> from crowdbot.core import Twist
    >>> drive = OmniWheelDrive(wheels=3, distance=0.2, wheel_radius=0.1)
    >>> drive.wheel_speeds(Twist(0.0, 1.0)).round(9).tolist()
    [2.0, 2.0, 2.0]
    """

    wheels: int = 3
    distance: float = 0.2
    first_angle: float = 0.0

    sideways = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("OmniWheelDrive", "wheels", self.wheels, min=3, whole=True)
        check_number("OmniWheelDrive", "distance", self.distance, "m", exclusive_min=0.0)
        check_number("OmniWheelDrive", "first_angle", self.first_angle, "rad", min=-2.0 * math.pi, max=2.0 * math.pi)

    @property
    def matrix(self) -> Floats:
        angles = self.first_angle + 2.0 * math.pi * np.arange(self.wheels) / self.wheels
        reach = np.full(self.wheels, self.distance)
        return np.stack([-np.sin(angles), reach, np.cos(angles)], axis=1) / self.wheel_radius

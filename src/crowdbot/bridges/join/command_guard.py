"""CommandGuard: emergency stop and limits before every command that leaves for a real robot."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from crowdbot.core import InputError, Twist, check_number


@dataclass(frozen=True)
class DrivingArea:
    """The rectangle that the robot may not leave, in the frame of the trial [m].

    Raises:
        InputError: a number is not finite, or the rectangle is empty.

    >>> DrivingArea.of("-3,-2,3,2").has(0.0, 1.9), DrivingArea.of("-3,-2,3,2").has(0.0, 2.1)
    (True, False)
    """

    low_x: float
    low_y: float
    high_x: float
    high_y: float

    def __post_init__(self) -> None:
        corners = (self.low_x, self.low_y, self.high_x, self.high_y)
        if not all(map(math.isfinite, corners)) or self.low_x >= self.high_x or self.low_y >= self.high_y:
            raise InputError(f"area {corners} must be x0,y0,x1,y1 in m with x0 < x1 and y0 < y1")

    @classmethod
    def of(cls, text: str) -> DrivingArea:
        """Return the area of a text ``x0,y0,x1,y1``."""
        try:
            low_x, low_y, high_x, high_y = (float(word) for word in text.split(","))
        except ValueError:
            raise InputError(f"area {text[:60]!r} must be x0,y0,x1,y1 in m, such as -3,-2,3,2") from None
        return cls(low_x, low_y, high_x, high_y)

    def has(self, x: float, y: float) -> bool:
        """Return whether a point is inside."""
        return self.low_x <= x <= self.high_x and self.low_y <= y <= self.high_y


@dataclass(frozen=True)
class GuardLimits:
    """Limits of what leaves for the robot.

    Fields:
        speed, turn: largest speed [m/s] and turn rate [rad/s].
        acceleration, turn_acceleration: largest change of a command [m/s2], [rad/s2]. An emergency stop has none.
        link: age of the latest pose of the robot [s] at which its link is lost.
        command: age of the latest command [s] at which the robot stops.

    Raises:
        InputError: a value is not finite or not above 0.
    """

    speed: float = 0.5
    turn: float = 1.0
    acceleration: float = 0.5
    turn_acceleration: float = 2.0
    link: float = 0.5
    command: float = 0.5

    def __post_init__(self) -> None:
        for name, unit in zip(self.__dataclass_fields__, ("m/s", "rad/s", "m/s2", "rad/s2", "s", "s"), strict=True):
            check_number("GuardLimits", name, getattr(self, name), unit, exclusive_min=0.0)


@dataclass
class CommandGuard:
    """Turns wanted velocities into those that may leave, all times in real time [s].

    An emergency stop is immediate and lasts until :meth:`release`: a key or message, no pose for ``limits.link``, or a
    robot that is outside its area or would not come to rest inside. Without commands, the robot stops with its
    acceleration limit and drives on with the next one. Until its first pose has come, the robot stands.

    Fields:
        area: where the robot may be.
        limits: limits of the commands.

    Attributes:
        reason: why the robot is stopped; empty if it may drive.
        stops: all reasons until now.

    >>> guard = CommandGuard(DrivingArea(-3.0, -3.0, 3.0, 3.0))
    >>> guard.note_pose(0.0, 0.0, 0.0, now=0.0)
    >>> guard.note_command(Twist(2.0), now=0.0)
    >>> guard.next_command(now=0.0).forward, round(guard.next_command(now=0.2).forward, 3)
    (0.0, 0.1)
    >>> guard.stop("the key")
    >>> guard.next_command(now=0.25).forward, guard.reason
    (0.0, 'the key')
    """

    area: DrivingArea
    limits: GuardLimits = field(default_factory=GuardLimits)
    reason: str = field(default="", init=False)
    stops: list[str] = field(default_factory=list, init=False)
    _pose: tuple[float, float, float] | None = field(default=None, init=False)
    _pose_time: float = field(default=-math.inf, init=False)
    _wanted: Twist = field(default_factory=Twist, init=False)
    _wanted_time: float = field(default=-math.inf, init=False)
    _sent: Twist = field(default_factory=Twist, init=False)
    _sent_time: float | None = field(default=None, init=False)

    def note_pose(self, x: float, y: float, heading: float, now: float) -> None:
        """Take the pose of the robot in the frame of the trial [m], [rad]."""
        self._pose, self._pose_time = (x, y, heading), now

    @property
    def has_pose(self) -> bool:
        """Whether a pose has come."""
        return self._pose is not None

    @property
    def waits(self) -> bool:
        """Whether the robot has a command and stands only because no pose has come."""
        return not self.reason and self._pose is None and any(self._wanted)

    def note_command(self, twist: Twist, now: float) -> None:
        """Take a wanted velocity.

        Raises:
            InputError: it is not finite.
        """
        if not all(map(math.isfinite, twist)):
            raise InputError(f"command {tuple(twist)} must be finite")
        self._wanted, self._wanted_time = twist, now

    def stop(self, reason: str) -> None:
        """Stop the robot until :meth:`release`; the first reason stays."""
        if not self.reason:
            self.reason = reason
            self.stops.append(reason)

    def release(self, now: float) -> str:
        """Let the robot drive again after new commands, and return why not, or an empty text."""
        problem = self._danger(now, Twist())
        if not problem:
            self.reason, self._wanted, self._wanted_time = "", Twist(), -math.inf
        return problem

    def next_command(self, now: float) -> Twist:
        """Return the velocity that may leave now."""
        step = 0.0 if self._sent_time is None else max(0.0, now - self._sent_time)
        twist = Twist() if self.reason or self._pose is None else self._limited(now, step)
        if not self.reason and (problem := self._danger(now, twist)):
            self.stop(problem)
            twist = Twist()
        self._sent, self._sent_time = twist, now
        return twist

    def _limited(self, now: float, step: float) -> Twist:
        limits = self.limits
        wanted = self._wanted if now - self._wanted_time <= limits.command else Twist()
        forward, left = _shortened(wanted.forward, wanted.left, limits.speed)
        turn = max(-limits.turn, min(limits.turn, wanted.turn))
        more_forward, more_left = _shortened(
            forward - self._sent.forward, left - self._sent.left, limits.acceleration * step
        )
        most = limits.turn_acceleration * step
        more_turn = max(-most, min(most, turn - self._sent.turn))
        return Twist(self._sent.forward + more_forward, self._sent.turn + more_turn, self._sent.left + more_left)

    def _danger(self, now: float, twist: Twist) -> str:
        """Return why the robot must stop, or an empty text."""
        if self._pose is None:
            return ""
        if now - self._pose_time > self.limits.link:
            return f"the link is lost: no pose of the robot for {self.limits.link:g} s"
        x, y, heading = self._pose
        if not self.area.has(x, y):
            return f"the robot has left its area at {x:.2f}, {y:.2f}"
        way = math.hypot(twist.forward, twist.left) / (2.0 * self.limits.acceleration)
        cos, sin = math.cos(heading), math.sin(heading)
        end = (
            x + way * (cos * twist.forward - sin * twist.left),
            y + way * (sin * twist.forward + cos * twist.left),
        )
        return "" if self.area.has(*end) else f"the robot would leave its area from {x:.2f}, {y:.2f}"


def _shortened(x: float, y: float, longest: float) -> tuple[float, float]:
    """Return a vector with at most this length."""
    length = math.hypot(x, y)
    return (x, y) if length <= longest else (x * longest / length, y * longest / length)

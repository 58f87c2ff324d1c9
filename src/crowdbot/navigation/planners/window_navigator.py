"""The dynamic window approach as a navigator: admissible twists of the next moments, judged by three terms."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.core import Paper, Twist, check_number, wrap_angle
from crowdbot.navigation.goal_motion import SLOWING_TIME
from crowdbot.navigation.navigator import Navigator
from crowdbot.navigation.observation import DriveLimits, Observation
from crowdbot.navigation.wall_arrays import wall_arrays
from crowdbot.typing import Floats

from .clearance import robot_wall_gaps, wall_gaps

STEP = 0.1
"""Time step of the simulated arcs [s]."""
SPEEDS, TURNS = 9, 21
"""Number of candidate speeds and turn rates, or of speeds ahead and aside of a holonomic drive."""
EAGER = 100.0
"""Value for unknown accelerations [m/s2], [rad/s2]."""


@dataclass(frozen=True)
class DynamicWindowNavigator(Navigator):
    """Takes the best admissible twist that the drive reaches within ``window``.

    Each twist is an arc (a line for a holonomic drive). With t the time to the first contact, people predicted at
    constant velocity, a twist is admissible if the drive can stop before the contact:
    ``v <= sqrt(2 a d)`` with the distance ``d = v t``. Its value is
    ``heading (1 - |theta| / pi) + clearance min(t, look) / look + velocity v / top``, with theta the angle to the
    waypoint 0.3 s later. Without an admissible twist the robot brakes.

    :func:`crowdbot.navigation.dynamic_window_twist` is another search: it follows a given velocity.

    Fields:
        speed: largest speed [m/s], limited by the drive.
        heading: weight of the angle to the waypoint.
        clearance: weight of the time to the first contact.
        velocity: weight of the speed.
        look: simulated time [s].
        window: time in which a twist must be reachable [s].
        margin: clearance to people that counts as contact [m].
        wall_margin: the same for walls [m].

    Source: Fox, Burgard, Thrun 1997, doi:10.1109/100.580977; the original has standing obstacles and the distance along
    the arc instead of the time.

    Raises:
        InputError: a number is out of its range.

    >>> from crowdbot.navigation import DriveLimits
    >>> free = Observation(pose=(0.0, 0.0, 0.0), goal=(9.0, 0.0), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.1)
    >>> DynamicWindowNavigator(speed=0.8).act(free)
    Twist(forward=0.8, turn=0.0, left=0.0)
    """

    paper: ClassVar[Paper] = Paper(
        "Fox, Burgard, Thrun",
        1997,
        "The dynamic window approach to collision avoidance",
        "IEEE Robotics & Automation Magazine 4",
        "10.1109/100.580977",
    )
    always_returns = True

    speed: float = 1.0
    heading: float = 0.8
    clearance: float = 0.6
    velocity: float = 0.3
    look: float = 3.5
    window: float = 0.5
    margin: float = 0.3
    wall_margin: float = 0.05

    def __post_init__(self) -> None:
        for name, unit in {"speed": "m/s", "look": "s", "window": "s"}.items():
            check_number("DynamicWindowNavigator", name, getattr(self, name), unit, exclusive_min=0.0)
        for name, unit in {"heading": "", "clearance": "", "velocity": "", "margin": "m", "wall_margin": "m"}.items():
            check_number("DynamicWindowNavigator", name, getattr(self, name), unit, min=0.0)

    def act(self, observation: Observation) -> Twist:
        limits, now = observation.limits, observation.twist
        top = min(self.speed, limits.max_speed)
        twists = window_twists(now, limits, top, self.window)
        points, angle = _arcs(observation, twists, max(2, round(self.look / STEP)))
        heading = observation.heading + twists[:, 1, None] * STEP * np.arange(1, points.shape[1] + 1)
        free = self._free_times(observation, points, heading)
        size = np.hypot(twists[:, 0], twists[:, 2])
        braking = min(limits.max_acceleration, EAGER)
        stops = size <= 2.0 * braking * np.maximum(free - STEP, 0.0)
        arrives = size <= max(observation.remaining / SLOWING_TIME, float(size.min()))
        slow = size <= max(observation.braking_speed(observation.remaining), float(size.min()))
        value = (
            self.heading * (1.0 - np.abs(angle) / math.pi)
            + self.clearance * np.minimum(free, self.look) / self.look
            + self.velocity * size / top
        )
        value[~((stops | (size == 0.0)) & arrives & slow)] = -np.inf
        best = int(np.argmax(value))
        if value[best] == -np.inf:
            return Twist()
        forward, turn, left = twists[best].tolist()
        if limits.holonomic:
            turn = observation.turn_by(observation.direction_to(observation.waypoint)) if size[best] > 0.05 else 0.0
        return Twist(forward, turn, left)

    def _free_times(self, observation: Observation, points: Floats, heading: Floats) -> Floats:
        """Return the times ``[C]`` [s] to the first contact on paths ``[C, T, 2]`` with headings ``[C, T]``, or inf."""
        people, (C, T) = observation.people, points.shape[:2]
        times = STEP * np.arange(1, T + 1)
        there = people.position + times[:, None, None] * people.velocity
        away = points[:, :, None] - there
        gap = np.hypot(away[..., 0], away[..., 1]) - people.radius - observation.radius
        meets = (gap < np.minimum(self.margin, np.maximum(observation.clearances, 0.0))).any(axis=2)
        near = _near_walls(observation, self.look)
        walls = robot_wall_gaps(observation, points.reshape(-1, 2), heading.reshape(-1), near).reshape(C, T)
        now = float(robot_wall_gaps(observation, observation.position[None], np.array([observation.heading]), near)[0])
        meets |= walls < min(self.wall_margin, max(now - 1e-6, -observation.radius))
        return np.where(meets.any(axis=1), times[np.argmax(meets, axis=1)], np.inf)


def window_twists(now: Twist, limits: DriveLimits, top: float, window: float) -> Floats:
    """Return the candidates ``[C, 3]`` within the window of accelerations around the current twist."""
    push = min(limits.max_acceleration, EAGER) * window
    if limits.holonomic:
        ahead = np.linspace(max(-top, min(now.forward - push, top)), min(top, max(now.forward + push, -top)), TURNS)
        aside = np.linspace(max(-top, min(now.left - push, top)), min(top, max(now.left + push, -top)), TURNS)
        grid = np.stack(np.meshgrid(ahead, np.append(aside, 0.0), indexing="ij"), axis=-1).reshape(-1, 2)
        size = np.hypot(*grid.T)
        grid = np.vstack([grid * np.minimum(1.0, top / np.maximum(size, 1e-9))[:, None], np.zeros((1, 2))])
        return np.stack([grid[:, 0], np.zeros(len(grid)), grid[:, 1]], axis=1)
    spin = min(limits.max_turn_acceleration, EAGER) * window
    low, high = max(0.0, min(now.forward - push, top)), min(top, max(0.0, now.forward + push))
    most = limits.max_turn_rate
    turns = np.linspace(max(-most, min(now.turn - spin, most)), min(most, max(now.turn + spin, -most)), TURNS)
    if turns[0] < 0.0 < turns[-1]:
        turns = np.append(turns, 0.0)
    pairs = np.stack(np.meshgrid(np.linspace(low, high, SPEEDS)[::-1], turns, indexing="ij"), axis=-1).reshape(-1, 2)
    return np.column_stack([pairs, np.zeros(len(pairs))])


def _arcs(observation: Observation, twists: Floats, steps: int) -> tuple[Floats, Floats]:
    """Return the points ``[C, T, 2]`` of arcs, and the angles ``[C]`` to the waypoint after a few steps [rad]."""
    x, y, heading = observation.pose
    k = np.arange(steps)
    middle = heading + twists[:, 1, None] * STEP * (k + 0.5)
    cos, sin = np.cos(middle), np.sin(middle)
    vx = cos * twists[:, 0, None] - sin * twists[:, 2, None]
    vy = sin * twists[:, 0, None] + cos * twists[:, 2, None]
    points = np.stack([x + STEP * np.cumsum(vx, axis=1), y + STEP * np.cumsum(vy, axis=1)], axis=-1)
    m = min(3, steps - 1)
    towards = np.array(observation.waypoint) - points[:, m]
    course = heading + twists[:, 1] * STEP * (m + 1)
    if observation.limits.holonomic:
        course = np.where(np.hypot(vx[:, 0], vy[:, 0]) > 0.0, np.arctan2(vy[:, 0], vx[:, 0]), heading + math.pi)
    angle = np.arctan2(towards[:, 1], towards[:, 0]) - course
    return points, wrap_angle(angle)


def _near_walls(observation: Observation, seconds: float) -> Floats:
    """Return the walls ``[M, 4]`` that the robot may reach in a time."""
    segments = wall_arrays(observation.walls).segments
    if len(segments) == 0:
        return segments
    each = np.array([wall_gaps(observation.position[None], row[None], observation.radius)[0] for row in segments])
    return np.asarray(segments[each < observation.limits.max_speed * seconds + 1.0])

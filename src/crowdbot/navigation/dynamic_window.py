"""Dynamic window: from a desired velocity to a collision-free twist within the limits of a drive.

Twists within the acceleration limits are simulated for a short time, people at constant velocity. The cost combines
the distance to the desired velocity and the clearance to people and walls.

Source of the idea: Fox, Burgard, Thrun 1997, doi:10.1109/100.580977.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Twist, kernel
from crowdbot.core.geometry import nearest_on_segment

from .observation import Observation

__all__ = ["WindowCosts", "dynamic_window_twist"]

Floats = NDArray[np.float64]

STEP = 0.1
"""Time step of the simulated paths [s]."""
WINDOW = 0.5
"""Candidates are the twists that the drive reaches within this time [s]."""
MATCH = 5
"""Number of steps after which the velocity is compared."""
SIGHT = 5.0
"""People and walls farther away than this are ignored [m]."""
FORWARD, TURNS = 9, 13
"""Number of candidate speeds and turn rates."""
EAGER = 100.0
"""Value for unknown accelerations [m/s2], [rad/s2]."""


class WindowCosts(NamedTuple):
    """Weights of the cost of a twist, which is its difference from the desired velocity [m/s] plus penalties [m/s]."""

    look: float = 1.5
    """Simulated time [s]."""
    margin: float = 0.3
    """Clearance to people below which a penalty applies [m]."""
    near: float = 1.0
    """Penalty at clearance 0; it fades with time."""
    skin: float = 0.05
    """Clearance to people that counts as contact [m]."""
    contact: float = 10.0
    """Penalty of an immediate contact; it fades with time."""
    wall_margin: float = 0.1
    """Clearance to walls below which a penalty applies [m]."""
    wall: float = 20.0
    """Penalty of wall contact."""
    facing: float = 0.5
    """Penalty of not facing the desired velocity, relative to its speed."""


class _Start(NamedTuple):
    """Initial motion and limits of the drive."""

    heading: float
    forward: float
    turn: float
    radius: float
    change: float
    turn_change: float


@kernel
def _cost(
    forward: float, turn: float, start: _Start, wish: Floats, people: Floats, walls: Floats, c: WindowCosts
) -> float:
    """Return the cost of a twist; people are rows x, y, vx, vy, radius relative to the robot."""
    x, y, heading, v, w = 0.0, 0.0, start.heading, start.forward, start.turn
    near, contact, touch, miss = 0.0, 0.0, 0.0, 0.0
    steps = max(MATCH, round(c.look / STEP))
    for k in range(steps):
        v += min(max(forward - v, -start.change), start.change)
        w += min(max(turn - w, -start.turn_change), start.turn_change)
        before_x, before_y, t = x, y, k * STEP
        x += v * math.cos(heading + 0.5 * w * STEP) * STEP
        y += v * math.sin(heading + 0.5 * w * STEP) * STEP
        heading += w * STEP
        fade = 1.0 - k / steps
        if k + 1 == MATCH:
            span = MATCH * STEP
            aside = math.sqrt(wish[0] ** 2 + wish[1] ** 2) - wish[0] * math.cos(heading) - wish[1] * math.sin(heading)
            miss = math.sqrt((x / span - wish[0]) ** 2 + (y / span - wish[1]) ** 2) + c.facing * aside
        for n in range(len(people)):
            px, py = people[n, 0] + people[n, 2] * t, people[n, 1] + people[n, 3] * t
            qx, qy = px + people[n, 2] * STEP - x, py + people[n, 3] * STEP - y
            nx, ny = nearest_on_segment(0.0, 0.0, px - before_x, py - before_y, qx, qy)
            gap = math.sqrt(nx * nx + ny * ny) - start.radius - people[n, 4]
            if gap < c.margin:
                near = max(near, fade * (c.margin - gap) / c.margin)
            if gap < c.skin:
                contact = max(contact, fade)
        for n in range(len(walls)):
            nx, ny = nearest_on_segment(x, y, walls[n, 0], walls[n, 1], walls[n, 2], walls[n, 3])
            gap = math.sqrt((nx - x) ** 2 + (ny - y) ** 2) - start.radius
            touch = max(touch, (c.wall_margin - gap) / c.wall_margin)
    return miss + c.near * near + c.contact * contact + c.wall * touch


@kernel
def _cheapest(
    forwards: Floats, turns: Floats, start: _Start, wish: Floats, people: Floats, walls: Floats, caution: WindowCosts
) -> tuple[float, float]:
    best, chosen, turning = np.inf, 0.0, 0.0
    for forward in forwards:
        for turn in turns:
            cost = _cost(forward, turn, start, wish, people, walls, caution)
            if cost < best:
                best, chosen, turning = cost, forward, turn
    return chosen, turning


def dynamic_window_twist(
    observation: Observation, wish: tuple[float, float], speed: float, caution: WindowCosts | None = None
) -> Twist:
    """Return the reachable twist with the smallest cost.

    Args:
        observation: what the robot knows.
        wish: desired velocity x, y in the world [m/s].
        speed: largest speed [m/s].
        caution: weights of the cost.

    >>> from crowdbot.navigation import DriveLimits
    >>> limits = DriveLimits(max_speed=1.0, max_turn_rate=2.0, max_acceleration=1.0, max_turn_acceleration=3.0)
    >>> still = Observation(pose=(0.0, 0.0, 0.0), goal=(9.0, 0.0), radius=0.3, limits=limits, dt=0.1)
    >>> dynamic_window_twist(still, (1.0, 0.0), speed=1.0)
    Twist(forward=0.5, turn=0.0, left=0.0)
    """
    top = min(speed, observation.limits.max_speed)
    push = min(observation.limits.max_acceleration, EAGER)
    spin = min(observation.limits.max_turn_acceleration, EAGER)
    forward, turn = observation.twist.forward, observation.twist.turn
    forwards = np.linspace(
        max(0.0, min(forward - push * WINDOW, top)), min(top, max(0.0, forward + push * WINDOW)), FORWARD
    )
    most = observation.limits.max_turn_rate
    turns = np.linspace(max(-most, turn - spin * WINDOW), min(most, turn + spin * WINDOW), TURNS)
    start = _Start(observation.heading, forward, turn, observation.radius, push * STEP, spin * STEP)
    chosen, turning = _cheapest(
        forwards, turns, start, np.array(wish), _people(observation), _walls(observation), caution or WindowCosts()
    )
    return Twist(float(chosen), float(turning))


def _people(observation: Observation) -> Floats:
    people = observation.people
    away = people.position - observation.position
    rows = np.concatenate([away, people.velocity, people.radius[:, None]], axis=1)
    return np.ascontiguousarray(rows[np.hypot(away[:, 0], away[:, 1]) < SIGHT])


def _walls(observation: Observation) -> Floats:
    walls = observation.walls.segments() - np.tile(observation.position, 2)
    along = walls[:, 2:] - walls[:, :2]
    length2 = np.maximum(along[:, 0] ** 2 + along[:, 1] ** 2, 1e-300)
    share = np.clip(-(walls[:, 0] * along[:, 0] + walls[:, 1] * along[:, 1]) / length2, 0.0, 1.0)
    foot = walls[:, :2] + share[:, None] * along
    return np.ascontiguousarray(walls[np.hypot(foot[:, 0], foot[:, 1]) < SIGHT])

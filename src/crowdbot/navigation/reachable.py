"""From a wished velocity to a twist that a drive can reach and that runs into nobody: a dynamic window.

Twists within reach of the accelerations are tried; each is followed for a moment, people going on with their velocity
meanwhile. The best one comes nearest to the wish and keeps clear of people and walls.

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

__all__ = ["Caution", "reachable"]

Floats = NDArray[np.float64]

STEP = 0.1
"""Time step of the ways that are tried [s]."""
WINDOW = 0.5
"""Twists that the drive can reach within this time [s] are tried."""
MATCH = 5
"""The wish is compared after so many steps."""
SIGHT = 5.0
"""People and walls farther than this are not considered [m]."""
FORWARD, TURNS = 9, 13
"""Number of speeds and of turn rates that are tried."""
EAGER = 100.0
"""An acceleration that nobody knows counts as this [m/s2], [rad/s2]."""


class Caution(NamedTuple):
    """What a twist costs besides its difference [m/s] from the wish; all but the distances in m/s."""

    look: float = 1.5
    """How far ahead ways are followed [s]."""
    margin: float = 0.3
    """Clearance to people below which a way costs [m]."""
    near: float = 1.0
    """Cost of a way that comes to clearance 0, the less the later."""
    skin: float = 0.05
    """Clearance to people that counts as contact [m]."""
    contact: float = 10.0
    """Cost of a contact at once, the less the later."""
    wall_margin: float = 0.1
    """Clearance to walls below which a way costs [m]."""
    wall: float = 20.0
    """Cost of touching a wall."""
    facing: float = 0.5
    """Cost of not facing the wish, as a share of its speed."""


class _Start(NamedTuple):
    """Where every way begins, and what the drive can do."""

    heading: float
    forward: float
    turn: float
    radius: float
    change: float
    turn_change: float


@kernel
def _cost(forward: float, turn: float, start: _Start, wish: Floats, people: Floats, walls: Floats, c: Caution) -> float:
    """Return what it costs to ask for a twist; people are rows x, y, vx, vy, radius from the robot's place."""
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
    forwards: Floats, turns: Floats, start: _Start, wish: Floats, people: Floats, walls: Floats, caution: Caution
) -> tuple[float, float]:
    best, chosen, turning = np.inf, 0.0, 0.0
    for forward in forwards:
        for turn in turns:
            cost = _cost(forward, turn, start, wish, people, walls, caution)
            if cost < best:
                best, chosen, turning = cost, forward, turn
    return chosen, turning


def reachable(
    observation: Observation, wish: tuple[float, float], speed: float, caution: Caution | None = None
) -> Twist:
    """Return the twist within reach that fits a wished velocity best and keeps clear of people and walls.

    Args:
        observation: what the robot knows.
        wish: x, y in the world [m/s].
        speed: never faster than this [m/s].
        caution: what nearness costs.

    >>> from crowdbot.navigation import Limits
    >>> limits = Limits(max_speed=1.0, max_turn_rate=2.0, max_acceleration=1.0, max_turn_acceleration=3.0)
    >>> still = Observation(pose=(0.0, 0.0, 0.0), goal=(9.0, 0.0), radius=0.3, limits=limits, dt=0.1)
    >>> reachable(still, (1.0, 0.0), speed=1.0)
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
        forwards, turns, start, np.array(wish), _people(observation), _walls(observation), caution or Caution()
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

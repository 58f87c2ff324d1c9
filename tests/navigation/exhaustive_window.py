"""The dynamic window without shortcuts: the cost of every candidate, computed to the end. A twin for tests."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Twist, kernel
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.navigation import Observation, WindowCosts
from crowdbot.navigation.dynamic_window import EAGER
from crowdbot.navigation.window_search import FORWARD, MATCH, SIGHT, STEP, TURNS, WINDOW

Floats = NDArray[np.float64]


class Start(NamedTuple):
    """Initial motion and limits of the drive."""

    heading: float
    forward: float
    turn: float
    radius: float
    change: float
    turn_change: float


@kernel
def cost_of(
    forward: float, turn: float, start: Start, wish: Floats, people: Floats, walls: Floats, c: WindowCosts
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
def cheapest(
    forwards: Floats, turns: Floats, start: Start, wish: Floats, people: Floats, walls: Floats, caution: WindowCosts
) -> tuple[float, float]:
    best, chosen, turning = np.inf, 0.0, 0.0
    for forward in forwards:
        for turn in turns:
            cost = cost_of(forward, turn, start, wish, people, walls, caution)
            if cost < best:
                best, chosen, turning = cost, forward, turn
    return chosen, turning


def exhaustive_twist(
    observation: Observation, wish: tuple[float, float], speed: float, caution: WindowCosts | None = None
) -> Twist:
    """Return the reachable twist with the smallest cost, of all 117 candidates."""
    top = min(speed, observation.limits.max_speed)
    push = min(observation.limits.max_acceleration, EAGER)
    spin = min(observation.limits.max_turn_acceleration, EAGER)
    forward, turn = observation.twist.forward, observation.twist.turn
    forwards = np.linspace(
        max(0.0, min(forward - push * WINDOW, top)), min(top, max(0.0, forward + push * WINDOW)), FORWARD
    )
    most = observation.limits.max_turn_rate
    turns = np.linspace(max(-most, turn - spin * WINDOW), min(most, turn + spin * WINDOW), TURNS)
    start = Start(observation.heading, forward, turn, observation.radius, push * STEP, spin * STEP)
    chosen, turning = cheapest(
        forwards, turns, start, np.array(wish), people_of(observation), walls_of(observation), caution or WindowCosts()
    )
    return Twist(float(chosen), float(turning))


def people_of(observation: Observation) -> Floats:
    people = observation.people
    away = people.position - observation.position
    rows = np.concatenate([away, people.velocity, people.radius[:, None]], axis=1)
    return np.ascontiguousarray(rows[np.hypot(away[:, 0], away[:, 1]) < SIGHT])


def walls_of(observation: Observation) -> Floats:
    walls = observation.walls.segments() - np.tile(observation.position, 2)
    along = walls[:, 2:] - walls[:, :2]
    length2 = np.maximum(along[:, 0] ** 2 + along[:, 1] ** 2, 1e-300)
    share = np.clip(-(walls[:, 0] * along[:, 0] + walls[:, 1] * along[:, 1]) / length2, 0.0, 1.0)
    foot = walls[:, :2] + share[:, None] * along
    return np.ascontiguousarray(walls[np.hypot(foot[:, 0], foot[:, 1]) < SIGHT])

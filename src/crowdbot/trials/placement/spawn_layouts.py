"""Spawn layouts: people who start on a circle or in one half of a zone, and go to the opposite side.

They reproduce the rules of CrowdNav: the angle on the circle is uniform, each coordinate gets uniform noise, and a
start closer than the sum of the radii and 0.2 m to a start or goal of somebody else is drawn again.

Source: Chen et al. 2019, Crowd-robot interaction, doi:10.1109/ICRA.2019.8794134, with the code of the authors.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from crowdbot.core import kernel, next_uniform, stream_states
from crowdbot.trials.people import Spawner
from crowdbot.trials.robot import RobotSpec
from crowdbot.typing import Floats, Ints, Words

CLEARANCE = 0.2
"""Clearance between people, and to robots, at the beginning and at their goals [m]."""
TRIES = 300
"""Number of places drawn for a person before the whole layout is drawn again."""
LAYOUTS = 300
"""Number of layouts drawn before the people do not fit."""


class LayoutDraw(NamedTuple):
    """People of a layout in E environments.

    Fields:
        position, goal: ``[E, N, 2]`` [m].
        placed: ``[E]`` number of people who fit.
    """

    position: Floats
    goal: Floats
    placed: Ints


def goal_discs(robots: Sequence[RobotSpec]) -> Floats:
    """Return ``[R, 3]`` goals x, y and radii of robots [m]."""
    rows = [(robot.goal.x, robot.goal.y, robot.radius) for robot in robots]
    return np.array(rows, dtype=np.float64).reshape(-1, 3)


def draw_layout(
    spawner: Spawner, number: int, seeds: Sequence[int], radius: Floats, starts: Floats, goals: Floats
) -> LayoutDraw:
    """Return the people of a spawner with a layout, for many seeds at once.

    Args:
        spawner: the spawner; its layout is ``circle`` or ``halves``.
        number: index of the spawner, which names its random stream.
        seeds: E seeds.
        radius: ``[E, N]`` radii [m].
        starts: ``[E, D, 3]`` x, y and radius of discs in which nobody starts [m].
        goals: ``[E, G, 3]`` the same for goals; nobody starts or ends there.

    >>> square = [(-4, -4), (4, -4), (4, 4), (-4, 4)]
    >>> people = Spawner(count=3, zone=square, goal=square, arrival="stay", layout="circle", noise=0.5)
    >>> none = np.zeros((1, 0, 3))
    >>> drawn = draw_layout(people, 0, [7], np.full((1, 3), 0.3), none, none)
    >>> drawn.placed.tolist(), bool(np.array_equal(drawn.goal, -drawn.position))
    ([3], True)
    """
    E, N = radius.shape
    corners = np.array(spawner.zone, dtype=np.float64)
    low, high = corners.min(axis=0), corners.max(axis=0)
    box = np.array([*(0.5 * (low + high)), *(0.5 * (high - low)), spawner.noise])
    whole = np.array([_wrapped(seed) for seed in seeds], dtype=np.int64)
    states = stream_states(whole, [("spawner", number, "layout")])[:, 0].copy()
    drawn = LayoutDraw(np.zeros((E, N, 2)), np.zeros((E, N, 2)), np.zeros(E, dtype=np.int64))
    begin, end = (np.require(item, np.float64, ["C", "W"]) for item in (starts, goals))
    sizes = np.require(radius, np.float64, ["C", "W"])
    _draw_all(states, spawner.layout == "circle", box, sizes, begin, end, *drawn)
    return drawn


def _wrapped(seed: int) -> int:
    """Return a seed of any size as one of 64 bits."""
    return (int(seed) + 2**63) % 2**64 - 2**63


@kernel
def _draw_all(
    states: Words, circle: bool, box: Floats, radius: Floats, starts: Floats, goals: Floats,
    position: Floats, goal: Floats, placed: Ints,
) -> None:  # fmt: skip
    """Write the people of all environments; a layout in which somebody finds no place is drawn again."""
    N = radius.shape[1]
    for e in range(len(states)):
        for _ in range(LAYOUTS):
            count = int(np.int64(0))
            while count < N and _find_place(
                states[e], circle, box, radius[e], starts[e], goals[e], count, position[e], goal[e]
            ):
                count += 1
            placed[e] = count
            if count == N:
                break


@kernel
def _find_place(
    state: Words, circle: bool, box: Floats, radius: Floats, starts: Floats, goals: Floats, n: int,
    position: Floats, goal: Floats,
) -> bool:  # fmt: skip
    """Write start and goal of person ``n``, clear of those before, and return whether a place was found."""
    side = 1.0 if next_uniform(state) < 0.5 else -1.0
    for _ in range(TRIES):
        if circle:
            angle = 2.0 * math.pi * next_uniform(state)
            dx = box[2] * math.cos(angle) + box[4] * (2.0 * next_uniform(state) - 1.0)
            dy = box[3] * math.sin(angle) + box[4] * (2.0 * next_uniform(state) - 1.0)
        else:
            dx = side * box[2] * next_uniform(state)
            dy = box[3] * (2.0 * next_uniform(state) - 1.0)
        position[n, 0], position[n, 1] = box[0] + dx, box[1] + dy
        if not _is_clear(position[n], radius, n, starts, position):
            continue
        if circle:
            goal[n, 0], goal[n, 1] = box[0] - dx, box[1] - dy
            if _is_clear(position[n], radius, n, goals, goal):
                return True
            continue
        for _ in range(TRIES):
            goal[n, 0] = box[0] - side * box[2] * next_uniform(state)
            goal[n, 1] = box[1] + box[3] * (2.0 * next_uniform(state) - 1.0)
            if _is_clear(goal[n], radius, n, goals, goal):
                return True
    return False


@kernel
def _is_clear(point: Floats, radius: Floats, n: int, discs: Floats, others: Floats) -> bool:
    """Return whether a point is clear of discs and of the points of the people before ``n``."""
    for k in range(len(discs)):
        least = radius[n] + discs[k, 2] + CLEARANCE
        dx, dy = point[0] - discs[k, 0], point[1] - discs[k, 1]
        if dx * dx + dy * dy < least * least:
            return False
    for k in range(n):
        least = radius[n] + radius[k] + CLEARANCE
        dx, dy = point[0] - others[k, 0], point[1] - others[k, 1]
        if dx * dx + dy * dy < least * least:
            return False
    return True

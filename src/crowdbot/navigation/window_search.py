"""Kernels of the dynamic window: the cheapest of 117 twists for each robot, found by branch and bound.

The cost of a twist is its difference from the desired velocity plus penalties that are never negative. Twists are
tried in order of the difference; a twist is given up as soon as its partial cost exceeds the best cost. People and
walls that no twist reaches are left out. Neither changes a bit of the result.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.core.geometry import nearest_on_segment

__all__ = ["FORWARD", "MATCH", "SIGHT", "STEP", "TURNS", "WINDOW", "choose_twists"]

Floats = NDArray[np.float64]
Counts = NDArray[np.int64]

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
SLACK = 1e-6
"""Margin [m] of what is left out, against rounding."""

MARGIN, NEAR, SKIN, CONTACT, WALL_MARGIN, WALL, FACING = 0, 1, 2, 3, 4, 5, 6
"""Indices of the weights."""


class _Work(NamedTuple):
    """Working memory of the search for one robot, with S steps."""

    forwards: Floats
    """``[FORWARD]`` candidate speeds [m/s]."""
    turns: Floats
    """``[TURNS]`` candidate turn rates [rad/s]."""
    speeds: Floats
    """``[S, FORWARD]`` speed in each step."""
    course: Floats
    """``[TURNS, S, 2]`` cosine and sine of the direction of each step."""
    ends: Floats
    """``[TURNS, 2]`` heading [rad] and turn rate [rad/s] after the computed steps."""
    known: Counts
    """``[TURNS]`` number of computed steps of the course."""
    miss: Floats
    """``[TURNS, FORWARD]`` difference from the desired velocity [m/s]; inf for tried candidates."""
    passing: Floats
    """``[S, A, 6]`` people within reach in each step: x, y before it and after it [m], radius, squared reach."""
    number: Counts
    """``[S]`` number of these people."""
    walls: Floats
    """``[M, 4]`` walls within reach, relative to the robot [m]."""
    fades: Floats
    """``[S]`` weight of each step."""
    reached: Floats
    """``[MATCH, 4]`` box x, y, x, y around all candidates before each of the first steps [m]."""


@kernel
def _fill(out: Floats, start: float, stop: float) -> None:
    """Write evenly spaced numbers with the bits of ``numpy.linspace``."""
    parts = len(out) - 1
    step = (stop - start) / parts
    for k in range(parts):
        out[k] = (k * step if step != 0.0 else k / parts * (stop - start)) + start
    out[parts] = stop


@kernel
def _larger(a: float, b: float) -> float:
    return b if b > a else a  # as the max of Python, also for zeros with different signs


@kernel
def _smaller(a: float, b: float) -> float:
    return b if b < a else a


@kernel
def _extend(work: _Work, j: int, change: float, steps: int) -> None:
    """Compute the course of turn rate j up to a number of steps."""
    course, ends = work.course, work.ends
    heading, w, turn = ends[j, 0], ends[j, 1], work.turns[j]
    for k in range(work.known[j], steps):
        w += min(max(turn - w, -change), change)
        course[j, k, 0] = math.cos(heading + 0.5 * w * STEP)
        course[j, k, 1] = math.sin(heading + 0.5 * w * STEP)
        heading += w * STEP
    ends[j, 0], ends[j, 1] = heading, w
    work.known[j] = steps


@kernel
def _stretch(box: Floats, x: Floats, y: Floats) -> None:
    """Extend a box to the points of all speeds."""
    for i in range(FORWARD):
        box[0], box[1] = min(box[0], x[i]), min(box[1], y[i])
        box[2], box[3] = max(box[2], x[i]), max(box[3], y[i])


@kernel
def _compare(work: _Work, forward: float, change: float, wish_x: float, wish_y: float, facing: float) -> None:
    """Compute speeds, and the difference of each candidate from the desired velocity after :data:`MATCH` steps."""
    speeds, course, ends, miss = work.speeds, work.course, work.ends, work.miss
    for i in range(FORWARD):
        v, wanted = forward, work.forwards[i]
        for k in range(len(speeds)):
            v += min(max(wanted - v, -change), change)
            speeds[k, i] = v
    length = math.sqrt(wish_x**2 + wish_y**2)
    span = MATCH * STEP
    x, y = np.empty(FORWARD), np.empty(FORWARD)
    work.reached[0] = 0.0
    work.reached[1:, :2], work.reached[1:, 2:] = math.inf, -math.inf
    for j in range(TURNS):
        aside = length - wish_x * math.cos(ends[j, 0]) - wish_y * math.sin(ends[j, 0])
        x[:], y[:] = 0.0, 0.0
        for k in range(MATCH):
            cos, sin = course[j, k, 0], course[j, k, 1]
            for i in range(FORWARD):  # vector instructions: one number for each speed
                x[i] += speeds[k, i] * cos * STEP
                y[i] += speeds[k, i] * sin * STEP
            if k + 1 < MATCH:
                _stretch(work.reached[k + 1], x, y)
        for i in range(FORWARD):
            miss[j, i] = math.sqrt((x[i] / span - wish_x) ** 2 + (y[i] / span - wish_y) ** 2) + facing * aside


@kernel
def _list_people(
    work: _Work, x: float, y: float, radius: float, fastest: float, reach: float,
    position: Floats, velocity: Floats, size: Floats, seen: NDArray[np.bool_],
) -> None:  # fmt: skip
    """List the people whom the robot may come closer to than ``reach``, for each step."""
    passing, count = work.passing, work.number
    count[:] = 0
    for a in range(len(size)):
        if not seen[a]:
            continue
        rx, ry, vx, vy = position[a, 0] - x, position[a, 1] - y, velocity[a, 0], velocity[a, 1]
        if not math.hypot(rx, ry) < SIGHT:
            continue
        far = radius + size[a] + reach + (math.sqrt(vx * vx + vy * vy) + fastest) * STEP * (1.0 + SLACK) + SLACK
        for k in range(len(count)):
            t = k * STEP
            px, py = rx + vx * t, ry + vy * t
            farthest = far + fastest * t * (1.0 + SLACK)
            if px * px + py * py > farthest * farthest:
                continue
            row = passing[k, count[k]]
            row[0], row[1], row[2], row[3] = px, py, px + vx * STEP, py + vy * STEP
            row[4], row[5] = size[a], far * far
            count[k] += 1


@kernel
def _list_walls(work: _Work, x: float, y: float, reach: float, segments: Floats) -> int:
    """List the walls that the robot may come closer to than ``reach``; return their number."""
    near = int(np.int64(0))
    for m in range(len(segments)):
        ax, ay, bx, by = segments[m, 0] - x, segments[m, 1] - y, segments[m, 2] - x, segments[m, 3] - y
        ex, ey = bx - ax, by - ay
        share = _smaller(_larger(-(ax * ex + ay * ey) / _larger(ex * ex + ey * ey, 1e-300), 0.0), 1.0)
        away = math.hypot(ax + share * ex, ay + share * ey)
        if away < SIGHT and away <= reach:
            row = work.walls[near]
            row[0], row[1], row[2], row[3] = ax, ay, bx, by
            near += 1
    return near


@kernel
def _cost(work: _Work, i: int, j: int, miss: float, bound: float, radius: float, walls: int, weights: Floats) -> float:
    """Return the cost of a candidate, or a part of it that exceeds the bound."""
    speeds, course, passing, count, wall, fades = (
        work.speeds, work.course, work.passing, work.number, work.walls, work.fades
    )  # fmt: skip
    margin, skin, wall_margin = weights[MARGIN], weights[SKIN], weights[WALL_MARGIN]
    x, y, near, contact, touch, total = 0.0, 0.0, 0.0, 0.0, 0.0, miss
    for k in range(len(count)):
        before_x, before_y, changed = x, y, False
        x += speeds[k, i] * course[j, k, 0] * STEP
        y += speeds[k, i] * course[j, k, 1] * STEP
        for n in range(count[k]):
            px, py = passing[k, n, 0] - before_x, passing[k, n, 1] - before_y
            if px * px + py * py > passing[k, n, 5]:
                continue
            nx, ny = nearest_on_segment(0.0, 0.0, px, py, passing[k, n, 2] - x, passing[k, n, 3] - y)
            gap = math.sqrt(nx * nx + ny * ny) - radius - passing[k, n, 4]
            if gap < margin:
                near, changed = max(near, fades[k] * (margin - gap) / margin), True
            if gap < skin:
                contact, changed = max(contact, fades[k]), True
        for n in range(walls):
            nx, ny = nearest_on_segment(x, y, wall[n, 0], wall[n, 1], wall[n, 2], wall[n, 3])
            gap = math.sqrt((nx - x) ** 2 + (ny - y) ** 2) - radius
            excess = (wall_margin - gap) / wall_margin
            if excess > touch:
                touch, changed = excess, True
        if changed:
            total = miss + weights[NEAR] * near + weights[CONTACT] * contact + weights[WALL] * touch
            if total > bound:
                break
    return total


@kernel
def _certain_cost(work: _Work, radius: float, weights: Floats) -> float:
    """Return a cost that every candidate has, since none can avoid the people in the first steps.

    The clearance in a step is at most that at its beginning, from the farthest corner of the box of all candidates.
    """
    near, contact, passing = 0.0, 0.0, work.passing
    for k in range(MATCH):
        box, fade = work.reached[k], work.fades[k]
        for n in range(work.number[k]):
            dx = max(abs(passing[k, n, 0] - box[0]), abs(passing[k, n, 0] - box[2]))
            dy = max(abs(passing[k, n, 1] - box[1]), abs(passing[k, n, 1] - box[3]))
            gap = math.sqrt(dx * dx + dy * dy) - radius - passing[k, n, 4] + SLACK
            if gap < weights[MARGIN]:
                near = max(near, fade * (weights[MARGIN] - gap) / weights[MARGIN])
            if gap < weights[SKIN]:
                contact = max(contact, fade)
    certain: float = (weights[NEAR] * near + weights[CONTACT] * contact) * (1.0 - SLACK)
    return certain


@kernel
def _row_minimum(row: Floats) -> tuple[float, int]:
    """Return the smallest difference of a turn rate, and the first speed that has it; inf if all are tried."""
    least, place = math.inf, int(np.int64(0))
    for n in range(FORWARD):
        if row[n] < least:
            least, place = row[n], n
    return least, place


@kernel
def _search(work: _Work, change: float, radius: float, walls: int, weights: Floats, prune: bool) -> tuple[int, int]:
    """Return speed and turn rate of the first candidate with the smallest cost, -1 if no cost is finite."""
    miss = work.miss
    best, speed, turn, steps = math.inf, int(np.int64(-1)), int(np.int64(-1)), len(work.number)
    certain = _certain_cost(work, radius, weights) if prune else 0.0
    least, place = np.empty(TURNS), np.empty(TURNS, np.int64)
    for m in range(TURNS):
        least[m], place[m] = _row_minimum(miss[m])
    for _ in range(miss.size):
        j, difference = int(np.int64(0)), math.inf
        for m in range(TURNS):
            if least[m] < difference:
                j, difference = m, least[m]
        if not difference < math.inf or (prune and difference + certain > best):
            break
        i = place[j]
        miss[j, i] = math.inf
        least[j], place[j] = _row_minimum(miss[j])
        if work.known[j] < steps:
            _extend(work, j, change, steps)
        cost = _cost(work, i, j, difference, best if prune else math.inf, radius, walls, weights)
        if cost < best or (cost == best and (i < speed or (i == speed and j < turn))):
            best, speed, turn = cost, i, j
    return speed, turn


@kernel
def choose_twists(
    asking: NDArray[np.bool_], pose: Floats, twist: Floats, radius: Floats, wish: Floats,
    position: Floats, velocity: Floats, size: Floats, seen: NDArray[np.bool_], segments: Floats,
    limits: Floats, weights: Floats, steps: int, prune: bool, out: Floats,
) -> None:  # fmt: skip
    """Write the cheapest twists ``[N, 3]``.

    Args:
        asking: ``[N]`` rows to fill.
        pose, twist, radius: ``[N, 3]``, ``[N, 3]``, ``[N]`` state of the robots.
        wish: ``[N, 2]`` desired velocities [m/s].
        position, velocity, size, seen: ``[N, A, ...]`` people.
        segments: ``[M, 4]`` walls [m].
        limits: speed, turn rate and their accelerations.
        weights: seven weights of the cost.
        steps: number of simulated steps.
        prune: whether no weight is negative.
        out: ``[N, 3]``.
    """
    A = size.shape[1]
    work = _Work(
        np.empty(FORWARD), np.empty(TURNS), np.empty((steps, FORWARD)), np.empty((TURNS, steps, 2)),
        np.empty((TURNS, 2)), np.empty(TURNS, np.int64), np.empty((TURNS, FORWARD)),
        np.empty((steps, A, 6)), np.empty(steps, np.int64), np.empty((len(segments), 4)),
        np.empty(steps), np.empty((MATCH, 4)),
    )  # fmt: skip
    for k in range(steps):
        work.fades[k] = 1.0 - k / steps
    top, most, push, spin = limits[0], limits[1], limits[2], limits[3]
    for e in range(len(pose)):
        if not asking[e]:
            continue
        x, y, forward, turn = pose[e, 0], pose[e, 1], twist[e, 0], twist[e, 1]
        low, high = forward - push * WINDOW, _larger(0.0, forward + push * WINDOW)
        _fill(work.forwards, _larger(0.0, _smaller(low, top)), _smaller(top, high))
        _fill(work.turns, _larger(-most, turn - spin * WINDOW), _smaller(most, turn + spin * WINDOW))
        work.known[:] = 0
        work.ends[:, 0], work.ends[:, 1] = pose[e, 2], turn
        for j in range(TURNS):
            _extend(work, j, spin * STEP, MATCH)
        _compare(work, forward, push * STEP, wish[e, 0], wish[e, 1], weights[FACING])
        fastest = max(abs(forward), work.forwards[0], work.forwards[FORWARD - 1])
        reach = max(weights[MARGIN], weights[SKIN])
        _list_people(work, x, y, radius[e], fastest, reach, position[e], velocity[e], size[e], seen[e])
        wall_reach = (radius[e] + weights[WALL_MARGIN] + fastest * STEP * steps) * (1.0 + SLACK) + SLACK
        walls = _list_walls(work, x, y, wall_reach if prune else math.inf, segments)
        i, j = _search(work, spin * STEP, radius[e], walls, weights, prune)
        out[e, 0] = work.forwards[i] if i >= 0 else 0.0
        out[e, 1] = work.turns[j] if j >= 0 else 0.0
        out[e, 2] = 0.0

"""Kernels of the dynamic window: the cheapest of 117 twists for each robot, found by branch and bound.

The cost of a twist is its difference from the desired velocity plus penalties that are never negative. Twists are
tried in order of the difference; a twist is given up as soon as its partial cost exceeds the best cost. People and
walls that no twist reaches are left out. Neither changes a bit of the result.

Working memory of the search with S steps, which the kernels share:

* ``forwards [FORWARD]`` and ``turns [TURNS]``: candidate speeds [m/s] and turn rates [rad/s];
* ``speeds [S, FORWARD]``: speed in each step [m/s];
* ``course [TURNS, 3]``: heading [rad] and turn rate [rad/s] after the computed steps, and their number;
* ``path [TURNS, S + 1, 2, FORWARD]``: positions x and y before each step and after the last one [m];
* ``miss [TURNS, FORWARD]``: difference from the desired velocity [m/s], inf for candidates that were tried;
* ``passing [S, A, 6]`` and ``count [S]``: people within reach in each step, see :func:`_list_people`;
* ``wall [M, 4]``: walls within reach, relative to the robot [m];
* ``fades [S]``: weight of each step;
* ``bearing [TURNS, S + 1]``: heading before each step and after the last one [rad].

They are passed one by one, without slices and tuples: each access to an array of a tuple counts references.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.core.outlines import wall_gap
from crowdbot.typing import Floats

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
STRIDE = 3
"""Number of steps that are computed at once beyond :data:`MATCH`."""
SLACK = 1e-6
"""Margin [m] of what is left out, against rounding."""

MARGIN, NEAR, SKIN, CONTACT, WALL_MARGIN, WALL, FACING = 0, 1, 2, 3, 4, 5, 6
"""Indices of the weights."""


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
def _accelerate(forwards: Floats, forward: float, change: float, speeds: Floats) -> None:
    """Write the speed of each candidate in each step."""
    for i in range(FORWARD):
        v, wanted = forward, forwards[i]
        for k in range(len(speeds)):
            v += min(max(wanted - v, -change), change)
            speeds[k, i] = v


@kernel(inline=True)
def _extend(
    j: int, steps: int, turns: Floats, speeds: Floats, change: float, course: Floats, path: Floats, bearing: Floats
) -> None:
    """Compute the positions of all speeds at turn rate j, up to a number of steps."""
    heading, w, turn = course[j, 0], course[j, 1], turns[j]
    for k in range(int(course[j, 2]), steps):
        w += min(max(turn - w, -change), change)
        cos, sin = math.cos(heading + 0.5 * w * STEP), math.sin(heading + 0.5 * w * STEP)
        heading += w * STEP
        bearing[j, k + 1] = heading
        for i in range(FORWARD):  # vector instructions: one number for each speed
            path[j, k + 1, 0, i] = path[j, k, 0, i] + speeds[k, i] * cos * STEP
            path[j, k + 1, 1, i] = path[j, k, 1, i] + speeds[k, i] * sin * STEP
    course[j, 0], course[j, 1], course[j, 2] = heading, w, steps


@kernel
def _begin(
    heading: float, rate: float, turns: Floats, speeds: Floats, change: float, course: Floats, path: Floats,
    bearing: Floats,
) -> None:  # fmt: skip
    """Compute the positions of all candidates in the first :data:`MATCH` steps, from a heading and a turn rate.

    As long as two turn rates are out of reach on the same side, their courses are equal.
    """
    course[:, 0], course[:, 1], course[:, 2] = heading, rate, MATCH
    for k in range(MATCH):
        cos, sin, last, origin = 0.0, 0.0, math.nan, math.nan
        for j in range(TURNS):
            w, start = course[j, 1], course[j, 0]
            w += min(max(turns[j] - w, -change), change)
            if w != last or start != origin:
                cos, sin, last, origin = math.cos(start + 0.5 * w * STEP), math.sin(start + 0.5 * w * STEP), w, start
            course[j, 0], course[j, 1] = start + w * STEP, w
            bearing[j, k + 1] = course[j, 0]
            for i in range(FORWARD):
                path[j, k + 1, 0, i] = path[j, k, 0, i] + speeds[k, i] * cos * STEP
                path[j, k + 1, 1, i] = path[j, k, 1, i] + speeds[k, i] * sin * STEP


@kernel
def _compare(wish_x: float, wish_y: float, facing: float, course: Floats, path: Floats, miss: Floats) -> None:
    """Write the difference of each candidate from the desired velocity after :data:`MATCH` steps."""
    length = math.sqrt(wish_x**2 + wish_y**2)
    span = MATCH * STEP
    for j in range(TURNS):
        aside = facing * (length - wish_x * math.cos(course[j, 0]) - wish_y * math.sin(course[j, 0]))
        for i in range(FORWARD):
            dx, dy = path[j, MATCH, 0, i] / span - wish_x, path[j, MATCH, 1, i] / span - wish_y
            miss[j, i] = math.sqrt(dx**2 + dy**2) + aside


@kernel
def _list_people(
    x: float, y: float, radius: float, fastest: float, reach: float,
    position: Floats, velocity: Floats, size: Floats, seen: NDArray[np.bool_], passing: Floats, count: Counts,
) -> None:  # fmt: skip
    """List the people whom the robot may come closer to than ``reach``, for each step.

    Args:
        x, y, radius, fastest: robot.
        reach: clearance [m].
        position, velocity, size, seen: people.
        passing: receives the people of each step: x, y before it and after it, relative to the robot, radius, and the
            distance before the step up to which they may touch the robot during it [m].
        count: receives their number.
    """
    count[:] = 0
    for a in range(len(size)):
        if not seen[a]:
            continue
        rx, ry, vx, vy = position[a, 0] - x, position[a, 1] - y, velocity[a, 0], velocity[a, 1]
        if not math.hypot(rx, ry) < SIGHT:
            continue
        touching = radius + size[a] + (math.sqrt(vx * vx + vy * vy) + fastest) * STEP * (1.0 + SLACK) + SLACK
        for k in range(len(count)):
            t = k * STEP
            px, py = rx + vx * t, ry + vy * t
            farthest = touching + reach + fastest * t * (1.0 + SLACK)
            if px * px + py * py > farthest * farthest:
                continue
            n = count[k]
            passing[k, n, 0], passing[k, n, 1] = px, py
            passing[k, n, 2], passing[k, n, 3] = px + vx * STEP, py + vy * STEP
            passing[k, n, 4], passing[k, n, 5] = size[a], touching
            count[k] += 1


@kernel
def _list_walls(x: float, y: float, reach: float, segments: Floats, walls: Floats) -> int:
    """Write the walls that the robot may come closer to than ``reach``, relative to it; return their number."""
    near = int(np.int64(0))
    for m in range(len(segments)):
        ax, ay, bx, by = segments[m, 0] - x, segments[m, 1] - y, segments[m, 2] - x, segments[m, 3] - y
        ex, ey = bx - ax, by - ay
        share = _smaller(_larger(-(ax * ex + ay * ey) / _larger(ex * ex + ey * ey, 1e-300), 0.0), 1.0)
        away = math.hypot(ax + share * ex, ay + share * ey)
        if away < SIGHT and away <= reach:
            walls[near, 0], walls[near, 1], walls[near, 2], walls[near, 3] = ax, ay, bx, by
            near += 1
    return near


@kernel
def _certain_cost(radius: float, weights: Floats, fades: Floats, passing: Floats, count: Counts, path: Floats) -> float:
    """Return a cost that every candidate has, since none can avoid the people in the first steps.

    The clearance in a step is at most that at its beginning, from the farthest corner of the box around all candidates.
    """
    near, contact, margin, skin = 0.0, 0.0, weights[MARGIN], weights[SKIN]
    for k in range(MATCH):
        if count[k] == 0:
            continue
        left, below, right, above = math.inf, math.inf, -math.inf, -math.inf
        for j in range(TURNS):
            for i in range(FORWARD):
                x, y = path[j, k, 0, i], path[j, k, 1, i]
                left, right = x if x < left else left, x if x > right else right
                below, above = y if y < below else below, y if y > above else above
        for n in range(count[k]):
            dx = max(abs(passing[k, n, 0] - left), abs(passing[k, n, 0] - right))
            dy = max(abs(passing[k, n, 1] - below), abs(passing[k, n, 1] - above))
            gap = math.sqrt(dx * dx + dy * dy) - radius - passing[k, n, 4] + SLACK
            if gap < margin:
                near = max(near, fades[k] * (margin - gap) / margin)
            if gap < skin:
                contact = max(contact, fades[k])
    certain: float = (weights[NEAR] * near + weights[CONTACT] * contact) * (1.0 - SLACK)
    return certain


@kernel(inline=True)
def _clearance(i: int, j: int, k: int, n: int, radius: float, passing: Floats, path: Floats) -> float:
    """Return the clearance [m] to a person during a step of a candidate."""
    px, py = passing[k, n, 0] - path[j, k, 0, i], passing[k, n, 1] - path[j, k, 1, i]
    qx, qy = passing[k, n, 2] - path[j, k + 1, 0, i], passing[k, n, 3] - path[j, k + 1, 1, i]
    nx, ny = nearest_on_segment(0.0, 0.0, px, py, qx, qy)
    gap: float = math.sqrt(nx * nx + ny * ny) - radius - passing[k, n, 4]
    return gap


@kernel
def _search(
    turns: Floats, speeds: Floats, change: float, radius: float, weights: Floats, prune: bool, fades: Floats,
    passing: Floats, count: Counts, wall: Floats, walls: int, course: Floats, path: Floats, miss: Floats,
    bearing: Floats, outline: Floats,
) -> tuple[int, int]:  # fmt: skip
    """Return speed and turn rate of the first candidate with the smallest cost, -1 if no cost is finite.

    Candidates of similar difference are close to each other, and the same person decides about them. The person who
    raised a cost last is therefore tried first; most candidates are given up after this comparison.
    """
    margin, skin, wall_margin = weights[MARGIN], weights[SKIN], weights[WALL_MARGIN]
    to_near, to_contact, to_wall = weights[NEAR], weights[CONTACT], weights[WALL]
    steps = len(count)
    best, speed, turn = math.inf, int(np.int64(-1)), int(np.int64(-1))
    certain = _certain_cost(radius, weights, fades, passing, count, path) if prune else 0.0
    step, person = int(np.int64(-1)), int(np.int64(0))
    least, place = np.empty(TURNS), np.empty(TURNS, np.int64)
    for j in range(TURNS):
        least[j], place[j] = miss[j, 0], 0
        for i in range(1, FORWARD):
            if miss[j, i] < least[j]:
                least[j], place[j] = miss[j, i], i
    for _ in range(miss.size):
        j, difference = int(np.int64(0)), math.inf
        for m in range(TURNS):
            if least[m] < difference:
                j, difference = m, least[m]
        if not difference < math.inf or (prune and difference + certain > best):
            break
        i = place[j]
        miss[j, i] = least[j] = math.inf
        for n in range(FORWARD):
            if miss[j, n] < least[j]:
                least[j], place[j] = miss[j, n], n
        bound = best if prune else math.inf
        near, contact, touch, total = 0.0, 0.0, 0.0, difference
        if step >= 0:
            if course[j, 2] <= step:
                _extend(j, step + 1, turns, speeds, change, course, path, bearing)
            gap = _clearance(i, j, step, person, radius, passing, path)
            if gap < margin:
                near = fades[step] * (margin - gap) / margin
            if gap < skin:
                contact = fades[step]
            total = difference + to_near * near + to_contact * contact + to_wall * touch
            if total > bound:
                continue
        for k in range(steps):
            if course[j, 2] <= k:  # most candidates are given up after a few steps
                _extend(j, min(k + STRIDE, steps), turns, speeds, change, course, path, bearing)
            changed = False
            reach = margin * (1.0 - near / fades[k]) + SLACK
            if fades[k] > contact:
                reach = max(reach, skin)
            for n in range(count[k]):
                px, py = passing[k, n, 0] - path[j, k, 0, i], passing[k, n, 1] - path[j, k, 1, i]
                far = passing[k, n, 5] + reach
                if far < 0.0 or px * px + py * py > far * far:
                    continue
                gap = _clearance(i, j, k, n, radius, passing, path)
                closer = fades[k] * (margin - gap) / margin
                if gap < margin and closer > near:
                    near, changed, step, person = closer, True, k, n
                if gap < skin and fades[k] > contact:
                    contact, changed, step, person = fades[k], True, k, n
            x, y = path[j, k + 1, 0, i], path[j, k + 1, 1, i]
            for n in range(walls):
                nx, ny = nearest_on_segment(x, y, wall[n, 0], wall[n, 1], wall[n, 2], wall[n, 3])
                gap = math.sqrt((nx - x) ** 2 + (ny - y) ** 2) - radius
                excess = (wall_margin - gap) / wall_margin
                if excess > touch and len(outline) > 0:  # the disc comes closer than the outline
                    gap = wall_gap(
                        x, y, bearing[j, k + 1], outline, 0, len(outline),
                        wall[n, 0], wall[n, 1], wall[n, 2], wall[n, 3],
                    )  # fmt: skip
                    excess = (wall_margin - gap) / wall_margin
                if excess > touch:
                    touch, changed = excess, True
            if changed:
                total = difference + to_near * near + to_contact * contact + to_wall * touch
                if total > bound:
                    break
        if total < best or (total == best and (i < speed or (i == speed and j < turn))):
            best, speed, turn = total, i, j
    return speed, turn


@kernel
def choose_twists(
    asking: NDArray[np.bool_], pose: Floats, twist: Floats, radius: Floats, wish: Floats,
    position: Floats, velocity: Floats, size: Floats, seen: NDArray[np.bool_], segments: Floats,
    limits: Floats, weights: Floats, steps: int, prune: bool, outline: Floats, out: Floats,
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
        outline: ``[K, 2]`` corners of the robots towards walls [m]; without corners they are discs.
        out: ``[N, 3]``.
    """
    A = size.shape[1]
    forwards, turns, fades = np.empty(FORWARD), np.empty(TURNS), np.empty(steps)
    speeds, course, miss = np.empty((steps, FORWARD)), np.empty((TURNS, 3)), np.empty((TURNS, FORWARD))
    path, bearing = np.zeros((TURNS, steps + 1, 2, FORWARD)), np.empty((TURNS, steps + 1))
    passing, count, wall = np.empty((steps, A, 6)), np.empty(steps, np.int64), np.empty((len(segments), 4))
    for k in range(steps):
        fades[k] = 1.0 - k / steps
    top, most, push, spin = limits[0], limits[1], limits[2], limits[3]
    for e in range(len(pose)):
        if not asking[e]:
            continue
        x, y, forward, turn = pose[e, 0], pose[e, 1], twist[e, 0], twist[e, 1]
        low, high = forward - push * WINDOW, _larger(0.0, forward + push * WINDOW)
        _fill(forwards, _larger(0.0, _smaller(low, top)), _smaller(top, high))
        _fill(turns, _larger(-most, turn - spin * WINDOW), _smaller(most, turn + spin * WINDOW))
        _accelerate(forwards, forward, push * STEP, speeds)
        _begin(pose[e, 2], turn, turns, speeds, spin * STEP, course, path, bearing)
        _compare(wish[e, 0], wish[e, 1], weights[FACING], course, path, miss)
        fastest = max(abs(forward), forwards[0], forwards[FORWARD - 1])
        reach = max(weights[MARGIN], weights[SKIN])
        _list_people(
            x, y, radius[e], fastest, reach, position[e], velocity[e], size[e], seen[e], passing, count
        )  # fmt: skip
        wall_reach = (radius[e] + weights[WALL_MARGIN] + fastest * STEP * steps) * (1.0 + SLACK) + SLACK
        walls = _list_walls(x, y, wall_reach if prune else math.inf, segments, wall)
        i, j = _search(
            turns, speeds, spin * STEP, radius[e], weights, prune, fades, passing, count, wall, walls, course, path,
            miss, bearing, outline,
        )  # fmt: skip
        out[e, 0] = forwards[i] if i >= 0 else 0.0
        out[e, 1] = turns[j] if j >= 0 else 0.0
        out[e, 2] = 0.0

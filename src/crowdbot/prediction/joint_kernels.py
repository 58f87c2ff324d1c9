"""Kernels of joint futures: assignment of futures to samples, separation of paths, wall crossings.

Every sum has a fixed order that is independent of the number of people.
"""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import kernel
from crowdbot.typing import Bools, Floats, Ints

FLAT = 1e-9
SURE = 1.0 - 1e-9
"""Factor of distances by which people who are far apart are left out, against rounding."""


@kernel
def _boxes(path: Floats, room: Floats) -> Floats:  # pragma: no cover - compiled
    """Return bounding boxes ``[A, K + 1, 4]`` [m] of all paths, expanded by ``room [A]``; the last contains all K."""
    A, K, T, _ = path.shape
    box = np.empty((A, K + 1, 4))
    for a in range(A):
        for c in range(2):
            box[a, K, c], box[a, K, 2 + c] = math.inf, -math.inf
            for k in range(K):
                low, high = math.inf, -math.inf
                for t in range(T):
                    low, high = min(low, path[a, k, t, c]), max(high, path[a, k, t, c])
                box[a, k, c], box[a, k, 2 + c] = low - room[a], high + room[a]
                box[a, K, c], box[a, K, 2 + c] = min(box[a, K, c], low - room[a]), max(box[a, K, 2 + c], high + room[a])
    return box


@kernel
def _disjoint(one: Floats, other: Floats) -> bool:  # pragma: no cover - compiled
    return bool(one[2] < other[0] or other[2] < one[0] or one[3] < other[1] or other[3] < one[1])


@kernel
def _longest_steps(path: Floats) -> Floats:  # pragma: no cover - compiled
    """Return ``[N]``: the longest step [m] of each path ``[N, T, 2]``."""
    N, T, _ = path.shape
    longest_steps = np.zeros(N)
    for n in range(N):
        for t in range(1, T):
            dx, dy = path[n, t, 0] - path[n, t - 1, 0], path[n, t, 1] - path[n, t - 1, 1]
            longest_steps[n] = max(longest_steps[n], math.sqrt(dx * dx + dy * dy))
    return longest_steps


@kernel
def _rows_apart(squared: float, limit: float, closing: float) -> int:  # pragma: no cover - compiled
    """Return after how many rows two people may be closer than ``limit`` [m] at the earliest, at least 1.

    They are the root of ``squared`` [m] apart, and come closer by at most ``closing`` [m] in a row.
    """
    away = math.sqrt(squared) * SURE - limit
    if away <= closing:
        return 1
    return int(min(away / closing, 1e9)) if closing > 0.0 else 1_000_000_000


@kernel
def _find_collisions(
    path: Floats, a: int, b: int, box: Floats, limit: float, hit: Bools
) -> bool:  # pragma: no cover - compiled
    """Write the collision matrix ``[K, K]`` of the futures of two people; return whether any pair collides."""
    K, T = path.shape[1], path.shape[2]
    collisions = False
    for k in range(K):
        for j in range(K):
            hit[k, j] = False
            if _disjoint(box[a, k], box[b, j]):
                continue
            for t in range(T):
                dx, dy = path[a, k, t, 0] - path[b, j, t, 0], path[a, k, t, 1] - path[b, j, t, 1]
                if dx * dx + dy * dy < limit * limit:
                    hit[k, j] = True
                    collisions = True
                    break
    return collisions


@kernel
def assign_futures(path: Floats, room: Floats, order: float, sweeps: int) -> Ints:  # pragma: no cover - compiled
    """Return ``[A, K]``: the future of each person in each of K joint futures; each future is used exactly once.

    The futures ``[A, K, T, 2]`` [m] are sorted by decreasing probability. One person after the other, two futures are
    exchanged between two joint futures while this reduces the number of collisions, that is, distances below the sum of
    ``room [A]`` [m] of both. A permuted future costs ``order * (displacement / K)**2``.
    """
    A, K = path.shape[0], path.shape[1]
    box = _boxes(path, room)
    choice = np.empty((A, K), dtype=np.int64)
    for a in range(A):
        for k in range(K):
            choice[a, k] = k
    one, other = np.empty(A * A, dtype=np.int64), np.empty(A * A, dtype=np.int64)
    count = 0
    for a in range(A):
        for b in range(a + 1, A):
            if not _disjoint(box[a, K], box[b, K]):
                one[count], other[count] = a, b
                count += 1
    hit = np.zeros((count, K, K), dtype=np.bool_)
    meet = np.zeros(count, dtype=np.bool_)
    for p in range(count):
        limit = room[one[p]] + room[other[p]]
        meet[p] = _find_collisions(path, one[p], other[p], box, limit, hit[p])
    cost = np.empty((K, K))
    for _ in range(sweeps):
        changed = False
        for a in range(A):
            clash = False
            for m in range(K):
                for k in range(K):
                    cost[m, k] = order * ((m - k) / K) ** 2
            for p in range(count):
                if meet[p] and (one[p] == a or other[p] == a):
                    for k in range(K):
                        for m in range(K):
                            first = one[p] == a
                            if hit[p, m, choice[other[p], k]] if first else hit[p, choice[one[p], k], m]:
                                cost[m, k] += 1.0
                                clash = True
            if clash and _exchange(choice[a], cost):
                changed = True
        if not changed:
            break
    return choice


@kernel
def _exchange(choice: Ints, cost: Floats) -> bool:  # pragma: no cover - compiled
    """Exchange futures of one person while the cost ``[future, joint]`` decreases; return whether any was exchanged."""
    K = len(choice)
    changed = False
    for _ in range(K):
        any_better = False
        for k in range(K):
            best, partner = -FLAT, -1
            for j in range(K):
                gain = cost[choice[k], j] + cost[choice[j], k] - cost[choice[k], k] - cost[choice[j], j]
                if gain < best:
                    best, partner = gain, j
            if partner >= 0:
                choice[k], choice[partner] = choice[partner], choice[k]
                any_better = True
        if not any_better:
            break
        changed = True
    return changed


@kernel
def _closest(
    one: Floats, other: Floats, limit: float, closing: float
) -> tuple[float, float, float, float]:  # pragma: no cover
    """Return where two paths ``[T, 2]``, straight between steps, are closest below ``limit``; -1: nowhere.

    Returns the step, with its fraction since the step before, the squared distance, and the difference of positions.
    Steps in which they cannot come below ``limit`` [m], since they close by at most ``closing`` [m] in a step, are left
    out.
    """
    when, least, dx, dy = -1.0, limit * limit, 0.0, 0.0
    u, v = one[0, 0] - other[0, 0], one[0, 1] - other[0, 1]
    t = 0
    while t < len(one):
        x, y = one[t, 0] - other[t, 0], one[t, 1] - other[t, 1]
        wx, wy = x - u, y - v
        length = wx * wx + wy * wy
        share = 1.0
        if length > 0.0:
            share = min(1.0, max(0.0, -(u * wx + v * wy) / length))
        near_x, near_y = u + share * wx, v + share * wy
        squared = near_x * near_x + near_y * near_y
        if squared < least:
            when, least, dx, dy = max(0.0, t - 1.0 + share), squared, near_x, near_y
        later = _rows_apart(x * x + y * y, limit, closing)
        if later > 1 and t + later < len(one):
            x, y = one[t + later - 1, 0] - other[t + later - 1, 0], one[t + later - 1, 1] - other[t + later - 1, 1]
        t += later
        u, v = x, y
    return when, least, dx, dy


@kernel
def separate_paths(path: Floats, rank: Ints, room: Floats, rounds: int) -> Floats:  # pragma: no cover - compiled
    """Return the paths ``[A, T, 2]`` [m] of one joint future with a minimum distance between people.

    Two people closer than the sum of ``room [A]`` [m] of both, at a step or between two, are moved in opposite
    directions where they are closest, by half of the missing distance each. The offset grows linearly up to there and
    stays constant afterwards.
    Of two agents with different ``rank [A]`` only the one with the higher rank is moved; those of rank 0 never are. All
    pairs move simultaneously in each round; the result does not depend on the
    order of people. Two people whom the round before did not move are not looked at again.
    """
    A, T, _ = path.shape
    out = path.copy()
    push, moved, longest = np.zeros((A, T, 2)), np.ones(A, dtype=np.bool_), _longest_steps(path)
    for _ in range(rounds):
        before = moved.copy()
        moved[:] = False
        found = False
        for a in range(A):
            for b in range(a + 1, A):
                if (rank[a] == 0 and rank[b] == 0) or not (before[a] or before[b]):
                    continue
                limit = room[a] + room[b]
                when, least, dx, dy = _closest(out[a], out[b], limit, longest[a] + longest[b])
                if when < 0.0:
                    continue
                found = True
                moved[a], moved[b] = moved[a] or rank[a] >= rank[b], moved[b] or rank[b] >= rank[a]
                away = math.sqrt(least)
                if away < FLAT:  # same position: move across the direction of motion
                    dy, dx = out[a, T - 1, 0] - out[a, 0, 0], out[a, 0, 1] - out[a, T - 1, 1]
                    away = max(math.sqrt(dx * dx + dy * dy), FLAT)
                    least = 0.0
                part = 0.5 if rank[a] == rank[b] else 1.0
                size = part * (1.02 * limit - math.sqrt(least)) / away
                for t in range(T):
                    grown = size * min(1.0, (t + 1.0) / (when + 1.0))
                    if rank[a] >= rank[b]:
                        push[a, t, 0] += grown * dx
                        push[a, t, 1] += grown * dy
                    if rank[b] >= rank[a]:
                        push[b, t, 0] -= grown * dx
                        push[b, t, 1] -= grown * dy
        if not found:
            break
        for a in range(A):
            if moved[a]:
                out[a] += push[a]
                push[a] = 0.0
                longest[a] = _longest_steps(out[a : a + 1])[0]
    return out


@kernel
def first_crossing(start: Floats, path: Floats, one: Floats, other: Floats) -> Ints:  # pragma: no cover - compiled
    """Return ``[N, K]`` the first step at which a path ``start [N, 2] + path [N, K, T, 2]`` crosses a segment, else T.

    The segments connect ``one [M, 2]`` and ``other [M, 2]`` [m].
    """
    N, K, T, _ = path.shape
    result = np.full((N, K), T, dtype=np.int64)
    for n in range(N):
        for k in range(K):
            x, y = start[n, 0], start[n, 1]
            for t in range(T):
                u, v = start[n, 0] + path[n, k, t, 0], start[n, 1] + path[n, k, t, 1]
                for m in range(len(one)):
                    ax, ay, bx, by = one[m, 0], one[m, 1], other[m, 0], other[m, 1]
                    if max(ax, bx) < min(x, u) or max(x, u) < min(ax, bx):
                        continue
                    side_1 = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
                    side_2 = (bx - ax) * (v - ay) - (by - ay) * (u - ax)
                    side_3 = (u - x) * (ay - y) - (v - y) * (ax - x)
                    side_4 = (u - x) * (by - y) - (v - y) * (bx - x)
                    if side_1 * side_2 < 0.0 and side_3 * side_4 < 0.0:
                        result[n, k] = t
                        break
                if result[n, k] < T:
                    break
                x, y = u, v
    return result

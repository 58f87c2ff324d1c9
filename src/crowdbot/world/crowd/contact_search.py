"""Search of bodies that may touch, by a sweep along x."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import SMALL, Neighbors, kernel, prange
from crowdbot.core.neighbors import nearest
from crowdbot.typing import Bools, Floats, Rows


def find_close_bodies(position: Floats, reach: Floats, most: int, seen: Bools, asking: Bools) -> Neighbors:
    """Return the nearest neighbors within short distances, equal to those of :func:`crowdbot.core.nearest`.

    Args:
        position: ``[E, A, 2]`` [m].
        reach: ``[E, A]`` distance of neighbors [m], exclusive.
        most: maximum number of neighbors.
        seen: ``[E, A]`` whether an agent can be a neighbor.
        asking: ``[E, A]`` whether to search the neighbors of an agent.

    >>> place, all_ = np.array([[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0]]]), np.ones((1, 3), dtype=bool)
    >>> find_close_bodies(place, np.full((1, 3), 1.5), 8, all_, all_).number.tolist()
    [[1, 1, 2]]
    """
    E, A = position.shape[:2]
    agent = np.empty((E, A, max(0, min(most, A - 1))), dtype=np.int32)
    number, fits = np.zeros((E, A), dtype=np.int32), np.ones(E, dtype=np.bool_)
    if E * A <= SMALL:
        _sweep_range(0, E, position, reach, seen, asking, agent, number, fits)
    else:
        _sweep(position, reach, seen, asking, agent, number, fits)
    if not fits.all():
        return nearest(position, reach, most, seen, asking)
    return Neighbors(agent, number, np.arange(E * A, dtype=np.int32))


@kernel(parallel=True)
def _sweep(position: Floats, reach: Floats, seen: Bools, asking: Bools, agent: Rows, number: Rows, fits: Bools) -> None:
    for e in prange(len(fits)):
        _sweep_range(e, e + 1, position, reach, seen, asking, agent, number, fits)


@kernel
def _sweep_range(
    begin: int, end: int, position: Floats, reach: Floats, seen: Bools, asking: Bools, agent: Rows, number: Rows,
    fits: Bools,
) -> None:  # fmt: skip
    """Write the neighbors of the agents of some environments; ``fits`` is False if there are too many."""
    A = number.shape[1]
    key, gap2 = np.empty(A), np.empty(agent.shape[1:])
    for e in range(begin, end):
        longest = 0.0
        for a in range(A):
            x = position[e, a, 0]
            key[a] = x if (seen[e, a] or asking[e, a]) and math.isfinite(x) else math.inf
            longest = max(longest, reach[e, a])
        order = np.argsort(key)
        for i in range(A):
            a = order[i]
            for j in range(i + 1, A):
                b = order[j]
                if not key[b] - key[a] < longest:
                    break
                dx, dy = position[e, b, 0] - position[e, a, 0], position[e, b, 1] - position[e, a, 1]
                d2 = dx * dx + dy * dy
                if asking[e, a] and seen[e, b] and d2 < reach[e, a] * reach[e, a]:
                    fits[e] = _insert(agent[e, a], gap2[a], number[e], a, b, d2) and fits[e]
                if asking[e, b] and seen[e, a] and d2 < reach[e, b] * reach[e, b]:
                    fits[e] = _insert(agent[e, b], gap2[b], number[e], b, a, d2) and fits[e]


@kernel
def _insert(near: Rows, gap2: Floats, number: Rows, a: int, b: int, d2: float) -> bool:
    """Insert a neighbor b of agent a in the order of distance, then of index; return False if there is no space."""
    k = int(number[a])
    if k == len(near):
        return False
    while k > 0 and (gap2[k - 1] > d2 or (gap2[k - 1] == d2 and near[k - 1] > b)):
        gap2[k], near[k] = gap2[k - 1], near[k - 1]
        k -= 1
    gap2[k], near[k] = d2, b
    number[a] += 1
    return True

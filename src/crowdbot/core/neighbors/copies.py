"""Neighbour search in copies of the same environments, in which agents differ in reach and number of neighbours only.

A calibration steps many candidates from the same recorded states: the neighbours of an agent are sorted once for all
copies.
"""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core.kernels import kernel, prange
from crowdbot.typing import Bools, Floats, Rows


def find_period(place: Floats, seen: Bools) -> int:
    """Return after how many environments the positions and the visible agents repeat; E if they do not.

    Args:
        place: ``[E, A, 2]`` positions [m].
        seen: ``[E, A]`` whether an agent can be a neighbour.

    >>> find_period(np.tile(np.arange(8.0).reshape(2, 2, 2), (3, 1, 1)), np.ones((6, 2), dtype=bool))
    2
    """
    E = len(place)
    if E < 2 or not place[0].size:
        return E
    bits = place.reshape(E, -1).view(np.int64)  # equal bits: NaN is equal to itself, and 0 differs from -0
    for period in (1 + np.flatnonzero(bits[1:, 0] == bits[0, 0])).tolist():
        if np.array_equal(bits[period], bits[0]):
            break
    else:
        return E
    if E % period or not (bits.reshape(-1, period, bits.shape[1]) == bits[:period]).all():
        return E
    return period if (seen.reshape(-1, period, seen.shape[1]) == seen[:period]).all() else E


@kernel(parallel=True)
def fill_copies(
    place: Floats, reach: Floats, capacity: Rows, asking: Bools, seen: Bools, A: int, period: int, agent: Rows,
    number: Rows,
) -> None:  # fmt: skip
    """Write the neighbours of all agents; the rows of the first ``period`` environments repeat."""
    first = period * A
    part = 16
    for work in prange((first + part - 1) // part):
        near2, order = np.empty(A), np.empty(A, dtype=np.int32)
        for row in range(work * part, min((work + 1) * part, first)):
            held = _sort_all(place, seen, row, A, near2, order)
            for copy in range(row, len(number), first):
                _fill_row(copy, near2, order, held, reach, capacity, asking, agent, number)


@kernel(parallel=True)
def count_copies(
    place: Floats, reach: Floats, capacity: Rows, asking: Bools, seen: Bools, A: int, period: int, agent: Rows,
    number: Rows,
) -> None:  # fmt: skip
    """Write the neighbours of the agents of the first ``period`` environments, and the number of all agents.

    The neighbours of an agent in a copy are the first of those that are written.
    """
    first, widest = period * A, agent.shape[1]
    part = 16
    for work in prange((first + part - 1) // part):
        near2, order = np.empty(A), np.empty(A, dtype=np.int32)
        for row in range(work * part, min((work + 1) * part, first)):
            held = _sort_all(place, seen, row, A, near2, order)
            for n in range(widest):
                agent[row, n] = order[n] if n < held else -1
            for copy in range(row, len(number), first):
                reach2 = reach[copy] * reach[copy]
                within = int(np.int64(0))
                for n in range(held):
                    within += 1 if near2[n] < reach2 else 0
                asks = asking[copy] and reach[copy] > 0.0
                number[copy] = min(within, capacity[copy], widest) if asks else 0


@kernel
def _sort_all(place: Floats, seen: Bools, row: int, A: int, near2: Floats, order: Rows) -> int:
    """Sort the visible agents of the environment by distance to an agent, then by index; return their number."""
    x, y = place[row, 0], place[row, 1]
    first = row // A * A
    held = int(np.int64(0))  # a literal 0 has its own type, which compiles the callees twice
    for k in range(first, first + A):
        dx, dy = place[k, 0] - x, place[k, 1] - y
        d2 = dx * dx + dy * dy
        if not seen[k] or k == row or not d2 < math.inf:
            continue
        n = held
        while n > 0 and d2 < near2[n - 1]:
            near2[n], order[n] = near2[n - 1], order[n - 1]
            n -= 1
        near2[n], order[n] = d2, k - first
        held += 1
    return held


@kernel
def _fill_row(
    row: int, near2: Floats, order: Rows, held: int, reach: Floats, capacity: Rows, asking: Bools, agent: Rows,
    number: Rows,
) -> None:  # fmt: skip
    """Write the neighbours of one agent within its reach."""
    widest = agent.shape[1]
    most = min(capacity[row], widest, held)
    count = int(np.int64(0))
    if asking[row] and reach[row] > 0.0:
        reach2 = reach[row] * reach[row]
        while count < most and near2[count] < reach2:
            agent[row, count] = order[count]
            count += 1
    number[row] = count
    for n in range(count, widest):
        agent[row, n] = -1

"""Neighbour search, in one environment or in copies of the same ones.

A calibration steps many candidates from the same recorded states: the neighbours of an agent are sorted once for all
copies.

Neighbours are sorted by distance, then by agent index; the result does not depend on the method. Small crowds are
searched by brute force, large crowds in a uniform grid.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core.errors import InputError, did_you_mean
from crowdbot.core.kernels import kernel, prange
from crowdbot.core.model_parameter import BOOL, FLOAT, dense
from crowdbot.typing import Bools, Floats, Rows

from .cell_grid import CHUNK, SMALL, SPARE, Seekers, keep_nearest, search_in_grid, sort_by_distance, sort_few
from .verlet_lists import search_again


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


COUNT = np.dtype(np.int32)
METHODS = ("auto", "brute", "grid")
CROWD = 120
"""Minimum number of agents for which the grid is faster than brute force (measured for single crowds and batches)."""
IN_ORDER = np.arange(SMALL, dtype=COUNT)
"""Order of the agents of small crowds; it must not be changed."""
FEW = 16
"""Maximum number of candidates for which an insertion sort is faster than counting ranks (measured)."""


class Neighbors(NamedTuple):
    """Neighbours of each agent.

    Fields:
        agent: ``[E, A, K]`` int32, agents sorted by distance, then by index; -1 past the end.
        number: ``[E, A]`` int32, number of neighbours.
        order: ``[E * A]`` int32, all rows ``e * A + a`` in spatial order, for memory locality of loops.
    """

    agent: Rows
    number: Rows
    order: Rows


def nearest(
    position: Floats,
    reach: ArrayLike,
    max_count: ArrayLike,
    seen: ArrayLike = True,
    asking: ArrayLike = True,
    *,
    method: str = "auto",
) -> Neighbors:
    """Return the nearest neighbours of each agent in its environment.

    Args:
        position: ``[E, A, 2]`` [m].
        reach: maximum distance of neighbours [m], exclusive; broadcasts to ``[E, A]``.
        max_count: maximum number of neighbours; broadcasts to ``[E, A]``.
        seen: whether an agent can be a neighbour (active and visible); broadcasts to ``[E, A]``.
        asking: whether to search the neighbours of an agent; broadcasts to ``[E, A]``.
        method: ``auto``, ``brute`` or ``grid``; the results are equal.

    Raises:
        InputError: the method is unknown.

    >>> found = nearest(np.array([[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0]]]), reach=1.5, max_count=8)
    >>> found.agent[0].tolist(), found.number.tolist()
    ([[2, -1], [2, -1], [0, 1]], [[1, 1, 2]])
    """
    if method not in METHODS:
        near = did_you_mean(method, METHODS)
        raise InputError(f"unknown neighbour search {method!r}{near}; choose {', '.join(METHODS)}")
    E, A = shape = position.shape[:2]
    seekers = Seekers(
        dense(position, (E, A, 2), FLOAT).reshape(-1, 2),
        dense(reach, shape, FLOAT).reshape(-1),
        dense(max_count, shape, COUNT).reshape(-1),
        dense(asking, shape, BOOL).reshape(-1),
    )
    visible = dense(seen, shape, BOOL).reshape(-1)
    most = max_count if isinstance(max_count, float | int) else seekers.max_count.max(initial=0)
    return nearest_of_rows(seekers, visible, shape, int(most), method)


def nearest_of_rows(
    seekers: Seekers,
    visible: NDArray[np.bool_],
    shape: tuple[int, int],
    most: int,
    method: str = "auto",
    shared: bool = False,
) -> Neighbors:
    """Return the nearest neighbours, as :func:`nearest` does, for arrays as kernels accept them.

    Args:
        seekers: positions ``[E * A, 2]``, and of each row the reach, the maximum number (int32) and whether to search.
        visible: ``[E * A]`` whether an agent can be a neighbour.
        shape: (E, A).
        most: largest maximum number.
        method: as for :func:`nearest`.
        shared: whether ``agent`` may be ``[P, A, K]``: environment e then has the neighbours of environment e modulo P.
    """
    E, A = shape
    count = E * A
    widest = max(0, min(most, A - 1)) if E else 0
    number = np.empty(count, dtype=COUNT)
    if shared and count > SMALL and A < CROWD and method == "auto":
        period = find_period(seekers[0].reshape(E, A, 2), visible.reshape(E, A))
        if period < E:
            agent = np.empty((period * A, widest), dtype=COUNT)
            count_copies(*seekers, visible, A, period, agent, number)
            return Neighbors(agent.reshape(period, A, widest), number.reshape(E, A), np.arange(count, dtype=COUNT))
    agent = np.empty((count, widest), dtype=COUNT)
    if method == "grid":
        order = search_in_grid(seekers, visible, E, agent, number)
    elif method == "auto" and A >= CROWD:
        order = search_again(seekers, visible, E, agent, number, search_in_grid, SMALL)
    elif count <= SMALL:
        order = IN_ORDER[:count]
        compare_rows(0, count, *seekers, visible, A, agent, number)
    else:
        order = np.arange(count, dtype=COUNT)
        period = E if shared else find_period(seekers[0].reshape(E, A, 2), visible.reshape(E, A))
        if period < E:
            fill_copies(*seekers, visible, A, period, agent, number)
        else:
            _compare(*seekers, visible, A, agent, number)
    return Neighbors(agent.reshape(E, A, widest), number.reshape(E, A), order)


@kernel(parallel=True)
def _compare(
    place: Floats, reach: Floats, capacity: Rows, asking: NDArray[np.bool_], seen: NDArray[np.bool_], A: int,
    agent: Rows, number: Rows,
) -> None:  # fmt: skip
    for part in prange((len(number) + CHUNK - 1) // CHUNK):
        end = min((part + 1) * CHUNK, len(number))
        compare_rows(part * CHUNK, end, place, reach, capacity, asking, seen, A, agent, number)


@kernel
def compare_rows(
    begin: int, end: int, place: Floats, reach: Floats, capacity: Rows, asking: NDArray[np.bool_],
    seen: NDArray[np.bool_], A: int, agent: Rows, number: Rows,
) -> None:  # fmt: skip
    """Search the neighbours of the rows from ``begin`` to ``end`` among all ``A`` agents of their environment."""
    widest = agent.shape[1]
    room = min(2 * widest + SPARE, A) + 2
    near, near2, sorted_ = np.empty(room, dtype=np.int32), np.empty(room), np.empty(room, dtype=np.int32)
    for row in range(begin, end):
        x, y, most = place[row, 0], place[row, 1], min(capacity[row], widest)
        first = row // A * A
        held = int(np.int64(0))  # a literal 0 has its own type, which compiles the callees twice
        if asking[row] and most > 0 and reach[row] > 0.0 and math.isfinite(x) and math.isfinite(y):
            reach2, limit2 = reach[row] * reach[row], math.inf
            for k in range(first, first + A):
                if held == room - 1:
                    held, limit2 = keep_nearest(near, near2, held, most, sorted_)
                dx, dy = place[k, 0] - x, place[k, 1] - y
                d2 = dx * dx + dy * dy
                near[held], near2[held] = k, d2
                # no branch: none could foresee it
                held += 1 if (d2 <= limit2) & (d2 < reach2) & seen[k] & (k != row) else 0
            if held <= FEW:
                sort_few(near2, held, sorted_)
            else:
                sort_by_distance(near, near2, held, sorted_)
            held = min(held, most)
        number[row] = held
        for n in range(held):
            agent[row, n] = near[sorted_[n]] - first
        for n in range(held, widest):
            agent[row, n] = -1

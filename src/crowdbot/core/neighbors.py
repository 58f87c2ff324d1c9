"""Neighbours: who is near whom, found once a step and shared by the models.

The answer does not depend on the way of searching: neighbours come sorted by distance, equal distances by agent index.
Small crowds are searched by brute force, large ones in a uniform grid that is filled by a counting sort. The grid wraps
around, so that a few agents far away from all others cost no memory: whoever lands in the same cell by wrapping is
rejected by distance.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numba import prange
from numpy.typing import ArrayLike, NDArray

from .errors import InputError, did_you_mean
from .kernels import kernel

__all__ = ["CHUNK", "SMALL", "Neighbors", "nearest"]

Array = NDArray[np.float64]
Rows = NDArray[np.int32]

METHODS = ("auto", "brute", "grid")
CHUNK = 64
"""Agents that one thread takes at a time."""
SMALL = 512
"""Up to this many agents one thread does it all: waking the others would take longer than the work (measured)."""
CROWD = 32
"""From this number of agents on the grid is faster than brute force (measured: 32 in a batch, 150 alone)."""
PER_CELL = 2.0
"""Agents in one cell, on average."""
GUESS = 0.25
"""Where the search begins: squared radius per neighbour wanted, in squared widths of a cell."""
SLACK = 1e-12
"""Relative width added where rounding could hide a neighbour behind the border of a cell."""


class _Grid(NamedTuple):
    """Agents of all environments sorted by cell: cell c of environment e begins at ``first[e, c]``."""

    shape: NDArray[np.int64]
    """``[E, 2]`` columns and rows before the grid wraps around."""
    size: Array
    """``[E]`` width of a cell [m]."""
    first: Rows
    """``[E, C + 1]``; brute force is a grid of one cell."""
    order: Rows
    """``[E * A]`` rows of the agents, sorted."""
    place: Array
    """``[E * A, 2]`` their positions [m], NaN for those whom nobody sees."""


class _Seekers(NamedTuple):
    """Who looks for neighbours, by row ``e * A + a``."""

    place: Array
    reach: Array
    most: Rows
    asking: NDArray[np.bool_]


class Neighbors(NamedTuple):
    """Neighbours of every agent.

    Fields:
        agent: ``[E, A, K]`` int32, agents sorted by distance, then by index; -1 past the end.
        number: ``[E, A]`` int32, how many of them there are.
        order: ``[E * A]`` int32, every row ``e * A + a`` once, near ones together, for loops that like warm memory.
    """

    agent: Rows
    number: Rows
    order: Rows


def nearest(
    position: Array,
    reach: ArrayLike,
    most: ArrayLike,
    seen: ArrayLike = True,
    asking: ArrayLike = True,
    *,
    method: str = "auto",
) -> Neighbors:
    """Return the nearest neighbours of every agent in its own environment.

    Args:
        position: ``[E, A, 2]`` [m].
        reach: neighbours are strictly nearer than this [m]; broadcasts to ``[E, A]``.
        most: no more than this many, the nearest; broadcasts to ``[E, A]``.
        seen: who can be a neighbour (active and visible); broadcasts to ``[E, A]``.
        asking: who needs neighbours; the others get none; broadcasts to ``[E, A]``.
        method: ``auto``, ``brute`` or ``grid``; the answers are the same.

    Raises:
        InputError: the method is unknown.

    >>> found = nearest(np.array([[[0.0, 0.0], [2.0, 0.0], [1.0, 0.0]]]), reach=1.5, most=8)
    >>> found.agent[0].tolist(), found.number.tolist()
    ([[2, -1], [2, -1], [0, 1]], [[1, 1, 2]])
    """
    if method not in METHODS:
        near = did_you_mean(method, METHODS)
        raise InputError(f"neighbours cannot be searched by {method!r}{near}; choose {', '.join(METHODS)}")
    E, A = position.shape[:2]
    seekers = _Seekers(
        np.require(position, np.float64, ["C", "W"]).reshape(E * A, 2),
        _rows(reach, (E, A), np.float64),
        _rows(most, (E, A), np.int32),
        _rows(asking, (E, A), np.bool_),
    )
    grid = _sorted(seekers, _rows(seen, (E, A), np.bool_), E, method == "grid" or (method == "auto" and A >= CROWD))
    widest = max(0, min(int(seekers.most.max(initial=0)), A - 1))
    agent = np.empty((E * A, widest), dtype=np.int32)
    number = np.empty(E * A, dtype=np.int32)
    if len(number) <= SMALL:
        _search_part(0, len(number), seekers, grid, agent, number)
    else:
        _search(seekers, grid, agent, number)
    return Neighbors(agent.reshape(E, A, widest), number.reshape(E, A), grid.order)


def _rows(value: ArrayLike, shape: tuple[int, int], kind: Any) -> NDArray[Any]:
    # writeable, too: a read-only array is another type to the compiler
    return np.require(np.broadcast_to(np.asarray(value, dtype=kind), shape), requirements=["C", "W"]).reshape(-1)


def _sorted(seekers: _Seekers, seen: NDArray[np.bool_], E: int, in_cells: bool) -> _Grid:
    """Sort all agents into cells, or leave them as they are in one large cell per environment."""
    rows = len(seen)
    shape, size = np.ones((E, 2), dtype=np.int64), np.full(E, 1e100)
    order = np.arange(rows, dtype=np.int32)
    place = np.where(seen[:, None], seekers.place, np.nan)
    A = rows // max(E, 1)
    if not in_cells:
        begin = np.arange(E, dtype=np.int32)[:, None] * A
        return _Grid(shape, size, np.concatenate([begin, begin + A], axis=1, dtype=np.int32), order, place)
    first = np.zeros((E, 2 * A + 17), dtype=np.int32)
    there = (seen | seekers.asking) & np.isfinite(seekers.place[:, 0]) & np.isfinite(seekers.place[:, 1])
    _sort(seekers.place, there, float(seekers.reach.max(initial=0.0)), shape, size, first, order)
    return _Grid(shape, size, first, order, place[order])


@kernel
def _sort(
    place: Array,
    there: NDArray[np.bool_],
    longest: float,
    shape: NDArray[np.int64],
    sizes: Array,
    first: Rows,
    order: Rows,
) -> None:
    """Sort the agents of every environment by cell (counting sort); the last cell holds all who are not there."""
    E = len(sizes)
    A = len(place) // E
    rest = first.shape[1] - 1
    where = np.empty(A, dtype=np.int32)
    for e in range(E):
        begin = e * A
        size, columns, rows = _cells(place[begin : begin + A], there[begin : begin + A], longest, rest)
        sizes[e], shape[e, 0], shape[e, 1] = size, columns, rows
        inverse = 1.0 / size
        for i in range(A):
            cell = rest
            if there[begin + i]:
                line = _wrapped(math.floor(place[begin + i, 1] * inverse), rows)
                cell = line * columns + _wrapped(math.floor(place[begin + i, 0] * inverse), columns)
            where[i] = cell
            first[e, cell] += 1
        total = begin + A
        for c in range(rest, -1, -1):
            total -= first[e, c]
            first[e, c] = total + first[e, c]
        for i in range(A - 1, -1, -1):  # backwards, so that agents of one cell keep their order
            first[e, where[i]] -= 1
            order[first[e, where[i]]] = begin + i


@kernel
def _cells(place: Array, there: NDArray[np.bool_], longest: float, cells: int) -> tuple[float, int, int]:
    """Choose the width of the cells of one environment, and how many there are before the grid wraps around."""
    low_x, high_x, low_y, high_y = math.inf, -math.inf, math.inf, -math.inf
    n = 0
    for i in range(len(place)):
        if there[i]:
            low_x, high_x = min(low_x, place[i, 0]), max(high_x, place[i, 0])
            low_y, high_y = min(low_y, place[i, 1]), max(high_y, place[i, 1])
            n += 1
    if n == 0:
        return 1.0, 1, 1
    wide, high = high_x - low_x, high_y - low_y
    size = max(math.sqrt(PER_CELL * wide / n) * math.sqrt(high), PER_CELL * max(wide, high) / n)
    if longest > 0.0:
        size = min(size, longest)
    # farther than 1e9 cells from the origin whole numbers would run out
    size = max(size, 1e-9 * max(abs(low_x), abs(high_x), abs(low_y), abs(high_y)), 1e-9)
    columns, rows = math.floor(wide / size) + 1, math.floor(high / size) + 1
    side = math.floor(math.sqrt(cells))
    if columns > side and rows > side:
        columns = rows = side
    columns = min(columns, cells // min(rows, side))
    rows = min(rows, cells // columns)
    return size, columns, rows


@kernel
def _wrapped(cell: int, count: int) -> int:
    """Return ``cell`` modulo ``count``, without a division where it is not needed."""
    return cell if 0 <= cell < count else cell % count


@kernel(parallel=True)
def _search(seekers: _Seekers, grid: _Grid, agent: Rows, number: Rows) -> None:
    for part in prange((len(number) + CHUNK - 1) // CHUNK):
        _search_part(part * CHUNK, min((part + 1) * CHUNK, len(number)), seekers, grid, agent, number)


@kernel
def _search_part(begin: int, end: int, seekers: _Seekers, grid: _Grid, agent: Rows, number: Rows) -> None:
    # the fields are taken out here: a field taken inside the loop counts references, atomically
    place, reach, capacity, asking = seekers
    shape, sizes, first, order, points = grid
    A = len(number) // len(sizes)
    widest = agent.shape[1]
    near = np.empty(widest, dtype=np.int32)
    near2 = np.empty(widest)
    for k in range(begin, end):
        row = order[k]
        e = row // A
        held = int(np.int64(0))  # a plain 0 would be a type of its own and compile what follows twice
        most = min(capacity[row], widest)
        if asking[row] and most > 0 and reach[row] > 0.0:
            x, y, size, reach2 = place[row, 0], place[row, 1], sizes[e], reach[row] * reach[row]
            limit2 = min(reach2, (GUESS * most + 0.5) * size * size)
            while True:
                held = _look_around(
                    first, e, size, shape[e, 0], shape[e, 1], order, points, x, y, row, limit2, most, near, near2
                )
                if held == most or limit2 == reach2:
                    break
                limit2 = min(reach2, 4.0 * limit2)
        number[row] = held
        for n in range(held):
            agent[row, n] = near[n] - e * A
        for n in range(held, widest):
            agent[row, n] = -1


@kernel
def _look_around(
    first: Rows,
    e: int,
    size: float,
    columns: int,
    rows: int,
    order: Rows,
    points: Array,
    x: float,
    y: float,
    row: int,
    limit2: float,
    most: int,
    near: Rows,
    near2: Array,
) -> int:
    """Look at the rows of the grid from the own one outwards, until the next is farther than the worst one held."""
    held = int(np.int64(0))
    if not (math.isfinite(x) and math.isfinite(y)):
        return held
    inverse = 1.0 / size
    own = math.floor(y * inverse)
    slack = SLACK * (abs(x) + abs(y) + size)
    for visit in range(rows):  # the own row, then +1, -1, +2, -2, ...
        ring = (visit + 1) // 2
        above = max(0.0, (own + ring) * size - y - slack)
        below = max(0.0, y - (own - ring + 1) * size - slack)
        if visit > 0 and min(above, below) ** 2 > limit2:
            break
        gap = above if visit % 2 == 1 else below if visit > 0 else 0.0
        if 2 * ring == rows:  # the same row of cells above and below, around the end of the grid
            gap = min(above, below)
        if gap * gap > limit2:
            continue
        width = math.sqrt(limit2 - gap * gap) + slack
        start = _wrapped(own + ring if visit % 2 == 1 else own - ring, rows) * columns
        low, high = 0, columns - 1
        if 2.0 * width * inverse + 2.0 < columns:
            low = _wrapped(math.floor((x - width) * inverse), columns)
            high = _wrapped(math.floor((x + width) * inverse), columns)
        if low > high:  # around the end of the row
            begin, end = first[e, start + low], first[e, start + columns]
            held, limit2 = _look(order, points, begin, end, x, y, row, limit2, most, held, near, near2)
            low = 0
        begin, end = first[e, start + low], first[e, start + high + 1]
        held, limit2 = _look(order, points, begin, end, x, y, row, limit2, most, held, near, near2)
    return held


@kernel
def _look(
    order: Rows,
    points: Array,
    begin: int,
    end: int,
    x: float,
    y: float,
    row: int,
    limit2: float,
    most: int,
    held: int,
    near: Rows,
    near2: Array,
) -> tuple[int, float]:
    """Look at the sorted agents from begin to end; return how many are held then, and the squared reach left."""
    for k in range(begin, end):
        dx, dy = points[k, 0] - x, points[k, 1] - y
        d2 = dx * dx + dy * dy
        if not d2 <= limit2:
            continue
        other = order[k]
        if other == row or (d2 == limit2 and (held < most or other > near[held - 1])):
            continue
        n = min(held, most - 1)
        held = n + 1
        while n > 0 and (d2 < near2[n - 1] or (d2 == near2[n - 1] and other < near[n - 1])):
            near2[n], near[n] = near2[n - 1], near[n - 1]
            n -= 1
        near2[n], near[n] = d2, other
        if held == most:
            limit2 = near2[held - 1]
    return held, limit2

"""Cell grid of agents, and the order of the candidates of one agent.

The grid wraps around: distant agents require no additional memory, and agents in the same cell due to wrapping are
rejected by distance.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core.kernels import kernel, prange
from crowdbot.typing import Floats, Rows


@kernel(inline=True)
def sort_few(near2: Floats, held: int, sorted_: Rows) -> None:
    """Write the indices of candidates that are in the order of agents, by distance (stable insertion)."""
    for i in range(held):
        n = i
        while n > 0 and near2[i] < near2[sorted_[n - 1]]:
            sorted_[n] = sorted_[n - 1]
            n -= 1
        sorted_[n] = i


@kernel
def keep_nearest(near: Rows, near2: Floats, held: int, most: int, sorted_: Rows) -> tuple[int, float]:
    """Keep only the nearest candidates; return their number and the squared distance of the last."""
    sort_by_distance(near, near2, held, sorted_)
    limit2 = near2[sorted_[most - 1]]
    for n in range(most, held):
        near2[sorted_[n]] = -1.0
    kept = int(np.int64(0))
    for i in range(held):
        if near2[i] >= 0.0:
            near[kept], near2[kept] = near[i], near2[i]
            kept += 1
    return kept, limit2


@kernel(inline=True)
def sort_by_distance(near: Rows, near2: Floats, held: int, sorted_: Rows) -> None:
    """Write the candidate indices in order of distance, then of agent index.

    The rank of a candidate is the number of nearer candidates, counted without branches.
    """
    near2[held] = math.inf
    sorted_[: held + 1] = -1
    for i in range(0, held, 2):
        rank, next_rank = int(np.int64(0)), int(np.int64(0))
        for j in range(held):
            rank += 1 if near2[j] < near2[i] else 0
            next_rank += 1 if near2[j] < near2[i + 1] else 0
        _put(near, sorted_, rank, i)
        _put(near, sorted_, next_rank, i + 1)


@kernel(inline=True)
def _put(near: Rows, sorted_: Rows, rank: int, i: int) -> None:
    """Insert i at its rank, ordered by agent index among equal distances."""
    while sorted_[rank] >= 0:
        if near[i] < near[sorted_[rank]]:
            i, sorted_[rank] = sorted_[rank], i
        rank += 1
    sorted_[rank] = i


CHUNK = 64
"""Number of agents in one work item of a thread."""
SMALL = 512
"""Maximum number of agents for which one thread is faster than several (measured)."""
PER_CELL = 2.0
"""Average number of agents in a cell."""
SPARE = 32
"""Size of the candidate buffer beyond twice the number of neighbours."""
GUESS = 0.25
"""Initial squared search radius per neighbour, in squared cell widths."""
SLACK = 1e-12
"""Relative margin against rounding at cell borders."""


Earlier = tuple[Rows, Rows]
NOTHING: Earlier = (np.empty((0, 0), dtype=np.int32), np.empty(0, dtype=np.int32))


class _Grid(NamedTuple):
    """Agents of all environments sorted by cell: cell c of environment e starts at ``first[e, c]``."""

    shape: NDArray[np.int64]
    """``[E, 2]`` columns and rows before the grid wraps around."""
    size: Floats
    """``[E]`` width of a cell [m]."""
    first: Rows
    """``[E, C + 1]``."""
    order: Rows
    """``[E * A]`` rows of the agents, sorted."""
    place: Floats
    """``[E * A, 2]`` positions of the sorted agents [m], NaN for invisible agents."""


class Seekers(NamedTuple):
    """Agents that search for neighbours, by row ``e * A + a``."""

    place: Floats
    reach: Floats
    max_count: Rows
    asking: NDArray[np.bool_]


def search_in_grid(
    seekers: Seekers, seen: NDArray[np.bool_], E: int, agent: Rows, number: Rows, earlier: Earlier | None = None
) -> Rows:
    """Sort all agents into cells and write their neighbours; return the spatial order of the agents.

    Args:
        seekers: agents that search.
        seen: ``[E * A]`` whether an agent can be a neighbour.
        E: number of environments.
        agent, number: output arrays ``[E * A, K]`` and ``[E * A]``.
        earlier: these arrays of an earlier search: where the neighbours of then are now limits the search.
    """
    rows = len(seen)
    A = rows // max(E, 1)
    shape, size = np.ones((E, 2), dtype=np.int64), np.empty(E)
    order = np.arange(rows, dtype=np.int32)
    place = np.where(seen[:, None], seekers.place, np.nan)
    first = np.zeros((E, 2 * A + 17), dtype=np.int32)
    there = (seen | seekers.asking) & np.isfinite(seekers.place[:, 0]) & np.isfinite(seekers.place[:, 1])
    _sort(seekers.place, there, float(seekers.reach.max(initial=0.0)), shape, size, first, order)
    grid = _Grid(shape, size, first, order, place[order])
    if rows <= SMALL:
        _search_part(0, rows, seekers, seen, grid, *(earlier or NOTHING), agent, number)
    else:
        _search(seekers, seen, grid, *(earlier or NOTHING), agent, number)
    return order


@kernel
def _sort(
    place: Floats, there: NDArray[np.bool_], longest: float, shape: NDArray[np.int64], sizes: Floats, first: Rows,
    order: Rows,
) -> None:  # fmt: skip
    """Sort the agents of each environment by cell (counting sort); the last cell contains the absent agents."""
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
                line = _wrap(math.floor(place[begin + i, 1] * inverse), rows)
                cell = line * columns + _wrap(math.floor(place[begin + i, 0] * inverse), columns)
            where[i] = cell
            first[e, cell] += 1
        total = begin + A
        for c in range(rest, -1, -1):
            total -= first[e, c]
            first[e, c] = total + first[e, c]
        for i in range(A - 1, -1, -1):  # backwards: agents of a cell keep their order
            first[e, where[i]] -= 1
            order[first[e, where[i]]] = begin + i


@kernel
def _cells(place: Floats, there: NDArray[np.bool_], longest: float, cells: int) -> tuple[float, int, int]:
    """Return cell width [m], columns and rows of the grid of one environment."""
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
    # limit the cell indices to 1e9, against integer overflow
    size = max(size, 1e-9 * max(abs(low_x), abs(high_x), abs(low_y), abs(high_y)), 1e-9)
    columns, rows = math.floor(wide / size) + 1, math.floor(high / size) + 1
    side = math.floor(math.sqrt(cells))
    if columns > side and rows > side:
        columns = rows = side
    columns = min(columns, cells // min(rows, side))
    rows = min(rows, cells // columns)
    return size, columns, rows


@kernel
def _wrap(cell: int, count: int) -> int:
    """Return ``cell`` modulo ``count``, without a division if possible."""
    return cell if 0 <= cell < count else cell % count


@kernel(parallel=True)
def _search(
    seekers: Seekers, seen: NDArray[np.bool_], grid: _Grid, before: Rows, count: Rows, agent: Rows, number: Rows
) -> None:
    for part in prange((len(number) + CHUNK - 1) // CHUNK):
        end = min((part + 1) * CHUNK, len(number))
        _search_part(part * CHUNK, end, seekers, seen, grid, before, count, agent, number)


@kernel
def _search_part(
    begin: int, end: int, seekers: Seekers, seen: NDArray[np.bool_], grid: _Grid, before: Rows, count: Rows,
    agent: Rows, number: Rows,
) -> None:  # fmt: skip
    # unpack the tuples outside of the loop: each access counts references, atomically
    place, reach, capacity, asking = seekers
    shape, sizes, first, order, points = grid
    A = len(number) // len(sizes)
    widest = agent.shape[1]
    room = 2 * widest + SPARE
    near, near2, sorted_ = np.empty(room, dtype=np.int32), np.empty(room), np.empty(room, dtype=np.int32)
    for k in range(begin, end):
        row = order[k]
        e = row // A
        x, y, reach2, most = place[row, 0], place[row, 1], reach[row] * reach[row], min(capacity[row], widest)
        held = int(np.int64(0))  # a literal 0 has its own type, which compiles the callees twice
        if asking[row] and most > 0 and reach[row] > 0.0 and math.isfinite(x) and math.isfinite(y):
            limit2 = min(reach2, (GUESS * most + 0.5) * sizes[e] * sizes[e])
            if len(count) > 0 and count[row] >= most:
                limit2 = min(reach2, _farthest_of(place, seen, before, row, row - row % A, most))
            while True:
                held = _look_around(
                    first, e, sizes[e], shape[e, 0], shape[e, 1], order, points, x, y, k, limit2, reach2, most,
                    near, near2, sorted_,
                )  # fmt: skip
                if held >= most or limit2 == reach2:
                    break
                limit2 = min(reach2, 4.0 * limit2)
            sort_by_distance(near, near2, held, sorted_)
            held = min(held, most)
        number[row] = held
        for n in range(held):
            agent[row, n] = near[sorted_[n]] - e * A
        for n in range(held, widest):
            agent[row, n] = -1


@kernel(inline=True)
def _farthest_of(place: Floats, seen: NDArray[np.bool_], before: Rows, row: int, first: int, most: int) -> float:
    """Return the largest squared distance to the neighbours of an earlier search; inf if one is none any more."""
    farthest2 = 0.0
    for n in range(most):
        other = first + before[row, n]
        dx, dy = place[other, 0] - place[row, 0], place[other, 1] - place[row, 1]
        d2 = dx * dx + dy * dy
        farthest2 = max(farthest2, d2 if seen[other] and d2 < math.inf else math.inf)
    return farthest2


@kernel(inline=True)
def _look_around(
    first: Rows, e: int, size: float, columns: int, rows: int, order: Rows, points: Floats, x: float, y: float,
    own: int, limit2: float, reach2: float, most: int, near: Rows, near2: Floats, sorted_: Rows,
) -> int:  # fmt: skip
    """Collect candidates by grid row, from the agent's row outwards up to the limit; return their number."""
    held = int(np.int64(0))
    inverse = 1.0 / size
    line = math.floor(y * inverse)
    slack = SLACK * (abs(x) + abs(y) + size)
    for visit in range(rows):  # the agent's row, then +1, -1, +2, -2, ...
        ring = (visit + 1) // 2
        above = max(0.0, (line + ring) * size - y - slack)
        below = max(0.0, y - (line - ring + 1) * size - slack)
        if visit > 0 and min(above, below) ** 2 > limit2:
            break
        gap = above if visit % 2 == 1 else below if visit > 0 else 0.0
        if 2 * ring == rows:  # the same row of cells above and below, around the end of the grid
            gap = min(above, below)
        if gap * gap > limit2:
            continue
        width = math.sqrt(limit2 - gap * gap) + slack
        start = _wrap(line + ring if visit % 2 == 1 else line - ring, rows) * columns
        low, high = 0, columns - 1
        if 2.0 * width * inverse + 2.0 < columns:
            low = _wrap(math.floor((x - width) * inverse), columns)
            high = _wrap(math.floor((x + width) * inverse), columns)
        for _ in range(1 if low <= high else 2):  # twice around the end of the row
            last = high if low <= high else columns - 1
            for k in range(first[e, start + low], first[e, start + last + 1]):
                if held == len(near) - 1:
                    held, limit2 = keep_nearest(near, near2, held, most, sorted_)
                dx, dy = points[k, 0] - x, points[k, 1] - y
                d2 = dx * dx + dy * dy
                near[held], near2[held] = order[k], d2
                held += 1 if (d2 <= limit2) & (d2 < reach2) & (k != own) else 0  # no branch: none could foresee it
            low = 0
    return held

"""Neighbour lists over several steps (Verlet lists): candidates within the reach and a skin, for slow crowds.

A search of a crowd that moves little in a step keeps its candidates, up to a skin beyond the reach. The next searches
sort only these, as long as no agent outside of a list can have come near enough: results equal those of a new search.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from crowdbot.core.kernels import kernel, prange
from crowdbot.typing import Bools, Floats, Rows

Search = Callable[..., Rows]
"""Fills ``agent [rows, K]`` and ``number [rows]`` for given seekers; returns the spatial order of the rows."""

SKIN = 0.5
"""Distance [m] beyond the reach within which agents are candidates."""
SLOW = SKIN / 8.0
"""Largest displacement in a step [m] of a crowd whose candidates are kept."""
EXTRA = 14
"""Number of candidates beyond the number of neighbours."""
LARGEST = 100_000
"""Largest number of rows whose candidates are kept, against memory."""
SLOTS = 4
"""Number of crowds, or models of one crowd, whose candidates are kept in a thread."""
PART = 64
"""Number of rows in one work item of a thread."""
SLACK = 1e-12
"""Relative margin against rounding of distances."""

_kept = threading.local()


@dataclass
class _Lists:
    """Positions of the last search, and candidates of an earlier one if the crowd is slow.

    Fields:
        last: ``[rows, 2]`` positions at the last search [m].
        place: positions when the candidates were searched; the candidates are invalid if it is None.
        seen, reach, most: what the candidates were searched for.
        agent, number: candidates as in :class:`~crowdbot.core.neighbors.Neighbors`, by row.
        limit: ``[rows]`` distance [m] within which every agent was a candidate.
        order: spatial order of the rows.
        found: neighbours of the last search in which the candidates did not suffice, and their number.
    """

    last: Floats
    found: tuple[Rows, Rows]
    place: Floats | None = None
    seen: Bools | None = None
    reach: Floats | None = None
    most: Rows | None = None
    agent: Rows | None = None
    number: Rows | None = None
    limit: Floats | None = None
    order: Rows | None = None


def search_again(seekers: Any, seen: Bools, E: int, agent: Rows, number: Rows, search: Search, small: int) -> Rows:
    """Fill the neighbours from kept candidates if they suffice, otherwise by ``search``; return the spatial order.

    Args:
        seekers: named tuple of position, reach, maximum number and whether to search, by row.
        seen: ``[rows]`` whether an agent can be a neighbour.
        E: number of environments.
        agent, number: output arrays ``[rows, K]`` and ``[rows]``.
        search: a new search, with the arguments seekers, seen, E, agent, number and the neighbours of an earlier one.
        small: largest number of rows for one thread.
    """
    place, reach, _, asking = seekers
    if len(number) > LARGEST or not agent.shape[1]:
        return search(seekers, seen, E, agent, number)
    slots: dict[Any, _Lists] = _kept.__dict__.setdefault("slots", {})
    key = (E, *agent.shape, float(reach.max()))
    lists = slots.pop(key, None)
    if lists is None:
        while len(slots) >= SLOTS:
            del slots[next(iter(slots))]
        slots[key] = _Lists(place.copy(), (agent, number))
        return search(seekers, seen, E, agent, number)
    slots[key] = lists  # the last one used
    if lists.place is not None and _fill(lists, seekers, seen, E, agent, number, small):
        lists.last = place.copy()
        assert lists.order is not None
        return lists.order
    slow = math.sqrt(_farthest_move(place, lists.last, seen, asking)) <= SLOW
    lists.last, lists.place = place.copy(), None
    if slow:
        _keep(lists, seekers, seen, E, agent.shape[1], search)
        if _fill(lists, seekers, seen, E, agent, number, small):
            assert lists.order is not None
            return lists.order
        lists.place = None
    order = search(seekers, seen, E, agent, number, lists.found)
    lists.found = agent, number
    return order


def _keep(lists: _Lists, seekers: Any, seen: Bools, E: int, widest: int, search: Search) -> None:
    """Search and keep the candidates of all agents that can be a neighbour or can ask for some."""
    rows = len(seen)
    wide = min(widest + EXTRA, max(1, rows // E - 1))
    agent, number = np.empty((rows, wide), dtype=np.int32), np.empty(rows, dtype=np.int32)
    reach = seekers.reach + SKIN
    capacity = np.minimum(seekers.max_count, widest) + np.int32(EXTRA)
    asked = seen | seekers.asking
    everyone = seekers._replace(reach=reach, max_count=capacity, asking=asked)
    order = search(everyone, seen, E, agent, number)
    limit = np.empty(rows)
    _measure_limits(seekers.place, reach, capacity, asked, agent, number, rows // E, limit)
    kept = {"place": lists.last, "seen": seen.copy(), "reach": seekers.reach.copy(), "most": seekers.max_count.copy()}
    for name, value in (kept | {"agent": agent, "number": number, "limit": limit, "order": order}).items():
        setattr(lists, name, value)


def _fill(lists: _Lists, seekers: Any, seen: Bools, E: int, agent: Rows, number: Rows, small: int) -> bool:
    """Fill the neighbours from the candidates; return whether they are those of a new search."""
    place, reach, most, asking = seekers
    compared: tuple[Any, ...] = (
        lists.place, lists.seen, lists.reach, lists.most, place, seen, reach, most, asking
    )  # fmt: skip
    farthest = math.sqrt(_farthest_since(*compared))
    if not 2.0 * farthest < SKIN:
        return False
    assert lists.order is not None
    rows = len(number)
    fits = np.ones((rows + PART - 1) // PART, dtype=np.bool_)
    values = (lists.agent, lists.number, lists.limit, farthest, *seekers, rows // E, agent, number, fits)
    if rows <= small:
        _sort_part(0, rows, *values)
    else:
        _sort_all(lists.order, *values)
    return bool(fits.all())


@kernel
def _farthest_move(place: Floats, earlier: Floats, seen: Bools, asking: Bools) -> float:
    """Return the largest squared displacement [m^2] of agents that can be a neighbour or ask for some; inf for NaN."""
    farthest = 0.0
    for row in range(len(place)):
        if seen[row] or asking[row]:
            dx, dy = place[row, 0] - earlier[row, 0], place[row, 1] - earlier[row, 1]
            moved = dx * dx + dy * dy
            if not moved <= farthest:
                farthest = moved if moved > farthest else math.inf
    return farthest


@kernel
def _farthest_since(
    earlier: Floats, earlier_seen: Bools, earlier_reach: Floats, earlier_most: Rows, place: Floats, seen: Bools,
    reach: Floats, most: Rows, asking: Bools,
) -> float:  # fmt: skip
    """Return the largest squared displacement [m^2] since an earlier search; inf if it was for something else."""
    for row in range(len(place)):
        if seen[row] != earlier_seen[row] or reach[row] != earlier_reach[row] or most[row] != earlier_most[row]:
            return math.inf
    return _farthest_move(place, earlier, seen, asking)


@kernel
def _measure_limits(
    place: Floats, reach: Floats, capacity: Rows, asked: Bools, agent: Rows, number: Rows, A: int, limit: Floats
) -> None:  # fmt: skip
    """Write the distance within which every agent is a candidate: the reach, or that of the last of a full list."""
    for row in range(len(number)):
        limit[row] = reach[row] if asked[row] else -math.inf
        if number[row] >= min(capacity[row], agent.shape[1]) and 0 < number[row] < A - 1:
            k = row - row % A + agent[row, number[row] - 1]
            dx, dy = place[k, 0] - place[row, 0], place[k, 1] - place[row, 1]
            limit[row] = math.sqrt(dx * dx + dy * dy)


@kernel(parallel=True)
def _sort_all(
    order: Rows, candidate: Rows, count: Rows, limit: Floats, farthest: float, place: Floats, reach: Floats,
    capacity: Rows, asking: Bools, A: int, agent: Rows, number: Rows, fits: Bools,
) -> None:  # fmt: skip
    for part in prange(len(fits)):
        near2 = np.empty(candidate.shape[1])
        for k in range(part * PART, min((part + 1) * PART, len(number))):
            if not _sort_row(
                order[k], candidate, count, limit, farthest, place, reach, capacity, asking, A, agent, number, near2
            ):
                fits[part] = False


@kernel
def _sort_part(
    begin: int, end: int, candidate: Rows, count: Rows, limit: Floats, farthest: float, place: Floats, reach: Floats,
    capacity: Rows, asking: Bools, A: int, agent: Rows, number: Rows, fits: Bools,
) -> None:  # fmt: skip
    near2 = np.empty(candidate.shape[1])
    for row in range(begin, end):
        if not _sort_row(
            row, candidate, count, limit, farthest, place, reach, capacity, asking, A, agent, number, near2
        ):  # fmt: skip
            fits[row // PART] = False


@kernel(inline=True)
def _sort_row(
    row: int, candidate: Rows, count: Rows, limit: Floats, farthest: float, place: Floats, reach: Floats,
    capacity: Rows, asking: Bools, A: int, agent: Rows, number: Rows, near2: Floats,
) -> bool:  # fmt: skip
    """Sort the candidates of an agent and write its neighbours; return whether no other agent can be one of them."""
    widest = agent.shape[1]
    x, y, most = place[row, 0], place[row, 1], min(capacity[row], widest)
    fits, held = True, int(np.int64(0))  # a literal 0 has its own type, which compiles the callees twice
    if asking[row] and most > 0 and reach[row] > 0.0:
        first = row - row % A
        for c in range(count[row]):  # the candidates are nearly in order: they were sorted in the last step
            other = candidate[row, c]
            dx, dy = place[first + other, 0] - x, place[first + other, 1] - y
            d2, n = dx * dx + dy * dy, c
            while n > 0 and (d2 < near2[n - 1] or (d2 == near2[n - 1] and other < candidate[row, n - 1])):
                near2[n], candidate[row, n] = near2[n - 1], candidate[row, n - 1]
                n -= 1
            near2[n], candidate[row, n] = d2, other
        reach2, most = reach[row] * reach[row], min(most, count[row])
        while held < most and near2[held] < reach2:
            agent[row, held] = candidate[row, held]
            held += 1
        safe = (limit[row] - 2.0 * farthest) * (1.0 - SLACK) - SLACK * (abs(x) + abs(y))
        full = held == min(capacity[row], widest)
        needed = math.sqrt(near2[held - 1]) if full else reach[row]
        fits = needed < safe or count[row] == A - 1
    number[row] = held
    for n in range(held, widest):
        agent[row, n] = -1
    return fits

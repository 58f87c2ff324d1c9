"""WaypointTable: the waypoints of all journeys as arrays, for one kernel over all people."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.typing import Bools, Floats

from .waypoint import Direction, Point, Waypoint, Zone, is_inside, nearest_point

Numbers = NDArray[np.int64]

POINT, HEADING, NEAREST, RANDOM, OTHER = 0, 1, 2, 3, 4
"""Kinds of waypoints: the goal of ``RANDOM`` and ``OTHER`` is not computed by kernels, nor the arrival of ``OTHER``."""
TURNS, LEAVES, ASKS, MOVES = 1, 2, 4, 8
"""Bits of a result: somebody has the next waypoint, leaves, needs a goal from outside, or has a goal that moved."""


class WaypointTable(NamedTuple):
    """Waypoints of J journeys in N rows.

    Fields:
        first: ``[J + 1]`` first row of each journey.
        again, leaves: ``[J]`` whether the journey starts again, or ends with a departure.
        kind: ``[N]`` kind of waypoint.
        number: ``[N, 3]`` x, y and tolerance [m]; for a heading, the vector to the goal.
        routed: ``[N]`` whether routing applies.
        corner: ``[N + 1]`` first corner of each waypoint in ``ring``.
        ring: ``[M, 2]`` corners of polygons [m].
    """

    first: Numbers
    again: Bools
    leaves: Bools
    kind: Numbers
    number: Floats
    routed: Bools
    corner: Numbers
    ring: Floats

    @classmethod
    def of(cls, journeys: Sequence[tuple[Sequence[Waypoint], str]]) -> WaypointTable:
        """Return the table of journeys, each with waypoints and what follows the last one.

        >>> table = WaypointTable.of([([Point(1.0, 2.0)], "leave")])
        >>> table.number.tolist(), table.leaves.tolist()
        ([[1.0, 2.0, 0.3]], [True])
        """
        stops = [stop for those, _ in journeys for stop in those]
        rings = [stop.ring if type(stop) is Zone else np.zeros((0, 2)) for stop in stops]
        return cls(
            _ends([len(those) for those, _ in journeys]),
            np.array([then == "again" for _, then in journeys], dtype=np.bool_),
            np.array([then == "leave" for _, then in journeys], dtype=np.bool_),
            np.array([_kind(stop) for stop in stops], dtype=np.int64),
            np.array([_number(stop) for stop in stops], dtype=np.float64).reshape(-1, 3),
            np.array([stop.uses_routing for stop in stops], dtype=np.bool_),
            _ends([len(ring) for ring in rings]),
            np.concatenate([*rings, np.zeros((0, 2))]),
        )

    @property
    def complete(self) -> bool:
        """Whether the table contains all there is to know about arrivals."""
        return bool(np.all(self.kind != OTHER))


def _ends(counts: Sequence[int]) -> Numbers:
    return np.concatenate([[0], np.cumsum(counts, dtype=np.int64)]).astype(np.int64)


def _kind(stop: Waypoint) -> int:
    if type(stop) is Zone:
        return NEAREST if stop.aim == "nearest" else RANDOM
    return {Point: POINT, Direction: HEADING}.get(type(stop), OTHER)


def _number(stop: Waypoint) -> tuple[float, float, float]:
    if type(stop) is Point:
        return float(stop.x), float(stop.y), stop.tolerance
    if type(stop) is Direction:
        return (*stop.ahead, 0.0)
    return 0.0, 0.0, stop.tolerance if type(stop) is Zone else 0.0


@kernel
def _row(table: WaypointTable, journey: float, number: float) -> int:
    """Return the row of a waypoint of a journey; -1 if there is none."""
    first, again = table[:2]
    j, k = int(journey), int(number)
    if not 0 <= j < len(again):
        return -1
    count = first[j + 1] - first[j]
    if again[j]:
        return int(first[j] + k % count)
    return int(first[j] + k) if k < count else -1


@kernel
def routing_mask(
    table: WaypointTable, journey: Floats, stop: Floats, active: Bools, external: Bools, out: Bools
) -> None:
    """Write which people ``[E, A]`` walk to a goal to which routing applies."""
    for e in range(len(active)):
        for a in range(active.shape[1]):
            out[e, a] = active[e, a] and not external[e, a]
            if out[e, a]:
                row = _row(table, journey[e, a], stop[e, a])
                out[e, a] = row < 0 or table[5][row]


@kernel
def advance_waypoints(
    table: WaypointTable, journey: Floats, position: Floats, external: Bools, stop: Floats, active: Bools,
    goal: Floats, ask: Bools,
) -> int:  # fmt: skip
    """Advance people who reached a waypoint, and move goals that depend on the position.

    Args:
        table: the waypoints, without those of kind ``OTHER``.
        journey, position, external: people ``[E, A]``.
        stop, active, goal: number of the waypoint, presence and goal of each person; modified in place.
        ask: written: who needs a goal that the caller computes.
    """
    found = 0
    leaves = table[2]
    for e in range(len(active)):
        for a in range(active.shape[1]):
            ask[e, a] = False
            if not active[e, a] or external[e, a]:
                continue
            row = _row(table, journey[e, a], stop[e, a])
            if row < 0:
                continue
            x, y = position[e, a, 0], position[e, a, 1]
            if _is_reached(table, row, x, y, goal[e, a, 0], goal[e, a, 1]):
                stop[e, a] = int(stop[e, a]) + 1
                found |= TURNS
                row = _row(table, journey[e, a], stop[e, a])
                if row < 0:
                    if leaves[int(journey[e, a])]:
                        active[e, a] = False
                        found |= LEAVES
                    continue
                found |= _aim(table, row, x, y, goal[e, a])
                if table[3][row] == RANDOM:
                    ask[e, a] = True
                    found |= ASKS
            elif table[3][row] == HEADING or table[3][row] == NEAREST:
                found |= _aim(table, row, x, y, goal[e, a])
    return found


@kernel
def _is_reached(table: WaypointTable, row: int, x: float, y: float, goal_x: float, goal_y: float) -> bool:
    kind, number, _routed, corner, ring = table[3:]
    if kind[row] == HEADING:
        return False
    dx, dy, near = x - goal_x, y - goal_y, number[row, 2]
    if dx * dx + dy * dy < near * near:
        return True
    return kind[row] != POINT and is_inside(ring[corner[row] : corner[row + 1]], x, y)


@kernel
def _aim(table: WaypointTable, row: int, x: float, y: float, goal: Floats) -> int:
    """Write the goal of a person at x, y, except a random one."""
    kind, number, _routed, corner, ring = table[3:]
    if kind[row] == POINT:
        goal[0], goal[1] = number[row, 0], number[row, 1]
    elif kind[row] == HEADING:
        goal[0], goal[1] = x + number[row, 0], y + number[row, 1]
    elif kind[row] == NEAREST:
        goal[0], goal[1] = nearest_point(ring[corner[row] : corner[row + 1]], x, y)
    return MOVES

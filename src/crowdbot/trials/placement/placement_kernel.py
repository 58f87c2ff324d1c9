"""Kernel that places the people of many environments, with the random numbers of their spawners."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import kernel, next_uniform
from crowdbot.typing import Bools, Floats, Ints, Words

from .spawn_placement import GAP

DOUBT = 1e-9
"""Distance [m] to a limit, relative to coordinates above 1 m, below which the kernel does not decide."""
MOST_MISSES = 64_000
"""Points outside a zone after which the kernel does not decide."""
NO, YES, UNSURE = 0, 1, 2


class Polygons(NamedTuple):
    """K polygons with holes as arrays: edges ``[M, 4]``, and ``[K + 1]`` the first edge of each."""

    edges: Floats
    first: Ints

    @classmethod
    def of(cls, shapes: Sequence[Any]) -> Polygons:
        """Return shapely polygons as arrays."""
        edges, first = [np.zeros((0, 4))], [0]
        for shape in shapes:
            rings = [] if shape.is_empty else [np.asarray(item.coords) for item in (shape.exterior, *shape.interiors)]
            edges += [np.concatenate([ring[:-1, :2], ring[1:, :2]], axis=1) for ring in rings]
            first.append(first[-1] + sum(len(ring) - 1 for ring in rings))
        return cls(np.concatenate(edges), np.array(first, dtype=np.int64))


class PlacementGeometry(NamedTuple):
    """Stage, zones and occupied discs of K spawners as arrays.

    Fields:
        solids: ``[M, 4]`` edges of walls and solids [m].
        blocks, grounds, bounded: solid polygons, parts of the walkable area, and whether there is one.
        zones: K spawn zones, then K goal zones, empty without a goal.
        low, size: ``[2 K, 2]`` lower corners and sizes of their boxes [m].
        discs: ``[D, 3]`` x, y and radius of robots and other people [m].
        cell: width of the cells of the grid of discs [m]; discs in cells that do not touch are not compared.
    """

    solids: Floats
    blocks: Polygons
    grounds: Polygons
    bounded: bool
    zones: Polygons
    low: Floats
    size: Floats
    discs: Floats
    cell: float


def place_people(
    states: Words,
    counts: Ints,
    geometry: PlacementGeometry,
    tries: int,
    radius: Floats,
    position: Floats,
    goal: Floats,
    decided: Bools,
) -> None:
    """Write positions and goals of N people of K spawners in E environments.

    Args:
        states: ``[E, 2 K, 4]`` states of the generators of positions, then of goals; advanced.
        counts: ``[K]`` number of people.
        geometry: stage, zones and discs.
        tries: number of points per person.
        radius: ``[E, N]`` [m].
        position, goal: ``[E, N, 2]`` [m], filled.
        decided: ``[E]`` filled with whether every decision is beyond doubt and everybody has found a place.
    """
    solids, blocks, grounds, bounded, zones, low, size, discs, cell = geometry
    stage = (solids, *blocks, *grounds, bounded)
    _place_all(
        states, counts, stage, tuple(zones), low, size, discs, cell, tries, radius, position, goal, decided
    )  # fmt: skip


@kernel
def _place_all(
    states: Words,
    counts: Ints,
    stage: Any,
    zones: Any,
    low: Floats,
    size: Floats,
    fixed: Floats,
    cell: float,
    tries: int,
    radius: Floats,
    position: Floats,
    goal: Floats,
    decided: Bools,
) -> None:
    spawners, others = len(counts), len(fixed)
    discs = np.empty((others + radius.shape[1], 3))
    discs[:others] = fixed
    point = np.empty(2)
    for e in range(len(states)):
        begin, fits = 0, True
        for k in range(spawners):
            for n in range(begin, begin + counts[k]):
                r = radius[e, n]
                fits = fits and _find(
                    states[e, k], stage, zones, k, low, size, tries, r, discs[: others + n], cell, point
                )
                position[e, n, 0], position[e, n, 1] = point[0], point[1]
                discs[others + n, 0], discs[others + n, 1], discs[others + n, 2] = point[0], point[1], r
            has_goal = zones[1][spawners + k + 1] > zones[1][spawners + k]
            for n in range(begin, begin + counts[k]):
                goal[e, n, 0], goal[e, n, 1] = position[e, n, 0], position[e, n, 1]
                if has_goal and fits:
                    i, r = spawners + k, radius[e, n]
                    fits = _find(states[e, i], stage, zones, i, low, size, tries, r, discs[:0], cell, point)
                    goal[e, n, 0], goal[e, n, 1] = point[0], point[1]
            begin += counts[k]
            if not fits:
                break
        decided[e] = fits


@kernel
def _find(
    state: Words,
    stage: Any,
    zones: Any,
    zone: int,
    low: Floats,
    size: Floats,
    tries: int,
    radius: float,
    discs: Floats,
    cell: float,
    point: Floats,
) -> bool:
    """Write the next random point of a zone with room for a disc, and return whether it is found beyond doubt."""
    misses = 0
    while tries > 0 and misses < MOST_MISSES:
        x = low[zone, 0] + next_uniform(state) * size[zone, 0]
        y = low[zone, 1] + next_uniform(state) * size[zone, 1]
        inside = _is_within(x, y, zones[0], zones[1][zone], zones[1][zone + 1])
        if inside == NO:
            misses += 1
            continue
        misses, tries = 0, tries - 1
        clear = _is_clear(x, y, radius, stage) if inside == YES else UNSURE
        if clear == YES:
            clear = _is_free(x, y, radius, discs, cell)
        if clear == YES:
            point[0], point[1] = x, y
            return True
        if clear == UNSURE:
            return False
    return False


@kernel
def _is_within(x: float, y: float, edges: Floats, first: int, last: int) -> int:
    """Return whether a point is inside of a polygon; unsure near its edges."""
    inside = False
    for m in range(first, last):
        x1, y1, x2, y2 = edges[m, 0], edges[m, 1], edges[m, 2], edges[m, 3]
        if _distance(x, y, x1, y1, x2, y2) <= _doubt(x, y):
            return UNSURE
        if (y1 > y) != (y2 > y) and x < (x2 - x1) * (y - y1) / (y2 - y1) + x1:
            inside = not inside
    return YES if inside else NO


@kernel
def _is_clear(x: float, y: float, radius: float, stage: Any) -> int:
    """Return whether a point is at least ``radius`` [m] away from all solids, and in the walkable area."""
    solids, blocks, block_first, grounds, ground_first, bounded = stage
    doubt = _doubt(x, y)
    for m in range(len(solids)):
        away = _distance(x, y, solids[m, 0], solids[m, 1], solids[m, 2], solids[m, 3])
        if away < radius + doubt:
            return NO if away < radius - doubt else UNSURE
    for k in range(len(block_first) - 1):
        inside = _is_within(x, y, blocks, block_first[k], block_first[k + 1])
        if inside != NO:
            return NO if inside == YES else UNSURE
    if not bounded:
        return YES
    for k in range(len(ground_first) - 1):
        inside = _is_within(x, y, grounds, ground_first[k], ground_first[k + 1])
        if inside != NO:
            return inside
    return NO


@kernel
def _is_free(x: float, y: float, radius: float, discs: Floats, cell: float) -> int:
    """Return whether a disc keeps the gap to all discs in its cell of the grid and the cells around."""
    i, j = math.floor(x / cell), math.floor(y / cell)
    for n in range(len(discs)):
        a, b = discs[n, 0], discs[n, 1]
        least = (radius + discs[n, 2] + GAP) * (radius + discs[n, 2] + GAP)
        away = (x - a) * (x - a) + (y - b) * (y - b)
        if away < least * (1.0 + DOUBT) and abs(math.floor(a / cell) - i) <= 1 and abs(math.floor(b / cell) - j) <= 1:
            return NO if away < least * (1.0 - DOUBT) else UNSURE
    return YES


@kernel
def _doubt(x: float, y: float) -> float:
    return DOUBT * max(1.0, abs(x), abs(y))


@kernel
def _distance(x: float, y: float, x1: float, y1: float, x2: float, y2: float) -> float:
    """Return the distance [m] of a point to a segment."""
    dx, dy, px, py = x2 - x1, y2 - y1, x - x1, y - y1
    square = dx * dx + dy * dy
    share = min(1.0, max(0.0, (px * dx + py * dy) / square)) if square > 0.0 else 0.0
    away, aside = px - share * dx, py - share * dy
    return math.sqrt(away * away + aside * aside)

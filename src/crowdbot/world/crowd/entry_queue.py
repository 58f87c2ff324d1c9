"""Kernels of queues: people arrive at sources and enter, in all environments."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel, next_uniform
from crowdbot.typing import Bools, Floats

from .entry_room import first_free, free_slot

Numbers = NDArray[np.int64]

BLOCK = 16
"""Random numbers that are drawn together for a queue."""
TRIES = 20
"""Positions tried per person and step."""
DONE, NO_BODY, WRONG_BODY = 0, 1, 2
"""Results of :func:`enter`: finished; a queue needs new speeds and radii; a speed or radius is not allowed."""


@kernel
def fill(
    queue: Any, rate: Floats, end: Floats, most: Floats, regular: Bools, now: Floats, chosen: Bools, short: Bools
) -> bool:
    """Add arrivals up to the time ``now`` ``[E]`` [s] to queues; write which lack random numbers, and return if any."""
    begin, due, come, waiting, arrival, gaps, gap = queue
    some = False
    for e in range(len(now)):
        for k in range(len(rate)):
            short[e, k] = False
            if not chosen[e, k]:
                continue
            while due[e, k] <= now[e] + 1e-9 and due[e, k] < end[k] and come[e, k] < most[k]:
                if not regular[k] and gap[e, k] >= gaps.shape[2]:
                    short[e, k] = some = True
                    break
                come[e, k] += 1
                waiting[e, k] += 1
                if regular[k]:
                    due[e, k] = begin[e, k] + come[e, k] / rate[k]
                else:
                    due[e, k] += 1.0 / rate[k] * gaps[e, k, gap[e, k]]
                    gap[e, k] += 1
            arrival[e, k] = due[e, k] if due[e, k] < end[k] and come[e, k] < most[k] else math.inf
    return some


@kernel
def enter(
    busy: Bools,
    queue: Any,
    people: Any,
    walls: Floats,
    rings: Floats,
    first: Numbers,
    ids: Numbers,
    following: Numbers,
    where: Numbers,
    values: Floats,
    mark: Numbers,
) -> int:
    """Let people of the ``busy`` ``[E, K]`` queues enter while there are free slots and room.

    Args:
        busy: the queues.
        queue: waiting, body, bodies, next, last and places of the queues.
        people: position, radius, presence and externality of all agents; modified.
        walls: ``[M, 4]``.
        rings, first: corners of the zones, and the first of each of the K zones.
        ids, following: ``[E, A]`` identities and ``[E]`` the next ones; modified.
        where: ``[N, 3]`` environment, agent and source of those who enter; filled.
        values: ``[N, 4]`` position [m], speed [m/s] and radius [m]; filled.
        mark: number of the queue at which to continue, and of people who have entered; modified.
    """
    waiting, body, bodies, next_, last, places = queue
    position, radius, active, external = people
    points = np.empty((TRIES, 2))
    sources = busy.shape[1]
    for number in range(mark[0], busy.size):
        e, k = number // sources, number % sources
        mark[0] = number
        ring = rings[first[k] : first[k + 1]]
        while busy[e, k] and waiting[e, k] > 0:
            slot = free_slot(active[e], external[e])
            if slot < 0:
                break
            if math.isnan(body[e, k, 0]):
                if next_[e, k] >= last[e, k]:
                    return NO_BODY
                speed, size = bodies[e, k, next_[e, k], 0], bodies[e, k, next_[e, k], 1]
                next_[e, k] += 1
                if not (0.0 < speed < math.inf and 0.0 < size < math.inf):
                    return WRONG_BODY
                body[e, k, 0], body[e, k, 1] = speed, size
            _draw_points(ring, places[e, k], points)
            row = first_free(points, ring, position[e], radius[e], active[e], walls, body[e, k, 1])
            if row < 0:
                break
            x, y, n = points[row, 0], points[row, 1], mark[1]
            position[e, slot, 0], position[e, slot, 1] = x, y
            radius[e, slot], active[e, slot] = body[e, k, 1], True
            where[n, 0], where[n, 1], where[n, 2] = e, slot, k
            values[n, 0], values[n, 1], values[n, 2], values[n, 3] = x, y, body[e, k, 0], body[e, k, 1]
            body[e, k, 0] = body[e, k, 1] = math.nan
            waiting[e, k] -= 1
            ids[e, slot] = following[e]
            following[e] += 1
            mark[1] += 1
    return DONE


@kernel
def _draw_points(ring: Floats, state: Any, points: Floats) -> None:
    """Write random positions in the bounding box of a zone [m]."""
    left, right, bottom, top = ring[0, 0], ring[0, 0], ring[0, 1], ring[0, 1]
    for row in range(1, len(ring)):
        left, right = min(left, ring[row, 0]), max(right, ring[row, 0])
        bottom, top = min(bottom, ring[row, 1]), max(top, ring[row, 1])
    width, height = right - left, top - bottom
    for row in range(len(points)):
        points[row, 0] = left + width * next_uniform(state)
        points[row, 1] = bottom + height * next_uniform(state)

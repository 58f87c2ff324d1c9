"""Clearances of a robot at one record of its metrics or at all of a log, in one pass over the agents."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.typing import Floats, Ints

from .agent_states import AgentLog, AgentStates
from .outline_clearance import outline_clearance
from .proximity import JUMP
from .step_clearance import step_outline_wall_clearance, step_wall_clearance, swept_length

REACH = 2.5
"""Radius [m] of the circle of the local density."""


class RecordClearance(NamedTuple):
    """Clearances of a robot at one record.

    Fields:
        near: ids of the agents closer than a limit since the previous record.
        swept: smallest clearance since the previous record [m].
        nearest: smallest clearance now [m].
        density: people within 2.5 m per area [1/m2].
        ttc: smallest time to collision [s].
        wall: smallest clearance to walls since the previous record [m].
    """

    near: Ints
    swept: float
    nearest: float
    density: float
    ttc: float
    wall: float


@kernel
def _measure(
    jump: float, old_ids: Ints, old_place: Floats, ids: Ints, place: Floats, velocity: Floats, radius: Floats, own: int,
    limit: float, near: NDArray[np.bool_],
) -> tuple[float, float, int, float]:  # fmt: skip
    """Return the smallest clearance since the old record and now, the number of people around, and the smallest TTC."""
    x, y, r = place[own, 0], place[own, 1], radius[own]
    before = np.searchsorted(old_ids, ids[own])
    steady = before < len(old_ids) and old_ids[before] == ids[own]
    bx, by = x, y
    if steady:
        bx, by = old_place[before, 0], old_place[before, 1]
        steady = math.hypot(x - bx, y - by) <= jump
    least_swept, least, count, least_ttc = math.inf, math.inf, 0, math.inf
    for n in range(len(ids)):
        near[n] = False
        if n == own:
            continue
        dx, dy = place[n, 0] - x, place[n, 1] - y
        gap = math.sqrt(dx * dx + dy * dy) - radius[n] - r
        swept = gap
        if steady:
            k = np.searchsorted(old_ids, ids[n])
            if k < len(old_ids) and old_ids[k] == ids[n]:
                px, py = old_place[k, 0], old_place[k, 1]
                if math.hypot(place[n, 0] - px, place[n, 1] - py) <= jump:
                    swept = swept_length(px - bx, py - by, dx, dy) - radius[n] - r
        near[n] = min(swept, gap) < limit
        least_swept, least = min(least_swept, swept), min(least, gap)
        count += 1 if math.hypot(dx, dy) < REACH else 0
        wx, wy = velocity[n, 0] - velocity[own, 0], velocity[n, 1] - velocity[own, 1]
        inner = dx * dx + dy * dy - (radius[n] + r) * (radius[n] + r)
        closing = dx * wx + dy * wy
        inside = closing * closing - (wx * wx + wy * wy) * inner
        ttc = math.inf
        if inner <= 0.0:
            ttc = 0.0
        elif closing < 0.0 and inside > 0.0:
            ttc = inner / (math.sqrt(inside) - closing)
        least_ttc = min(least_ttc, ttc)
    return least_swept, least, count, least_ttc


def record_clearance(
    before: AgentStates | None,
    states: AgentStates,
    own: int,
    radius: float,
    walls: Floats,
    limit: float,
    outline: Floats | None = None,
) -> RecordClearance:
    """Return the clearances of a robot at a record; motion since the record before is straight and uniform.

    Args:
        before: the record before, or None.
        states: the record.
        own: index of the robot in it.
        radius: radius of the robot towards walls [m].
        walls: segments ``[N, 4]`` [m].
        limit: agents closer than this [m] are ``near``.
        outline: corners ``[K, 2]`` of the robot in its frame [m]; None for a disc.

    >>> at = AgentStates(
    ...     0.0, np.arange(2), np.array([[0.0, 0.0], [2.0, 0.0]]), np.zeros((2, 2)), np.zeros(2), np.array([0.3, 0.2])
    ... )
    >>> record_clearance(None, at, 0, 0.3, np.zeros((0, 4)), 1.0).nearest
    1.5
    """
    if outline is not None:
        row = log_clearance(_pair(before, states), own, radius, walls, outline)
        near_ids = states.ids[row.closest[-1] < limit]
        return RecordClearance(near_ids, *(float(column[-1]) for column in row[1:]))
    old = states if before is None else before
    jump = -1.0 if before is None else JUMP * (states.time - before.time)
    near = np.empty(len(states.ids), dtype=np.bool_)
    place = np.ascontiguousarray(states.position)
    numbers = (states.ids, place, np.ascontiguousarray(states.velocity), np.ascontiguousarray(states.radius))
    swept, nearest, count, ttc = _measure(jump, old.ids, np.ascontiguousarray(old.position), *numbers, own, limit, near)
    own_old = place[own : own + 1]
    if before is not None:
        position, _, here = before.at(states.ids[own : own + 1])
        own_old = position if here[0] else np.zeros((1, 2))
    wall = step_wall_clearance(own_old, place[own : own + 1], np.array([radius]), walls)[0]
    return RecordClearance(states.ids[near], swept, nearest, count / (math.pi * REACH**2), ttc, float(wall))


def _pair(before: AgentStates | None, states: AgentStates) -> AgentLog:
    """Return the log of the agents of a record at the record before and now, or of a single record."""
    old = states if before is None else before
    place, velocity, here = old.at(states.ids)
    index = np.minimum(np.searchsorted(old.ids, states.ids), len(old.ids) - 1)
    heading = np.where(here, old.heading[index], np.nan)
    everybody = np.ones(len(states.ids), dtype=np.bool_)
    rows: tuple[Any, ...] = (
        np.array([old.time, states.time]),
        np.stack([place, states.position]),
        np.stack([velocity, states.velocity]),
        np.stack([heading, states.heading]),
        np.stack([states.radius, states.radius]),
        np.stack([here, everybody]),
    )
    return AgentLog(*(row[1 if before is None else 0 :] for row in rows))


class LogClearance(NamedTuple):
    """Clearances of a robot at each record of a log.

    Fields:
        closest: ``[T, A]`` smallest clearance of each agent since the previous record [m], infinite if absent.
        swept, nearest, density, ttc, wall: ``[T]``, see :class:`RecordClearance`.
    """

    closest: Floats
    swept: Floats
    nearest: Floats
    density: Floats
    ttc: Floats
    wall: Floats


@kernel
def _measure_log(
    jump: Floats, place: Floats, velocity: Floats, radius: Floats, active: NDArray[np.bool_], own: int,
    closest: Floats, out: Floats,
) -> None:  # fmt: skip
    """Write at each time the values of :func:`_measure`, and the smallest clearance of each agent since the last."""
    for t in range(len(place)):
        b = max(t - 1, 0)
        x, y, r = place[t, own, 0], place[t, own, 1], radius[t, own]
        bx, by = place[b, own, 0], place[b, own, 1]
        moves = t > 0 and math.hypot(x - bx, y - by) <= jump[t]
        least_swept, least, count, least_ttc = math.inf, math.inf, 0, math.inf
        for n in range(place.shape[1]):
            closest[t, n] = math.inf
            if n == own or not active[t, n]:
                continue
            dx, dy = place[t, n, 0] - x, place[t, n, 1] - y
            gap = math.sqrt(dx * dx + dy * dy) - radius[t, n] - r
            swept = gap
            if moves and active[b, n]:
                px, py = place[b, n, 0], place[b, n, 1]
                if math.hypot(place[t, n, 0] - px, place[t, n, 1] - py) <= jump[t]:
                    swept = swept_length(px - bx, py - by, dx, dy) - radius[t, n] - r
            closest[t, n] = min(swept, gap)
            least_swept, least = min(least_swept, swept), min(least, gap)
            count += 1 if math.hypot(dx, dy) < REACH else 0
            wx, wy = velocity[t, n, 0] - velocity[t, own, 0], velocity[t, n, 1] - velocity[t, own, 1]
            inner = dx * dx + dy * dy - (radius[t, n] + r) * (radius[t, n] + r)
            closing = dx * wx + dy * wy
            inside = closing * closing - (wx * wx + wy * wy) * inner
            ttc = math.inf
            if inner <= 0.0:
                ttc = 0.0
            elif closing < 0.0 and inside > 0.0:
                ttc = inner / (math.sqrt(inside) - closing)
            least_ttc = min(least_ttc, ttc)
        out[0, t], out[1, t], out[2, t], out[3, t] = least_swept, least, count, least_ttc


def log_clearance(log: AgentLog, own: int, radius: float, walls: Floats, outline: Floats | None = None) -> LogClearance:
    """Return the clearances of a robot at each record of a log, with the bits of :func:`record_clearance`.

    Args:
        log: the log; the robot is always present.
        own: id of the robot.
        radius: radius of the robot towards walls [m].
        walls: segments ``[N, 4]`` [m].
        outline: corners ``[K, 2]`` of the robot in its frame [m]; None for a disc.

    >>> place = np.array([[[0.0, 0.0], [2.0, 0.0]]])
    >>> log = AgentLog(np.zeros(1), place, 0 * place, np.zeros((1, 2)), np.array([[0.3, 0.2]]), np.ones((1, 2), bool))
    >>> log_clearance(log, 0, 0.3, np.zeros((0, 4))).nearest.tolist()
    [1.5]
    """
    if outline is not None:
        return _outline_log(log, own, radius, walls, outline)
    closest, out = np.empty(log.active.shape), np.empty((4, len(log.times)))
    jump = JUMP * np.diff(log.times, prepend=-math.inf)
    moving = np.ascontiguousarray(log.position), np.ascontiguousarray(log.velocity)
    _measure_log(jump, *moving, np.ascontiguousarray(log.radius), np.ascontiguousarray(log.active), own, closest, out)
    place = log.position[:, own]
    before = np.concatenate([place[:1], place[:-1]])
    wall = step_wall_clearance(before, place, np.full(len(place), radius), walls)
    swept, nearest, count, ttc = out
    return LogClearance(closest, swept, nearest, count / (math.pi * REACH**2), ttc, wall)


def _outline_log(log: AgentLog, own: int, radius: float, walls: Floats, outline: Floats) -> LogClearance:
    heading = log.heading[:, own]
    swept, gap, ttc = outline_clearance(
        log.times, log.position, log.velocity, heading, log.radius, log.active, own, outline
    )
    place = log.position[:, own]
    away = np.hypot(*np.moveaxis(log.position - place[:, None], -1, 0))
    around = log.active & (away < REACH)
    around[:, own] = False
    old, turn = (np.concatenate([column[:1], column[:-1]]) for column in (place, heading))
    known = np.isfinite(heading)
    turn = np.where(np.isfinite(turn), turn, heading)
    size = np.full(len(place), radius)
    wall = step_wall_clearance(old, place, size, walls)
    wall[known] = step_outline_wall_clearance(
        old[known], turn[known], place[known], heading[known], size[known], outline, walls
    )
    least = (column.min(axis=1, initial=math.inf) for column in (np.minimum(swept, gap), gap, ttc))
    near, nearest, soonest = least
    density = around.sum(axis=1) / (math.pi * REACH**2)
    return LogClearance(np.minimum(swept, gap), near, nearest, density, soonest, wall)

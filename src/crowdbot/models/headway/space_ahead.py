"""Speed by the space ahead: the kernels of the headway layer."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, Neighbors, kernel, prange

__all__ = ["HeadwayRows", "limit_speeds", "limit_speeds_part"]

Floats = NDArray[np.float64]

SLOWEST = 1e-9
"""Speeds below this [m/s] have no direction."""
SMALLEST_SHARE = 1e-3
"""Lower limit of the share of the time gap, against division by zero."""
ATTEMPTS = 20
"""Passes over the neighbours in which a sliding person looks for a free velocity."""
LEEWAY = 1e-3
"""Speed into others [m/s] that ends this search."""
STANDING = 0.1
"""People slower than this [m/s] do not count as oncoming."""


class HeadwayRows(NamedTuple):
    """Data of every agent for the kernels, by row ``e * A + a``."""

    position: Floats
    velocity: Floats
    chosen: Floats
    wish: Floats
    radius: Floats
    time_gap: Floats
    spacing: Floats
    width: Floats
    taper: Floats
    anticipation: Floats
    oncoming: Floats
    reaction: Floats
    sliding: Floats
    walking: NDArray[np.bool_]


@kernel(parallel=True)
def limit_speeds(crowd: HeadwayRows, near: Neighbors, dt: float, out: Floats) -> None:
    """Limit the speed of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        limit_speeds_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), crowd, near, dt, out)


@kernel
def limit_speeds_part(begin: int, end: int, crowd: HeadwayRows, near: Neighbors, dt: float, out: Floats) -> None:
    """Limit the speed of the agents ``begin`` to ``end`` in spatial order."""
    # unpack the tuples outside of the loop: each access counts references
    place, velocity, chosen, wish, radius, gap, spacing, width, taper, look, oncoming, reaction, sliding, walking = crowd
    agent, number, order = near
    A = agent.shape[1]
    for k in range(begin, end):
        row = order[k]
        vx, vy = chosen[row, 0], chosen[row, 1]
        out[row, 0], out[row, 1] = vx, vy
        speed = math.sqrt(vx * vx + vy * vy)
        if not walking[row] or speed < SLOWEST:
            continue
        ux, uy = vx / speed, vy / speed
        limit, way = math.inf, math.inf
        e, a = row // A, row % A
        for n in range(number[e, a]):
            other = row - a + agent[e, a, n]
            dx, dy = place[other, 0] - place[row, 0], place[other, 1] - place[row, 1]
            contact = radius[row] + radius[other]
            free, side = _space(dx, dy, ux, uy, contact)
            if side < 1.0:
                way = min(way, max(free, 0.0))
            if side < width[row]:
                toward = velocity[other, 0] * ux + velocity[other, 1] * uy
                free += look[row] * max(toward, 0.0) - spacing[row]
                share = 1.0 - taper[row] * (side / width[row]) ** 2
                if toward < 0.0:
                    fast = math.sqrt(velocity[other, 0] ** 2 + velocity[other, 1] ** 2)
                    share *= 1.0 - (1.0 - oncoming[row]) * min(1.0, -toward / max(fast, STANDING))
                limit = min(limit, max(free, 0.0) / (gap[row] * max(share, SMALLEST_SHARE)))
        if limit < math.inf and reaction[row] > 0.0:
            now = max(0.0, velocity[row, 0] * ux + velocity[row, 1] * uy)
            free_speed = math.sqrt(wish[row, 0] ** 2 + wish[row, 1] ** 2)
            limit = now + (min(limit, max(free_speed, now)) - now) * -math.expm1(-dt / reaction[row])
        wanted = min(limit, speed)
        limit = min(limit, way / dt)
        if limit < speed:
            out[row, 0], out[row, 1] = limit * ux, limit * uy
        if sliding[row] > 0.0 and limit < wanted:
            sx, sy = _slide(row, a, agent[e, a], number[e, a], place, radius, wanted * ux, wanted * uy, dt)
            out[row, 0] += sliding[row] * (sx - out[row, 0])
            out[row, 1] += sliding[row] * (sy - out[row, 1])


@kernel
def _slide(
    row: int, a: int, agent: Any, number: int, place: Floats, radius: Floats, vx: float, vy: float, dt: float
) -> tuple[float, float]:
    """Return the velocity without the part that leads into others; each of two takes half of the way to contact.

    It is 0 if no velocity is found that leads into nobody.
    """
    for _ in range(ATTEMPTS):
        free = True
        for n in range(number):
            other = row - a + agent[n]
            dx, dy = place[other, 0] - place[row, 0], place[other, 1] - place[row, 1]
            distance = math.sqrt(dx * dx + dy * dy)
            if distance == 0.0:
                continue
            room = 0.5 * max(distance - radius[row] - radius[other], 0.0) / dt
            toward = (vx * dx + vy * dy) / distance
            if toward > room + LEEWAY:
                free = False
                vx -= (toward - room) * dx / distance
                vy -= (toward - room) * dy / distance
        if free:
            return vx, vy
    return 0.0, 0.0


@kernel
def _space(dx: float, dy: float, ux: float, uy: float, contact: float) -> tuple[float, float]:
    """Return the way [m] to contact with a disc at dx, dy in direction u, and its lateral offset in sums of radii.

    For a disc at the side that is never met, the way ends abreast of it. A disc behind has an infinite offset.
    """
    along, side = dx * ux + dy * uy, abs(dx * uy - dy * ux) / contact if contact > 0.0 else math.inf
    if along <= 0.0:
        return math.inf, math.inf
    inside = min(side, 1.0)
    return along - contact * math.sqrt(1.0 - inside * inside), side

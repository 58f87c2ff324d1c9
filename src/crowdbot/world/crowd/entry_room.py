"""Room for people who enter: free slots and free positions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.typing import Bools, Floats

from .waypoint import is_inside

Numbers = NDArray[np.int64]

GAP = 0.01
"""Smallest distance [m] between bodies at entry."""


@kernel
def find_busy(arrival: Floats, waiting: Numbers, now: Floats, active: Bools, external: Bools, busy: Bools) -> bool:
    """Write the sources ``[E, K]`` at which somebody arrives or may enter; return whether there is one."""
    some = False
    for e in range(len(now)):
        slot = int(np.int64(-2))
        for k in range(waiting.shape[1]):
            busy[e, k] = arrival[e, k] <= now[e] + 1e-9
            if not busy[e, k] and waiting[e, k] > 0:
                slot = free_slot(active[e], external[e]) if slot == -2 else slot
                busy[e, k] = slot >= 0
            some = some or busy[e, k]
    return some


@kernel
def free_slot(active: Bools, external: Bools) -> int:
    """Return the first slot of an absent person, -1 for none."""
    for a in range(len(active)):
        if not active[a] and not external[a]:
            return a
    return -1


@kernel
def first_free(
    points: Floats, ring: Floats, position: Floats, size: Floats, active: Bools, walls: Floats, radius: float
) -> int:
    """Return the first point in the zone with room for a body, -1 for none."""
    for row in range(len(points)):
        x, y = points[row, 0], points[row, 1]
        free = is_inside(ring, x, y)
        for k in range(len(active)):
            if not free:
                break
            if active[k]:
                dx, dy, reach = position[k, 0] - x, position[k, 1] - y, size[k] + radius + GAP
                free = not dx * dx + dy * dy < reach * reach
        for m in range(len(walls)):
            if not free:
                break
            free = not _distance2(x, y, walls[m]) < radius * radius
        if free:
            return row
    return -1


@kernel
def _distance2(x: float, y: float, wall: Floats) -> float:
    """Return the squared distance [m2] from a point to a wall ``[4]``."""
    ex, ey = wall[2] - wall[0], wall[3] - wall[1]
    dx, dy = x - wall[0], y - wall[1]
    along = min(max((dx * ex + dy * ey) / max(ex * ex + ey * ey, 1e-300), 0.0), 1.0)
    return float((dx - along * ex) * (dx - along * ex) + (dy - along * ey) * (dy - along * ey))

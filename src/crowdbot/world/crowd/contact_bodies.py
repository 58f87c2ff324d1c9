"""Bodies before and after contacts are resolved."""

from __future__ import annotations

import math

from crowdbot.core import kernel
from crowdbot.typing import Bools, Floats

SPARE = 0.25
"""Margin of the neighbor search, in radii; pushes change positions."""


@kernel
def gather_bodies(
    before: Floats, after: Floats, size: Floats, active: Bools, external: Bools, visible: Bools, start: Floats,
    place: Floats, radius: Floats, reach: Floats, pushed: Bools, seen: Bools,
) -> None:  # fmt: skip
    """Write the data of every agent: zeros for absent ones, and the distance within which neighbors are searched."""
    for e in range(len(active)):
        largest = 0.0
        for a in range(active.shape[1]):
            here = active[e, a]
            pushed[e, a], seen[e, a] = here and not external[e, a], here and visible[e, a]
            radius[e, a] = size[e, a] if here else 0.0
            largest = max(largest, radius[e, a])
            for k in range(2):
                start[e, a, k] = before[e, a, k] if here else 0.0
                place[e, a, k] = after[e, a, k] if here else 0.0
        for a in range(active.shape[1]):
            reach[e, a] = radius[e, a] + (1.0 + SPARE) * largest


@kernel
def shift_bodies(
    place: Floats, position: Floats, velocity: Floats, max_speed: Floats, pushed: Bools, dt: float, out: Floats,
    pace: Floats,
) -> bool:  # fmt: skip
    """Write positions and velocities after the push to ``place``; return whether somebody was pushed."""
    some = False
    for e in range(len(pushed)):
        for a in range(pushed.shape[1]):
            vx, vy = velocity[e, a, 0], velocity[e, a, 1]
            out[e, a, 0], out[e, a, 1] = position[e, a, 0], position[e, a, 1]
            pace[e, a, 0], pace[e, a, 1] = vx, vy
            if not pushed[e, a]:
                continue
            dx, dy = place[e, a, 0] - position[e, a, 0], place[e, a, 1] - position[e, a, 1]
            if dx != 0.0 or dy != 0.0:
                x, y = vx + dx / dt, vy + dy / dt
                limit = max(math.hypot(vx, vy), max_speed[e, a])
                share = min(1.0, limit / max(math.hypot(x, y), 1e-300))
                out[e, a, 0], out[e, a, 1] = place[e, a, 0], place[e, a, 1]
                pace[e, a, 0], pace[e, a, 1] = x * share, y * share
                some = True
    return some

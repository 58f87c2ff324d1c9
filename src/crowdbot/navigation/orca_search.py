"""Kernel of the ORCA navigator: the velocity of one robot among people, in many environments.

The lines are those of :class:`crowdbot.models.ORCA`; people are not agents here, so that only one velocity is computed
in each environment. Results equal those of the model to the last bit.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.models.velocity_obstacles import linear_program, orca_lines
from crowdbot.typing import Floats

from .goal_motion import exact_distance, slow_speed

Counts = NDArray[np.int64]

NUMBERS = (
    "top", "max_acceleration", "safety", "share", "time_horizon", "time_horizon_walls", "neighbor_distance", "reaction",
)  # fmt: skip
"""Order of the numbers of the navigator."""

best_velocity = linear_program.best_velocity
avoid_agent, avoid_edge = orca_lines.avoid_agent, orca_lines.avoid_edge
edges_in_reach, edges_of = orca_lines.edges_in_reach, orca_lines.edges_of
Edges = orca_lines.Edges


@kernel
def _nearest(
    x: float, y: float, reach: float, position: Floats, seen: NDArray[np.bool_], found: Counts, gap2: Floats
) -> int:
    """Find the nearest people closer than ``reach``, by distance, then by index; return their number."""
    held, most = int(np.int64(0)), len(found)
    for a in range(len(seen)):
        dx, dy = position[a, 0] - x, position[a, 1] - y
        d2 = dx * dx + dy * dy
        if not (seen[a] and d2 < reach * reach) or (held == most and not (most > 0 and d2 < gap2[most - 1])):
            continue
        n = held if held < most else most - 1
        while n > 0 and d2 < gap2[n - 1]:
            gap2[n], found[n] = gap2[n - 1], found[n - 1]
            n -= 1
        gap2[n], found[n] = d2, a
        held = min(held + 1, most)
    return held


@kernel
def choose_velocities(
    asking: NDArray[np.bool_], pose: Floats, goal: Floats, waypoint: Floats, twist: Floats, radius: Floats,
    position: Floats, velocity: Floats, size: Floats, seen: NDArray[np.bool_],
    corner: Floats, direction: Floats, previous: Counts, following: Counts, convex: NDArray[np.bool_],
    numbers: Floats, most: int, out: Floats,
) -> None:  # fmt: skip
    """Write the velocities ``[N, 2]`` [m/s] in the world.

    Args:
        asking: ``[N]`` rows to fill.
        pose, goal, waypoint, twist, radius: ``[N, ...]`` the robot.
        position, velocity, size, seen: ``[N, A, ...]`` people.
        corner, direction, previous, following, convex: edges of the walls.
        numbers: as in :data:`NUMBERS`.
        most: largest number of people considered.
        out: ``[N, 2]``.
    """
    top, push, safety, share = numbers[0], numbers[1], numbers[2], numbers[3]
    horizon, wall_horizon, reach, reaction = numbers[4], numbers[5], numbers[6], numbers[7]
    M, A = len(corner), size.shape[1]
    found, gap2 = np.empty(min(most, A), np.int64), np.empty(min(most, A))
    edge, edge2 = np.empty(M, np.int64), np.empty(M)
    lines = np.empty((M + len(found), 4))
    spare = np.empty_like(lines)
    for e in range(len(pose)):
        if not asking[e]:
            continue
        x, y, tx, ty, own = pose[e, 0], pose[e, 1], waypoint[e, 0], waypoint[e, 1], radius[e] + safety
        cos, sin = math.cos(pose[e, 2]), math.sin(pose[e, 2])
        vx, vy = cos * twist[e, 0] - sin * twist[e, 2], sin * twist[e, 0] + cos * twist[e, 2]
        distance = exact_distance(x, y, tx, ty)
        remaining = distance + exact_distance(tx, ty, goal[e, 0], goal[e, 1])
        scale = slow_speed(top, remaining, push) / max(distance, 1e-9)
        fixed = int(np.int64(0))
        for n in range(edges_in_reach(corner, following, x, y, wall_horizon * top + own, edge, edge2)):
            fixed += avoid_edge(
                lines, fixed, edge[n], corner, direction, previous, following, convex, x, y, vx, vy, own, wall_horizon
            )
        count = fixed
        for n in range(_nearest(x, y, reach, position[e], seen[e], found, gap2)):
            a = found[n]
            avoid_agent(
                lines, count, position[e, a, 0] - x, position[e, a, 1] - y, vx, vy, velocity[e, a, 0],
                velocity[e, a, 1], own + size[e, a], horizon, reaction, share, 1.0,
            )  # fmt: skip
            count += 1
        out[e, 0], out[e, 1] = best_velocity(lines, fixed, count, top, (tx - x) * scale, (ty - y) * scale, spare)

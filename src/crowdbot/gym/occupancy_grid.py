"""Occupancy grids around a robot, of the people that it sees and the walls of the stage."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.navigation import ObservationBatch
from crowdbot.typing import Floats


def occupancy_grids(batch: ObservationBatch, cells: int, cell: float) -> Floats:
    """Return ``[N, cells, cells]`` grids: 1 where the centre of a cell is within half a cell of a person or a wall.

    Row i and column j count from the back right corner of a square around the robot: i forward, j to the left.

    Args:
        batch: what the robot knows in N environments.
        cells: number of cells of a side.
        cell: width of a cell [m].

    >>> from crowdbot.navigation import DriveLimits
    >>> batch = ObservationBatch(pose=np.zeros((1, 3)), goal=np.ones((1, 2)), radius=np.full(1, 0.3),
    ...     limits=DriveLimits(1.0, 2.0), dt=0.1)
    >>> occupancy_grids(batch, 4, 0.5).sum()
    np.float64(0.0)
    """
    found = np.zeros((len(batch), cells, cells))
    people = batch.people
    walls = np.require(batch.walls.segments(), np.float64, ["C", "W"])
    _paint(batch.pose, people.position, people.radius, people.seen, walls, cell, found)
    return found


@kernel
def _paint(
    pose: Floats, position: Floats, radius: Floats, seen: NDArray[np.bool_], walls: Floats, cell: float, out: Floats
) -> None:
    """Mark the cells of discs and of wall segments x, y, x, y."""
    cells = out.shape[1]
    half = 0.5 * cell * cells
    for e in range(len(pose)):
        x, y, heading = pose[e, 0], pose[e, 1], pose[e, 2]
        cos, sin = math.cos(heading), math.sin(heading)
        for a in range(radius.shape[1]):
            if seen[e, a]:
                dx, dy = position[e, a, 0] - x, position[e, a, 1] - y
                px, py = cos * dx + sin * dy, cos * dy - sin * dx
                _mark(px, py, px, py, radius[e, a] + 0.5 * cell, cell, half, out[e])
        for w in range(len(walls)):
            ax, ay, bx, by = walls[w, 0] - x, walls[w, 1] - y, walls[w, 2] - x, walls[w, 3] - y
            px, py, qx, qy = cos * ax + sin * ay, cos * ay - sin * ax, cos * bx + sin * by, cos * by - sin * bx
            _mark(px, py, qx, qy, 0.5 * cell, cell, half, out[e])


@kernel
def _mark(ax: float, ay: float, bx: float, by: float, far: float, cell: float, half: float, grid: Floats) -> None:
    """Mark the cells whose centres are nearer to a segment than ``far``."""
    cells = len(grid)
    if min(ax, bx) - far > half or max(ax, bx) + far < -half or min(ay, by) - far > half or max(ay, by) + far < -half:
        return
    low = max(math.floor((min(ax, bx) - far + half) / cell), 0)
    high = min(math.floor((max(ax, bx) + far + half) / cell) + 1, cells)
    right = max(math.floor((min(ay, by) - far + half) / cell), 0)
    left = min(math.floor((max(ay, by) + far + half) / cell) + 1, cells)
    dx, dy = bx - ax, by - ay
    square = dx * dx + dy * dy
    for i in range(low, high):
        for j in range(right, left):
            x, y = (i + 0.5) * cell - half, (j + 0.5) * cell - half
            share = 0.0
            if square > 0.0:
                share = min(max(((x - ax) * dx + (y - ay) * dy) / square, 0.0), 1.0)
            nx, ny = ax + share * dx - x, ay + share * dy - y
            if nx * nx + ny * ny < far * far:
                grid[i, j] = 1.0

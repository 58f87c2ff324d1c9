"""Grid of walls for fast visibility and distance queries."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crowdbot.core import kernel
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.typing import Floats, Rows

CELLS_A_WALL = 8
MOST_CELLS = 1 << 18
SLACK = 1.001
"""Rounding margin: walls are listed in cells slightly farther away than needed."""
EXACT = 1.0 - 1e-6
"""Fraction of a clearance that counts as the full clearance."""


class WallCells(NamedTuple):
    """Walls by grid cell.

    Fields:
        wall: ``[M, 4]`` x, y, x, y [m].
        first: ``[C + 1]`` start of each cell in ``member``.
        member: indices of walls.
        frame: lower left corner x, y [m], width of a cell [m], columns, rows, reach [m]: a wall is listed in each cell
            with a point closer than the reach.
    """

    wall: Floats
    first: Rows
    member: Rows
    frame: Floats


def wall_cells(segments: Floats, reach: float) -> WallCells:
    """Sort walls ``[M, 4]`` into all grid cells within ``reach`` [m].

    >>> cells = wall_cells(np.array([[0.0, 0.0, 4.0, 0.0]]), reach=0.5)
    >>> sees(*cells, 2.0, 1.0, 2.0, -1.0, 1.0), sees(*cells, 2.0, 1.0, 9.0, 0.6, 1.0)
    (False, True)
    """
    wall = np.ascontiguousarray(segments, dtype=np.float64).reshape(-1, 4)
    if len(wall) == 0:
        return WallCells(wall, np.zeros(2, np.int32), np.zeros(0, np.int32), np.array([0, 0, 1, 1, 1, reach], float))
    points = wall.reshape(-1, 2)
    low, high = points.min(axis=0) - SLACK * reach, points.max(axis=0) + SLACK * reach
    wide, tall = float(high[0] - low[0]), float(high[1] - low[1])
    count = min(MOST_CELLS, max(64, CELLS_A_WALL * len(wall)))
    size = max(reach, math.sqrt(wide / count) * math.sqrt(tall), max(wide, tall) / 2048.0)
    columns, rows = math.floor(wide / size) + 1, math.floor(tall / size) + 1
    first = np.zeros(columns * rows + 1, dtype=np.int32)
    frame = np.array([low[0], low[1], size, columns, rows, reach])
    _list(wall, frame, first, np.zeros(0, dtype=np.int32))
    member = np.empty(first[-1], dtype=np.int32)
    _list(wall, frame, first, member)
    return WallCells(wall, first, member, frame)


@kernel
def _list(wall: Floats, frame: Floats, first: Rows, member: Rows) -> None:
    """Count the walls of each cell if ``member`` is empty, otherwise list them."""
    size, columns, rows, reach = frame[2], int(frame[3]), int(frame[4]), SLACK * frame[5]
    near2 = (reach + 0.7072 * size) ** 2
    place = first[:-1].copy()
    for m in range(len(wall)):
        left = max(0, math.floor((min(wall[m, 0], wall[m, 2]) - reach - frame[0]) / size))
        right = min(columns - 1, math.floor((max(wall[m, 0], wall[m, 2]) + reach - frame[0]) / size))
        low = max(0, math.floor((min(wall[m, 1], wall[m, 3]) - reach - frame[1]) / size))
        high = min(rows - 1, math.floor((max(wall[m, 1], wall[m, 3]) + reach - frame[1]) / size))
        for j in range(low, high + 1):
            for i in range(left, right + 1):
                x, y = frame[0] + (i + 0.5) * size, frame[1] + (j + 0.5) * size
                if distance2(x, y, wall[m, 0], wall[m, 1], wall[m, 2], wall[m, 3]) > near2:
                    continue
                cell = j * columns + i
                if len(member) > 0:
                    member[place[cell]] = m
                    place[cell] += 1
                else:
                    first[cell + 1] += 1
    if len(member) == 0:
        for cell in range(len(first) - 1):
            first[cell + 1] += first[cell]


@kernel
def distance2(x: float, y: float, ax: float, ay: float, bx: float, by: float) -> float:
    """Return the squared distance [m2] from x, y to segment a-b."""
    nx, ny = nearest_on_segment(x, y, ax, ay, bx, by)
    return (x - nx) * (x - nx) + (y - ny) * (y - ny)


@kernel
def sees(
    wall: Floats, first: Rows, member: Rows, frame: Floats, x: float, y: float, tx: float, ty: float, share: float
) -> bool:  # fmt: skip
    """Return whether the segment from x, y to t is free: it crosses no wall and keeps a share of the reach from walls.

    A wall closer than that to one of the ends may be as close along the segment.
    """
    dx, dy = tx - x, ty - y
    size, columns, rows, reach = frame[2], int(frame[3]), int(frame[4]), share * frame[5]
    begin, end = _clip_interval(x - frame[0], dx, columns * size, 0.0, 1.0)
    begin, end = _clip_interval(y - frame[1], dy, rows * size, begin, end)
    if begin > end:
        return True
    i = min(columns - 1, max(0, math.floor((x + begin * dx - frame[0]) / size)))
    j = min(rows - 1, max(0, math.floor((y + begin * dy - frame[1]) / size)))
    last_i = min(columns - 1, max(0, math.floor((x + end * dx - frame[0]) / size)))
    last_j = min(rows - 1, max(0, math.floor((y + end * dy - frame[1]) / size)))
    right, up = (1 if dx > 0.0 else -1), (1 if dy > 0.0 else -1)
    each_x = size / abs(dx) if dx != 0.0 else math.inf
    each_y = size / abs(dy) if dy != 0.0 else math.inf
    next_x = (frame[0] + (i + (1 if right > 0 else 0)) * size - x) / dx if dx != 0.0 else math.inf
    next_y = (frame[1] + (j + (1 if up > 0 else 0)) * size - y) / dy if dy != 0.0 else math.inf
    for _ in range(columns + rows):
        cell = j * columns + i
        for k in range(first[cell], first[cell + 1]):
            m = member[k]
            if _blocks(wall[m, 0], wall[m, 1], wall[m, 2], wall[m, 3], x, y, tx, ty, reach):
                return False
        if i == last_i and j == last_j:
            break
        if next_x < next_y:
            i += right
            next_x += each_x
        else:
            j += up
            next_y += each_y
        if i < 0 or i >= columns or j < 0 or j >= rows:
            break
    return True


@kernel
def _clip_interval(place: float, way: float, width: float, begin: float, end: float) -> tuple[float, float]:
    """Clip an interval of a segment to coordinates from 0 to ``width`` along one axis; begin > end if empty."""
    if way == 0.0:
        return (begin, end) if 0.0 <= place <= width else (1.0, 0.0)
    enter, leave = -place / way, (width - place) / way
    return max(begin, min(enter, leave)), min(end, max(enter, leave))


@kernel
def _blocks(
    ax: float, ay: float, bx: float, by: float, px: float, py: float, qx: float, qy: float, reach: float
) -> bool:  # fmt: skip
    """Return whether wall a-b blocks segment p-q: crossed, or closer than the reach and than at p and q."""
    dx, dy = qx - px, qy - py
    left_a, left_b = dx * (ay - py) - dy * (ax - px), dx * (by - py) - dy * (bx - px)
    if (left_a < 0.0 < left_b) or (left_b < 0.0 < left_a):
        wx, wy = bx - ax, by - ay
        left_p, left_q = wx * (py - ay) - wy * (px - ax), wx * (qy - ay) - wy * (qx - ax)
        if (left_p < 0.0 < left_q) or (left_q < 0.0 < left_p):
            return True
    near2 = min(distance2(ax, ay, px, py, qx, qy), distance2(bx, by, px, py, qx, qy))
    if near2 >= reach * reach * EXACT:
        return False
    at_p, at_q = distance2(px, py, ax, ay, bx, by), distance2(qx, qy, ax, ay, bx, by)
    return near2 < min(reach * reach, at_p, at_q) * EXACT

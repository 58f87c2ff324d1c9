"""Shortest paths between the corners of walls."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import kernel, prange
from crowdbot.typing import Floats, Rows

from .wall_cells import WallCells, sees


@kernel(parallel=True)
def _connect(wall: Floats, first: Rows, member: Rows, frame: Floats, node: Floats, length: Floats) -> None:
    """Compute the distances between corners in sight of each other."""
    for i in prange(len(node)):
        for j in range(i):
            x, y, tx, ty = node[i, 0], node[i, 1], node[j, 0], node[j, 1]
            if sees(wall, first, member, frame, x, y, tx, ty, 1.0):
                length[i, j] = length[j, i] = math.sqrt((tx - x) ** 2 + (ty - y) ** 2)


@kernel
def _shorten(length: Floats, after: Rows) -> None:
    """Compute shortest path lengths from leg lengths, and the corner after i on the path to j (Floyd-Warshall)."""
    N = len(length)
    for k in range(N):
        for i in range(N):
            head = length[i, k]
            if head == math.inf or i == k:
                continue
            step = after[i, k]
            for j in range(N):
                total = head + length[k, j]
                if total < length[i, j]:
                    length[i, j] = total
                    after[i, j] = step


def corner_graph(cells: WallCells, node: Floats) -> tuple[Floats, Rows]:
    """Return the lengths of shortest paths between all corners, and the corner after i on the path to j."""
    N = len(node)
    length = np.full((N, N), np.inf)
    _connect(*cells, node, length)
    np.fill_diagonal(length, 0.0)
    after = np.where(np.isfinite(length), np.arange(N, dtype=np.int32), np.int32(-1)).astype(np.int32)
    _shorten(length, after)
    return length, after

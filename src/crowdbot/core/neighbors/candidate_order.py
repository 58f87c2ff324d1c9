"""Order of the candidates of one agent: by distance, then by agent index."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core.kernels import kernel
from crowdbot.typing import Floats, Rows


@kernel(inline=True)
def sort_few(near2: Floats, held: int, sorted_: Rows) -> None:
    """Write the indices of candidates that are in the order of agents, by distance (stable insertion)."""
    for i in range(held):
        n = i
        while n > 0 and near2[i] < near2[sorted_[n - 1]]:
            sorted_[n] = sorted_[n - 1]
            n -= 1
        sorted_[n] = i


@kernel
def keep_nearest(near: Rows, near2: Floats, held: int, most: int, sorted_: Rows) -> tuple[int, float]:
    """Keep only the nearest candidates; return their number and the squared distance of the last."""
    sort_by_distance(near, near2, held, sorted_)
    limit2 = near2[sorted_[most - 1]]
    for n in range(most, held):
        near2[sorted_[n]] = -1.0
    kept = int(np.int64(0))
    for i in range(held):
        if near2[i] >= 0.0:
            near[kept], near2[kept] = near[i], near2[i]
            kept += 1
    return kept, limit2


@kernel(inline=True)
def sort_by_distance(near: Rows, near2: Floats, held: int, sorted_: Rows) -> None:
    """Write the candidate indices in order of distance, then of agent index.

    The rank of a candidate is the number of nearer candidates, counted without branches.
    """
    near2[held] = math.inf
    sorted_[: held + 1] = -1
    for i in range(0, held, 2):
        rank, next_rank = int(np.int64(0)), int(np.int64(0))
        for j in range(held):
            rank += 1 if near2[j] < near2[i] else 0
            next_rank += 1 if near2[j] < near2[i + 1] else 0
        _put(near, sorted_, rank, i)
        _put(near, sorted_, next_rank, i + 1)


@kernel(inline=True)
def _put(near: Rows, sorted_: Rows, rank: int, i: int) -> None:
    """Insert i at its rank, ordered by agent index among equal distances."""
    while sorted_[rank] >= 0:
        if near[i] < near[sorted_[rank]]:
            i, sorted_[rank] = sorted_[rank], i
        rank += 1
    sorted_[rank] = i

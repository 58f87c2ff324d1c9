"""Ranks of rows in their tracks: all first rows, then all second rows, and so on."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Indices = NDArray[np.intp]


def row_rank(id: NDArray[np.int64], frame: NDArray[np.int64]) -> Indices:
    """Return the number of earlier rows of the same track for each row ``[N]``.

    >>> row_rank(np.array([7, 7, 3, 7]), np.array([0, 20, 10, 10])).tolist()
    [0, 2, 0, 1]
    """
    order = np.lexsort((frame, id))
    begins = np.searchsorted(id[order], id[order])
    number = np.empty(len(id), dtype=np.intp)
    number[order] = np.arange(len(id)) - begins
    return number


def iterate_ranks(id: NDArray[np.int64], frame: NDArray[np.int64]) -> Iterator[tuple[Indices, Indices]]:
    """Yield the rows of each rank with the previous rows of the same tracks.

    Rank 0 has no previous rows.

    >>> [(a.tolist(), b.tolist()) for a, b in iterate_ranks(np.array([7, 3, 7]), np.array([0, 0, 10]))]
    [([1, 0], []), ([2], [0])]
    """
    order = np.lexsort((frame, id))
    before = np.empty(len(id), dtype=np.intp)
    before[order[1:]] = order[:-1]
    number = row_rank(id, frame)
    by_turn = order[np.argsort(number[order], kind="stable")]
    borders = np.searchsorted(number[by_turn], np.arange(int(number.max()) + 2))
    for turn, (begin, end) in enumerate(pairwise(borders.tolist())):
        rows = by_turn[begin:end]
        yield rows, before[rows] if turn else rows[:0]

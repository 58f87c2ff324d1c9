"""Walls as arrays for the kernels of navigators, computed once for each stage."""

from __future__ import annotations

import weakref
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Walls

from .orca_search import Edges, edges_of

KNOWN: dict[int, tuple[weakref.ref[Walls], WallArrays]] = {}
"""Arrays of the walls in use, by identity."""


class WallArrays(NamedTuple):
    """Walls for kernels."""

    segments: NDArray[np.float64]
    """``[M, 4]`` x, y, x, y [m]; a thin wall is one segment."""
    edges: Edges
    """Directed edges for ORCA."""


def wall_arrays(walls: Walls) -> WallArrays:
    """Return the arrays of walls, from memory if the walls were asked before; the walls must not be changed.

    >>> wall_arrays(Walls.of([[(0.0, 0.0), (4.0, 0.0)]])).segments.tolist()
    [[0.0, 0.0, 4.0, 0.0]]
    """
    key = id(walls)
    known = KNOWN.get(key)
    if known is not None and known[0]() is walls:
        return known[1]
    arrays = WallArrays(np.require(walls.segments(), np.float64, ["C", "W"]), edges_of(walls))
    KNOWN[key] = (weakref.ref(walls, lambda _: KNOWN.pop(key, None)), arrays)
    return arrays

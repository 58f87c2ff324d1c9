"""Surfaces of walls for force models: faces and corners without duplicates.

A face acts where the foot of the perpendicular is strictly inside it; a corner acts where it is nearer than its edges.
A wall of many edges therefore acts like a single wall: joints do not count twice, and there are no gaps.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Walls, kernel
from crowdbot.typing import Floats


class WallSurfaces(NamedTuple):
    """Faces and corners of walls."""

    face: Floats
    """``[M, 6]``: start, end [m] and unit direction; free space is on the right."""
    corner: Floats
    """``[C, 2]`` [m]."""
    arm: Floats
    """``[I, 2]`` unit directions of the edges at each corner; those of corner c begin at ``first[c]``."""
    first: NDArray[np.int64]
    """``[C + 1]`` first index in ``arm`` of each corner."""


def wall_surfaces(walls: Walls) -> WallSurfaces:
    """Return the faces and the convex corners of ``walls``, which are kept with the walls.

    >>> wall = wall_surfaces(Walls.of([[(0, 0), (2, 0)], [(2, 0), (4, 0)]]))
    >>> len(wall.face), wall.corner.tolist()
    (4, [[0.0, 0.0], [2.0, 0.0], [4.0, 0.0]])
    """
    return walls.derive(_surfaces)


def _surfaces(walls: Walls) -> WallSurfaces:
    along = walls.end - walls.start
    direction = along / np.maximum(np.hypot(along[:, 0], along[:, 1]), 1e-300)[:, None]
    ends = np.concatenate([walls.start, walls.end])
    corner, which = np.unique(ends + 0.0, axis=0, return_inverse=True)  # + 0.0 converts -0 to 0
    which = which.reshape(-1)
    out = np.zeros(len(corner), dtype=np.bool_)
    out[which[: len(walls)][walls.convex]] = True
    order = np.argsort(which, kind="stable")
    order = order[out[which[order]]]
    count = np.bincount(which, minlength=len(corner))[out]
    return WallSurfaces(
        np.ascontiguousarray(np.concatenate([walls.start, walls.end, direction], axis=1)),
        np.ascontiguousarray(corner[out]),
        np.ascontiguousarray(np.concatenate([direction, -direction])[order]),
        np.concatenate([[0], np.cumsum(count)]).astype(np.int64),
    )


@kernel
def is_nearest_corner(corner: Floats, arm: Floats, first: NDArray[np.int64], c: int, x: float, y: float) -> bool:
    """Return whether corner c is nearer to x, y than all other points of its edges."""
    dx, dy = x - corner[c, 0], y - corner[c, 1]
    near = True
    for k in range(first[c], first[c + 1]):
        near = near and dx * arm[k, 0] + dy * arm[k, 1] <= 0.0
    return near


@kernel
def surface_distance(
    face: Floats, corner: Floats, arm: Floats, first: NDArray[np.int64], k: int, x: float, y: float, reach: float
) -> tuple[float, float, float]:
    """Return distance and unit normal of surface k (faces first) at x, y; inf if it does not act within ``reach``."""
    if k < len(face):
        ux, uy = face[k, 4], face[k, 5]
        dx, dy = x - face[k, 0], y - face[k, 1]
        height = dx * uy - dy * ux
        if not 0.0 < height < reach:
            return math.inf, 0.0, 0.0
        if dx * ux + dy * uy > 0.0 and (x - face[k, 2]) * ux + (y - face[k, 3]) * uy < 0.0:
            return height, uy, -ux
        return math.inf, 0.0, 0.0
    c = k - len(face)
    dx, dy = x - corner[c, 0], y - corner[c, 1]
    distance = math.sqrt(dx * dx + dy * dy)
    if 0.0 < distance < reach and is_nearest_corner(corner, arm, first, c, x, y):
        return distance, dx / distance, dy / distance
    return math.inf, 0.0, 0.0

"""Floor that a viewpoint sees over and between the walls of a stage."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from crowdbot.trials.stage import Stage


GRID = 24
"""Number of rows and columns of floor points over a stage."""
NEAREST_WALL = 0.25
"""Least distance [m] of a floor point to a wall."""


def floor_points(stage: Stage, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points ``[N, 2]`` [m] of a grid from ``low`` to ``high`` ``[2]`` where people can walk.

    >>> from crowdbot.trials import load_trial
    >>> stage = load_trial("bottleneck").stage
    >>> len(floor_points(stage, np.array([-1.0, -1.0]), np.array([1.0, 1.0])))
    504
    """
    sides = [low[k] + (np.arange(GRID) + 0.5) / GRID * (high[k] - low[k]) for k in (0, 1)]
    floor = np.stack(np.meshgrid(*sides), axis=-1).reshape(-1, 2)
    return np.asarray(floor[stage.clearance(floor) > NEAREST_WALL])


def hidden_floor(stage: Stage, floor: NDArray[np.float64], eyes: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return ``[E, N]`` whether walls hide floor points ``[N, 2]`` from ``eyes`` ``[E, 3]`` [m].

    >>> from crowdbot.trials import load_trial
    >>> stage = load_trial("bottleneck").stage
    >>> hidden_floor(stage, np.array([[2.0, 0.0], [2.0, 3.0]]), np.array([[-2.0, 0.0, 1.6]]))
    array([[False,  True]])
    """
    import shapely

    result = np.zeros((len(eyes), len(floor)), dtype=np.bool_)
    walls = stage.as_walls(props=False).segments()
    if not len(floor) or not len(walls):
        return result
    tree = shapely.STRtree(shapely.linestrings(walls.reshape(-1, 2, 2)))
    for row, eye in zip(result, eyes, strict=True):  # only the last part of a ray to the floor is below the tops
        share = 1.0 if eye[2] <= 0.0 else min(1.0, stage.wall_height / eye[2])
        below = floor + (eye[:2] - floor) * share
        rays = shapely.linestrings(np.stack([floor, below], axis=1))
        row[np.unique(tree.query(rays, predicate="intersects")[0])] = True
    return result

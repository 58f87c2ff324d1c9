"""Earth mover's distance between sets of paths."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .nearest_neighbor import _check, path_distances


def earth_mover_distance(real: ArrayLike, drawn: ArrayLike) -> NDArray[np.float64]:
    """Return the earth mover's distance ``[...]`` [m] of equally many real and drawn paths, lower is better.

    With equal numbers and weights, the distance is the mean over the optimal one-to-one assignment of real to drawn
    paths. The distance of two paths is the mean over the steps, as in ADE. Two samples of the same distribution have a
    distance above 0 that decreases with their size: compare only equal numbers.

    Args:
        real: ``[..., N, T, 2]`` [m].
        drawn: ``[..., N, T, 2]`` [m].

    Paper: Rubner, Tomasi, Guibas (2000), doi 10.1023/A:1026543900054.

    Raises:
        InputError: the shapes differ, or there is no path.

    >>> earth_mover_distance([[[0.0, 0.0]], [[4.0, 0.0]]], [[[4.0, 1.0]], [[0.0, 0.0]]]).item()
    0.5
    """
    from scipy.optimize import linear_sum_assignment

    one, other = _check(real, drawn)
    cost = path_distances(one, other)
    result = np.zeros(cost.shape[:-2])
    for index in np.ndindex(result.shape):
        result[index] = cost[index][linear_sum_assignment(cost[index])].mean()
    return result

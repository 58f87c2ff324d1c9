"""Distances between sets of real and drawn paths: nearest-neighbor test, earth mover, coverage of modes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError
from crowdbot.typing import Floats

TIE = 1e-12
"""Relative tolerance of equal distances."""


def nearest_neighbor_accuracy(real: ArrayLike, drawn: ArrayLike) -> Floats:
    """Return the leave-one-out accuracy of the 1-nearest-neighbor classifier, ``[...]`` from 0 to 1; 0.5 is ideal.

    Each path, real or drawn, is classified by its nearest other path. An accuracy of 1 means that real and drawn paths
    are distinguishable, 0 that drawn paths are copies of real ones. Among equally near paths, the share of the correct
    class counts. The distance is the mean over the steps, as in ADE. With 20 paths of each class the standard deviation
    is about 0.1: average over conditions and draws.

    Args:
        real: ``[..., N, T, 2]`` [m].
        drawn: ``[..., N, T, 2]`` [m], the same number.

    Paper: Xu et al. (2018), arXiv 1806.07755; Lopez-Paz, Oquab (2017), arXiv 1610.06545.

    Raises:
        InputError: the shapes differ, or there is no path.

    >>> nearest_neighbor_accuracy([[[0.0, 0.0]], [[1.0, 0.0]]], [[[0.0, 5.0]], [[1.0, 5.0]]]).item()
    1.0
    """
    one, other = _check(real, drawn)
    both = np.concatenate([one, other], axis=-3)
    away = path_distances(both, both)
    count = both.shape[-3]
    away[..., np.arange(count), np.arange(count)] = np.inf
    nearest = away <= away.min(axis=-1, keepdims=True) * (1.0 + TIE)
    kind = np.arange(count) < count // 2
    same = nearest & (kind[:, None] == kind)
    return np.asarray((same.sum(axis=-1) / nearest.sum(axis=-1)).mean(axis=-1))


def path_distances(one: Floats, other: Floats) -> Floats:
    """Return the mean distance over the steps between all pairs of paths, ``[..., N, M]`` [m].

    Args:
        one: ``[..., N, T, 2]`` [m].
        other: ``[..., M, T, 2]`` [m].
    """
    away = one[..., :, None, :, :] - other[..., None, :, :, :]
    return np.asarray(np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2).mean(axis=-1))


def _check(real: ArrayLike, drawn: ArrayLike) -> tuple[Floats, Floats]:
    one, other = np.asarray(real, dtype=np.float64), np.asarray(drawn, dtype=np.float64)
    if one.shape != other.shape or one.ndim < 3 or one.shape[-1] != 2 or 0 in one.shape[-3:]:
        raise InputError(
            f"paths to compare have shapes {list(one.shape)} and {list(other.shape)}; both must be [..., N, T, 2],"
            " with as many real as drawn paths, at least one"
        )
    return one, other


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


FOUND = 0.25
"""A mode is found if it has at least this fraction of an equal share."""


def mode_shares(drawn: ArrayLike, modes: ArrayLike, within: float = np.inf) -> Floats:
    """Return the share of paths of each mode, ``[..., M]``; paths far from all modes belong to none.

    Args:
        drawn: ``[..., K, T, 2]`` [m].
        modes: ``[..., M, T, 2]`` [m], the centre of each mode.
        within: mean distance [m] over the steps within which a path belongs to its nearest mode.

    Raises:
        InputError: the shapes do not match, or there is no path or mode.

    >>> ways = [[[1.0, 0.0]], [[0.0, 1.0]]]
    >>> mode_shares([[[1.0, 0.1]], [[0.9, 0.0]], [[0.0, 1.1]], [[5.0, 5.0]]], ways, within=0.5).tolist()
    [0.5, 0.25]
    """
    paths, middles = np.asarray(drawn, dtype=np.float64), np.asarray(modes, dtype=np.float64)
    fits = paths.ndim >= 3 and paths.ndim == middles.ndim and paths.shape[-2:] == middles.shape[-2:]
    if not fits or paths.shape[:-3] != middles.shape[:-3] or 0 in (*paths.shape, *middles.shape):
        raise InputError(
            f"paths {list(paths.shape)} and modes {list(middles.shape)} do not match; they must be [..., K, T, 2] and"
            " [..., M, T, 2], at least one of each"
        )
    away = path_distances(paths, middles)
    nearest = away.argmin(axis=-1)[..., None] == np.arange(middles.shape[-3])
    return np.asarray((nearest & (away <= within)).mean(axis=-2))


def mode_count(drawn: ArrayLike, modes: ArrayLike, within: float = np.inf) -> NDArray[np.int64]:
    """Return the number of found modes ``[...]``: those with at least a quarter of an equal share of the paths."""
    shares = mode_shares(drawn, modes, within)
    return np.asarray((shares >= FOUND / shares.shape[-1]).sum(axis=-1), dtype=np.int64)


def mode_coverage(drawn: ArrayLike, modes: ArrayLike, within: float = np.inf) -> Floats:
    """Return the coverage ``[...]`` from 0 to 1: 1 if all modes have equal shares."""
    shares = mode_shares(drawn, modes, within)
    return np.asarray(np.minimum(shares, 1.0 / shares.shape[-1]).sum(axis=-1))

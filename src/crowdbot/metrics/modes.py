"""Mode coverage of drawn paths."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError
from crowdbot.typing import Floats

from .nearest_neighbor import path_distances

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

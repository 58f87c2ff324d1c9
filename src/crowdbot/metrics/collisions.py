"""Collisions of predicted people with other predictions or with the ground truth."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, did_you_mean
from crowdbot.data import Forecast, Windows

from .displacement import check

__all__ = ["CONTACT", "collision_mask", "collision_share", "neighbor_mask"]

Bools = NDArray[np.bool_]
Floats = NDArray[np.float64]

CONTACT = 0.2
"""Two people closer than this [m] collide (TrajNet++)."""
NEIGHBORS = ("predicted", "true")
PAIRS_AT_ONCE = 500_000
"""Maximum number of pair distances in memory at once."""


def collision_mask(forecast: Forecast, future: Windows, limit: float = CONTACT, neighbors: str = "predicted") -> Bools:
    """Return ``[W, K, A]``: scored people who come closer than ``limit`` [m], centre to centre, to another at any step.

    A step counts if both people are present in the ground truth; positions between steps are not tested. Samples with
    weight 0 do not collide.

    Args:
        forecast, future: forecast and future of the same windows.
        limit: collision distance [m].
        neighbors: ``predicted``: predictions of the other scored people of the window in the same sample (Col-I of
            TrajNet++); ``true``: true positions of all others in the window, including people who are not scored and
            robots (Col-II). Robots themselves are not scored. People who enter after the last observed step are not in
            the window.

    Raises:
        InputError: forecast and future do not match, or ``neighbors`` is unknown.
    """
    check(forecast, future)
    _check_neighbors(neighbors)
    W, K, _, A, _ = forecast.position.shape
    hit = np.zeros((W, K, A), dtype=np.bool_)
    for window in np.flatnonzero(
        neighbor_mask(future, neighbors).any(axis=1)
    ):  # one by one: most padded pairs are empty
        here = future.present[window]
        who = np.flatnonzero(future.scored[window])
        others = who if neighbors == "predicted" else np.flatnonzero(here.any(axis=0))
        pair = here[:, who, None] & here[:, None, others] & (who[:, None] != others)
        size = max(1, PAIRS_AT_ONCE // pair.size)
        counts = np.flatnonzero(forecast.weight[window] > 0.0)
        for few in (counts[first : first + size] for first in range(0, len(counts), size)):
            own = forecast.position[window, few][:, :, who]
            there = own if neighbors == "predicted" else future.position[window][None, :, others]
            dx, dy = (own[..., :, None, axis] - there[..., None, :, axis] for axis in (0, 1))
            hit[window, few[:, None], who] = np.any(pair & (dx * dx + dy * dy < limit * limit), axis=(1, 3))
    return hit


def collision_share(forecast: Forecast, future: Windows, limit: float = CONTACT, neighbors: str = "predicted") -> float:
    """Return the share of people with neighbors who come closer than ``limit`` [m] to another one.

    The share is a mean over the people of :func:`neighbor_mask` and a weighted mean over the samples; NaN without such
    people. Neighbors are defined in :func:`collision_mask`.
    """
    together = neighbor_mask(future, neighbors)
    hit = collision_mask(forecast, future, limit, neighbors)
    if not np.any(together):
        return float("nan")
    return float(mean_over_samples(forecast, hit)[together].mean())


def neighbor_mask(future: Windows, neighbors: str = "predicted") -> Bools:
    """Return ``[W, A]``: scored people with neighbors.

    With ``predicted``, these are the people in windows with at least two scored people; with ``true``, people who share
    at least one step with anyone else in the ground truth.
    """
    if _check_neighbors(neighbors) == "predicted":
        return np.asarray(future.scored & (future.scored.sum(axis=1) > 1)[:, None])
    crowd = future.present.sum(axis=2, keepdims=True) > 1
    return np.asarray(future.scored & np.any(future.present & crowd, axis=1))


def mean_over_samples(forecast: Forecast, value: Bools) -> Floats:
    """Return the weighted mean ``[W, A]`` of values ``[W, K, A]`` over the samples."""
    return np.asarray(np.sum(value * forecast.weight[:, :, None], axis=1))


def _check_neighbors(neighbors: str) -> str:
    if neighbors not in NEIGHBORS:
        allowed = " or ".join(NEIGHBORS)
        raise InputError(f"collisions: neighbors {neighbors!r}{did_you_mean(neighbors, NEIGHBORS)} must be {allowed}")
    return neighbors

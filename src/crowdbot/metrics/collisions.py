"""Collisions of predicted people with other predictions or with the ground truth."""

from __future__ import annotations

import numpy as np

from crowdbot.core import InputError, did_you_mean
from crowdbot.data import Forecast, Windows
from crowdbot.typing import Bools, Floats

from .displacement import check
from .proximity import swept_distance

CONTACT = 0.2
"""Two people closer than this [m] collide (TrajNet++)."""
NEIGHBORS = ("predicted", "true")
PAIRS_AT_ONCE = 500_000
"""Maximum number of pair distances in memory at once."""


def collision_mask(
    forecast: Forecast,
    future: Windows,
    limit: float = CONTACT,
    neighbors: str = "predicted",
    parts: int = 1,
    everyone: bool = False,
) -> Bools:
    """Return ``[W, K, A]``: scored people who come closer than ``limit`` [m], centre to centre, to another at any step.

    A step counts if both people are present in the ground truth. Samples with weight 0 do not collide.

    Args:
        forecast, future: forecast and future of the same windows.
        limit: collision distance [m].
        neighbors: ``predicted``: predictions of the other scored people of the window in the same sample (Col-I of
            TrajNet++); ``true``: true positions of all others in the window, including people who are not scored and
            robots (Col-II). Robots themselves are not scored. People who enter after the last observed step are not in
            the window.
        parts: number of parts into which the straight way between two steps is divided; the points between them are
            tested too. TrajNet++ has 2; 1: steps only. See also :func:`swept_collision_shares`.
        everyone: predicted neighbors are all people with a forecast, not only those who are scored. TrajNet++ scores
            one person of a scene.

    Raises:
        InputError: forecast and future do not match, ``neighbors`` is unknown, or ``parts`` is below 1.
    """
    check(forecast, future)
    _check_neighbors(neighbors)
    if parts < 1:
        raise InputError(f"collisions: parts = {parts} must be at least 1")
    W, K, _, A, _ = forecast.position.shape
    hit = np.zeros((W, K, A), dtype=np.bool_)
    known = future.scored if not everyone else future.present.any(axis=1) & forecast.valid
    crowded = future.scored.any(axis=1) if everyone else neighbor_mask(future, neighbors).any(axis=1)
    for window in np.flatnonzero(crowded):  # one by one: most padded pairs are empty
        here = _divide(future.present[window].astype(np.float64), parts) >= 1.0
        who = np.flatnonzero(future.scored[window])
        others = np.flatnonzero(known[window] if neighbors == "predicted" else here.any(axis=0))
        true = _divide(future.position[window], parts)
        pair = here[:, who, None] & here[:, None, others] & (who[:, None] != others)
        size = max(1, PAIRS_AT_ONCE // pair.size)
        counts = np.flatnonzero(forecast.weight[window] > 0.0)
        for few in (counts[first : first + size] for first in range(0, len(counts), size)):
            drawn = _divide(np.moveaxis(forecast.position[window, few], 0, 1), parts).swapaxes(0, 1)
            own, there = drawn[:, :, who], drawn[:, :, others] if neighbors == "predicted" else true[None, :, others]
            dx, dy = (own[..., :, None, axis] - there[..., None, :, axis] for axis in (0, 1))
            hit[window, few[:, None], who] = np.any(pair & (dx * dx + dy * dy < limit * limit), axis=(1, 3))
    return hit


def _divide(rows: Floats, parts: int) -> Floats:
    """Return rows ``[T, ...]`` with ``parts - 1`` evenly spaced points between each two: ``[(T - 1) parts + 1, ...]``.

    >>> _divide(np.array([0.0, 1.0]), 2).tolist()
    [0.0, 0.5, 1.0]
    """
    if parts == 1:
        return rows
    at = np.arange((len(rows) - 1) * parts + 1) / parts
    low = np.minimum(at.astype(np.int64), max(len(rows) - 2, 0))
    share = (at - low).reshape(-1, *(1,) * (rows.ndim - 1))
    return np.asarray((1.0 - share) * rows[low] + share * rows[np.minimum(low + 1, len(rows) - 1)])


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


def swept_collision_shares(
    forecast: Forecast, past: Windows, future: Windows, limit: float = CONTACT
) -> tuple[float, float]:
    """Return the shares of scored people who come closer than ``limit`` [m] to another one, predicted and true.

    People move straight between rows, from the last observed row on: this finds collisions that
    :func:`collision_share` overlooks. Both shares are means over the people in windows with at least two scored people,
    over all steps at which both are present; the first is a weighted mean over the samples. NaN without such people.

    Args:
        forecast, past, future: forecast, past and future of the same windows.
        limit: distance between centres [m]: 0.2 m, or the sum of two radii.
    """
    check(forecast, future)
    together = neighbor_mask(future)
    found = np.zeros(together.shape), np.zeros(together.shape)
    for window in np.flatnonzero(together.any(axis=1)):
        who = np.flatnonzero(future.scored[window])
        here = np.concatenate([past.present[window, -1:, who].T, future.present[window][:, who]])
        start = past.position[window, -1][who]
        paths = np.concatenate([forecast.position[window][:, :, who], future.position[window][None, :, who]])
        hit = np.array([_swept_hits(np.concatenate([start[None], path]), here, limit) for path in paths])
        found[0][window, who] = forecast.weight[window] @ hit[:-1]
        found[1][window, who] = hit[-1]
    if not np.any(together):
        return float("nan"), float("nan")
    return float(found[0][together].mean()), float(found[1][together].mean())


def _swept_hits(path: Floats, here: Bools, limit: float) -> Bools:
    """Return ``[A]``: whether a person of ``path [T, A, 2]`` comes closer than ``limit`` [m] to another one."""
    away = path[:, :, None] - path[:, None]
    both = here[:, :, None] & here[:, None] & ~np.eye(path.shape[1], dtype=np.bool_)
    near = swept_distance(away[:-1], away[1:]) < limit
    return np.asarray((near & both[:-1] & both[1:]).any(axis=(0, 2)))


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

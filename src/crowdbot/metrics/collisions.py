"""Collisions of predicted people with other predictions or with the ground truth."""

from __future__ import annotations

import numpy as np

from crowdbot.core import InputError, did_you_mean, kernel
from crowdbot.data import Forecast, Windows
from crowdbot.typing import Bools, Floats

from .displacement import check

CONTACT = 0.2
"""Two people closer than this [m] collide (TrajNet++)."""
RADIUS = 0.2
"""Radius of a person [m] where the windows have none."""
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
            tested too. TrajNet++ has 2; 1: steps only. See also :func:`swept_collisions`.
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


def swept_collisions(
    forecast: Forecast, past: Windows, future: Windows, limit: float | None = CONTACT
) -> tuple[Floats, Floats]:
    """Return ``[W, A]`` twice: the share of the samples in which a scored person collides, and 1 if the true one does.

    People move straight between rows, from the last observed row on: this finds collisions that
    :func:`collision_mask` overlooks. Two people collide if their centres come closer than ``limit`` [m] while both are
    present in the ground truth. Other people are the other scored people of the window, in the same sample; the share
    is weighted by the samples. Both values are NaN for people without another scored person, see
    :func:`neighbor_mask`.

    Args:
        forecast, past, future: forecast, past and future of the same windows.
        limit: collision distance [m]; None: the sum of the radii of the two people, :data:`RADIUS` where a radius is
            unknown.

    Raises:
        InputError: forecast, past and future do not match.

    >>> here = np.ones((1, 1, 2), dtype=bool)
    >>> place = np.array([[[[0.0, 0.0], [1.0, 0.05]]]])
    >>> past, future = (Windows(at, here, here[:, 0], ~here[:, 0], np.array([[7, 8]]), np.array([[10 * k]]), 0.4, "all",
    ...     "street") for k, at in enumerate((place, place[:, :, ::-1])))  # both go to the place of the other
    >>> stand = Forecast.of(place[:, None], here[:, 0], 0.4, "me")
    >>> [share.tolist() for share in swept_collisions(stand, past, future)]
    [[[0.0, 0.0]], [[1.0, 1.0]]]
    """
    check(forecast, future)
    if past.id.shape != future.id.shape or np.any(past.id != future.id):
        raise InputError(f"collisions: past and future of {future.source} have different people")
    together = neighbor_mask(future)
    share, true = np.full(together.shape, np.nan), np.full(together.shape, np.nan)
    radius = np.full(together.shape, RADIUS) if past.radius is None else past.radius
    radius = np.where(np.isnan(radius), RADIUS, radius)
    for window in np.flatnonzero(together.any(axis=1)):
        who = np.flatnonzero(future.scored[window])
        here = np.concatenate([past.present[window, -1:][:, who], future.present[window][:, who]])
        paths = np.concatenate([forecast.position[window][:, :, who], future.position[window][None, :, who]])
        start = np.broadcast_to(past.position[window, -1][who], (len(paths), 1, len(who), 2))
        size = radius[window, who] if limit is None else np.full(len(who), 0.5 * limit)
        hit = _swept_hits(np.concatenate([start, paths], axis=1), here, size)
        share[window, who] = forecast.weight[window] @ hit[:-1]
        true[window, who] = hit[-1]
    return share, true


@kernel
def _swept_hits(path: Floats, here: Bools, radius: Floats) -> Bools:  # pragma: no cover - compiled
    """Return ``[K, A]``: whether a person of ``path [K, T, A, 2]`` [m] comes closer than the radii to another one."""
    K, T, A, _ = path.shape
    hit = np.zeros((K, A), dtype=np.bool_)
    for k in range(K):
        for a in range(A):
            for b in range(a + 1, A):
                if hit[k, a] and hit[k, b]:
                    continue
                limit = radius[a] + radius[b]
                for t in range(1, T):
                    if not (here[t - 1, a] and here[t - 1, b] and here[t, a] and here[t, b]):
                        continue
                    x, y = path[k, t - 1, a, 0] - path[k, t - 1, b, 0], path[k, t - 1, a, 1] - path[k, t - 1, b, 1]
                    u, v = path[k, t, a, 0] - path[k, t, b, 0] - x, path[k, t, a, 1] - path[k, t, b, 1] - y
                    way = u * u + v * v
                    at = min(max(-(x * u + y * v) / way, 0.0), 1.0) if way > 0.0 else 0.0
                    if (x + at * u) ** 2 + (y + at * v) ** 2 < limit * limit:
                        hit[k, a] = hit[k, b] = True
                        break
    return hit


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

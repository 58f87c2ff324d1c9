"""Latency of tracks: how long people are visible before they are tracked."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .track_comparison import TrackComparison, match_nearest


def track_latency(table: TrackComparison, times: ArrayLike, reach: float = 0.5) -> NDArray[np.float64]:
    """Return the time from the first sight of each person to the first track, ``[A]`` [s]; ``inf`` if never tracked.

    It is NaN for people who are never visible.

    Args:
        table: people and tracks.
        times: ``[T]`` [s].
        reach: largest distance of a person and a track [m].

    >>> table = TrackComparison.of([{0: (0, 0)}] * 3, [{}, {}, {5: (0.2, 0)}])
    >>> track_latency(table, [1.0, 1.1, 1.2]).round(3).tolist()
    [0.2]
    """
    seen = table.visible_only(reach)
    when = np.asarray(times, dtype=np.float64)
    there = ~np.isnan(seen.truth[..., 0])
    result = np.full(there.shape[1], np.nan)
    result[there.any(axis=0)] = np.inf
    begin = when[there.argmax(axis=0)] if len(when) else result
    for t, distance in enumerate(seen.distances()):
        people, _ = match_nearest(distance, reach)
        new = people[np.isinf(result[people])]
        result[new] = when[t] - begin[new]
    return result

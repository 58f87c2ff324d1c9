"""Tracks through occlusions: whether people keep their identity while they are hidden."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .track_comparison import TrackComparison, match_nearest

BACK = 1.0
"""A person who is not tracked this long after an occlusion [s] is lost."""


class OcclusionCount(NamedTuple):
    """Occlusions of people who were tracked before."""

    total: int
    kept: int
    """Occlusions after which the person has the same track."""
    people: NDArray[np.bool_]
    """``[A]`` people with an occlusion."""


def count_occlusions(
    table: TrackComparison, times: ArrayLike, reach: float = 0.5, least: float = 0.3
) -> OcclusionCount:
    """Count the occlusions of tracked people, and those after which the person has the same track.

    An occlusion is a time of at least ``least`` in which the person is hidden, between two in which the person is
    visible. The track before it is the last one within reach while visible, the track after it is the first one within
    reach, within 1 s.

    Args:
        table: people and tracks.
        times: ``[T]`` [s].
        reach: largest distance of a person and a track [m].
        least: shortest occlusion [s].

    >>> table = TrackComparison.of([{0: (0, 0)}] * 5, [{4: (0, 0)}] * 2 + [{}] * 2 + [{4: (0.1, 0)}],
    ...     [[], [], [0], [0], []])
    >>> count_occlusions(table, [0.0, 0.2, 0.4, 0.6, 0.8])[:2]
    (1, 1)
    """
    when = np.asarray(times, dtype=np.float64)
    there = ~np.isnan(table.truth[..., 0])
    hidden = np.zeros_like(there) if table.hidden is None else table.hidden & there
    track = np.full(there.shape, -1)
    for t, distance in enumerate(table.distances()):
        people, tracks = match_nearest(distance, reach)
        track[t, people] = tracks
    total = kept = 0
    marked = np.zeros(there.shape[1], dtype=np.bool_)
    for a in range(there.shape[1]):
        for first, after in _spans(hidden[:, a], there[:, a]):
            if when[after] - when[first] < least - 1e-9:
                continue
            seen = track[:first, a][~hidden[:first, a]]
            before = seen[-1] if len(seen) else -1
            if before < 0:
                continue
            late = track[after:, a][(when[after:] <= when[after] + BACK) & ~hidden[after:, a]]
            late = late[late >= 0]
            marked[a] = True
            total += 1
            kept += int(len(late) > 0 and late[0] == before)
    return OcclusionCount(total, kept, marked)


def _spans(hidden: NDArray[np.bool_], there: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return the first hidden instant and the next visible one of each occlusion between two visible instants."""
    change = np.flatnonzero(np.diff(np.concatenate([[False], hidden, [False]]).astype(np.int8)))
    pairs = zip(change[::2].tolist(), change[1::2].tolist(), strict=True)
    return [(a, b) for a, b in pairs if a > 0 and b < len(hidden) and there[a - 1] and there[b]]

"""CLEAR MOT: accuracy and precision of tracks."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .track_comparison import TrackComparison, match_nearest


@dataclass(frozen=True)
class ClearMot:
    """Accuracy and precision of tracks.

    Fields:
        mota: 1 - (misses + false tracks + switches) / people, over all instants; can be negative, NaN without people.
        motp: mean distance of the matches [m]; NaN without a match.
        people: number of people over all instants.
        matches, misses, false_tracks: numbers of pairs, of people without a track and of tracks without a person.
        switches: how often a person is matched with another track than the last time.
        fragments: how often a person is tracked again after being lost.
    """

    mota: float
    motp: float
    people: int
    matches: int
    misses: int
    false_tracks: int
    switches: int
    fragments: int


def clear_mot(table: TrackComparison, reach: float = 0.5) -> ClearMot:
    """Return the CLEAR MOT scores.

    A pair of the previous instant is kept while it is within reach; the others are matched with the smallest sum of
    distances. MOTA = 1 - sum(misses + false tracks + switches) / sum(people), MOTP = sum(distances) / matches
    (Bernardin and Stiefelhagen (2008), Evaluating multiple object tracking performance: the CLEAR MOT metrics, doi
    10.1155/2008/246309).

    Args:
        table: people and tracks; hidden people are left out first.
        reach: largest distance of a pair [m].

    >>> table = TrackComparison.of([{0: (0, 0)}] * 4, [{5: (0.1, 0)}, {5: (0.1, 0)}, {}, {6: (0.1, 0)}])
    >>> found = clear_mot(table)
    >>> found.mota, round(found.motp, 3), found.misses, found.switches
    (0.5, 0.1, 1, 1)
    """
    seen = table.visible_only(reach)
    distances = seen.distances()
    T, A, B = distances.shape
    last = np.full(A, -1)
    tracked = np.zeros(A, dtype=np.bool_)
    matches = misses = false_tracks = switches = fragments = people_count = 0
    total = 0.0
    for t in range(T):
        distance = distances[t].copy()
        there = ~np.isnan(seen.truth[t, :, 0])
        held = np.flatnonzero(last >= 0)
        held = held[distance[held, last[held]] <= reach] if B else held[:0]
        _, first = np.unique(last[held], return_index=True)
        held = held[first]
        pairs = [(int(a), int(last[a])) for a in held]
        for a, b in pairs:
            distance[a, :], distance[:, b] = np.nan, np.nan
        pairs += [(int(a), int(b)) for a, b in zip(*match_nearest(distance, reach), strict=True)]
        now = np.zeros(A, dtype=np.bool_)
        for a, b in pairs:
            switches += int(last[a] not in (-1, b))
            fragments += int(last[a] >= 0 and not tracked[a])
            last[a], now[a] = b, True
            total += float(distances[t, a, b])
        tracked = np.where(there, now, tracked)
        matches += len(pairs)
        misses += int(there.sum()) - len(pairs)
        false_tracks += int((~np.isnan(seen.estimate[t, :, 0])).sum()) - len(pairs)
        people_count += int(there.sum())
    mota = 1.0 - (misses + false_tracks + switches) / people_count if people_count else math.nan
    motp = total / matches if matches else math.nan
    return ClearMot(mota, motp, people_count, matches, misses, false_tracks, switches, fragments)

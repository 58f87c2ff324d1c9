"""Scores of tracks: CLEAR MOT, HOTA, IDF1, OSPA, occlusions and latency, and all as one row of a table."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.typing import Floats

from .track_comparison import TrackComparison, match_nearest


def ospa(table: TrackComparison, cutoff: float = 1.0, order: float = 2.0) -> Floats:
    """Return the optimal subpattern assignment distance at each instant, ``[T]`` [m]; 0 without people and tracks.

    With m <= n elements in the two sets: ((min sum over m pairs of min(d, c)^p + c^p (n - m)) / n)^(1/p) (Schuhmacher,
    Vo and Vo (2008), A consistent metric for performance evaluation of multi-object filters, doi
    10.1109/TSP.2008.920469). Identities do not count.

    Args:
        table: people and tracks; hidden people are left out first.
        cutoff: c [m].
        order: p.

    >>> table = TrackComparison.of([{0: (0, 0), 1: (5, 0)}], [{7: (0, 0.6)}])
    >>> ospa(table).round(4).tolist()
    [0.8246]
    """
    from scipy.optimize import linear_sum_assignment

    seen = table.visible_only(cutoff)
    result = np.zeros(len(seen.truth))
    for t, distance in enumerate(_present(seen)):
        small, large = sorted(distance.shape)
        a, b = linear_sum_assignment(np.minimum(distance, cutoff) ** order)
        total = float((np.minimum(distance[a, b], cutoff) ** order).sum()) + cutoff**order * (large - small)
        result[t] = (total / large) ** (1.0 / order) if large else 0.0
    return result


def gospa(table: TrackComparison, cutoff: float = 1.0, order: float = 2.0) -> Floats:
    """Return the generalized OSPA distance at each instant, ``[T]`` [m], for alpha = 2.

    (sum over assigned pairs of d^p + c^p / 2 (misses + false tracks))^(1/p), minimized over assignments of pairs within
    c (Rahmathullah, Garcia-Fernandez and Svensson (2017), Generalized optimal sub-pattern assignment metric, doi
    10.23919/ICIF.2017.8009645). It is not divided by the number of people.

    Args:
        table: people and tracks; hidden people are left out first.
        cutoff: c [m].
        order: p.

    >>> table = TrackComparison.of([{0: (0, 0), 1: (5, 0)}], [{7: (0, 0.6)}])
    >>> gospa(table).round(4).tolist() == [round(math.sqrt(0.36 + 0.5), 4)]
    True
    """
    from scipy.optimize import linear_sum_assignment

    seen = table.visible_only(cutoff)
    result = np.zeros(len(seen.truth))
    for t, distance in enumerate(_present(seen)):
        cost = np.minimum(distance, cutoff) ** order
        a, b = linear_sum_assignment(cost)
        near = distance[a, b] < cutoff
        single = sum(distance.shape) - 2 * int(near.sum())
        result[t] = math.pow(float(cost[a, b][near].sum()) + 0.5 * cutoff**order * single, 1.0 / order)
    return result


def _present(table: TrackComparison) -> list[Floats]:
    """Return the distances between those present, ``[people, tracks]`` for each instant."""
    distances = table.distances()
    people, tracks = (~np.isnan(item[..., 0]) for item in (table.truth, table.estimate))
    return [distance[people[t]][:, tracks[t]] for t, distance in enumerate(distances)]


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


def identity_f1(table: TrackComparison, reach: float = 0.5) -> float:
    """Return IDF1 = 2 IDTP / (people + tracks), both over all instants; NaN without both.

    IDTP is the number of instants at which a person is within reach of the one track that is assigned to the person for
    the whole time; the assignment maximizes it (Ristani et al. (2016), Performance measures and a data set for
    multi-target, multi-camera tracking, doi 10.1007/978-3-319-48881-3_2).

    Args:
        table: people and tracks; hidden people are left out first.
        reach: largest distance of a pair [m].

    >>> table = TrackComparison.of([{0: (0, 0)}] * 4, [{5: (0, 0)}, {5: (0, 0)}, {5: (0, 0)}, {6: (0, 0)}])
    >>> identity_f1(table)
    0.75
    """
    from scipy.optimize import linear_sum_assignment

    seen = table.visible_only(reach)
    together = (seen.distances() <= reach).sum(axis=0)
    people, tracks = linear_sum_assignment(-together)
    right = int(together[people, tracks].sum())
    count = int((~np.isnan(seen.truth[..., 0])).sum() + (~np.isnan(seen.estimate[..., 0])).sum())
    return 2.0 * right / count if count else math.nan


THRESHOLDS = np.arange(0.05, 0.99, 0.05)
"""Thresholds of similarity."""


class Hota(NamedTuple):
    """Means over the thresholds of similarity; NaN without people and tracks."""

    hota: float
    detection: float
    """DetA"""
    association: float
    """AssA"""


def hota(table: TrackComparison, zero: float = 1.0) -> Hota:
    """Return the higher order tracking accuracy.

    At each threshold, DetA = TP / (TP + FN + FP), AssA is the mean over the pairs of TPA / (TPA + FNA + FPA), and
    HOTA = sqrt(DetA AssA); the result is the mean over the thresholds 0.05 to 0.95 (Luiten et al. (2021), HOTA, doi
    10.1007/s11263-020-01375-2). The similarity of a pair is max(0, 1 - distance / ``zero``).

    Args:
        table: people and tracks; hidden people are left out first.
        zero: distance at which the similarity is 0 [m].

    >>> table = TrackComparison.of([{0: (0, 0)}] * 4, [{5: (0, 0)}, {5: (0, 0)}, {6: (0, 0)}, {6: (0, 0)}])
    >>> found = hota(table)
    >>> round(found.detection, 6), round(found.association, 6), round(found.hota, 3)
    (1.0, 0.5, 0.707)
    """
    from scipy.optimize import linear_sum_assignment

    seen = table.visible_only(zero)
    similarity = np.nan_to_num(np.maximum(0.0, 1.0 - seen.distances() / zero))
    people, tracks = (~np.isnan(item[..., 0]) for item in (seen.truth, seen.estimate))
    whole = float(people.sum() + tracks.sum())
    if whole == 0.0:
        return Hota(math.nan, math.nan, math.nan)
    alignment = _alignment(similarity, people, tracks)
    pairs = np.zeros((len(THRESHOLDS), *similarity.shape[1:]))
    for t in range(len(similarity)):
        a, b = linear_sum_assignment(-alignment * similarity[t])
        for k, threshold in enumerate(THRESHOLDS):
            good = (similarity[t, a, b] >= threshold - np.finfo(float).eps) & people[t, a] & tracks[t, b]
            pairs[k, a[good], b[good]] += 1.0
    count = pairs.sum(axis=(1, 2))
    detection = count / (whole - count)
    union = people.sum(axis=0)[:, None] + tracks.sum(axis=0)[None, :] - pairs
    association = (pairs * pairs / np.maximum(1.0, union)).sum(axis=(1, 2)) / np.maximum(1.0, count)
    return Hota(float(np.sqrt(detection * association).mean()), float(detection.mean()), float(association.mean()))


def _alignment(similarity: Floats, people: NDArray[np.bool_], tracks: NDArray[np.bool_]) -> Floats:
    """Return the global alignment score ``[A, B]``, by which pairs of the same identities are preferred."""
    total = similarity.sum(axis=1, keepdims=True) + similarity.sum(axis=2, keepdims=True) - similarity
    share = np.divide(similarity, total, out=np.zeros_like(similarity), where=total > np.finfo(float).eps)
    possible = share.sum(axis=0)
    union = people.sum(axis=0)[:, None] + tracks.sum(axis=0)[None, :] - possible
    return np.asarray(possible / np.maximum(union, 1e-12))


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


TRACKING_SCORES = {
    "mota": "",
    "motp": "m",
    "idf1": "",
    "hota": "",
    "ospa": "m",
    "gospa": "m",
    "switches": "",
    "misses": "",
    "false_tracks": "",
    "latency": "s",
    "kept_through_occlusion": "",
}
"""Names of the scores and their units. Misses and false tracks are shares of the people over all instants; switches are
numbers by 100 instants of people; latency is the median of people; the last one is the share of occlusions of at least
0.3 s after which a person has the same track."""


def tracking_scores(
    table: TrackComparison, times: ArrayLike, reach: float = 0.5, cutoff: float = 1.0
) -> dict[str, float]:
    """Return the scores of tracks by name, see :data:`TRACKING_SCORES`.

    Args:
        table: people and tracks.
        times: ``[T]`` [s].
        reach: largest distance of a person and a track in MOTA, MOTP, IDF1 and latency [m].
        cutoff: distance at which HOTA, OSPA and GOSPA see no similarity [m].

    >>> table = TrackComparison.of([{0: (0, 0)}] * 2, [{5: (0.1, 0)}] * 2)
    >>> scores = tracking_scores(table, [0.0, 0.1])
    >>> scores["mota"], round(scores["ospa"], 3), list(scores) == list(TRACKING_SCORES)
    (1.0, 0.1, True)
    """
    clear = clear_mot(table, reach)
    late = track_latency(table, times, reach)
    late = late[~np.isnan(late)]
    count = max(1, clear.people)
    occlusions = count_occlusions(table, times, reach)
    return {
        "mota": clear.mota,
        "motp": clear.motp,
        "idf1": identity_f1(table, reach),
        "hota": hota(table, cutoff).hota,
        "ospa": float(ospa(table, cutoff).mean()) if len(table.truth) else float("nan"),
        "gospa": float(gospa(table, cutoff).mean()) if len(table.truth) else float("nan"),
        "switches": 100.0 * clear.switches / count,
        "misses": clear.misses / count,
        "false_tracks": clear.false_tracks / count,
        "latency": float(np.median(late)) if len(late) else float("nan"),
        "kept_through_occlusion": occlusions.kept / occlusions.total if occlusions.total else float("nan"),
    }

"""OSPA and GOSPA: distances between the set of people and the set of tracks at each instant."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.typing import Floats

from .track_comparison import TrackComparison


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

"""HOTA: detection and association of tracks in one score."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.typing import Floats

from .track_comparison import TrackComparison

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

"""IDF1: how long people keep one identity."""

from __future__ import annotations

import math

import numpy as np

from .track_comparison import TrackComparison


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

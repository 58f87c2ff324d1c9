"""Correction of p-values for several tests."""

from __future__ import annotations

import math
from collections.abc import Sequence


def correct_p_values(p_values: Sequence[float]) -> list[float]:
    """Return p-values after the correction of Holm; NaN values stay and do not count.

    Holm 1979, A simple sequentially rejective multiple test procedure, https://www.jstor.org/stable/4615733.

    >>> correct_p_values([0.01, 0.04, 0.03])
    [0.03, 0.06, 0.06]
    """
    order = sorted((k for k, value in enumerate(p_values) if not math.isnan(value)), key=lambda k: p_values[k])
    corrected, highest = list(map(float, p_values)), 0.0
    for rank, k in enumerate(order):
        highest = max(highest, min(1.0, p_values[k] * (len(order) - rank)))
        corrected[k] = highest
    return corrected

"""Paired comparisons of two methods on the same trials and seeds."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crowdbot.core import stream
from crowdbot.typing import Floats

from .intervals import Estimate, bootstrap_estimate

PERMUTATIONS = 10_000
EXACT = 12
"""Largest number of pairs of which all sign flips are tried."""


class PairedComparison(NamedTuple):
    """The difference of two methods in one metric, from runs with the same trial and seed.

    Fields:
        trial, robot, metric: what is compared.
        first, second: names of the methods.
        difference: mean of second minus first, with its bootstrap interval.
        p_value: of the hypothesis that there is no difference.
        corrected: the p-value after the correction of Holm for all comparisons of an evaluation; NaN before it.
    """

    trial: str
    robot: str
    metric: str
    first: str
    second: str
    difference: Estimate
    p_value: float
    corrected: float = math.nan


def paired_comparison(first: Floats, second: Floats, seed: int = 0) -> tuple[Estimate, float]:
    """Return the mean difference of paired values and its p-value.

    Binary values are compared by the exact test of McNemar, others by a permutation of signs. Pairs with a value that
    is not finite are left out; the p-value is NaN without pairs.

    McNemar 1947, https://doi.org/10.1007/BF02295996; Good 2005, Permutation, Parametric and Bootstrap Tests of
    Hypotheses, https://doi.org/10.1007/b138696.

    Args:
        first, second: ``[N]`` values of two methods for the same N runs.
        seed: seed of the permutations.

    >>> difference, p_value = paired_comparison(np.zeros(10), np.ones(10))
    >>> difference.value, round(p_value, 4)
    (1.0, 0.002)
    """
    both = np.isfinite(first) & np.isfinite(second)
    gap = np.asarray(second[both] - first[both], dtype=np.float64)
    estimate = bootstrap_estimate(gap, seed=seed)
    if not len(gap):
        return estimate, math.nan
    if np.isin(np.concatenate([first[both], second[both]]), (0.0, 1.0)).all():
        from scipy import stats  # takes longer to import than the app to start

        more, less = int(np.sum(gap > 0)), int(np.sum(gap < 0))
        return estimate, 1.0 if more + less == 0 else float(stats.binomtest(more, more + less).pvalue)
    return estimate, _sign_flips(gap, seed)


def _sign_flips(gap: Floats, seed: int) -> float:
    """Return the share of sign flips whose mean is at least as far from 0."""
    wanted = abs(float(np.sum(gap)))
    if len(gap) <= EXACT:
        bits = np.arange(2 ** len(gap))[:, None] >> np.arange(len(gap)) & 1
        sums = np.abs((1 - 2 * bits) @ gap)
        return float(np.mean(sums >= wanted * (1 - 1e-12)))
    rng = stream(seed, "sign flips", len(gap))
    signs = 1 - 2 * rng.integers(0, 2, (PERMUTATIONS, len(gap)), dtype=np.int8)
    above = int(np.sum(np.abs(signs @ gap) >= wanted * (1 - 1e-12)))
    return (above + 1) / (PERMUTATIONS + 1)

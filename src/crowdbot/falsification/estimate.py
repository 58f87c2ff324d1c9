"""Estimates of a failure probability with 95 % intervals."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy import special, stats

from crowdbot.evaluation import Estimate

__all__ = ["importance_estimate", "replicate_estimate"]

Floats = NDArray[np.float64]
FEW = 5
"""Least number of failures for an interval from their weights."""


def importance_estimate(
    fails: NDArray[np.bool_], weights: Floats, largest: float, confidence: float = 0.95
) -> Estimate:
    """Return the failure probability of importance sampling, with the interval of the weighted mean.

    The probability is the mean of the weights of failures. Its interval is symmetric on the logarithm (delta method),
    which keeps it above 0. With fewer than 5 failures, the interval is that of a binomial proportion (Clopper-Pearson)
    whose upper end is scaled by the largest possible weight, which is conservative.

    Args:
        fails: ``[N]`` which runs fail.
        weights: ``[N]`` standard normal density over the proposal.
        largest: bound of the weights.
        confidence: level of the interval.

    >>> importance_estimate(np.arange(1000) < 10, np.full(1000, 0.1), 1.0).value
    0.001
    """
    count, hits = len(fails), int(np.sum(fails))
    values = np.where(fails, weights, 0.0)
    mean = float(values.mean())
    if hits < FEW:
        tail = 0.5 - confidence / 2.0
        high = min(1.0, largest * float(stats.beta.ppf(1.0 - tail, hits + 1, count - hits)))
        low = 0.0 if hits == 0 else float(stats.beta.ppf(tail, hits, count - hits + 1)) * float(weights[fails].min())
        return Estimate(mean, min(low, mean), max(high, mean), count)
    error = float(values.std(ddof=1)) / math.sqrt(count)
    factor = math.exp(float(special.ndtri(0.5 + confidence / 2.0)) * error / mean)
    return Estimate(mean, mean / factor, min(1.0, mean * factor), count)


def replicate_estimate(values: Floats, runs: int, confidence: float = 0.95) -> Estimate:
    """Return the mean of independent estimates, with Student's interval.

    Args:
        values: ``[R]`` independent estimates, R at least 2.
        runs: total number of runs.
        confidence: level of the interval.

    >>> print(replicate_estimate(np.array([0.01, 0.012, 0.011]), 3000))
    0.011 [0.00852, 0.0135]
    """
    mean = float(values.mean())
    half = float(stats.t.ppf(0.5 + confidence / 2.0, len(values) - 1) * stats.sem(values))
    return Estimate(mean, max(0.0, mean - half), min(1.0, mean + half), runs)

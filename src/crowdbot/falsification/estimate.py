"""Estimates of a failure probability with 95 % intervals."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy import special

from crowdbot.core import stream
from crowdbot.evaluation import Estimate
from crowdbot.metrics import corrected_interval
from crowdbot.typing import Floats

FEW = 5
"""Least number of failures for a bootstrap."""
REPLICATES = 4000
"""Replicates of the bootstrap."""


def mixture_estimate(
    fails: NDArray[np.bool_],
    weights: Floats,
    groups: NDArray[np.int64],
    largest: float,
    confidence: float = 0.95,
) -> Estimate:
    """Return the failure probability from the runs of several proposals, each weighted by the mixture of all.

    The probability is the sum of the weights of failures over the number of runs. With 5 failures and more, its
    interval holds those of two methods: the bootstrap of runs within their proposals (bias-corrected and accelerated),
    and the gamma interval of weighted Poisson counts, which assumes one more failure with the largest weight seen. With
    fewer failures, the gamma interval assumes one with the largest possible weight; without a failure its lower end is
    0, and its upper end is the rule of three: 3 of the smallest expected number of runs that see a failure. If all
    runs fail, the same rule holds for the probability of a run without a failure.

    Args:
        fails: ``[N]`` which runs fail.
        weights: ``[N]`` standard normal density over the mixture of the proposals.
        groups: ``[N]`` index of the proposal of each run.
        largest: bound of the weights.
        confidence: level of the interval.

    Source: weights: Veach & Guibas 1995, doi:10.1145/218380.218498; Owen & Zhou 2000,
    doi:10.1080/01621459.2000.10473909; gamma interval: Fay & Feuer 1997,
    doi:10.1002/(SICI)1097-0258(19970415)16:7<791::AID-SIM500>3.0.CO;2-#; bootstrap: Efron 1987,
    doi:10.1080/01621459.1987.10478410; no failure: Hanley & Lippman-Hand 1983, doi:10.1001/jama.1983.03330370053031.

    >>> mixture_estimate(np.arange(1000) < 10, np.full(1000, 0.1), np.zeros(1000, dtype=int), 1.0).value
    0.001
    >>> print(mixture_estimate(np.zeros(1000, dtype=bool), np.ones(1000), np.zeros(1000, dtype=int), 1.0))
    0 [0, 0.003]
    >>> print(mixture_estimate(np.ones(1000, dtype=bool), np.full(1000, 0.4), np.zeros(1000, dtype=int), 1.0))
    1 [0.997, 1]
    """
    count, hits = len(fails), int(np.sum(fails))
    if hits == 0:
        return Estimate(0.0, 0.0, min(1.0, -math.log(1.0 - confidence) * largest / count), count)
    if hits == count:  # the same for the runs without a failure, of which there is none
        return Estimate(1.0, max(0.0, 1.0 + math.log(1.0 - confidence) * largest / count), 1.0, count)
    values = weights[fails] / count
    mean = float(values.sum())
    low, high = _gamma_interval(values, float(values.max()) if hits >= FEW else largest / count, confidence)
    if hits >= FEW:
        least, most = _stratified_interval(values, groups[fails], np.bincount(groups), confidence)
        low, high = min(low, least), max(high, most)
    return Estimate(mean, min(low, mean), min(1.0, max(high, mean)), count)


def _gamma_interval(values: Floats, extra: float, confidence: float) -> tuple[float, float]:
    """Return the interval of a sum of weighted Poisson counts; ``extra`` is the weight of a count not seen."""
    mean, square = float(values.sum()), float(np.sum(values**2))
    tail = 0.5 - confidence / 2.0
    low = square / mean * special.gammaincinv(mean**2 / square, tail)
    mean, square = mean + extra, square + extra**2
    return float(low), float(square / mean * special.gammaincinv(mean**2 / square, 1.0 - tail))


def _stratified_interval(
    values: Floats, groups: NDArray[np.int64], sizes: NDArray[np.int64], confidence: float
) -> tuple[float, float]:
    """Return the bootstrap interval of the sum of values of failures ``[F]`` in groups of runs of given sizes."""
    rng = stream(0, "bootstrap")
    mean, sums = float(values.sum()), np.zeros(REPLICATES)
    cube = square = 0.0
    for group in np.unique(groups):
        own, size = values[groups == group], int(sizes[group])
        shares = np.append(np.full(len(own), 1.0 / size), max(0.0, 1.0 - len(own) / size))
        sums += rng.multinomial(size, shares, size=REPLICATES)[:, :-1] @ own
        away = np.append(own, 0.0) - own.sum() / size
        times = np.append(np.ones(len(own)), size - len(own))
        cube, square = cube + float(times @ away**3), square + float(times @ away**2)
    slope = cube / (6.0 * square**1.5) if square > 0.0 else 0.0
    return corrected_interval(sums, mean, confidence, slope)


def replicate_estimate(values: Floats, runs: int, confidence: float = 0.95) -> Estimate:
    """Return the mean of independent estimates, with Student's interval.

    Args:
        values: ``[R]`` independent estimates, R at least 2.
        runs: total number of runs.
        confidence: level of the interval.

    >>> print(replicate_estimate(np.array([0.01, 0.012, 0.011]), 3000))
    0.011 [0.00852, 0.0135]
    """
    from scipy import stats  # takes longer to import than the rest

    mean = float(values.mean())
    half = float(stats.t.ppf(0.5 + confidence / 2.0, len(values) - 1) * stats.sem(values))
    return Estimate(mean, max(0.0, mean - half), min(1.0, mean + half), runs)

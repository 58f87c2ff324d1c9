"""Confidence intervals: exact and Wilson for proportions, bootstrap for means and quantiles."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np

from crowdbot.core import InputError, stream
from crowdbot.metrics import corrected_interval
from crowdbot.typing import Floats

RESAMPLES = 2000


class Estimate(NamedTuple):
    """A value with its confidence interval, and the number of runs that it comes from.

    >>> print(Estimate(0.5, 0.31, 0.69, 24))
    0.5 [0.31, 0.69]
    """

    value: float
    low: float
    high: float
    runs: int

    def __str__(self) -> str:
        """Return the value and the interval, if there is one."""
        if math.isnan(self.value):
            return "-"
        if math.isnan(self.low):
            return f"{self.value:.3g}"
        return f"{self.value:.3g} [{self.low:.3g}, {self.high:.3g}]"


def proportion_interval(
    successes: int, count: int, confidence: float = 0.95, method: Literal["exact", "wilson"] = "exact"
) -> Estimate:
    """Return a proportion with its binomial confidence interval, by SciPy.

    ``exact`` is the interval of Clopper and Pearson, which covers the true proportion at least as often as its level
    (1934, https://doi.org/10.1093/biomet/26.4.404); ``wilson`` is the shorter score interval of Wilson, which covers it
    about as often (1927, https://doi.org/10.1080/01621459.1927.10502953).

    Args:
        successes: number of successes, 0 to ``count``.
        count: number of runs; 0 gives NaN.
        confidence: level, between 0 and 1.
        method: ``exact`` or ``wilson``.

    Raises:
        InputError: a number is out of range.

    >>> [round(value, 4) for value in proportion_interval(0, 100)[:3]]
    [0.0, 0.0, 0.0362]
    >>> [round(value, 4) for value in proportion_interval(8, 10, method="wilson")[:3]]
    [0.8, 0.4902, 0.9433]
    """
    _check(confidence)
    if not 0 <= successes <= count:
        raise InputError(f"successes = {successes} must be from 0 to the number of runs, {count}")
    if count == 0:
        return Estimate(math.nan, math.nan, math.nan, 0)
    from scipy import stats  # takes longer to import than the app to start

    low, high = stats.binomtest(successes, count).proportion_ci(confidence, method=method)
    return Estimate(successes / count, float(low), float(high), count)


def bootstrap_estimate(
    values: Floats,
    statistic: Callable[[Floats], Floats] | None = None,
    confidence: float = 0.95,
    seed: int = 0,
    infinite: bool = False,
) -> Estimate:
    """Return a statistic with its bias-corrected bootstrap interval.

    Values that are not finite are left out, unless infinite ones count. The interval is that of
    :func:`crowdbot.metrics.corrected_interval`, without the acceleration.

    Args:
        values: ``[N]`` one value for each run.
        statistic: function of ``[R, N]`` that returns ``[R]`` (default: the mean).
        confidence: level, between 0 and 1.
        seed: seed of the resamples.
        infinite: whether infinite values count.

    Raises:
        InputError: the level is out of range.

    >>> estimate = bootstrap_estimate(np.arange(100.0))
    >>> estimate.value, 40 < estimate.low < 49.5 < estimate.high < 60
    (49.5, True)
    """
    _check(confidence)
    kept = np.asarray(values, dtype=np.float64)
    kept = kept[~np.isnan(kept) if infinite else np.isfinite(kept)]
    if not len(kept):
        return Estimate(math.nan, math.nan, math.nan, 0)
    find = statistic or _mean
    value = float(find(kept[None])[0])
    if len(kept) == 1 or np.all(kept == kept[0]):
        spread = 0.0 if len(kept) > 1 else math.nan
        return Estimate(value, value - spread, value + spread, len(kept))
    rng = stream(seed, "bootstrap", len(kept))
    samples = find(kept[rng.integers(0, len(kept), (RESAMPLES, len(kept)))])
    return Estimate(value, *corrected_interval(samples, value, confidence), len(kept))


def _mean(rows: Floats) -> Floats:
    return np.asarray(np.mean(rows, axis=1))


def _check(confidence: float) -> None:
    if not 0.0 < confidence < 1.0:
        raise InputError(f"confidence = {confidence} must be between 0 and 1")

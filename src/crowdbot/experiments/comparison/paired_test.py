"""Paired comparison of two conditions within participants: tests, effect size and equivalence."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError


class PairedTest(NamedTuple):
    """The difference of two conditions, second minus first, within participants.

    Fields:
        participants: number of participants with both conditions.
        difference: mean difference.
        low, high: 95 % confidence interval of the difference.
        p_value: of the paired t-test, or of the sign test for shares; two-sided.
        effect: Cohen's d_z, the mean in relation to the standard deviation of the differences.
        bound: largest difference that counts as equivalent.
        equivalence: p-value of the two one-sided tests; below 0.05 the conditions are equivalent within the bound.
    """

    participants: int
    difference: float
    low: float
    high: float
    p_value: float
    effect: float
    bound: float
    equivalence: float

    @property
    def equivalent(self) -> bool:
        """Whether the difference is smaller than the bound, at a level of 5 %."""
        return self.equivalence < 0.05


def paired_test(first: ArrayLike, second: ArrayLike, bound: float, *, binary: bool = False) -> PairedTest:
    """Compare two conditions of the same participants.

    Pairs with a value that is not finite are left out. With fewer than 3 pairs, or no spread of the differences, only
    the mean is known. Shares of binary outcomes get the exact sign test over the participants who differ, which is the
    exact test of McNemar for one trial in each condition; the normal approximation of the interval and of the
    equivalence needs many participants.

    Source: Lakens (2013), Calculating and reporting effect sizes, doi 10.3389/fpsyg.2013.00863; Schuirmann (1987), A
    comparison of the two one-sided tests procedure, doi 10.1007/BF01068419; McNemar (1947), doi 10.1007/BF02295996.

    Args:
        first, second: ``[N]`` values of N participants.
        bound: largest difference that counts as equivalent, above 0.
        binary: whether the values are shares of binary outcomes.

    Raises:
        InputError: the shapes differ, or the bound is not above 0.

    >>> test = paired_test([1.0, 1.2, 0.9, 1.1, 1.0], [1.1, 1.25, 1.05, 1.1, 1.1], bound=0.3)
    >>> test.participants, round(test.difference, 3), round(test.effect, 2), test.equivalent
    (5, 0.08, 1.4, True)
    """
    one, other = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    if one.ndim != 1 or one.shape != other.shape:
        raise InputError(f"the values have the shapes {one.shape} and {other.shape}; both must be [N]")
    if not bound > 0.0:
        raise InputError(f"bound = {bound} must be above 0")
    gap = (other - one)[np.isfinite(one) & np.isfinite(other)]
    count, mean = len(gap), float(gap.mean()) if len(gap) else math.nan
    spread = float(gap.std(ddof=1)) if count > 2 else 0.0
    if spread == 0.0:
        return PairedTest(count, mean, math.nan, math.nan, math.nan, math.nan, bound, math.nan)
    from scipy import stats  # takes longer to import than the app to start

    error, law = spread / math.sqrt(count), stats.t(count - 1)
    half = float(law.ppf(0.975)) * error
    p_value = _sign_test(gap) if binary else 2.0 * float(law.sf(abs(mean) / error))
    equivalence = max(float(law.sf((mean + bound) / error)), float(law.sf((bound - mean) / error)))
    return PairedTest(count, mean, mean - half, mean + half, p_value, mean / spread, bound, equivalence)


def _sign_test(gap: NDArray[np.float64]) -> float:
    """Return the two-sided p-value of the exact sign test; pairs without a difference do not count."""
    from scipy import stats

    up, down = int((gap > 0.0).sum()), int((gap < 0.0).sum())
    return float(stats.binomtest(up, up + down, 0.5).pvalue) if up + down else 1.0

"""Fundamental diagrams: speed and flow over density, with spreads and confidence intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import InputError
from crowdbot.metrics import bootstrap_interval
from crowdbot.typing import Floats

from .rows import table

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class StartsMean:
    """Mean of a measurement over independent starts with its interval.

    Fields:
        mean, deviation: mean and sample standard deviation over the starts; the deviation of one start is NaN.
        low, high: 95 % confidence interval of the mean; NaN for one start.
        starts: number of starts.
    """

    mean: float
    deviation: float
    low: float
    high: float
    starts: int


def compute_fundamental_diagram(
    density: ArrayLike, speed: ArrayLike, width: float, person: ArrayLike | None = None, least: int = 20
) -> pd.DataFrame:
    """Return means of speed and specific flow in bins of density.

    The specific flow of a value is ``density * speed`` [1/(m s)].

    Args:
        density: ``[N]`` [1/m2], or [1/m] for a single file.
        speed: ``[N]`` [m/s]; pairs with NaN are ignored.
        width: width of the bins, in units of density.
        person: ``[N]`` identity (or start) by which values are correlated; with it, the columns low and high give the
            95 % interval of the mean speed by the bootstrap over people.
        least: minimum number of values of a bin.

    Returns:
        Columns density (middle of the bin), speed, spread (standard deviation), flow, count, and low, high.

    Raises:
        InputError: the arrays differ in length, or the width is not above 0.

    >>> compute_fundamental_diagram([0.9, 1.0, 1.1, 3.0], [1.0, 1.2, 0.9, 0.5], 1.0, least=1).speed.round(2).tolist()
    [1.0, 1.05, 0.5]
    """
    rho, v = np.asarray(density, dtype=np.float64), np.asarray(speed, dtype=np.float64)
    who = None if person is None else np.asarray(person)
    if rho.shape != v.shape or rho.ndim != 1 or (who is not None and who.shape != rho.shape):
        raise InputError("density, speed and person of a fundamental diagram must be columns of equal length")
    if not width > 0.0:
        raise InputError(f"the bins of a fundamental diagram must be wider than {width}")
    known = ~(np.isnan(rho) | np.isnan(v))
    rho, v, who = rho[known], v[known], None if who is None else who[known]
    number = np.floor(rho / width).astype(np.int64)
    kept = [n for n in np.unique(number) if np.sum(number == n) >= least]
    found = {
        "density": [float((n + 0.5) * width) for n in kept],
        "speed": [float(v[number == n].mean()) for n in kept],
        "spread": [float(v[number == n].std()) for n in kept],
        "flow": [float((rho * v)[number == n].mean()) for n in kept],
        "count": [int(np.sum(number == n)) for n in kept],
    }
    if who is not None:
        ends = [bootstrap_interval(v[number == n], who[number == n]) for n in kept]
        found |= {"low": [low for low, _ in ends], "high": [high for _, high in ends]}
    return table(**found)


def mean_over_starts(values: Sequence[float] | Floats, resamples: int = 1000, seed: int = 0) -> StartsMean:
    """Return the mean of one value a start with its 95 % bootstrap interval; NaN values are refused.

    Raises:
        InputError: there are no values, or one is not finite.

    >>> mean_over_starts([1.0, 1.2, 1.1, 0.9]).mean
    1.05
    """
    found = np.asarray(values, dtype=np.float64)
    if found.ndim != 1 or len(found) == 0 or not np.all(np.isfinite(found)):
        raise InputError("a mean over starts needs one finite value for each start")
    low, high = bootstrap_interval(found, np.arange(len(found)), resamples=resamples, seed=seed)
    deviation = float(found.std(ddof=1)) if len(found) > 1 else float("nan")
    return StartsMean(float(found.mean()), deviation, low, high, len(found))

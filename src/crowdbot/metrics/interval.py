"""The bootstrap: draws of people or runs, intervals of drawn values, and means over people by the cluster bootstrap.

Windows of a person overlap, and their errors are strongly correlated; resampling windows would give intervals that are
several times too narrow. Therefore, people are resampled with all their windows (cluster bootstrap, Davison, Hinkley
(1997), Bootstrap Methods and their Application, section 3.8, doi 10.1017/CBO9780511802843). Correlations between people
who walk together are not included; in dense crowds the intervals are rather too narrow.

``scipy.stats.bootstrap`` is not used: it computes the statistic on copies of all values, which takes 13 to 78 times as
long for the means of 30 to 3000 people as sums weighted by how often each is drawn, and it has no intervals of values
that can be infinite, or of sums of weighted runs.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from crowdbot.core import InputError, stream
from crowdbot.typing import Floats, Ints

Interval = tuple[float, float]

RESAMPLES = 1000
LEVEL = 0.95
UNKNOWN: Interval = (math.nan, math.nan)
DRAWS_AT_ONCE = 2_000_000
"""Number of people drawn at once, which limits memory."""


def draw_counts(rng: np.random.Generator, units: int, resamples: int) -> Floats:
    """Return how often each of N people, runs or pieces is drawn ``[R, N]``; a resample draws N with replacement.

    Args:
        rng: generator of the draws.
        units: number N of people, runs or pieces.
        resamples: number R of resamples.

    >>> draw_counts(np.random.default_rng(1), 4, 2).sum(axis=1).tolist()
    [4.0, 4.0]
    """
    drawn = rng.integers(0, units, (resamples, units)) + units * np.arange(resamples)[:, None]
    times = np.bincount(drawn.ravel(), minlength=resamples * units)
    return times.reshape(resamples, units).astype(np.float64)


def percentile_interval(samples: Floats, level: float = LEVEL) -> tuple[Floats, Floats]:
    """Return the ends of the central part of resampled values ``[R, ...]``, over the first axis.

    >>> low, high = percentile_interval(np.arange(101.0), 0.9)
    >>> round(float(low), 6), round(float(high), 6)
    (5.0, 95.0)
    """
    low, high = np.quantile(samples, (0.5 - 0.5 * level, 0.5 + 0.5 * level), axis=0)
    return low, high


def corrected_interval(samples: Floats, value: float, level: float = LEVEL, acceleration: float = 0.0) -> Interval:
    """Return the bias-corrected interval of resampled values ``[R]``, accelerated if an acceleration is given.

    Where a resampled value is infinite, an end is one of the resampled values, without interpolation. Efron 1987,
    Better bootstrap confidence intervals, https://doi.org/10.1080/01621459.1987.10478410.

    Args:
        samples: ``[R]`` the statistic of each resample.
        value: the statistic of all values.
        level: confidence level.
        acceleration: a of the paper; 0 gives the bias-corrected interval.

    >>> [round(end, 6) for end in corrected_interval(np.arange(101.0), 50.0, 0.9)]
    [5.0, 95.0]
    """
    from scipy import special  # takes longer to import than the rest of the room

    R = len(samples)
    below = (np.sum(samples < value) + 0.5 * np.sum(samples == value)) / R
    shift = float(special.ndtri(np.clip(below, 1.0 / R, 1.0 - 1.0 / R)))
    z = shift + special.ndtri(np.array([0.5 - level / 2.0, 0.5 + level / 2.0]))
    edges = special.ndtr(shift + z / (1.0 - acceleration * z))
    if np.isfinite(samples).all():
        low, high = np.quantile(samples, edges)
    else:
        low, high = np.quantile(samples, edges[0], method="lower"), np.quantile(samples, edges[1], method="higher")
    return float(low), float(high)


@dataclass(frozen=True)
class Intervals:
    """Confidence intervals (low, high) of the means of a score, 95 % by the bootstrap over people; NaN when unknown."""

    ade: Interval = UNKNOWN
    fde: Interval = UNKNOWN
    miss_rate: Interval = UNKNOWN
    collisions: Interval = UNKNOWN
    true_collisions: Interval = UNKNOWN
    swept_collisions: Interval = UNKNOWN
    swept_contacts: Interval = UNKNOWN
    nll: Interval = UNKNOWN
    energy: Interval = UNKNOWN


NAMES = tuple(field.name for field in fields(Intervals))


@dataclass(frozen=True)
class PersonValues:
    """Sums over the windows of each of M people, for means and their intervals.

    Fields:
        id: ``[M]`` identity in the recording; people of several recordings are concatenated.
        total, count: ``[M, 9]`` sum and number of the known values, columns as in :class:`Intervals`.
    """

    id: Ints
    total: Floats
    count: Floats

    @classmethod
    def of(cls, id: Ints, values: Sequence[Floats]) -> PersonValues:
        """Add up values ``[N]`` by person ``[N]``; NaN is ignored."""
        known, row = np.unique(id, return_inverse=True)
        there = [~np.isnan(value) for value in values]
        total = [
            np.bincount(row[has], value[has], minlength=len(known)) for value, has in zip(values, there, strict=True)
        ]
        count = [np.bincount(row[has], minlength=len(known)).astype(np.float64) for has in there]
        return cls(known, np.stack(total, axis=1), np.stack(count, axis=1))

    @classmethod
    def concatenate(cls, parts: Sequence[PersonValues]) -> PersonValues:
        """Return the people of several recordings together; recordings share no people."""
        arrays = ([getattr(part, name) for part in parts] for name in ("id", "total", "count"))
        return cls(*map(np.concatenate, arrays))

    def intervals(self) -> Intervals:
        """Return the intervals of all means."""
        return Intervals(*_percentiles(_resample(self.total, self.count, RESAMPLES, 0), self.count, LEVEL))

    def minus(self, other: PersonValues, name: str) -> tuple[float, Interval]:
        """Return the difference of a mean to that of another predictor on the same people, and its interval.

        The same people are drawn for both (paired comparison).

        Raises:
            InputError: the name is unknown, or the people differ.
        """
        if name not in NAMES:
            raise InputError(f"there is no mean of {name!r}, there are {', '.join(NAMES)}")
        column = NAMES.index(name)
        if not (np.array_equal(self.id, other.id) and np.array_equal(self.count[:, column], other.count[:, column])):
            raise InputError(f"scores of {name} of different people cannot be compared person by person")
        total = np.stack([self.total[:, column], other.total[:, column]], axis=1)
        count = np.stack([self.count[:, column]] * 2, axis=1)
        whole = _ratio(total.sum(axis=0), count.sum(axis=0))
        drawn = _resample(total, count, RESAMPLES, 0)
        return float(whole[0] - whole[1]), _percentiles(drawn[:, :1] - drawn[:, 1:], count[:, :1], LEVEL)[0]


def bootstrap_interval(
    values: Floats, person: Ints, resamples: int = RESAMPLES, level: float = LEVEL, seed: int = 0
) -> Interval:
    """Return the percentile interval (low, high) of a mean over windows, drawn by person.

    Args:
        values: values ``[N]``, one per person and window; NaN is ignored.
        person: person of each value ``[N]``. All values of a person are drawn together.
        resamples: number of bootstrap samples; each draws all people with replacement.
        level: confidence level.
        seed: seed of the draws.

    The result is (NaN, NaN) for fewer than two people.

    Raises:
        InputError: resamples are below 1, or the level is not between 0 and 1.

    >>> import numpy as np
    >>> rng = np.random.default_rng(1)
    >>> own = rng.normal(size=50)  # 50 people with equal errors in 20 windows
    >>> person = np.repeat(np.arange(50), 20)
    >>> by_person = bootstrap_interval(own[person], person)
    >>> by_window = bootstrap_interval(own[person], np.arange(1000))
    >>> [round(high - low, 1) for low, high in (by_person, by_window)]
    [0.5, 0.1]
    """
    if resamples < 1 or not 0.0 < level < 1.0:
        raise InputError(f"an interval needs at least 1 resample and a level in 0..1, not {resamples} and {level}")
    people = PersonValues.of(person, [values])
    return _percentiles(_resample(people.total, people.count, resamples, seed), people.count, level)[0]


def _resample(total: Floats, count: Floats, resamples: int, seed: int) -> Floats:
    """Return the means ``[R, C]`` of R resamples of people with sums ``[M, C]``; NaN where no value was drawn."""
    M = len(total)
    rng = stream(seed, "bootstrap")
    both = np.concatenate([total, count], axis=1)
    means = np.full((resamples, total.shape[1]), np.nan)
    size = max(1, DRAWS_AT_ONCE // max(M, 1))
    for first in range(0, resamples if M > 1 else 0, size):
        few = min(size, resamples - first)
        # not a matrix product: its last bits depend on the number of threads
        sums = np.einsum("rm,mc->rc", draw_counts(rng, M, few), both)
        means[first : first + few] = _ratio(*np.split(sums, 2, axis=1))
    return means


def _ratio(total: Floats, count: Floats) -> Floats:
    return np.where(count > 0.0, total / np.maximum(count, 1.0), np.nan)


def _percentiles(means: Floats, count: Floats, level: float) -> list[Interval]:
    """Return the interval of each column; NaN for fewer than two people with values."""
    intervals = [UNKNOWN] * means.shape[1]
    for column in np.flatnonzero(np.sum(count > 0.0, axis=0) > 1):
        known = means[:, column][~np.isnan(means[:, column])]
        if len(known) > 0:
            low, high = percentile_interval(known, level)
            intervals[column] = float(low), float(high)
    return intervals

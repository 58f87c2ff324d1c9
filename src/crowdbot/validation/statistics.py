"""Statistics of the checks: steady states of simulations and intervals over starts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import stream
from crowdbot.measurement import detect_steady_state, mean_over_starts
from crowdbot.typing import Floats

STARTS = 20
"""Independent starts of each point."""
MEMORY = 20
"""Largest value of the CUSUM statistic: 20 stored steps of 0.2 s."""
REFERENCE = 1.0 / 3.0
"""Share of a run at its end that is the reference of the steady state."""
DRIFT = 0.1
"""Largest relative difference between the means of the two halves of the reference."""


class SteadyWindow(NamedTuple):
    """Part of a run that is measured.

    Fields:
        begin, end: times [s].
        steady: whether the steady state was found; otherwise the window is the reference at the end of the run.
    """

    begin: float
    end: float
    steady: bool


def find_steady_window(times: ArrayLike, values: ArrayLike) -> SteadyWindow:
    """Return the steady window at the end of a time series by the modified CUSUM method.

    The reference is the last third of the run. A series whose reference is constant is steady from the first of these
    values on; one whose reference drifts by more than 10 % is not steady.

    Args:
        times: ``[N]`` equidistant times [s].
        values: ``[N]`` values, such as the mean speed of all starts.

    >>> times = np.arange(300) * 0.2
    >>> speed = 1.0 - np.exp(-times / 3.0) + 0.01 * np.random.default_rng(0).normal(size=300)
    >>> window = find_steady_window(times, speed)
    >>> window.steady, 5.0 < window.begin < 20.0
    (True, True)
    """
    t, x = np.asarray(times, dtype=np.float64), np.asarray(values, dtype=np.float64)
    first = float(t[-1] - REFERENCE * (t[-1] - t[0]))
    part = x[t >= first]
    if float(np.ptp(part)) < 1e-9:
        away = np.flatnonzero(np.abs(x - part[-1]) >= 1e-9)
        return SteadyWindow(float(t[away[-1] + 1] if len(away) else t[0]), float(t[-1]), True)
    half = len(part) // 2
    if abs(float(part[half:].mean() - part[:half].mean())) > DRIFT * abs(float(part.mean())):
        return SteadyWindow(first, float(t[-1]), False)
    found = detect_steady_state(t, x, (first, float(t[-1])), s_max=MEMORY).intervals
    if len(found) and found[-1, 0] <= first:
        return SteadyWindow(float(found[-1, 0]), float(t[-1]), True)
    return SteadyWindow(first, float(t[-1]), False)


def summarize_starts(rows: Sequence[Sequence[float]] | Floats) -> dict[str, Any]:
    """Return means with 95 % bootstrap intervals over starts, one for each row.

    Args:
        rows: ``[points, starts]`` values.

    >>> summarize_starts([[1.0, 1.2, 1.1]])["mean"]
    [1.1]
    """
    found = [mean_over_starts(np.asarray(row, dtype=np.float64)) for row in rows]
    single = [one.starts == 1 for one in found]
    return {
        "mean": [round(one.mean, 6) for one in found],
        "low": [one.mean if alone else one.low for one, alone in zip(found, single, strict=True)],
        "high": [one.mean if alone else one.high for one, alone in zip(found, single, strict=True)],
        "starts": found[0].starts,
    }


def ends_of(summary: Mapping[str, Any]) -> list[tuple[float, float]]:
    """Return the intervals of a result of :func:`summarize_starts`, one for each row.

    >>> ends_of({"mean": [1.1], "low": [1.0], "high": [1.2]})
    [(1.0, 1.2)]
    """
    return list(zip(summary["low"], summary["high"], strict=True))


def mean_of(values: Sequence[float]) -> tuple[float, list[float]]:
    """Return the mean of a value over starts and its interval.

    >>> mean_of([1.5])
    (1.5, [1.5, 1.5])
    """
    found = summarize_starts([values])
    return found["mean"][0], [found["low"][0], found["high"][0]]


def worst_of(rows: Sequence[Mapping[str, Any]], overlap: bool = True) -> dict[str, float]:
    """Return the mean share of people in walls, and the largest overlap [m] of all starts.

    >>> worst_of([{"outside": 0.0, "overlap": 0.1}, {"outside": 0.5, "overlap": 0.3}])
    {'outside': 0.25, 'overlap': 0.3}
    """
    found = {"outside": float(np.mean([row["outside"] for row in rows]))}
    return found | ({"overlap": max(row["overlap"] for row in rows)} if overlap else {})


def bin_values(density: Floats, speed: Floats, width: float) -> dict[str, list[float]]:
    """Return the sums of a start that :func:`pool_bins` needs: bin, count, sum and sum of squares of the speed.

    >>> bin_values(np.array([0.2, 0.3, 1.1]), np.array([1.0, 1.2, 0.5]), 0.5)["count"]
    [2, 1]
    """
    number = np.floor(density / width).astype(np.int64)
    kept = np.unique(number)
    return {
        "bin": [int(n) for n in kept],
        "count": [int(np.sum(number == n)) for n in kept],
        "sum": [float(speed[number == n].sum()) for n in kept],
        "squares": [float((speed[number == n] ** 2).sum()) for n in kept],
    }


def pool_bins(starts: Sequence[dict[str, Any]], width: float, least: int, resamples: int = 1000) -> dict[str, Any]:
    """Return a fundamental diagram over all starts, with 95 % bootstrap intervals of the means over starts.

    Args:
        starts: results of :func:`bin_values`.
        width: width of the bins.
        least: minimum number of values of a bin.
        resamples: bootstrap samples; each draws whole starts.

    >>> rows = [bin_values(np.array([0.2, 0.3]), np.array([v, v]), 0.5) for v in (1.0, 1.2)]
    >>> pool_bins(rows, 0.5, 2)["speed"]
    [1.1]
    """
    bins = sorted({n for start in starts for n in start["bin"]})
    sums = np.zeros((3, len(starts), len(bins)))
    for e, start in enumerate(starts):
        for k, n in enumerate(start["bin"]):
            sums[:, e, bins.index(n)] = start["count"][k], start["sum"][k], start["squares"][k]
    drawn = stream(0, "pool").integers(0, len(starts), (resamples, len(starts)))
    result: dict[str, Any] = {name: [] for name in ("density", "speed", "spread", "count", "low", "high")}
    for k, n in enumerate(bins):
        count, total, squares = sums[:, :, k].sum(axis=1)
        if count < least:
            continue
        mean = total / count
        counts, totals = sums[0, :, k][drawn].sum(axis=1), sums[1, :, k][drawn].sum(axis=1)
        means = totals[counts > 0] / counts[counts > 0]
        low, high = np.percentile(means, (2.5, 97.5)) if len(starts) > 1 else (mean, mean)
        values = (n + 0.5) * width, round(mean, 6), max(0.0, squares / count - mean**2) ** 0.5, count, low, high
        for name, value in zip(result, values, strict=True):
            result[name].append(int(value) if name == "count" else float(value))
    return result


def text_of(value: float, ends: Sequence[float] | None) -> str:
    """Return a value with its interval as text, or alone if it has none.

    >>> text_of(0.24, (0.22, 0.27)), text_of(0.24, None)
    ('0.24 (0.22 to 0.27)', '0.24')
    """
    return f"{value:.2f} ({ends[0]:.2f} to {ends[1]:.2f})" if ends is not None else f"{value:.2f}"

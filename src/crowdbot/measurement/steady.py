"""Steady states of time series by the modified CUSUM method.

Liao, Tordeux, Seyfried, Chraibi, Drzycimski, Zheng, Zhao 2016, Measuring the steady state of pedestrian flow in
bottleneck experiments, doi 10.1016/j.physa.2016.05.051. A value far from a reference process raises a statistic s, a
value near to it lowers it; s lies between 0 and s_max. The state is steady while s is below a threshold, which an
autoregressive process with the autocorrelation of the reference exceeds with a probability of 1 - gamma only.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import InputError
from crowdbot.typing import Floats

LIMIT = 6.0
"""Range of the normal distribution that is discretised [standard deviations]."""
NODES = 20


@dataclass(frozen=True, eq=False)
class SteadyState:
    """Steady intervals of a time series.

    Fields:
        intervals: first and last time of each, ``[M, 2]``, in the units of ``time``.
        statistic: ``[N]`` values of s.
        threshold: threshold of s.
        mean, deviation: of the reference process.
        autocorrelation: of two successive values of the reference process.
    """

    intervals: Floats
    statistic: Floats
    threshold: int
    mean: float
    deviation: float
    autocorrelation: float


def detect_steady_state(
    time: ArrayLike,
    values: ArrayLike,
    reference: tuple[float, float],
    alpha: float = 0.99,
    gamma: float = 0.99,
    s_max: int = 100,
) -> SteadyState:
    """Return the steady intervals of a time series, such as a density or a speed.

    Args:
        time: ``[N]`` equidistant times or frames.
        values: ``[N]`` values.
        reference: first and last time of the reference process, an interval that looks steady.
        alpha: critical probability: values outside the central share ``2 alpha - 1`` of the reference count as far.
        gamma: confidence of the threshold.
        s_max: largest value of s.

    The statistic reacts late; the intervals are shifted back by the reaction times ``s_max - threshold`` at the begin
    and ``threshold`` at the end (equation 8 of the paper), in steps of time.

    Raises:
        InputError: an argument is not allowed, or the reference has fewer than three values or does not vary.

    >>> rng = np.random.default_rng(1)
    >>> values = np.concatenate([np.linspace(3.0, 0.0, 150), rng.normal(size=500) * 0.1])
    >>> found = detect_steady_state(np.arange(650.0), values, reference=(300.0, 600.0))
    >>> bool(abs(found.intervals[0, 0] - 150.0) < 20.0)
    True
    """
    t, x = np.asarray(time, dtype=np.float64), np.asarray(values, dtype=np.float64)
    if t.shape != x.shape or t.ndim != 1 or len(t) < 3 or not np.all(np.isfinite(x)):
        raise InputError("a steady state needs at least three finite values with their times")
    steps = np.diff(t)
    if not np.all(steps > 0.0) or not np.allclose(steps, steps[0], rtol=1e-6):
        raise InputError("the times of a steady state must increase in equal steps")
    part = x[(t >= reference[0]) & (t <= reference[1])]
    if len(part) < 3 or not part.std() > 0.0:
        raise InputError(
            f"the reference from {reference[0]:g} to {reference[1]:g} has {len(part)} values; at least three that vary"
            " are needed"
        )
    before, after = part[:-1] - part[:-1].mean(), part[1:] - part[1:].mean()
    norm = math.sqrt(float(before @ before) * float(after @ after))
    autocorrelation = float(before @ after) / norm if norm > 0.0 else 0.0
    threshold = steady_threshold(autocorrelation, alpha, gamma, s_max)
    mean, deviation = float(part.mean()), float(part.std())
    far = np.abs((x - mean) / deviation) > _quantile(alpha)
    statistic = np.empty(len(x))
    s = float(s_max)
    for k, away in enumerate(far.tolist()):
        s = s if k == 0 else min(max(0.0, s + (1.0 if away else -1.0)), float(s_max))
        statistic[k] = s
    return SteadyState(
        _intervals(t, statistic, threshold, s_max), statistic, threshold, mean, deviation, autocorrelation
    )


def combine_steady_states(states: Sequence[SteadyState]) -> Floats:
    """Return the intervals ``[M, 2]`` in which all series are steady, such as density and speed.

    Raises:
        InputError: there are no series.
    """
    if not states:
        raise InputError("there is no series to combine")
    common = states[0].intervals
    for state in states[1:]:
        both = [(max(a, c), min(b, d)) for a, b in common for c, d in state.intervals]
        common = np.asarray([item for item in both if item[0] < item[1]], dtype=np.float64).reshape(-1, 2)
    return common


def steady_threshold(autocorrelation: float, alpha: float = 0.99, gamma: float = 0.99, s_max: int = 100) -> int:
    """Return the threshold of s: the smallest m with ``P(s <= m) >= gamma`` for a steady process.

    The process ``y_k = c y_(k-1) + sqrt(1 - c^2) e_k`` with autocorrelation c and s form a Markov chain. Its stationary
    distribution is computed on Gauss-Legendre nodes, level by level of s.

    Args:
        autocorrelation: c; values above 0.999 are taken as 0.999, negative ones as they are.
        alpha, gamma: see :func:`detect_steady_state`.
        s_max: largest value of s.

    Raises:
        InputError: a probability is not between 0.5 and 1, or s_max is below 2.

    >>> steady_threshold(0.0), steady_threshold(0.9)
    (1, 3)
    """
    if not (0.5 < alpha < 1.0 and 0.5 < gamma < 1.0) or s_max < 2:
        raise InputError(f"alpha {alpha} and gamma {gamma} must be between 0.5 and 1, s_max {s_max} at least 2")
    q, c = _quantile(alpha), min(max(autocorrelation, -0.999), 0.999)
    y, weight = _nodes(q)
    width2 = 1.0 - c * c
    move = weight[:, None] * np.exp(-((y[:, None] - c * y[None, :]) ** 2) / (2.0 * width2))
    move /= move.sum(axis=0)  # columns are probabilities: from node to nodes
    far = np.abs(y) > q
    up, down = np.where(far[:, None], move, 0.0), np.where(far[:, None], 0.0, move)
    share = _levels(up, down, s_max)
    return int(np.argmax(np.cumsum(share) >= gamma))


def _levels(up: Floats, down: Floats, s_max: int) -> Floats:
    """Return the stationary share of each value of s, by elimination of the levels from above.

    Level s gets ``up`` from the level below and ``down`` from the level above; the ends keep what would leave them.
    """
    n = len(up)
    eye = np.eye(n)
    ratio: list[Floats] = [np.empty((0, 0))] * (s_max + 1)  # p_s = ratio_s p_(s-1)
    ratio[s_max] = np.asarray(np.linalg.solve(eye - up, up), dtype=np.float64)
    for s in range(s_max - 1, 0, -1):
        ratio[s] = np.asarray(np.linalg.solve(eye - down @ ratio[s + 1], up), dtype=np.float64)
    closed = down + down @ ratio[1]
    value, vector = np.linalg.eig(closed)
    p = np.abs(np.real(vector[:, int(np.argmin(np.abs(value - 1.0)))]))
    share = np.empty(s_max + 1)
    for s in range(s_max + 1):
        p = p if s == 0 else ratio[s] @ p
        share[s] = p.sum()
    return np.asarray(share / share.sum())


def _nodes(q: float) -> tuple[Floats, Floats]:
    """Return nodes and weights on both sides of the limits -q and q."""
    node, weight = np.polynomial.legendre.leggauss(NODES)
    parts = [(-LIMIT, -q), (-q, 0.0), (0.0, q), (q, LIMIT)]
    y = np.concatenate([0.5 * (b - a) * node + 0.5 * (a + b) for a, b in parts])
    return y, np.concatenate([0.5 * (b - a) * weight for a, b in parts])


def _quantile(alpha: float) -> float:
    from scipy.special import ndtri

    return float(ndtri(alpha))


def _intervals(time: Floats, statistic: Floats, threshold: int, s_max: int) -> Floats:
    """Return the runs below the threshold, shifted by the reaction times; overlapping ones are joined."""
    step = float(time[1] - time[0])
    steady = np.concatenate([[False], statistic < threshold, [False]])
    begin, end = np.flatnonzero(~steady[:-1] & steady[1:]), np.flatnonzero(steady[:-1] & ~steady[1:]) - 1
    low = np.maximum(time[begin] + step - (s_max - threshold) * step, time[0])
    high = np.minimum(time[end] + step - threshold * step, time[-1])
    merged: list[list[float]] = []
    for first, last in zip(low.tolist(), high.tolist(), strict=True):
        if merged and first <= merged[-1][1]:
            merged[-1][1] = max(last, merged[-1][1])
        elif first < last:
            merged.append([first, last])
    return np.asarray(merged, dtype=np.float64).reshape(-1, 2)

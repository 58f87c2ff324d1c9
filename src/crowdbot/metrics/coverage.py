"""Calibration of Gaussian mixtures: the share of the truth inside the central region of a probability."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, kernel
from crowdbot.data import Forecast, Windows
from crowdbot.typing import Floats

from .displacement import check

NODES = 256
"""Number of points with which the probability of a region is measured, to about 1 %."""
SEQUENCE = 1.2207440846057596 ** -np.arange(1.0, 4.0)
"""Steps of the points: powers of the root of ``x^4 = x + 1``."""


def region_coverage(forecast: Forecast, future: Windows, share: float = 0.95) -> NDArray[np.float64]:
    """Return ``[T]``: share of true positions inside the central region of a probability; NaN without people.

    The central region of a probability is the smallest one that has it: where the density of
    :meth:`.Forecast.mixture` is highest. It is an ellipse for one component. A calibrated forecast returns ``share`` at
    every step; less is overconfident.

    Args:
        forecast, future: forecast, with covariances, and future of the same windows.
        share: probability of the region.

    Raises:
        InputError: forecast and future do not match, the forecast has no mixture, or the share is not between 0 and 1.

    >>> here = np.ones((1, 1, 2), dtype=bool)
    >>> future = Windows(np.array([[[[2.0, 0.0], [3.0, 0.0]]]]), here, here[:, 0], ~here[:, 0], np.array([[7, 8]]),
    ...     np.array([[10]]), 0.4, "all", "street")
    >>> import dataclasses
    >>> forecast = Forecast.of(np.zeros((1, 1, 1, 2, 2)), here[:, 0], 0.4, "me")
    >>> forecast = dataclasses.replace(forecast, covariance=np.broadcast_to(np.eye(2), (1, 1, 2, 2, 2)))
    >>> region_coverage(forecast, future).tolist()
    [0.5]
    """
    check(forecast, future)
    if not 0.0 < share < 1.0:
        raise InputError(f"coverage: share = {share} must be between 0 and 1")
    weight, mean, covariance = forecast.mixture()
    window, step, person = np.nonzero(future.present & future.scored[:, None])
    level = region_levels(
        weight[window, :, person], mean[window, :, step, person], covariance[window, :, step, person],
        future.position[window, step, person],
    )  # fmt: skip
    steps = future.present.shape[1]
    count = np.bincount(step, minlength=steps)
    held = np.bincount(step, level <= share, minlength=steps)
    return np.asarray(np.where(count > 0, held / np.maximum(count, 1), np.nan))


def region_levels(weight: Floats, mean: Floats, covariance: Floats, truth: Floats) -> Floats:
    """Return ``[N]``: probability of the central region of a Gaussian mixture with the truth on its border.

    Args:
        weight: ``[N, K]``, sums to 1 over K.
        mean, covariance: ``[N, K, 2]`` [m] and ``[N, K, 2, 2]`` [m^2].
        truth: ``[N, 2]`` [m].

    The levels of calibrated mixtures are evenly distributed between 0 and 1. One component is exact; several are
    measured with fixed quasi-random points (the R3 sequence of M. Roberts, 2018). Without an area the level is 1.

    >>> one = np.ones((1, 1)), np.zeros((1, 1, 2)), np.eye(2)[None, None]
    >>> region_levels(*one, np.array([[0.0, 1.1774]])).round(3).tolist()
    [0.5]
    """
    u, v, choice = (np.arange(1.0, NODES + 1.0)[:, None] * SEQUENCE % 1.0).T
    away = np.sqrt(-2.0 * np.log1p(-u))
    node = np.stack([away * np.cos(math.tau * v), away * np.sin(math.tau * v)], axis=1)
    weight, mean, covariance, truth = (np.ascontiguousarray(part) for part in (weight, mean, covariance, truth))
    return np.asarray(_levels(weight, mean, covariance, truth, node, choice))


@kernel
def _levels(
    weight: Floats, mean: Floats, covariance: Floats, truth: Floats, node: Floats, choice: Floats
) -> Floats:  # pragma: no cover - compiled
    """Return the levels ``[N]``; points ``node [S, 2]`` of a unit normal, in the component at ``choice [S]``."""
    N, K = weight.shape
    level = np.ones(N)
    form, root, height, ladder = np.zeros((K, 3)), np.zeros((K, 3)), np.zeros(K), np.zeros(K)
    for n in range(N):
        total, flat = 0.0, False
        for k in range(K):
            xx, xy, yy = covariance[n, k, 0, 0], covariance[n, k, 0, 1], covariance[n, k, 1, 1]
            area = xx * yy - xy * xy
            if not area > 0.0:
                flat = True
                break
            form[k, 0], form[k, 1], form[k, 2] = yy / area, -xy / area, xx / area
            root[k, 0] = math.sqrt(xx)
            root[k, 1], root[k, 2] = xy / root[k, 0], math.sqrt(area / xx)
            height[k] = weight[n, k] / math.sqrt(area)
            total += weight[n, k]
            ladder[k] = total
        if flat:
            continue
        limit = _density(form, height, mean[n], truth[n, 0], truth[n, 1])
        if K == 1:
            level[n] = 1.0 - limit / height[0]
            continue
        above = 0
        for s in range(len(node)):
            k = 0
            while k < K - 1 and choice[s] * total > ladder[k]:
                k += 1
            x = mean[n, k, 0] + root[k, 0] * node[s, 0]
            y = mean[n, k, 1] + root[k, 1] * node[s, 0] + root[k, 2] * node[s, 1]
            above += _density(form, height, mean[n], x, y) > limit
        level[n] = above / len(node)
    return level


@kernel
def _density(form: Floats, height: Floats, mean: Floats, x: float, y: float) -> float:  # pragma: no cover - compiled
    density = 0.0
    for k in range(len(height)):
        dx, dy = x - mean[k, 0], y - mean[k, 1]
        density += height[k] * math.exp(
            -0.5 * (form[k, 0] * dx * dx + 2.0 * form[k, 1] * dx * dy + form[k, 2] * dy * dy)
        )
    return density

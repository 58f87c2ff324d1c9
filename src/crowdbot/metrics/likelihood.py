"""Negative log-likelihood and Mahalanobis distance of the truth to the samples (AMD), and their spread (AMV)."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.data import Forecast, Windows
from crowdbot.typing import Floats

from .displacement import check

FLOOR = -20.0
"""Lower bound of the log density [nat], as in the Trajectron and in TrajNet++."""
FLAT = 1e-12
"""Minimum ratio of the eigenvalues of the covariance; samples on a line have no density in the plane."""
EQUAL = 1e-9
"""Samples with a smaller spread [m] count as equal."""
NUMBERS_AT_ONCE = 400_000
"""Maximum number of positions in memory at once."""


def kde_nll(forecast: Forecast, future: Windows, floor: float = FLOOR) -> Floats:
    """Return the negative log-likelihood ``[W, A]`` [nat] of the true positions under the samples, lower is better.

    At each step, the density is a sum of Gaussian kernels at the samples, as in ``scipy.stats.gaussian_kde``. The
    kernel covariance is the covariance of the weighted samples times ``n ** (-1 / 3)`` (Scott's rule in the plane),
    where ``n = 1 / sum(weight ** 2)`` is the effective number of samples. The logarithm of the density [m^-2] at the
    true position is limited to at least ``floor`` and averaged over the existing steps.

    A single sample, equal samples and samples on a line have no density; such steps are left out (TrajNet++). The value
    is NaN if no step remains, and for people who are not scored. It depends on the number of samples: compare only
    equal numbers (TrajNet++ uses 100, Trajectron++ 2000). The value has no lower bound, so people nearly at rest can
    dominate the mean. :func:`energy_score` has none of these limitations.

    Papers: Ivanovic, Pavone (2019), The Trajectron, arXiv 1810.05993 (the metric); Scott (1992), doi
    10.1002/9780470316849 (the width).

    Raises:
        InputError: forecast and future do not match.

    >>> import numpy as np
    >>> here = np.ones((1, 1, 1), dtype=bool)
    >>> future = Windows(np.zeros((1, 1, 1, 2)), here, here[:, 0], ~here[:, 0], np.array([[7]]),
    ...     np.array([[10]]), 0.4, "all", "street")
    >>> cross = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])[None, :, None, None]
    >>> [kde_nll(Forecast.of(at, here[:, 0], 0.4, "me"), future)[0, 0].round(3).item() for at in (cross, cross[:, :1])]
    [2.161, nan]
    """
    check(forecast, future)
    result = np.full(future.scored.shape, np.nan)
    window, person = np.nonzero(future.scored)
    if forecast.samples == 1:
        return result
    size = max(1, NUMBERS_AT_ONCE // (forecast.samples * forecast.steps))
    for first in range(0, len(window), size):
        w, a = window[first : first + size], person[first : first + size]
        truth, there = future.position[w, :, a], future.present[w, :, a]
        density = _log_density(forecast.position[w, :, :, a], forecast.weight[w], truth)
        known = there & ~np.isnan(density)
        steps = known.sum(axis=1)
        total = -np.sum(np.where(known, np.maximum(density, floor), 0.0), axis=1)
        result[w, a] = np.where(steps > 0, total / np.maximum(steps, 1), np.nan)
    return result


def _log_density(samples: Floats, weight: Floats, truth: Floats) -> Floats:
    """Return the log density ``[N, T]`` at truth ``[N, T, 2]`` of samples ``[N, K, T, 2]`` with weights ``[N, K]``."""
    share = weight[:, :, None]
    power = np.sum(weight * weight, axis=1)[:, None]  # 1 / effective number of samples
    x, y = (samples[..., axis] - np.sum(share * samples[..., axis], axis=1)[:, None] for axis in (0, 1))
    unbiased = np.maximum(1.0 - power, np.finfo(np.float64).tiny)
    xx, xy, yy = (np.sum(share * product, axis=1) / unbiased for product in (x * x, x * y, y * y))
    middle, radius = (xx + yy) / 2.0, np.hypot((xx - yy) / 2.0, xy)
    flat = (middle - radius <= FLAT * (middle + radius)) | (middle + radius <= EQUAL**2) | (power > 1.0 - 1e-9)
    width = np.cbrt(power)  # Scott: n ** (-1 / (d + 4)), squared, d = 2
    xx, xy, yy = (np.where(flat, item, value * width) for item, value in ((1.0, xx), (0.0, xy), (1.0, yy)))
    determinant = xx * yy - xy * xy
    dx, dy = (samples[..., axis] - truth[:, None, :, axis] for axis in (0, 1))
    distance2 = (yy[:, None] * dx * dx - 2.0 * xy[:, None] * dx * dy + xx[:, None] * dy * dy) / determinant[:, None]
    exponent = np.where(share > 0.0, -0.5 * distance2, -np.inf)
    largest = exponent.max(axis=1)
    kernels = np.sum(share * np.exp(exponent - largest[:, None]), axis=1)
    density = largest + np.log(kernels) - 0.5 * np.log(determinant) - math.log(2.0 * math.pi)
    return np.where(flat, np.nan, density)


"""Minimum ratio of the eigenvalues of the covariance; samples on a line have no spread across it."""


def mahalanobis(forecast: Forecast, future: Windows) -> tuple[Floats, Floats]:
    """Return AMD ``[W, A]`` and AMV ``[W, A]`` [m^2] of weighted samples, lower is better.

    At each step, a normal density with the weighted mean and unbiased covariance of the samples is computed. AMD is the
    mean Mahalanobis distance of the true position over the existing steps: 0 at the mean, about 1.25 if the truth has
    this distribution, larger for overconfident or displaced samples. AMV is the mean of the largest eigenvalue of the
    covariance, which penalises widely spread samples. The paper fits a mixture with a number of components chosen by
    BIC to 1000 samples; with the usual 20 samples this is one component.

    Steps with equal samples or samples on a line are left out. Both values are NaN if no step remains, for people who
    are not scored, and for forecasts with one sample.

    Paper: Mohamed et al. (2022), Social-Implicit, ECCV, arXiv 2203.03057.

    Raises:
        InputError: forecast and future do not match.

    >>> here = np.ones((1, 1, 1), dtype=bool)
    >>> future = Windows(np.full((1, 1, 1, 2), 2.0), here, here[:, 0], ~here[:, 0], np.array([[7]]),
    ...     np.array([[10]]), 0.4, "all", "street")
    >>> cross = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])[None, :, None, None]
    >>> [values.round(3).item() for values in mahalanobis(Forecast.of(cross, here[:, 0], 0.4, "me"), future)]
    [3.464, 0.667]
    """
    check(forecast, future)
    distance, spread = np.full(future.scored.shape, np.nan), np.full(future.scored.shape, np.nan)
    window, person = np.nonzero(future.scored)
    if forecast.samples == 1 or not len(window):
        return distance, spread
    share = forecast.weight[window][:, :, None, None]  # [N, K, 1, 1]
    samples = forecast.position[window, :, :, person]  # [N, K, T, 2]
    middle = np.sum(share * samples, axis=1)
    away = samples - middle[:, None]
    unbiased = np.maximum(1.0 - np.sum(share * share, axis=1), np.finfo(np.float64).tiny)[..., 0]  # [N, 1]
    weight = share[..., 0]
    xx, xy, yy = (np.sum(weight * away[..., i] * away[..., j], axis=1) / unbiased for i, j in ((0, 0), (0, 1), (1, 1)))
    mean, radius = (xx + yy) / 2.0, np.hypot((xx - yy) / 2.0, xy)
    known = future.present[window, :, person] & (mean - radius > FLAT * (mean + radius))
    determinant = np.where(known, xx * yy - xy * xy, 1.0)
    dx, dy = np.moveaxis(future.position[window, :, person] - middle, -1, 0)
    far = np.sqrt(np.maximum(0.0, (yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) / determinant))
    steps = known.sum(axis=1)
    for found, values in ((distance, far), (spread, mean + radius)):
        total = np.sum(np.where(known, values, 0.0), axis=1)
        found[window, person] = np.where(steps > 0, total / np.maximum(steps, 1), np.nan)
    return distance, spread

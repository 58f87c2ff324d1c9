"""Mahalanobis distance of the truth to the samples (AMD) and spread of the samples (AMV)."""

from __future__ import annotations

import numpy as np

from crowdbot.data import Forecast, Windows
from crowdbot.typing import Floats

from .displacement import check

FLAT = 1e-12
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

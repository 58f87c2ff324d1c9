"""Mahalanobis distance and spread: how far the truth is from the samples in units of their scatter, and the scatter."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdbot.data import Forecast, Windows

from .displacement import check

__all__ = ["mahalanobis"]

Floats = NDArray[np.float64]

FLAT = 1e-12
"""Samples on a line have no scatter across it: smallest over largest eigenvalue of their covariance."""


def mahalanobis(forecast: Forecast, future: Windows) -> tuple[Floats, Floats]:
    """Return AMD ``[W, A]`` and AMV ``[W, A]`` [m^2] of weighted samples, lower is better; best of K sees neither.

    At every step a normal density is laid through the samples, with their weighted mean and unbiased covariance. AMD is
    the Mahalanobis distance of the true position to it, mean over the steps that exist: 0 in the middle, about 1.25
    when the truth comes from this density, more when the samples are too sure or elsewhere. AMV is the largest
    eigenvalue of the covariance, mean over the same steps: samples that lie everywhere are paid for here. The paper
    fits a mixture whose number of normal densities is chosen by BIC to 1000 samples; with the usual 20 that is one.

    Steps whose samples are equal or stand on a line have no distance and are left out; both are NaN where no step
    remains, as for who is not scored and for forecasts of one sample.

    Paper: Mohamed et al. (2022), Social-Implicit, ECCV, arXiv 2203.03057.

    Raises:
        InputError: forecast and future do not belong together.

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

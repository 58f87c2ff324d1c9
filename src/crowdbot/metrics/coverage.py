"""Calibration of covariances: the share of the truth inside the ellipse of a probability."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.data import Forecast, Windows

from .displacement import check


def ellipse_coverage(forecast: Forecast, future: Windows, share: float = 0.95) -> NDArray[np.float64]:
    """Return ``[T]``: share of true positions inside the ellipse of a probability, at each step; NaN without people.

    The ellipse of the covariance is around the first sample: forecast with K = 1. Its squared Mahalanobis radius is
    ``-2 ln(1 - share)``. A calibrated forecast returns ``share`` at every step; less is overconfident.

    Args:
        forecast, future: forecast, with covariances, and future of the same windows.
        share: probability of the ellipse.

    Raises:
        InputError: forecast and future do not match, the forecast has no covariance or several samples, or the share is
            not between 0 and 1.

    >>> here = np.ones((1, 1, 2), dtype=bool)
    >>> future = Windows(np.array([[[[2.0, 0.0], [3.0, 0.0]]]]), here, here[:, 0], ~here[:, 0], np.array([[7, 8]]),
    ...     np.array([[10]]), 0.4, "all", "street")
    >>> import dataclasses
    >>> forecast = Forecast.of(np.zeros((1, 1, 1, 2, 2)), here[:, 0], 0.4, "me")
    >>> forecast = dataclasses.replace(forecast, covariance=np.broadcast_to(np.eye(2), (1, 1, 2, 2, 2)))
    >>> ellipse_coverage(forecast, future).tolist()
    [0.5]
    """
    check(forecast, future)
    if forecast.covariance is None or forecast.samples != 1:
        raise InputError(
            f"coverage: the forecast of {forecast.predictor} has"
            + (" no covariance" if forecast.covariance is None else f" {forecast.samples} samples, it must have one")
        )
    if not 0.0 < share < 1.0:
        raise InputError(f"coverage: share = {share} must be between 0 and 1")
    known = future.present & future.scored[:, None]
    dx, dy = np.moveaxis(future.position - forecast.position[:, 0], -1, 0)
    xx, xy, yy = (forecast.covariance[..., i, j] for i, j in ((0, 0), (0, 1), (1, 1)))
    determinant = xx * yy - xy * xy
    limit = -2.0 * math.log(1.0 - share)
    inside = (yy * dx * dx - 2.0 * xy * dx * dy + xx * dy * dy) <= limit * determinant
    count = known.sum(axis=(0, 2))
    held = (inside & known).sum(axis=(0, 2))
    return np.asarray(np.where(count > 0, held / np.maximum(count, 1), np.nan))

"""Covariances of a mixture of futures around one trajectory, widened for places and trackers that no training saw."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.data import Windows
from crowdbot.prediction.kalman import Kalman
from crowdbot.typing import Floats

from .agent_frame import PREDICTED_ROWS, rotate
from .anchors import resample_paths

HORIZON = 4.8
"""Horizon of the training [s]; beyond it standard deviations grow in proportion to time."""
WIDENED, FILTERED = 3.0, 0.2
"""Factors of the covariance of the mixture and of that of the Kalman filter in their sum. The training recordings are
interpolated and have hardly any noise, so the mixture alone is overconfident elsewhere."""


@kernel
def add_products(
    probability: Floats, spread: Floats, arm: Floats, away: Floats
) -> Floats:  # pragma: no cover - compiled
    """Return covariances ``[N, T, 2, 2]`` [m^2] within and between K futures, summed in a fixed order.

    Args:
        probability, spread: ``[N, K]``, ``[N, K, D]`` of the futures.
        arm: ``[N, D, T, 2]`` [m] displacements by the coefficients.
        away: ``[N, K, T, 2]`` [m] from the trajectory to each future.
    """
    N, D, T, _ = arm.shape
    products = np.zeros((N, T, 2, 2))
    for n in range(N):
        for d in range(D):
            variance = 0.0
            for k in range(probability.shape[1]):
                variance += probability[n, k] * spread[n, k, d] ** 2
            for t in range(T):
                for x in range(2):
                    for y in range(2):
                        products[n, t, x, y] += variance * arm[n, d, t, x] * arm[n, d, t, y]
        for k in range(probability.shape[1]):
            for t in range(T):
                for x in range(2):
                    for y in range(2):
                        products[n, t, x, y] += probability[n, k] * away[n, k, t, x] * away[n, k, t, y]
    return products


def future_covariances(
    basis: Floats, probability: Floats, spread: Floats, away: Floats, heading: Floats, steps: int, dt: float
) -> Floats:
    """Return covariances ``[N, T, 2, 2]`` [m^2] of the mixture of futures of N people around one trajectory.

    Args:
        basis: ``[D, 24]`` residuals of the coefficients.
        probability: ``[N, K]`` of the futures.
        spread: ``[N, K, D]`` standard deviations of the coefficients around each future.
        away: ``[N, K, T, 2]`` [m] from the trajectory to each future.
        heading: ``[N, 2]`` directions of the people.
        steps, dt: number of rows and their time step [s].
    """
    D, N = len(basis), len(probability)
    shape = resample_paths(basis.reshape(1, D, PREDICTED_ROWS, 2), np.zeros((1, 2)), steps, dt)[0]
    time = dt * np.arange(1, steps + 1)
    arm = rotate(np.broadcast_to(shape, (N, D, steps, 2)), heading, back=True)
    found = add_products(probability, spread, np.ascontiguousarray(arm), np.ascontiguousarray(away))
    found *= (np.maximum(time / HORIZON, 1.0) ** 2)[:, None, None]
    return found


def total_covariances(past: Windows, mixture: Floats, window: NDArray[np.int64], slot: NDArray[np.int64]) -> Floats:
    """Return covariances ``[W, T, A, 2, 2]`` [m^2] of agents by slot; 0 for absent agents and known plans.

    They are the weighted sum of those of the mixture ``[N, T, 2, 2]`` and of the Kalman filter, and that of the last
    position if the tracker gives it, since the futures start there. People observed once have that of the filter, whose
    velocity is unknown then.
    """
    W, A = past.present.shape[0], past.present.shape[2]
    filtered = Kalman().predict(past, mixture.shape[1]).covariance
    assert filtered is not None
    own = np.zeros((W, mixture.shape[1], A, 2, 2))
    own[window, :, slot] = mixture
    once = (past.present.sum(axis=1) == 1)[:, None, :, None, None]
    found = WIDENED * own + FILTERED * filtered
    if past.covariance is not None:
        found += np.where(past.present[:, -1, :, None, None], np.nan_to_num(past.covariance[:, -1]), 0.0)[:, None]
    found = np.where(once, filtered, found)
    if past.plan is not None:
        for step in range(mixture.shape[1]):
            known = ~np.isnan(past.plan_at(step + 1)).any(axis=-1)
            found[:, step][known] = 0.0
    return found

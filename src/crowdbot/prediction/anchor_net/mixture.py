"""Covariances of the futures of people, and of their mixture around one trajectory."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.data import Windows
from crowdbot.prediction.kalman import Kalman
from crowdbot.prediction.pretrained_weights import STEP
from crowdbot.typing import Floats

from .agent_frame import PREDICTED_ROWS, rotate
from .anchors import resample_paths

HORIZON = 4.8
"""Horizon of the training [s]; beyond it standard deviations grow in proportion to time."""
WIDTH, EARLY_WIDTH = 1.3, 1.0
"""Factor of the standard deviation of a future at t: ``WIDTH + EARLY_WIDTH * 0.4 s / t``. The training recordings are
interpolated and have hardly any noise, so the mixture alone is too narrow elsewhere, above all at short horizons.
``python studies/forecast_calibration.py DATA --fit`` chooses the values."""


@kernel
def add_products(
    probability: Floats, spread: Floats, arm: Floats, away: Floats, width: Floats, growth: Floats
) -> tuple[Floats, Floats]:  # pragma: no cover - compiled
    """Return covariances ``[N, K, T, 2, 2]`` [m^2] of the futures, and ``[N, T, 2, 2]`` of all around the trajectory.

    Sums have a fixed order.

    Args:
        probability, spread: ``[N, K]``, ``[N, K, D]`` of the futures.
        arm: ``[N, D, T, 2]`` [m] displacements by the coefficients.
        away: ``[N, K, T, 2]`` [m] from the trajectory to each future.
        width: ``[T]`` factors of the standard deviation of a future.
        growth: ``[T]`` factors of the covariances.
    """
    N, D, T, _ = arm.shape
    K = probability.shape[1]
    own, products = np.zeros((N, K, T, 2, 2)), np.zeros((N, T, 2, 2))
    for n in range(N):
        for k in range(K):
            for t in range(T):
                for x in range(2):
                    for y in range(2):
                        total = 0.0
                        for d in range(D):
                            total += spread[n, k, d] ** 2 * arm[n, d, t, x] * arm[n, d, t, y]
                        own[n, k, t, x, y] = growth[t] * width[t] ** 2 * total
                        between = growth[t] * away[n, k, t, x] * away[n, k, t, y]
                        products[n, t, x, y] += probability[n, k] * (own[n, k, t, x, y] + between)
    return own, products


def future_covariances(
    basis: Floats, probability: Floats, spread: Floats, away: Floats, heading: Floats, steps: int, dt: float
) -> tuple[Floats, Floats]:
    """Return covariances ``[N, K, T, 2, 2]`` [m^2] of the futures of N people, and ``[N, T, 2, 2]`` of their mixture.

    The second ones are around one trajectory.

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
    time = dt * np.arange(1.0, steps + 1.0)
    arm = rotate(np.broadcast_to(shape, (N, D, steps, 2)), heading, back=True)
    width = np.asarray(WIDTH + EARLY_WIDTH * STEP / time)
    growth = np.asarray(np.maximum(time / HORIZON, 1.0) ** 2)
    return add_products(probability, spread, np.ascontiguousarray(arm), np.ascontiguousarray(away), width, growth)


@kernel
def scatter_covariances(
    own: Floats, future: NDArray[np.int64], window: NDArray[np.int64], slot: NDArray[np.int64], placed: Floats
) -> None:  # pragma: no cover - compiled
    """Write the covariances of chosen futures of people into their windows and slots.

    Args:
        own: ``[N, K, T, 2, 2]`` of all futures of N people.
        future: ``[N, S]`` which of them are chosen.
        window, slot: ``[N]`` of the people.
        placed: ``[W, S, T, A, 2, 2]``, changed.
    """
    N, S = future.shape
    T = own.shape[2]
    for n in range(N):
        w, a = window[n], slot[n]
        for s in range(S):
            k = future[n, s]
            for t in range(T):
                for x in range(2):
                    for y in range(2):
                        placed[w, s, t, a, x, y] = own[n, k, t, x, y]


def placed_covariances(
    past: Windows, own: Floats, future: NDArray[np.int64], window: NDArray[np.int64], slot: NDArray[np.int64]
) -> Floats:
    """Return covariances ``[W, S, T, A, 2, 2]`` [m^2] of agents by slot; 0 for absent agents and known plans.

    They are those of futures ``[N, S]`` of N people, chosen from ``own``, ``[N, K, T, 2, 2]``, plus that of the last
    position if the tracker gives it, since the futures start there. People observed once have that of the Kalman
    filter, whose velocity is unknown then.
    """
    W, A, S, steps = len(past), past.present.shape[2], future.shape[1], own.shape[2]
    placed = np.zeros((W, S, steps, A, 2, 2))
    scatter_covariances(own, future, window, slot, placed)
    if past.covariance is not None:
        last = np.where(past.present[:, -1, :, None, None], np.nan_to_num(past.covariance[:, -1]), 0.0)
        placed += last[:, None, None]
    once = np.equal(past.present.sum(axis=1), 1)[:, None, None, :, None, None]
    if np.any(once):
        filtered = Kalman().predict(past, steps).covariance
        assert filtered is not None
        placed = np.where(once, filtered[:, None], placed)
    if past.plan is not None:
        for step in range(steps):
            known = np.asarray(~np.isnan(past.plan_at(step + 1)).any(axis=-1))
            placed[:, :, step] = np.where(known[:, None, :, None, None], 0.0, placed[:, :, step])
    return placed

"""Kernels of Kalman filters: a position and its derivatives, each row of a track measured with its own covariance.

The covariance of a state with n derivatives is ``[n, n, B, B]``: B = 1 where x and y have the same variances, else 2.
Each person is filtered alone, so the bits do not depend on the others.
"""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import kernel
from crowdbot.typing import Bools, Floats


@kernel
def _predict(spread: Floats, drift: Floats, noise: Floats) -> None:  # pragma: no cover - compiled
    """Replace a covariance ``[n, n, B, B]`` by ``F P F' + Q``, with a triangular ``F``."""
    n, size = spread.shape[0], spread.shape[2]
    for x in range(size):
        for y in range(size):
            for j in range(n):
                for i in range(n):  # rows below are still the old ones
                    for k in range(i + 1, n):
                        spread[i, j, x, y] += drift[i, k] * spread[k, j, x, y]
            for i in range(n):
                for j in range(n):
                    for k in range(j + 1, n):
                        spread[i, j, x, y] += drift[j, k] * spread[i, k, x, y]
                    if x == y:
                        spread[i, j, x, y] += noise[i, j]


@kernel
def filter_rows(
    position: Floats, present: Bools, measured: Floats, drift: Floats, noise: Floats, start: Floats
) -> tuple[Floats, Floats, Floats]:  # pragma: no cover - compiled
    """Return motions ``[N, n, 2]``, negative log-likelihoods ``[N]`` and covariances ``[N, n, n, B, B]`` after rows.

    The likelihood is that of the rows after the first observed one, without ``log(2 pi)`` of each.

    Args:
        position, present: rows ``[T, N, 2]`` [m], ``[T, N]``.
        measured: ``[T, N, B, B]`` [m^2] covariances of the measured positions.
        drift, noise: transition and process noise ``[n, n]`` of a row.
        start: ``[n]`` initial standard deviations of position and derivatives.
    """
    T, N = present.shape
    n, size = len(start), measured.shape[2]
    motion, surprise = np.zeros((N, n, 2)), np.zeros(N)
    spread = np.zeros((N, n, n, size, size))
    inverse, gain, old = np.zeros((size, size)), np.zeros((n, size, size)), np.zeros((n, size, size))
    wrong, error = np.zeros(2), np.zeros((size, size))
    for a in range(N):
        own, state, started = spread[a], motion[a], False
        for i in range(n):
            for x in range(size):
                own[i, i, x, x] = start[i] ** 2
        for t in range(T):
            if started:
                for i in range(n):
                    for c in range(2):
                        for k in range(i + 1, n):
                            state[i, c] += drift[i, k] * state[k, c]
                _predict(own, drift, noise)
            if not present[t, a]:
                continue
            if not started:
                started = True
                state[0, 0], state[0, 1] = position[t, a, 0], position[t, a, 1]
                own[0, 0] = measured[t, a]
                continue
            for x in range(size):
                for y in range(size):
                    error[x, y] = own[0, 0, x, y] + measured[t, a, x, y]
            if size == 1:
                whole = error[0, 0] * error[0, 0]
                inverse[0, 0] = 1.0 / error[0, 0]
            else:
                whole = error[0, 0] * error[1, 1] - error[0, 1] * error[1, 0]
                inverse[0, 0], inverse[1, 1] = error[1, 1] / whole, error[0, 0] / whole
                inverse[0, 1], inverse[1, 0] = -error[0, 1] / whole, -error[1, 0] / whole
            distance = 0.0
            for c in range(2):
                wrong[c] = position[t, a, c] - state[0, c]
            for c in range(2):
                for d in range(2):
                    if size == 2:
                        distance += wrong[c] * inverse[c, d] * wrong[d]
                    elif c == d:
                        distance += wrong[c] * inverse[0, 0] * wrong[c]
            surprise[a] += 0.5 * math.log(whole) + 0.5 * distance
            for i in range(n):
                for x in range(size):
                    for y in range(size):
                        old[i, x, y] = own[0, i, x, y]
                        if size == 1:
                            gain[i, 0, 0] = own[i, 0, 0, 0] / error[0, 0]
                        else:
                            gain[i, x, y] = own[i, 0, x, 0] * inverse[0, y] + own[i, 0, x, 1] * inverse[1, y]
            for i in range(n):
                for c in range(2):
                    if size == 1:
                        state[i, c] += gain[i, 0, 0] * wrong[c]
                    else:
                        state[i, c] += gain[i, c, 0] * wrong[0] + gain[i, c, 1] * wrong[1]
                for j in range(n):
                    for x in range(size):
                        for y in range(size):
                            for k in range(size):
                                own[i, j, x, y] -= gain[i, x, k] * old[j, k, y]
    return motion, surprise, spread


@kernel
def predict_variances(
    spread: Floats, drift: Floats, noise: Floats, steps: int
) -> Floats:  # pragma: no cover - compiled
    """Return the covariances ``[N, steps, B, B]`` [m^2] of the positions in the next rows.

    Args:
        spread: ``[N, n, n, B, B]`` covariances now.
        drift, noise: transition and process noise ``[n, n]`` of a row.
        steps: number of rows.
    """
    N, size = len(spread), spread.shape[3]
    found, ahead = np.empty((N, steps, size, size)), spread.copy()
    for a in range(N):
        for step in range(steps):
            _predict(ahead[a], drift, noise)
            found[a, step] = ahead[a, 0, 0]
    return found

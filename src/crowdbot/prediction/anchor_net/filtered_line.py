"""Lines of Kalman filters through observed tracks, as coefficients of the residuals to constant velocity.

The last displacement, the base of the network, is inaccurate in measured tracks. The filter of
:class:`~crowdbot.prediction.Kalman` has fixed noise; here the noise is fitted to each track: a grid of filters runs
over it, and their lines are averaged by likelihood (multiple-model estimation, Magill 1965). The likelihood also says
how probable it is that the person walks straight and the track is noisy. There a line is better than the network.
Where the tracker gives covariances, they replace the noise of the measurements on the grid.
"""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import kernel
from crowdbot.prediction.kalman import Kalman
from crowdbot.prediction.pretrained_weights import STEP
from crowdbot.typing import Bools, Floats

from .agent_frame import PREDICTED_ROWS, rotate

LINE_SHARE = 0.8
"""Share of the filtered line in the single trajectory of people who surely walk straight with a noisy track, in weights
for other places. Chosen with weights that did not learn from the data sets on which they were scored: 0.6 is better by
0.4 points on average, but on one set of noisy tracks more than 3 % worse than the best baseline."""
ACCELERATION = np.array([0.01, 0.05, 0.2, 0.8])
"""Square roots of the spectral density of the acceleration on the grid [m s^-1.5]."""
MEASUREMENT = np.array([0.0005, 0.002, 0.015, 0.05, 0.12])
"""Standard deviations of a measured coordinate on the grid [m]."""
STRAIGHT, NOISY = 0.1, 0.03
"""Filters with a lower acceleration noise and a higher measurement noise belong to straight noisy tracks."""

FilteredTracks = tuple[Floats, Floats, Floats]


@kernel
def filter_tracks(
    past: Floats, seen: Bools, given: Floats, dt: float, acceleration: Floats, measurement: Floats, speed: float
) -> FilteredTracks:  # pragma: no cover - compiled
    """Return positions ``[N, 2]`` [m] at the last row, velocities ``[N, 2]`` [m/s], and how straight and noisy ``[N]``.

    Args:
        past: ``[N, T, 2]`` [m] tracks.
        seen: ``[N, T]`` mask of the observed rows.
        given: ``[N, T]`` [m^2] variance of a measured coordinate, NaN where ``measurement`` counts.
        dt: time step [s].
        acceleration, measurement: noise on the grid, see :class:`~crowdbot.prediction.Kalman`.
        speed: initial standard deviation of a velocity component [m/s].
    """
    N, T, _ = past.shape
    G = len(acceleration) * len(measurement)
    place, velocity, straight = np.zeros((N, 2)), np.zeros((N, 2)), np.zeros(N)
    state, likelihood = np.empty((G, 4)), np.empty(G)
    for n in range(N):
        largest = -np.inf
        known, rows = 0.0, 0  # mean standard deviation of the tracker
        for t in range(T):
            if seen[n, t] and not np.isnan(given[n, t]):
                known += math.sqrt(given[n, t])
                rows += 1
        known = known / rows if rows else 0.0
        for g in range(G):
            push = acceleration[g // len(measurement)] ** 2
            assumed = measurement[g % len(measurement)] ** 2
            x = y = u = v = a = b = c = total = 0.0
            started = False
            for t in range(T):
                if started:
                    x += dt * u
                    y += dt * v
                    a += dt * (2.0 * b + dt * c) + push * dt**3 / 3.0
                    b += dt * c + push * dt**2 / 2.0
                    c += push * dt
                if not seen[n, t]:
                    continue
                noise = assumed if np.isnan(given[n, t]) else given[n, t]
                if not started:
                    x, y, a, b, c, started = past[n, t, 0], past[n, t, 1], noise, 0.0, speed**2, True
                    continue
                expected = a + noise
                dx, dy = past[n, t, 0] - x, past[n, t, 1] - y
                total -= math.log(expected) + (dx * dx + dy * dy) / (2.0 * expected)
                gain, pull = a / expected, b / expected
                x += gain * dx
                y += gain * dy
                u += pull * dx
                v += pull * dy
                c -= pull * b
                b -= gain * b
                a -= gain * a
            state[g, 0], state[g, 1], state[g, 2], state[g, 3] = x, y, u, v
            likelihood[g] = total
            largest = max(largest, total)
        whole = 0.0
        for g in range(G):
            likelihood[g] = math.exp(likelihood[g] - largest)
            whole += likelihood[g]
        for g in range(G):
            deviation = known if rows else measurement[g % len(measurement)]
            if acceleration[g // len(measurement)] < STRAIGHT and deviation > NOISY:
                straight[n] += likelihood[g] / whole
            for k in range(2):
                place[n, k] += likelihood[g] / whole * state[g, k]
                velocity[n, k] += likelihood[g] / whole * state[g, 2 + k]
    return place, velocity, straight


def filtered_lines(past: Floats, seen: Bools, noise: Floats, heading: Floats, basis: Floats) -> tuple[Floats, Floats]:
    """Return coefficients ``[N, D]`` of filtered lines in the frames of people, and how straight and noisy ``[N]``.

    Args:
        past: ``[N, 8, 2]`` [m] tracks relative to their last position.
        seen: ``[N, 8]`` mask of the observed rows.
        noise: ``[N, 8]`` [m^2] variance of a measured coordinate, NaN where the noise is fitted to the track.
        heading: ``[N, 2]`` directions of the frames.
        basis: ``[D, 24]`` residuals of the coefficients, orthonormal.

    >>> straight = np.linspace([-2.8, 0.0], [0.0, 0.0], 8)[None]
    >>> unknown = np.full((1, 8), np.nan)
    >>> line, noisy = filtered_lines(straight, np.isnan(unknown), unknown, np.array([[1.0, 0.0]]), np.eye(24)[:6])
    >>> bool(np.allclose(line, 0.0, atol=1e-3)), bool(noisy[0] < 0.01)
    (True, True)
    """
    start, velocity, straight = filter_tracks(
        np.ascontiguousarray(past), np.ascontiguousarray(seen), np.ascontiguousarray(noise), STEP, ACCELERATION,
        MEASUREMENT, Kalman().speed,
    )  # fmt: skip
    ahead = np.arange(1.0, PREDICTED_ROWS + 1.0)[:, None]
    step = past[:, -1] - past[:, -2]
    away = start[:, None] + (STEP * velocity - step)[:, None] * ahead
    residual = rotate(away, heading).reshape(len(past), 2 * PREDICTED_ROWS)
    found = np.zeros((len(past), len(basis)))
    for column in range(residual.shape[1]):  # summation order independent of the batch
        found += residual[:, column, None] * basis[:, column]
    return found, straight

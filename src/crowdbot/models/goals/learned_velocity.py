"""LearnedVelocity: learned weights of the last displacements for predicting the velocity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.data import Trajectories, Windows, fill_gaps, resample_rows, slice_rows, steady_velocity
from crowdbot.typing import Floats

RIDGE = 0.01
"""Regularisation of the weights, as a fraction of the mean square of the inputs."""
ROUNDS = 15
"""Number of re-weighting iterations; the weights converge earlier."""
SMALLEST = 0.05
"""Lower limit of residuals as a fraction of their median, against unbounded weights."""


@dataclass(frozen=True, eq=False)
class LearnedVelocity:
    """Weighted mean of displacements around :func:`~crowdbot.data.motion.steady_velocity`.

    The weights minimise the sum of distances between the predicted and the mean future velocity. Distances are not
    squared, which limits the influence of people who turn. The weights are equal for x and y and therefore invariant
    to rotation. There is one row of weights for each length of history.

    Fields:
        weight: ``[N, N]``: the end of row n - 1 contains the weights of the last n displacements, oldest first.
        dt: time step of the recordings [s].
    """

    weight: Floats
    dt: float

    @property
    def history(self) -> float:
        """Observed time that the weights read [s]."""
        return len(self.weight) * self.dt

    @classmethod
    def learn(cls, recordings: tuple[Trajectories, ...], observe: int = 8, lookahead: float = 1.6) -> Self:
        """Return the weights learned from recordings of one place.

        Args:
            recordings: recordings in metres, with one time step.
            observe: maximum number of observed rows.
            lookahead: prediction time [s].

        Raises:
            InputError: no recording is given, they are in pixels or differ in time step, or a value is not allowed.
            DataError: a recording has no window of sufficient length.
        """
        return cls.fit(pairs_of(recordings, observe, lookahead))

    @classmethod
    def fit(cls, pairs: list[tuple[Windows, Windows]]) -> Self:
        """Return the weights fitted to the scored people in pairs of past and future."""
        most = pairs[0][0].position.shape[1] - 1
        weight = np.zeros((most, most))
        for count in range(1, most + 1):
            offs, misses = zip(*(_sample(past, future, count) for past, future in pairs), strict=True)
            weight[count - 1, most - count :] = _least_distance(np.concatenate(offs), np.concatenate(misses))
        return cls(weight, pairs[0][0].dt)

    def velocity(self, past: Windows) -> Floats:
        """Return ``[W, A, 2]`` [m/s]; 0 for people observed only at the last row or absent there.

        Windows with another time step are interpolated at the time step of the recordings.

        Raises:
            InputError: the windows are in pixels.
        """
        if past.units != "m":
            raise InputError(
                f"goals: {past.source} is in {past.units}, the goal was learned in m; convert it to metres"
            )
        if not abs(past.dt - self.dt) <= 0.01 * self.dt:
            past = resample_rows(past, self.dt)
        most = len(self.weight)
        known = slice_rows(fill_gaps(past), max(0, past.position.shape[1] - 1 - most), past.position.shape[1])
        steady = steady_velocity(known)
        offs, both = _velocity_deviations(known, steady)
        count = np.minimum(np.sum(both, axis=1), most)
        if most == 0 or offs.shape[1] == 0:
            return steady
        weight = self.weight[np.maximum(count, 1) - 1][..., most - offs.shape[1] :]
        change = np.sum(np.moveaxis(offs, 1, -2) * weight[..., None], axis=-2)
        known_here = past.present[:, -1] & (count > 0)
        return np.where(known_here[..., None], steady + change, steady)


def pairs_of(recordings: tuple[Trajectories, ...], observe: int, lookahead: float) -> list[tuple[Windows, Windows]]:
    """Return past and future windows for learning; futures need at least two rows."""
    if not recordings:
        raise InputError("goals: there is no recording to learn from; give at least one")
    if not 0.0 < lookahead < np.inf:
        raise InputError(f"goals: lookahead = {lookahead} s must be finite and above 0")
    dt = recordings[0].dt
    for tracks in recordings:
        if tracks.units != "m":
            raise InputError(f"goals: {tracks.name} is in pixels; convert it to metres to learn from it")
        if not abs(tracks.dt - dt) <= 0.01 * dt:
            raise InputError(
                f"goals: {recordings[0].name} has steps of {dt:.4g} s and {tracks.name} has steps of"
                f" {tracks.dt:.4g} s; resample one of them"
            )
    steps = max(1, round(lookahead / dt))
    return [tracks.windows(max(2, observe), steps, "partial") for tracks in recordings]


def _velocity_deviations(known: Windows, steady: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Return displacement velocities minus the steady velocity ``[W, n, A, 2]`` [m/s], and which ones are known."""
    both = known.present[:, 1:] & known.present[:, :-1]
    off = np.diff(known.position, axis=1) / known.dt - steady[:, None]
    return np.where(both[..., None], off, 0.0), both


def _sample(past: Windows, future: Windows, count: int) -> tuple[Floats, Floats]:
    """Return deviations ``[P, count, 2]`` and errors of the steady velocity ``[P, 2]`` [m/s] of scored people."""
    rows = past.position.shape[1]
    known = slice_rows(past, rows - 1 - count, rows)
    steady = steady_velocity(known)
    counted = future.scored
    off = np.moveaxis(_velocity_deviations(fill_gaps(known), steady)[0], 1, 2)[counted]
    return off, (mean_velocity(past, future) - steady)[counted]


def mean_velocity(past: Windows, future: Windows) -> Floats:
    """Return the mean velocity ``[W, A, 2]`` [m/s] until the last future row of each person."""
    steps = future.present.shape[1]
    last = steps - 1 - np.argmax(future.present[:, ::-1], axis=1)
    end = np.take_along_axis(future.position, last[:, None, :, None], axis=1)[:, 0]
    return np.asarray((end - past.position[:, -1]) / ((last + 1) * past.dt)[..., None])


def _least_distance(off: Floats, miss: Floats) -> Floats:
    """Return weights ``[n]`` that minimise the sum of ``|miss - weights off|`` by re-weighted least squares.

    Sums are explicit, since the order of additions in a matrix product depends on the number of threads.
    """
    count = off.shape[1]
    x, y = off.reshape(len(off), count, 2), miss
    floor = max(SMALLEST * float(np.median(np.sqrt(np.sum(y * y, axis=-1)))), 1e-9)
    worth = np.ones(len(y))
    weight = np.zeros(count)
    for _ in range(ROUNDS):
        scaled = worth[:, None, None] * x
        gram = np.array([[np.sum(scaled[:, i] * x[:, j]) for j in range(count)] for i in range(count)])
        right = np.array([np.sum(scaled[:, i] * y) for i in range(count)])
        scale = np.trace(gram) / count
        if not scale > 1e-12 * len(y):
            return weight  # all velocities are constant: nothing to fit
        weight = np.linalg.solve(gram + RIDGE * scale * np.eye(count), right)
        left = y - np.sum(x * weight[:, None], axis=1)
        worth = 1.0 / np.maximum(np.sqrt(np.sum(left * left, axis=-1)), floor)
    return weight

"""The contract of trackers, their tracks, and the Kalman filters behind them."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, storable
from crowdbot.typing import Bools, Floats, Ints

from .detector import Detections


@storable
@dataclass(frozen=True)
class Tracks:
    """People followed by a tracker at one instant, in the world frame.

    Fields:
        time: time [s].
        ids: ``[N]`` identities, from 0 in the order of their first detection; none is used twice.
        position, velocity: ``[N, 2]`` [m], [m/s].
        covariance: ``[N, 4, 4]`` of x, y, vx, vy.
        existence: ``[N]`` probability that there is a person.
        detected: ``[N]`` whether the person was detected at this instant, otherwise the motion is continued.

    >>> Tracks.none(0.5).position.shape
    (0, 2)
    """

    time: float
    ids: NDArray[np.int64]
    position: Floats
    velocity: Floats
    covariance: Floats
    existence: Floats
    detected: NDArray[np.bool_]

    @classmethod
    def none(cls, time: float) -> Tracks:
        """Return nobody."""
        empty = np.zeros((0, 2))
        nobody = np.zeros(0, dtype=np.int64)
        return cls(time, nobody, empty, empty, np.zeros((0, 4, 4)), np.zeros(0), np.zeros(0, dtype=np.bool_))

    def __len__(self) -> int:
        """Return the number of people."""
        return len(self.ids)

    def at(self, time: float) -> Floats:
        """Return positions ``[N, 2]`` [m] at another time [s], with constant velocities."""
        return np.asarray(self.position + (time - self.time) * self.velocity)


@dataclass(frozen=True, kw_only=True)
class Tracker(ABC):
    """Follows people from detection to detection: a frozen specification and two pure functions.

    The state is never changed in place, so that a copy of a reference is a snapshot. It is a dataclass, tuple, list or
    dict of arrays and numbers.
    """

    @abstractmethod
    def begin(self) -> Any:
        """Return the state before the first detections."""

    @abstractmethod
    def update(self, detections: Detections, time: float, state: Any) -> tuple[Tracks, Any]:
        """Return the tracks at ``time`` [s] and the next state.

        Args:
            detections: detections at this time.
            time: time [s], not before that of the state.
            state: state of :meth:`begin` or of the last update.

        Raises:
            InputError: the time is not finite or before that of the state.
        """

    @staticmethod
    def check_time(time: float, last: float) -> None:
        """Raise :class:`InputError` if a time is not finite or before the last one, which is NaN at the beginning."""
        if not math.isfinite(time) or time < last:
            after = "" if math.isnan(last) else f" and not before the last update at {last:g} s"
            raise InputError(f"tracker: time = {time} s must be finite{after}")


class FilterState(NamedTuple):
    """Filters of N people with M motion models; the state is x, y [m], vx, vy [m/s]."""

    mean: Floats
    """``[N, M, 4]``"""
    covariance: Floats
    """``[N, M, 4, 4]``"""
    weight: Floats
    """``[N, M]`` probability of each model."""

    def moments(self) -> tuple[Floats, Floats]:
        """Return mean ``[N, 4]`` and covariance ``[N, 4, 4]`` of the mixtures."""
        if self.mean.shape[1] == 1:
            return self.mean[:, 0], self.covariance[:, 0]
        mean = np.einsum("nm,nmi->ni", self.weight, self.mean)
        away = self.mean - mean[:, None]
        spread = self.covariance + away[..., :, None] * away[..., None, :]
        return mean, np.einsum("nm,nmij->nij", self.weight, spread)


class Innovation(NamedTuple):
    """Differences between D detections and the predictions of N filters with M models."""

    residual: Floats
    """``[N, D, M, 2]`` [m]."""
    inverse: Floats
    """``[N, D, M, 2, 2]`` inverse covariance of the residuals."""
    log_density: Floats
    """``[N, D, M]`` log density of the residuals [1/m^2]."""
    distance: Floats
    """``[N, D]`` smallest squared Mahalanobis distance over the models."""
    likelihood: Floats
    """``[N, D]`` log density of the mixture."""


def start(position: Floats, covariance: Floats, speed: float, models: int) -> FilterState:
    """Return filters at positions ``[N, 2]`` [m] with an unknown velocity of standard deviation ``speed`` [m/s]."""
    N = len(position)
    mean, spread = np.zeros((N, models, 4)), np.zeros((N, models, 4, 4))
    mean[..., :2] = position[:, None]
    spread[..., :2, :2] = covariance[:, None]
    spread[..., 2, 2] = spread[..., 3, 3] = speed**2
    return FilterState(mean, spread, np.full((N, models), 1.0 / models))


def mix(state: FilterState, dt: float, dwell: float) -> FilterState:
    """Return the filters after a change of the motion model with the rate 1 / ``dwell``, over ``dt`` [s]."""
    M = state.mean.shape[1]
    if M == 1 or dt == 0.0:
        return state
    change = (1.0 - math.exp(-dt / dwell)) / (M - 1)
    switch = np.full((M, M), change)
    np.fill_diagonal(switch, 1.0 - change * (M - 1))
    weight = state.weight @ switch
    share = state.weight[:, :, None] * switch[None] / weight[:, None, :]
    mean = np.einsum("nij,nik->njk", share, state.mean)
    away = state.mean[:, :, None] - mean[:, None]
    spread = state.covariance[:, :, None] + away[..., :, None] * away[..., None, :]
    return FilterState(mean, np.einsum("nij,nijkl->njkl", share, spread), weight)


def predict(state: FilterState, dt: float, densities: Floats) -> FilterState:
    """Return the filters ``dt`` [s] later, with white noise of spectral densities ``[M]`` [m^2/s^3] as acceleration."""
    move = np.eye(4)
    move[0, 2] = move[1, 3] = dt
    noise = np.zeros((4, 4))
    noise[0, 0] = noise[1, 1] = dt**3 / 3.0
    noise[0, 2] = noise[2, 0] = noise[1, 3] = noise[3, 1] = dt**2 / 2.0
    noise[2, 2] = noise[3, 3] = dt
    covariance = move @ state.covariance @ move.T + densities[:, None, None] * noise
    return FilterState(state.mean @ move.T, covariance, state.weight)


def innovation(state: FilterState, position: Floats, covariance: Floats) -> Innovation:
    """Return the differences between detections ``[D, 2]`` and filters."""
    residual = position[None, :, None] - state.mean[:, None, :, :2]
    spread = state.covariance[:, None, :, :2, :2] + covariance[None, :, None]
    a, b, c = spread[..., 0, 0], spread[..., 0, 1], spread[..., 1, 1]
    determinant = a * c - b * b
    inverse = np.stack([np.stack([c, -b], -1), np.stack([-b, a], -1)], -2) / determinant[..., None, None]
    x, y = residual[..., 0], residual[..., 1]
    square = (c * x * x - 2.0 * b * x * y + a * y * y) / determinant
    density = -0.5 * (square + np.log(determinant)) - math.log(2.0 * math.pi)
    if density.shape[-1] == 1:
        return Innovation(residual, inverse, density, square[..., 0], density[..., 0])
    top = density.max(axis=-1)
    mixture = top + np.log(np.einsum("nm,ndm->nd", state.weight, np.exp(density - top[..., None])))
    return Innovation(residual, inverse, density, square.min(axis=-1), mixture)


def correct(state: FilterState, found: Innovation, tracks: Ints, targets: Ints) -> FilterState:
    """Return the filters after the detections ``targets`` of the filters ``tracks``."""
    prior = state.covariance[tracks]
    gain = prior[..., :2] @ found.inverse[tracks, targets]
    residual = found.residual[tracks, targets]
    mean, covariance, weight = state.mean.copy(), state.covariance.copy(), state.weight.copy()
    mean[tracks] += np.einsum("kmij,kmj->kmi", gain, residual)
    after = prior - gain @ prior[..., :2, :]
    covariance[tracks] = 0.5 * (after + np.swapaxes(after, -1, -2))
    density = found.log_density[tracks, targets]
    chance = weight[tracks] * np.exp(density - density.max(axis=-1, keepdims=True))
    weight[tracks] = np.maximum(chance / chance.sum(axis=-1, keepdims=True), 1e-6)
    weight /= weight.sum(axis=-1, keepdims=True)
    return FilterState(mean, covariance, weight)


@storable
@dataclass(frozen=True)
class TrackerState:
    """State of a :class:`GlobalNearestNeighbor` with N tracks and M motion models.

    Fields:
        time: time of the last update [s]; NaN before the first.
        next_id: identity of the next track.
        ids: ``[N]`` identities.
        mean, covariance: ``[N, M, 4]``, ``[N, M, 4, 4]`` of x, y, vx, vy by each motion model.
        weight: ``[N, M]`` probability of each motion model.
        existence: ``[N]`` probability that there is a person.
        confirmed: ``[N]`` whether the track is reported.
        last: ``[N]`` time of the last detection [s].
        times: ``[H]`` times of the last updates [s], if a predictor moves the people.
        places: ``[N, H, 2]`` positions after these updates [m]; NaN before the first detection.
    """

    time: float
    next_id: int
    ids: Ints
    mean: Floats
    covariance: Floats
    weight: Floats
    existence: Floats
    confirmed: Bools
    last: Floats
    times: Floats
    places: Floats

    @property
    def filters(self) -> FilterState:
        """Means, covariances and weights of the motion models."""
        return FilterState(self.mean, self.covariance, self.weight)

    def confirmed_tracks(self) -> Tracks:
        """Return the tracks that are reported."""
        kept = self.confirmed
        mean, covariance = self.filters.moments()
        mean, covariance = mean[kept], covariance[kept]
        return Tracks(
            self.time, self.ids[kept], mean[:, :2].copy(), mean[:, 2:].copy(), covariance, self.existence[kept],
            self.last[kept] == self.time,
        )  # fmt: skip

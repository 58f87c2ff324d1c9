"""Kalman filters with nearly constant velocity or acceleration, fitted to recordings."""

from __future__ import annotations

import dataclasses
import math
from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Paper, read_only
from crowdbot.data import Forecast, Windows
from crowdbot.typing import Floats

from .kalman_kernels import filter_rows, predict_variances
from .predictor import Predictor

KALMAN = Paper(
    "Kalman", 1960, "A new approach to linear filtering and prediction problems", "J. Basic Engineering",
    "10.1115/1.3662552",
)  # fmt: skip


@dataclass(frozen=True)
class _Filter(Predictor):
    """Filter of position and n - 1 derivatives; the last derivative is driven by white noise.

    Subclasses define the noise parameters as fields.
    """

    paper: ClassVar[Paper] = KALMAN
    lowest: ClassVar[Mapping[str, float]] = {}
    """Lower bounds of the fit; interpolated recordings have no measurement noise."""
    first_guess: ClassVar[Mapping[str, float]] = {}
    """Initial values of the fit."""

    @property
    @abstractmethod
    def _push(self) -> float:
        """Square root of the spectral density of the driving noise."""

    @property
    @abstractmethod
    def _start(self) -> tuple[float, ...]:
        """Initial standard deviations of position and derivatives."""

    def __post_init__(self) -> None:
        for name in self.lowest:
            value = getattr(self, name)
            if not 0.0 < value < math.inf:
                raise InputError(f"{self.name.partition('(')[0]}: {name} = {value} must be finite and above 0")

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        self.check(past, steps, samples)
        noise = None if past.covariance is None else _rows_first(past.covariance)
        motion, _, spread = self._run_filter(_rows_first(past.position), _rows_first(past.present), past.dt, noise)
        time = past.dt * np.arange(1, steps + 1)[:, None, None]
        terms = [value[:, None] * time**order / math.factorial(order) for order, value in enumerate(motion)]
        place = np.sum(terms[1:], axis=0) + terms[0]
        covariance = self._covariance(spread, past, steps)
        return dataclasses.replace(self.forecast(past, place[:, None]), covariance=covariance)

    def _covariance(self, spread: Floats, past: Windows, steps: int) -> Floats:
        """Return covariances ``[W, T, A, 2, 2]`` [m^2] of predicted positions; 0 for absent agents and known plans."""
        n, (W, A) = len(self._start), spread.shape[:2]
        drift, noise = _step(n, past.dt), self._push**2 * _noise(n, past.dt)
        flat = np.ascontiguousarray(spread).reshape(W * A, *spread.shape[2:])
        ahead = predict_variances(flat, drift, noise, steps).reshape(W, A, steps, *spread.shape[4:])
        found = np.moveaxis(ahead, 2, 1)
        here = np.repeat(past.present[:, -1][:, None], steps, axis=1)
        if past.plan is not None:
            for step in range(1, steps + 1):
                here[:, step - 1] &= np.isnan(past.plan_at(step)).any(axis=-1)
        found = np.where(here[..., None, None], found, 0.0)
        return np.asarray(found * np.eye(2) if found.shape[-1] == 1 else found)

    @classmethod
    def fit(cls, *pasts: Windows) -> Self:
        """Return the maximum-likelihood filter of the observed rows of training windows.

        The likelihood of each row given the previous rows is maximized over the noise parameters with a compass search
        on their logarithms, to a precision of 0.1 %. Robots are excluded.

        Raises:
            InputError: nobody is observed at two rows.
        """
        tracks = [_tracks(past) for past in pasts]
        if sum(len(track.present.T) for track in tracks) == 0:
            raise InputError("kalman: a fit requires at least one person who is observed at two rows")
        best = dict(cls.first_guess)
        cost = cls(**best)._negative_log_likelihood(tracks)
        factor = 4.0
        while factor > 1.001:
            improved = False
            for name in cls.lowest:
                for ratio in (factor, 1.0 / factor):
                    trial = best | {name: max(best[name] * ratio, cls.lowest[name])}
                    value = cls(**trial)._negative_log_likelihood(tracks)
                    if value < cost:
                        best, cost, improved = trial, value, True
            factor = factor if improved else math.sqrt(factor)
        return cls(**best)

    def negative_log_likelihood(self, *pasts: Windows) -> float:
        """Return the mean negative log-likelihood of a row (two coordinates) given the rows before it [nat]."""
        return self._negative_log_likelihood([_tracks(past) for past in pasts])

    def _negative_log_likelihood(self, tracks: list[_Tracks]) -> float:
        total = sum(self._run_filter(*track)[1] for track in tracks)
        rows = sum(int(np.sum(track.present)) - track.present.shape[1] for track in tracks)
        return float(total / rows + math.log(2.0 * math.pi))

    def _run_filter(
        self, position: Floats, present: NDArray[np.bool_], dt: float, covariance: Floats | None = None
    ) -> tuple[list[Floats], float, Floats]:
        """Return position and derivatives ``[..., 2]`` after the rows, the negative log-likelihood and the covariance.

        The covariance is ``[..., n, n, 2, 2]``; without covariances ``[T, ..., 2, 2]`` of the measured positions x and
        y have the same variances, ``[..., n, n, 1, 1]``.
        """
        n, shape = len(self._start), present.shape[1:]
        one = np.eye(1 if covariance is None else 2)
        measured = np.broadcast_to(self._start[0] ** 2 * one, (len(position), *shape, *one.shape))
        if covariance is not None:
            measured = np.where(np.isnan(covariance), measured, covariance)
        rows, size = len(position), len(one)
        motion, surprise, spread = filter_rows(
            np.ascontiguousarray(position).reshape(rows, -1, 2), np.ascontiguousarray(present).reshape(rows, -1),
            read_only(measured).reshape(rows, -1, size, size), _step(n, dt),
            self._push**2 * _noise(n, dt), np.array(self._start),
        )  # fmt: skip
        moved = motion.reshape(*shape, n, 2)
        return [moved[..., i, :] for i in range(n)], float(surprise.sum()), spread.reshape(*shape, n, n, size, size)


@dataclass(frozen=True)
class Kalman(_Filter):
    """Kalman filter with nearly constant velocity (white acceleration noise).

    Position and velocity are filtered over the observed rows; the forecast has constant velocity. Missing rows are
    skipped. The velocity of people observed once is zero. Deterministic: K = 1. The forecast has the covariance of the
    predicted positions. Where the windows have covariances of the measured positions, they replace ``measurement``;
    without them, x and y are independent.

    Fields:
        acceleration: square root of the spectral density of the acceleration [m s^-1.5].
        measurement: standard deviation of a measured coordinate [m], where the windows have no covariance.
        speed: initial standard deviation of a velocity component [m/s].

    The defaults are the maximum-likelihood values for six recordings outside the five ETH/UCY test sets: the training
    parts of zara03 and uni_examples (leave-one-out files), and hyang_4 to hyang_7 of the Stanford Drone
    Dataset in the TrajNet cut, all by ``Kalman.fit(*[load(file).windows()[0] for file in files])``. The first
    two alone, which are interpolated, give 0.173, 0.0026 and 0.845; the other four 0.328, 0.0543 and 0.783: fit the
    filter to your own tracker.

    Paper: Kalman (1960), doi 10.1115/1.3662552.

    >>> import numpy as np
    >>> here = np.ones((1, 3, 1), dtype=bool)
    >>> past = Windows(np.array([[[[0.0, 0.0]], [[0.5, 0.0]], [[1.0, 0.0]]]]), here, ~here[:, 0], ~here[:, 0],
    ...     np.array([[7]]), np.array([[0, 10, 20]]), 0.4, "all", "street")
    >>> Kalman().predict(past, 2).position[0, 0, :, 0, 0].round(2).tolist()
    [1.5, 2.0]
    """

    acceleration: float = 0.266
    measurement: float = 0.0365
    speed: float = 0.815

    lowest: ClassVar[Mapping[str, float]] = {"acceleration": 1e-4, "measurement": 1e-4, "speed": 1e-2}
    first_guess: ClassVar[Mapping[str, float]] = {"acceleration": 0.3, "measurement": 0.02, "speed": 1.0}
    batched = True

    @property
    def _push(self) -> float:
        return self.acceleration

    @property
    def _start(self) -> tuple[float, ...]:
        return self.measurement, self.speed


@dataclass(frozen=True)
class KalmanAcceleration(_Filter):
    """Kalman filter with nearly constant acceleration (white jerk noise).

    Otherwise as :class:`Kalman`. It follows tracks more closely than the filter with constant velocity, but its errors
    grow quickly beyond the first second. Included for comparison.

    Fields:
        jerk: square root of the spectral density of the jerk [m s^-2.5].
        measurement: standard deviation of a measured coordinate [m].
        speed: initial standard deviation of a velocity component [m/s].
        acceleration: initial standard deviation of an acceleration component [m/s^2].

    The defaults are the maximum-likelihood values for the six recordings of :class:`Kalman`. The last value is the
    lower bound of the fit. The mean log-likelihood per row is below that of
    :class:`Kalman` (1.374 against 1.482 nat).

    Paper: Kalman (1960), doi 10.1115/1.3662552.

    >>> import numpy as np
    >>> here = np.ones((1, 4, 1), dtype=bool)
    >>> path = np.array([0.0, 1.0, 4.0, 9.0])[None, :, None, None] * np.array([1.0, 0.0])
    >>> past = Windows(path, here, ~here[:, 0], ~here[:, 0], np.array([[7]]), np.arange(4)[None], 1.0, "all", "street")
    >>> exact = KalmanAcceleration(jerk=1e-3, measurement=1e-3, speed=10.0, acceleration=10.0)
    >>> exact.predict(past, 2).position[0, 0, :, 0, 0].round(2).tolist()
    [16.0, 25.0]
    """

    jerk: float = 0.174
    measurement: float = 0.0495
    speed: float = 0.825
    acceleration: float = 0.001

    lowest: ClassVar[Mapping[str, float]] = {"jerk": 1e-4, "measurement": 1e-4, "speed": 1e-2, "acceleration": 1e-3}
    first_guess: ClassVar[Mapping[str, float]] = {"jerk": 0.3, "measurement": 0.02, "speed": 1.0, "acceleration": 0.3}
    batched = True

    @property
    def _push(self) -> float:
        return self.jerk

    @property
    def _start(self) -> tuple[float, ...]:
        return self.measurement, self.speed, self.acceleration


class _Tracks(NamedTuple):
    """Rows of N people: ``position [T, N, 2]`` [m], ``present [T, N]``, ``dt`` [s]."""

    position: Floats
    present: NDArray[np.bool_]
    dt: float


def _tracks(past: Windows) -> _Tracks:
    who = (past.present.sum(axis=1) > 1) & ~past.robot
    chosen = np.nonzero(who)
    return _Tracks(
        np.swapaxes(past.position[chosen[0], :, chosen[1]], 0, 1),
        past.present[chosen[0], :, chosen[1]].T,
        past.dt,
    )


def _step(n: int, dt: float) -> Floats:
    """Return the transition matrix ``[n, n]`` of one row."""
    return np.array([[dt ** (j - i) / math.factorial(j - i) if j >= i else 0.0 for j in range(n)] for i in range(n)])


def _noise(n: int, dt: float) -> Floats:
    """Return the process noise covariance ``[n, n]`` of one row for unit density."""
    left = [n - 1 - i for i in range(n)]
    return np.array(
        [[dt ** (p + q + 1) / ((p + q + 1) * math.factorial(p) * math.factorial(q)) for q in left] for p in left]
    )


def _rows_first(values: NDArray) -> NDArray:  # type: ignore[type-arg]
    return np.swapaxes(values, 0, 1)

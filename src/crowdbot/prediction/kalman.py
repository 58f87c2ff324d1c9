"""A Kalman filter of people who walk with a nearly constant velocity, and the fit of its noise to recordings."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Paper
from crowdbot.data.forecast import Forecast
from crowdbot.data.windows import Windows

from .predictor import Predictor

__all__ = ["Kalman"]

Floats = NDArray[np.float64]

LOWEST = {"acceleration": 1e-4, "measurement": 1e-4, "speed": 1e-2}
"""Smallest noise that the fit tries; interpolated recordings have no measurement noise of their own."""
FIRST_GUESS = {"acceleration": 0.3, "measurement": 0.02, "speed": 1.0}
"""Where the fit begins."""


@dataclass(frozen=True)
class Kalman(Predictor):
    """Everyone's position and velocity are filtered over the observed rows, then the velocity is kept.

    The velocity is driven by white acceleration; x and y are independent and alike. Missing rows are bridged.
    Deterministic: K = 1.

    Fields:
        acceleration: root of the spectral density of the acceleration [m s^-1.5].
        measurement: standard deviation of a measured coordinate [m].
        speed: standard deviation of a velocity component before anything is seen of the motion [m/s].

    The defaults are the most likely ones for six recordings that are in none of the five ETH/UCY test sets: the
    training parts of zara03 and uni_examples (leave-one-out files), and hyang_4 to hyang_7 of the Stanford Drone
    Dataset in the TrajNet cut, all by ``Kalman.fit(*[load(file, fps=2.5).windows()[0] for file in files])``. The first
    two alone, which are interpolated, give 0.173, 0.0026 and 0.845; the other four 0.328, 0.0543 and 0.783: fit your
    own tracker.

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

    paper: ClassVar[Paper] = Paper(
        "Kalman", 1960, "A new approach to linear filtering and prediction problems", "J. Basic Engineering",
        "10.1115/1.3662552",
    )  # fmt: skip

    def __post_init__(self) -> None:
        for name in LOWEST:
            value = getattr(self, name)
            if not 0.0 < value < math.inf:
                raise InputError(f"kalman: {name} = {value} must be finite and above 0")

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        """Return where people will be, see :meth:`Predictor.predict`."""
        self.check(past, steps, samples)
        place, velocity, _ = self._filtered(_rows_first(past.position), _rows_first(past.present), past.dt)
        time = past.dt * np.arange(1, steps + 1)
        return self.forecast(past, (place[:, None] + velocity[:, None] * time[:, None, None])[:, None])

    @classmethod
    def fit(cls, *pasts: Windows) -> Kalman:
        """Return the filter under which the observed rows of training windows are most likely.

        The likelihood of every row given the rows before it is maximised over the three parameters with a compass
        search on their logarithms, down to 0.1 %.

        Raises:
            InputError: nobody is seen at two rows.
        """
        tracks = [_tracks(past) for past in pasts]
        if sum(len(track.present.T) for track in tracks) == 0:
            raise InputError("kalman: a fit needs at least one person who is seen at two rows")
        names = list(LOWEST)
        best = dict(FIRST_GUESS)
        cost = _surprise(cls(**best), tracks)
        factor = 4.0
        while factor > 1.001:
            improved = False
            for name in names:
                for ratio in (factor, 1.0 / factor):
                    trial = best | {name: max(best[name] * ratio, LOWEST[name])}
                    value = _surprise(cls(**trial), tracks)
                    if value < cost:
                        best, cost, improved = trial, value, True
            factor = factor if improved else math.sqrt(factor)
        return cls(**best)

    def surprise(self, *pasts: Windows) -> float:
        """Return the mean negative log-likelihood of a row (two coordinates) given the rows before it [nat]."""
        return _surprise(self, [_tracks(past) for past in pasts])

    def _filtered(self, position: Floats, present: NDArray[np.bool_], dt: float) -> tuple[Floats, Floats, float]:
        """Return place and velocity ``[..., 2]`` after the rows ``[T, ..., 2]``, and the sum of the surprise."""
        q, r = self.acceleration**2, self.measurement**2
        place, velocity = np.zeros(position.shape[1:]), np.zeros(position.shape[1:])
        started = np.zeros(present.shape[1:], dtype=np.bool_)
        pp, pv, vv = np.full(started.shape, r), np.zeros(started.shape), np.full(started.shape, self.speed**2)
        surprise = 0.0
        for seen, here in zip(position, present, strict=True):
            place = place + velocity * dt
            pp = np.where(started, pp + dt * (2.0 * pv + dt * vv) + q * dt**3 / 3.0, r)
            pv = np.where(started, pv + dt * vv + q * dt**2 / 2.0, 0.0)
            vv = np.where(started, vv + q * dt, vv)
            update = started & here
            spread = pp + r
            wrong = np.where(update[..., None], seen - place, 0.0)
            length2 = wrong[..., 0] ** 2 + wrong[..., 1] ** 2
            surprise += float(np.sum(np.where(update, np.log(spread) + length2 / (2.0 * spread), 0.0)))
            gain_p, gain_v = np.where(update, pp / spread, 0.0), np.where(update, pv / spread, 0.0)
            place, velocity = place + gain_p[..., None] * wrong, velocity + gain_v[..., None] * wrong
            pp, pv, vv = pp * (1.0 - gain_p), pv * (1.0 - gain_p), vv - gain_v * pv
            first = here & ~started
            place = np.where(first[..., None], seen, place)
            started |= here
        return place, velocity, surprise


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


def _surprise(filter_: Kalman, tracks: list[_Tracks]) -> float:
    total = sum(filter_._filtered(*track)[2] for track in tracks)
    rows = sum(int(np.sum(track.present)) - track.present.shape[1] for track in tracks)
    return float(total / rows + math.log(2.0 * math.pi))


def _rows_first(values: NDArray) -> NDArray:  # type: ignore[type-arg]
    return np.swapaxes(values, 0, 1)

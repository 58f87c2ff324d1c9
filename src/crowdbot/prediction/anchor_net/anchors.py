"""Anchors: a constant velocity plus a fixed set of bends, the same for everybody; the floor of learned predictors."""

from __future__ import annotations

import dataclasses
import warnings
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Paper, stream
from crowdbot.data import Forecast, Windows
from crowdbot.prediction.constant import SampledConstantVelocity
from crowdbot.prediction.predictor import Predictor
from crowdbot.prediction.pretrained_weights import ALL, AUTO, STEP, check_fold, fold_of, learned, misfit

from .agent_frame import AHEAD, forward, people_of, turned

__all__ = ["Anchors", "centres", "residuals", "scattered", "spread_over_time"]

Floats = NDArray[np.float64]

CHAI = Paper(
    "MultiPath", 2019, "MultiPath: multiple probabilistic anchor trajectory hypotheses for behavior prediction",
    "CoRL", "10.48550/arXiv.1910.05449",
)  # fmt: skip
POINTS = 8000
"""The centres are looked for among so many residuals at most."""


@dataclass(frozen=True)
class Anchors(Predictor):
    """Everyone goes on with the last displacement, bent in 20 fixed ways in their own frame: no network at all.

    The ways are the centres of what constant velocity missed in training recordings, sorted by how often each was the
    nearest; these shares are the weights of the forecast. Fewer samples are the likeliest ways; more than there are
    are not given. Best of 20 mostly rewards covering the plane well, so a learned predictor is worth something only
    below this one.

    Fields:
        fold: which shipped set is used: the one learned without this place (``eth``, ``hotel``, ``univ``, ``zara1``,
            ``zara2``), ``all`` recordings, or ``auto``: the one without the place that the recording is named after,
            else ``all``.
        shapes: ``[K, 12, 2]`` [m] own bends at steps of 0.4 s, see :meth:`fit`; None means the shipped ones.
        share: ``[K]`` how often each is the nearest.

    Rows at other time steps up to 0.7 s are interpolated; beyond the 12th step of 0.4 s the bend stays as it is, and
    somebody seen once stands.

    Paper: the idea of fixed anchors, Chai et al. (2019), arXiv 1910.05449.
    """

    fold: str = AUTO
    shapes: Floats | None = None
    share: Floats | None = None

    paper: ClassVar[Paper] = CHAI

    def __post_init__(self) -> None:
        check_fold(self.fold)
        if (self.shapes is None) != (self.share is None):
            raise InputError("anchors: shapes and share belong together")
        if self.shapes is not None and self.share is not None and (
            self.shapes.ndim != 3 or self.shapes.shape[1:] != (AHEAD, 2) or self.share.shape != self.shapes.shape[:1]
        ):  # fmt: skip
            raise InputError(f"anchors: shapes {list(self.shapes.shape)} must be [K, {AHEAD}, 2] and share [K]")

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        """Return where people will be, see :meth:`Predictor.predict`."""
        self.check(past, steps, samples)
        why = misfit(past)
        if why:
            warnings.warn(f"anchors: {why}; sampled constant velocity answers instead", stacklevel=2)
            return SampledConstantVelocity().predict(past, steps, samples, rng)
        shapes, share = self._chosen(past)
        people, window, slot = people_of(past)
        bend = turned(np.broadcast_to(shapes[:samples], (len(window), *shapes[:samples].shape)), forward(people.past),
                      back=True)  # fmt: skip
        bend = np.where((people.seen.sum(axis=1) > 1)[:, None, None, None], bend, 0.0)
        step = people.past[:, -1] - people.past[:, -2]
        path = scattered(past, spread_over_time(bend, step, steps, past.dt), window, slot)
        forecast = self.forecast(past, path)
        weight = share[:samples] / share[:samples].sum()
        return dataclasses.replace(forecast, weight=np.broadcast_to(weight, forecast.weight.shape).copy())

    def _chosen(self, past: Windows) -> tuple[Floats, Floats]:
        if self.shapes is not None and self.share is not None:
            return self.shapes, self.share
        found = learned("anchors", fold_of(past.source) if self.fold == AUTO else self.fold)
        return found["shapes"], found["share"]

    def note(self, past: Windows) -> str:
        """Return what a user should know of forecasts of such windows in one sentence, or nothing."""
        why = misfit(past)
        if why:
            return f"anchors: {why}; a baseline answers instead"
        if self.shapes is None and self.fold == AUTO and fold_of(past.source) == ALL:
            return f"anchors: {past.source} is none of the five places, so the shapes of all of them are used"
        return ""

    @classmethod
    def fit(cls, *pairs: tuple[Windows, Windows], count: int = 20, seed: int = 0) -> Self:
        """Return the anchors of training windows, pairs of past and future as :meth:`Trajectories.windows` cuts them.

        Raises:
            InputError: fewer than ``count`` people are scored over 12 rows at steps of 0.4 s.
        """
        missed = np.concatenate([residuals(*pair) for pair in pairs]) if pairs else np.zeros((0, AHEAD, 2))
        if len(missed) < count:
            raise InputError(f"anchors: {len(missed)} futures of 12 rows are too few for {count} shapes")
        both = np.concatenate([missed, missed * np.array([1.0, -1.0])])
        found, share = centres(both.reshape(len(both), -1), count, seed)
        return cls(shapes=found.reshape(count, AHEAD, 2), share=share)


def residuals(past: Windows, future: Windows) -> Floats:
    """Return what constant velocity misses ``[N, 12, 2]`` [m] in the own frames of everyone scored over all 12 rows."""
    if future.present.shape[1] != AHEAD or abs(past.dt - STEP) > 1e-6:
        raise InputError(
            f"learning needs 12 rows ahead at steps of {STEP} s, not {future.present.shape[1]} of {past.dt:.4g} s"
        )
    people, window, slot = people_of(past)
    kept = future.scored[window, slot] & future.present[window, :, slot].all(axis=1)
    people, window, slot = people.at(np.flatnonzero(kept)), window[kept], slot[kept]
    ahead = future.position[window, :, slot] - past.position[window, -1, slot][:, None]
    step = people.past[:, -1] - people.past[:, -2]
    return turned(ahead - step[:, None] * np.arange(1.0, AHEAD + 1.0)[:, None], forward(people.past))


def centres(points: Floats, count: int, seed: int = 0, rounds: int = 60, starts: int = 2) -> tuple[Floats, Floats]:
    """Return ``count`` centres of points ``[N, D]``, the ones most points are near to first, and these shares.

    Lloyd's rounds after a k-means++ start; the best of the starts is kept.
    """
    rng = stream(seed, "anchors")
    if len(points) > POINTS:
        points = points[rng.permutation(len(points))[:POINTS]]
    best: tuple[float, Floats, Floats] | None = None
    for _ in range(starts):
        place = _start(points, count, rng)
        for _ in range(rounds):
            near = np.argmin(_squared(points, place), axis=1)
            size = np.bincount(near, minlength=count)
            mean = np.stack([np.bincount(near, column, count) for column in points.T], axis=1)
            place = np.where(size[:, None] > 0, mean / np.maximum(size, 1)[:, None], place)
        squared = _squared(points, place)
        cost = float(squared.min(axis=1).sum())
        if best is None or cost < best[0]:
            share = np.bincount(np.argmin(squared, axis=1), minlength=count) / len(points)
            best = cost, place, share
    assert best is not None
    order = np.argsort(-best[2], kind="stable")
    share = np.maximum(best[2][order], 1e-6)
    return best[1][order], share / share.sum()


def spread_over_time(bend: Floats, step: Floats, steps: int, dt: float) -> Floats:
    """Return displacements ``[N, K, steps, 2]`` [m] at rows of ``dt`` of a constant velocity plus bends.

    Args:
        bend: ``[N, K, 12, 2]`` [m] at steps of 0.4 s; between them it is interpolated, later it stays.
        step: ``[N, 2]`` [m] last displacement in 0.4 s.
        steps, dt: rows asked for, and the time between them [s].
    """
    time = np.arange(1, steps + 1) * (dt / STEP)
    time = np.where(np.abs(time - np.rint(time)) < 1e-6, np.rint(time), time)
    known = np.concatenate([np.zeros_like(bend[:, :, :1]), bend], axis=2)
    low = np.minimum(time.astype(np.int64), AHEAD)
    high = np.minimum(low + 1, AHEAD)
    share = np.where(low < AHEAD, time - low, 0.0)[:, None]
    bent = known[:, :, low] + share * (known[:, :, high] - known[:, :, low])
    return np.asarray(step[:, None, None] * time[:, None] + bent)


def scattered(past: Windows, away: Floats, window: NDArray[np.int64], slot: NDArray[np.int64]) -> Floats:
    """Return positions ``[W, K, T, A, 2]`` [m] of displacements ``[N, K, T, 2]`` from the last places."""
    W, A = past.present.shape[0], past.present.shape[2]
    path = np.zeros((W, *away.shape[1:3], A, 2))
    path[window, :, :, slot] = past.position[window, -1, slot][:, None, None] + away
    return path


def _start(points: Floats, count: int, rng: np.random.Generator) -> Floats:
    """Return ``count`` of the points, far from each other (k-means++)."""
    place: Floats = points[int(rng.integers(len(points)))][None]
    nearest = _squared(points, place)[:, 0]
    for _ in range(count - 1):
        share = np.cumsum(nearest)
        row = min(int(np.searchsorted(share, rng.random() * share[-1])), len(points) - 1)
        new = points[row][None]
        nearest = np.minimum(nearest, _squared(points, new)[:, 0])
        place = np.concatenate([place, new])
    return np.asarray(place)


def _squared(points: Floats, place: Floats) -> Floats:
    return np.asarray(np.stack([((points - one) ** 2).sum(axis=1) for one in place], axis=1))

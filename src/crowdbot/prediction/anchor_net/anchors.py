"""Anchors: constant velocity plus a fixed set of residuals, the baseline of learned predictors."""

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
from crowdbot.prediction.pretrained_weights import (
    AUTO,
    OPEN,
    STEP,
    check_fold,
    fold_of,
    incompatibility,
    load_pretrained,
)
from crowdbot.typing import Floats

from .agent_frame import HISTORY, PREDICTED_ROWS, agent_histories, heading_vectors, rotate

CHAI = Paper(
    "MultiPath", 2019, "MultiPath: multiple probabilistic anchor trajectory hypotheses for behavior prediction",
    "CoRL", "10.48550/arXiv.1910.05449",
)  # fmt: skip
POINTS = 8000
"""Maximum number of residuals for the clustering."""


@dataclass(frozen=True)
class Anchors(Predictor):
    """Constant velocity plus 20 fixed residuals in each person's frame, without a network.

    The residuals are cluster centers of the errors of constant velocity in training recordings, sorted by cluster
    size; the relative cluster sizes are the weights of the forecast. K is at most 20; smaller K selects the most
    frequent ones. Best-of-20 errors mostly measure the coverage of the plane: a learned predictor is useful only if it
    has lower errors than this one.

    Fields:
        fold: shipped set: trained without a place (``eth``, ``hotel``, ``univ``, ``zara1``, ``zara2``), with ``all``
            places, ``open``: with UCY, the Jülich archive and simulated crowds only, or ``auto``: without the place of
            the recording, by its name, else ``open``.
        shapes: ``[K, 12, 2]`` [m] own residuals at steps of 0.4 s, see :meth:`fit`; None means the shipped set.
        share: ``[K]`` relative cluster sizes.

    Other time steps up to 0.7 s are interpolated. Beyond 12 steps of 0.4 s the residual is constant. People observed
    once have a constant position.

    Paper: the idea of fixed anchors, Chai et al. (2019), arXiv 1910.05449.
    """

    fold: str = AUTO
    shapes: Floats | None = None
    share: Floats | None = None

    paper: ClassVar[Paper] = CHAI
    history: ClassVar[float] = HISTORY
    batched = draws = learned = True

    def __post_init__(self) -> None:
        check_fold(self.fold)
        if (self.shapes is None) != (self.share is None):
            raise InputError("anchors: shapes and share belong together")
        if (
            self.shapes is not None
            and self.share is not None
            and (self.shapes.shape[1:] != (PREDICTED_ROWS, 2) or self.share.shape != self.shapes.shape[:1])
        ):
            raise InputError(
                f"anchors: shapes {list(self.shapes.shape)} must be [K, {PREDICTED_ROWS}, 2] and share [K]"
            )

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        self.check(past, steps, samples)
        why = incompatibility(past)
        if why:
            warnings.warn(f"anchors: {why}; sampled constant velocity is used instead", stacklevel=2)
            return SampledConstantVelocity().predict(past, steps, samples, rng)
        shapes, share = self._anchors(past)
        people, window, slot = agent_histories(past)
        residual = np.broadcast_to(shapes[:samples], (len(window), *shapes[:samples].shape))
        bend = rotate(residual, heading_vectors(people.past), back=True)
        bend = np.where((people.seen.sum(axis=1) > 1)[:, None, None, None], bend, 0.0)
        step = people.past[:, -1] - people.past[:, -2]
        path = scatter_to_slots(past, resample_paths(bend, step, steps, past.dt), window, slot)
        forecast = self.forecast(past, path)
        weight = share[:samples] / share[:samples].sum()
        return dataclasses.replace(forecast, weight=np.broadcast_to(weight, forecast.weight.shape).copy())

    def _anchors(self, past: Windows) -> tuple[Floats, Floats]:
        if self.shapes is not None and self.share is not None:
            return self.shapes, self.share
        found = load_pretrained("anchors", fold_of(past.source) if self.fold == AUTO else self.fold)
        return found["shapes"], found["share"]

    def note(self, past: Windows) -> str:
        why = incompatibility(past)
        if why:
            return f"anchors: {why}; a baseline is used instead"
        if self.shapes is None and self.fold == AUTO and fold_of(past.source) == OPEN:
            return (
                f"anchors: {past.source} is not named after a training place; using those of UCY, the Jülich archive"
                " and simulations"
            )
        return ""

    @classmethod
    def fit(cls, *pairs: tuple[Windows, Windows], count: int = 20, seed: int = 0) -> Self:
        """Return the anchors of training windows, pairs of past and future from :meth:`Trajectories.windows`.

        Raises:
            InputError: fewer than ``count`` people with 12 future rows at steps of 0.4 s.
        """
        return cls.fit_residuals(
            np.concatenate([residuals(*pair) for pair in pairs]) if pairs else np.zeros((0, PREDICTED_ROWS, 2)),
            count, seed,
        )  # fmt: skip

    @classmethod
    def fit_residuals(cls, missed: Floats, count: int = 20, seed: int = 0) -> Self:
        """Return the anchors of residuals ``[N, 12, 2]`` [m] to constant velocity, in the frames of people.

        Raises:
            InputError: fewer than ``count`` people.
        """
        if len(missed) < count:
            raise InputError(f"anchors: {len(missed)} futures of 12 rows are too few for {count} shapes")
        both = np.concatenate([missed, missed * np.array([1.0, -1.0])])
        found, share = cluster_centers(both.reshape(len(both), -1), count, seed)
        return cls(shapes=found.reshape(count, PREDICTED_ROWS, 2), share=share)


def residuals(past: Windows, future: Windows) -> Floats:
    """Return residuals to constant velocity ``[N, 12, 2]`` [m], in the frames of people with 12 future rows."""
    if future.present.shape[1] != PREDICTED_ROWS or abs(past.dt - STEP) > 1e-6:
        raise InputError(
            f"training requires 12 future rows at steps of {STEP} s, not {future.present.shape[1]} of {past.dt:.4g} s"
        )
    people, window, slot = agent_histories(past)
    kept = future.scored[window, slot] & future.present[window, :, slot].all(axis=1)
    people, window, slot = people.at(np.flatnonzero(kept)), window[kept], slot[kept]
    ahead = future.position[window, :, slot] - past.position[window, -1, slot][:, None]
    step = people.past[:, -1] - people.past[:, -2]
    return rotate(ahead - step[:, None] * np.arange(1.0, PREDICTED_ROWS + 1.0)[:, None], heading_vectors(people.past))


def cluster_centers(points: Floats, count: int, seed: int = 0) -> tuple[Floats, Floats]:
    """Return ``count`` cluster centers of points ``[N, D]``, sorted by cluster size, and the relative sizes.

    k-means with k-means++ initialization and 60 iterations; the best of two starts.
    """
    rng = stream(seed, "anchors")
    if len(points) > POINTS:
        points = points[rng.permutation(len(points))[:POINTS]]
    best: tuple[float, Floats, Floats] | None = None
    for _ in range(2):
        place = _start(points, count, rng)
        for _ in range(60):
            near = np.argmin(_squared_distances(points, place), axis=1)
            size = np.bincount(near, minlength=count)
            mean = np.stack([np.bincount(near, column, count) for column in points.T], axis=1)
            place = np.where(size[:, None] > 0, mean / np.maximum(size, 1)[:, None], place)
        squared = _squared_distances(points, place)
        cost = float(squared.min(axis=1).sum())
        if best is None or cost < best[0]:
            share = np.bincount(np.argmin(squared, axis=1), minlength=count) / len(points)
            best = cost, place, share
    assert best is not None
    order = np.argsort(-best[2], kind="stable")
    share = np.maximum(best[2][order], 1e-6)
    return best[1][order], share / share.sum()


def resample_paths(bend: Floats, step: Floats, steps: int, dt: float) -> Floats:
    """Return displacements ``[N, K, steps, 2]`` [m] at time steps ``dt`` of constant velocity plus residuals.

    Args:
        bend: ``[N, K, 12, 2]`` [m] at steps of 0.4 s, interpolated linearly and constant beyond the last step.
        step: ``[N, 2]`` [m] last displacement in 0.4 s.
        steps: number of rows.
        dt: time step [s].
    """
    time = np.arange(1, steps + 1) * (dt / STEP)
    time = np.where(np.abs(time - np.rint(time)) < 1e-6, np.rint(time), time)
    known = np.concatenate([np.zeros_like(bend[:, :, :1]), bend], axis=2)
    low = np.minimum(time.astype(np.int64), PREDICTED_ROWS)
    high = np.minimum(low + 1, PREDICTED_ROWS)
    share = np.where(low < PREDICTED_ROWS, time - low, 0.0)[:, None]
    bent = known[:, :, low] + share * (known[:, :, high] - known[:, :, low])
    return np.asarray(step[:, None, None] * time[:, None] + bent)


def scatter_to_slots(past: Windows, away: Floats, window: NDArray[np.int64], slot: NDArray[np.int64]) -> Floats:
    """Return positions ``[W, K, T, A, 2]`` [m] from displacements ``[N, K, T, 2]`` [m]."""
    W, A = past.present.shape[0], past.present.shape[2]
    path = np.zeros((W, *away.shape[1:3], A, 2))
    path[window, :, :, slot] = past.position[window, -1, slot][:, None, None] + away
    return path


def _start(points: Floats, count: int, rng: np.random.Generator) -> Floats:
    """Return ``count`` initial centers (k-means++)."""
    place: Floats = points[int(rng.integers(len(points)))][None]
    nearest = _squared_distances(points, place)[:, 0]
    for _ in range(count - 1):
        share = np.cumsum(nearest)
        row = min(int(np.searchsorted(share, rng.random() * share[-1])), len(points) - 1)
        new = points[row][None]
        nearest = np.minimum(nearest, _squared_distances(points, new)[:, 0])
        place = np.concatenate([place, new])
    return np.asarray(place)


def _squared_distances(points: Floats, place: Floats) -> Floats:
    return np.asarray(np.stack([((points - item) ** 2).sum(axis=1) for item in place], axis=1))

"""Forecasts, errors and results by frame, window by window."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.calibration import Fit
from crowdbot.core import stream
from crowdbot.data import Forecast, Windows
from crowdbot.metrics import PersonErrors, person_errors
from crowdbot.prediction import Predictor


@dataclass(frozen=True)
class FrameResults:
    """Results by frame, ``[W]`` each; a frame is the last observed row of a window.

    Fields:
        frame: frame number in the recording.
        people: number of people present.
        cost: cost of the calibrated crowd [m]; NaN without calibration.
        evaluations: number of simulated candidate crowds.
        seconds: prediction time [s]; an equal share if windows were predicted together.
        ade, fde: mean error over the scored people of the window [m].
    """

    frame: NDArray[np.int64]
    people: NDArray[np.int64]
    cost: NDArray[np.float64]
    evaluations: NDArray[np.int64]
    seconds: NDArray[np.float64]
    ade: NDArray[np.float64]
    fde: NDArray[np.float64]

    @property
    def calibrated(self) -> bool:
        """Whether a crowd was calibrated for these frames."""
        return bool(np.any(self.evaluations > 0))

    @classmethod
    def concatenate(cls, parts: Sequence[FrameResults]) -> FrameResults:
        """Return the frames of several results, in order."""
        names = [field.name for field in dataclasses.fields(cls)]
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


@dataclass(frozen=True)
class WindowResults:
    """Results of a range of windows.

    Fields:
        first, last: range of the windows.
        forecast: forecast of these windows.
        errors: errors of the scored people, window by window.
        frames: results by frame.
        fit: fit of a calibrated crowd, or None.
    """

    first: int
    last: int
    forecast: Forecast
    errors: PersonErrors
    frames: FrameResults
    fit: Fit | None


def predict_windows(
    predictor: Predictor,
    past: Windows,
    future: Windows,
    samples: int = 1,
    best_of: str = "person",
    seed: int = 0,
    live: bool = False,
    size: int = 1,
    first: int = 0,
    last: int | None = None,
) -> Iterator[WindowResults]:
    """Predict windows in order and yield their results.

    The results do not depend on ``size`` and ``first``, except the times and those of ``live`` prediction. One
    prediction is made before the first window, which excludes the compilation of kernels from the times.

    Args:
        predictor: the predictor.
        past, future: windows of the same people.
        samples: number of futures per person.
        best_of: rule that selects the best future, see :func:`~crowdbot.metrics.best_of`.
        seed: seed of all random draws.
        live: each calibration starts from the fit of the windows before.
        size: number of windows that are predicted together.
        first, last: range of windows (default: all).

    >>> from crowdbot.data import Trajectories
    >>> from crowdbot.prediction import ConstantVelocity
    >>> tracks = Trajectories([7] * 5, range(5), [0.0, 0.5, 1.0, 1.5, 2.5], [0.0] * 5, row_rate=2.5)
    >>> parts = predict_windows(ConstantVelocity(), *tracks.windows(observe=2, predict=2))
    >>> [round(float(part.frames.ade[0]), 2) for part in parts]
    [0.0, 0.25]
    """
    rng = stream(seed, "predict")
    rng.integers(0, 2**63, size=first)  # one number per window: results do not depend on the first one
    predictor.follow(past[:1], future.position.shape[1], samples, stream(seed, "warm"))
    memory = None
    end = len(past) if last is None else last
    for start in range(first, end, size):
        part = slice(start, min(start + size, end))
        begin = time.perf_counter()
        forecast, memory = predictor.follow(
            past[part], future.position.shape[1], samples, rng, memory if live else None
        )
        seconds = (time.perf_counter() - begin) / len(past[part])
        errors = person_errors(forecast, future[part], best_of, past[part])
        fit = memory if isinstance(memory, Fit) else None
        frames = _frame_results(past[part], future[part], errors, fit, seconds)
        yield WindowResults(part.start, part.stop, forecast, errors, frames, fit)


def _frame_results(
    past: Windows, future: Windows, errors: PersonErrors, fit: Fit | None, seconds: float
) -> FrameResults:
    W = len(past)
    window = np.repeat(np.arange(W), future.scored.sum(axis=1))
    count = np.bincount(window, minlength=W)

    def mean(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.where(count > 0, np.bincount(window, values, W) / np.maximum(count, 1), np.nan)

    return FrameResults(
        frame=past.frame[:, -1],
        people=past.present[:, -1].sum(axis=1),
        cost=np.full(W, np.nan) if fit is None else fit.cost,
        evaluations=np.zeros(W, dtype=np.int64) if fit is None else fit.evaluations,
        seconds=np.full(W, seconds),
        ade=mean(errors.ade),
        fde=mean(errors.fde),
    )

"""Forecasts of tracked people that take the uncertainty of the tracks into account."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from crowdbot.core import InputError, stream
from crowdbot.data import Forecast, Windows
from crowdbot.prediction import Predictor
from crowdbot.typing import Floats


def predict_uncertain(
    predictor: Predictor, past: Windows, covariance: Floats, steps: int, samples: int = 20,
    rng: np.random.Generator | None = None,
) -> Forecast:  # fmt: skip
    """Return a forecast from samples of the past of tracked people.

    In each sample, the state of each person at the last row is drawn from the track: its error of the position shifts
    the whole past, and its error of the velocity grows with the time before the last row. The first sample is the past
    itself. Each sample of the past has one sample of the forecast.

    Args:
        predictor: any predictor.
        past: one window of tracked people, with the last row at the time of the tracks.
        covariance: ``[A, 4, 4]`` of x, y [m], vx, vy [m/s] of the tracks; 0 for known states, such as robots.
        steps: number of predicted rows.
        samples: number of futures.
        rng: random generator; default: ``stream(0, "predict")``.

    Raises:
        InputError: several windows, or covariances of another shape.

    >>> from crowdbot.prediction import ConstantVelocity
    >>> here = np.ones((1, 2, 1), dtype=bool)
    >>> past = Windows(np.array([[[[0.0, 0.0]], [[0.4, 0.0]]]]), here, ~here[:, 0], ~here[:, 0], np.array([[7]]),
    ...     np.array([[0, 10]]), 0.4, "all", "street")
    >>> forecast = predict_uncertain(ConstantVelocity(), past, 0.01 * np.eye(4)[None], 2, samples=5)
    >>> forecast.position.shape, forecast.position[0, 0, 0, 0].round(1).tolist()
    ((1, 5, 2, 1, 2), [0.8, 0.0])
    """
    A = past.present.shape[2]
    if len(past) != 1 or covariance.shape != (A, 4, 4):
        raise InputError(
            f"tracks: {len(past)} windows and covariances of shape {list(covariance.shape)};"
            f" they must be 1 and {[A, 4, 4]}"
        )
    source = stream(0, "predict") if rng is None else rng
    value, axes = np.linalg.eigh(covariance)
    root = axes * np.sqrt(np.maximum(value, 0.0))[:, None, :]
    error = np.einsum("aij,kaj->kai", root, source.standard_normal((samples, A, 4)))
    error[0] = 0.0
    before = past.dt * np.arange(1.0 - past.position.shape[1], 1.0)[:, None, None]
    shift = error[:, None, :, :2] + before * error[:, None, :, 2:]
    changes: dict[str, Any] = {
        name: np.repeat(getattr(past, name), samples, axis=0) for name in ("present", "scored", "robot", "id", "frame")
    }
    position = np.where(past.present[..., None], past.position + shift, 0.0)
    plan = None if past.plan is None else np.repeat(past.plan, samples, axis=0)
    drawn = dataclasses.replace(past, position=position, plan=plan, **changes)
    found = predictor.predict(drawn, steps, 1, source)
    chosen = found.position[:, 0]  # the first future of each sample of the past
    forecast = predictor.forecast(past, chosen[None])
    if found.covariance is None:
        return forecast
    return dataclasses.replace(forecast, covariance=found.covariance[:1])

"""Check that a user-defined predictor fulfils the contract."""

from __future__ import annotations

import dataclasses

import numpy as np

from crowdbot.core import InputError, stream
from crowdbot.data import Forecast, Windows, example_windows

from .predictor import Predictor

STEPS = 12


def check_predictor(predictor: Predictor) -> None:
    """Check that a predictor fulfils the contract on small windows.

    Raises:
        InputError: the predictor violates a rule of the contract.

    >>> from crowdbot.prediction import ConstantVelocity
    >>> check_predictor(ConstantVelocity())
    """
    name = type(predictor).__name__
    if not isinstance(predictor, Predictor):
        raise InputError(f"{name} is not a Predictor")
    parameters = getattr(predictor, "__dataclass_params__", None)
    if parameters is None or not parameters.frozen:
        raise InputError(f"{name} is not frozen; decorate the class with @dataclass(frozen=True)")
    for rows in (8, 2):
        _check_windows(predictor, example_windows(rows))
    for steps, samples in ((0, 1), (1, 0)):
        try:
            predictor.predict(example_windows(), steps, samples)
        except InputError:
            continue
        raise InputError(
            f"{name}.predict accepts steps = {steps}, samples = {samples}; call self.check(past, steps, samples) first"
        )


def _check_windows(predictor: Predictor, past: Windows) -> None:
    name, before = type(predictor).__name__, past.position.copy()
    for samples in (1, 3):
        forecast = _predict(predictor, past, samples)
        W, K, T, A, _ = forecast.position.shape
        if (len(past), STEPS, past.present.shape[2]) != (W, T, A) or K not in (1, samples):
            wanted = f"[{len(past)}, 1 or {samples}, {STEPS}, {past.present.shape[2]}, 2]"
            raise InputError(f"{name}.predict: position has shape {list(forecast.position.shape)}, it must be {wanted}")
        if not np.array_equal(forecast.valid, past.present[:, -1]):
            raise InputError(f"{name}.predict must predict everyone who is present at the last row, and nobody else")
        if not _same(_predict(predictor, past, samples), forecast):
            raise InputError(f"{name}.predict is not deterministic: the same generator returned another forecast")
        unscored = dataclasses.replace(past, scored=~past.scored)
        if not _same(_predict(predictor, unscored, samples), forecast):
            raise InputError(f"{name}.predict uses past.scored; it must not")
        if not _same(_predict(predictor, past[:1], samples), forecast[:1]):
            raise InputError(f"{name}.predict: the forecast of a window differs when it is predicted alone")
    if not np.array_equal(past.position, before):
        raise InputError(f"{name}.predict changes past.position; it must only read it")


def _predict(predictor: Predictor, past: Windows, samples: int) -> Forecast:
    forecast = predictor.predict(past, STEPS, samples, stream(1, "contract"))
    if not isinstance(forecast, Forecast):
        raise InputError(f"{type(predictor).__name__}.predict returned a {type(forecast).__name__}, not a Forecast")
    return forecast


def _same(forecast: Forecast, other: Forecast) -> bool:
    return np.array_equal(forecast.position, other.position) and np.array_equal(forecast.weight, other.weight)

"""Calibration of the probabilities and spreads of AnchorNet on validation data."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import stream
from crowdbot.typing import Floats

from .agent_frame import PREDICTED_ROWS, SPEED_CLASSES, speed_class
from .forward_pass import feature_limit, network_output
from .training_data import NO_AUGMENTATION, TrainingSet, make_batch

Numbers = dict[str, NDArray[Any]]

TEMPERATURES = np.exp(np.linspace(-3.0, 1.5, 91))
WIDENINGS = np.exp(np.linspace(-2.5, 1.5, 81))
FEW = 200
"""Minimum number of people per speed class; below it, all people are used."""
WORST = -50.0
"""Lower bound of log-densities, to limit the influence of outliers."""


def calibrate_confidence(numbers: Numbers, material: TrainingSet) -> Numbers:
    """Return the weights with ``temperature`` and ``widening`` for each speed class.

    The temperature divides the logits of the probabilities, the widening multiplies the spreads. Both maximize the
    likelihood of validation data: of the nearest future, and of the truth under the mixture.
    """
    held = {name: np.asarray(values, dtype=np.float64) for name, values in numbers.items()}
    own, company, there, missed = make_batch(
        material, np.arange(len(material)), NO_AUGMENTATION, stream(0, "calibrated"), feature_limit(held)
    )
    out = network_output(held, own, company, there)
    K, D = held["centres"].shape
    bend = held["centres"] + out[:, : D * K].reshape(-1, K, D) * held["spread"]
    score, spread = out[:, D * K : D * K + K], np.clip(held["width"] + out[:, None, -D:], -6.0, 2.0)
    nearest = np.array([_nearest(item @ held["basis"], truth) for item, truth in zip(bend, missed, strict=True)])
    truth = missed.reshape(len(missed), -1) @ held["basis"].T
    z2 = ((truth[:, None] - bend) / held["spread"] * np.exp(-spread)) ** 2
    kind = speed_class(material.people.past)
    temperature, widening = [], []
    for bin_ in range(len(SPEED_CLASSES) + 1):
        who = np.flatnonzero(kind == bin_)
        who = who if len(who) >= FEW else np.arange(len(kind))
        warmth = _temperature(score[who], nearest[who])
        temperature.append(warmth)
        widening.append(_widening(_log_share(score[who] / warmth), z2[who], spread[who]))
    return numbers | {"temperature": np.asarray(temperature), "widening": np.asarray(widening)}


def _nearest(path: Floats, truth: Floats) -> int:
    away = path.reshape(-1, PREDICTED_ROWS, 2) - truth
    return int(np.argmin(np.sqrt((away**2).sum(axis=2)).mean(axis=1)))


def _temperature(score: Floats, nearest: NDArray[np.int64]) -> float:
    row = np.arange(len(score))
    return float(min(TEMPERATURES, key=lambda t: -_log_share(score / t)[row, nearest].mean()))


def _widening(log_share: Floats, z2: Floats, spread: Floats) -> float:
    def negative_log_likelihood(width: float) -> float:
        each = log_share - (0.5 * z2 / width**2 + spread + np.log(width)).sum(axis=2)
        top = each.max(axis=1)
        return float(-np.maximum(top + np.log(np.exp(each - top[:, None]).sum(axis=1)), WORST).mean())

    return float(min(WIDENINGS, key=negative_log_likelihood))


def _log_share(score: Floats) -> Floats:
    top = score.max(axis=1, keepdims=True)
    return np.asarray(score - top - np.log(np.exp(score - top).sum(axis=1, keepdims=True)))

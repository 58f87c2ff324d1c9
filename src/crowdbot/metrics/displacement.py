"""Displacement errors: ADE, FDE, best of K samples, and miss rate.

Only people scored by the protocol count. A future that ends early counts up to its end. ADE is the mean distance over
these steps, FDE the distance at the last one. Samples with weight 0 are padding and ignored.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.data import Forecast, Windows
from crowdbot.typing import Bools, Floats

RULES = ("person", "scene", "same")
MISS = 2.0
"""A person is missed if no sample ends within this distance [m] of the true position."""
SUM = 1e-6
"""Tolerance of the sum of the weights of a window."""


def distances(forecast: Forecast, future: Windows) -> tuple[Floats, Bools]:
    """Return the distance to the truth ``[W, K, T, A]`` [m] and which steps count ``[W, T, A]``.

    Steps that do not count have the distance 0. Distances include samples with weight 0.

    Raises:
        InputError: forecast and future do not match, a scored person was not predicted, or the weights do not sum to 1.
    """
    check(forecast, future)
    counted = future.present & future.scored[:, None]
    away = forecast.position - future.position[:, None]
    length = np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2)
    return np.where(counted[:, None], length, 0.0), counted


def ade(forecast: Forecast, future: Windows) -> Floats:
    """Return the average displacement error ``[W, K, A]`` [m] over the existing steps.

    NaN for people who are not scored and for samples with weight 0.
    """
    return mean_and_final(forecast, *distances(forecast, future))[0]


def fde(forecast: Forecast, future: Windows) -> Floats:
    """Return the displacement error ``[W, K, A]`` [m] at the last existing step; NaN as in :func:`ade`."""
    return mean_and_final(forecast, *distances(forecast, future))[1]


def best_of(ade: Floats, fde: Floats, rule: str = "person") -> tuple[Floats, Floats]:
    """Return ADE and FDE ``[W, A]`` [m] of the best of K samples, from the errors of all samples ``[W, K, A]``.

    Args:
        ade, fde: errors of all samples; NaN for people who are not scored and for samples with weight 0.
        rule: ``person``: the smallest over the samples for each person, ADE and FDE separately (Social-STGCNN,
            Trajectron++); ``scene``: the sample with the smallest sum over the people of a window, ADE and FDE on
            their own (SGAN); ``same``: for each person the sample with the smallest ADE, which also gives the FDE
            (TrajNet++).

    >>> import numpy as np
    >>> a, f = np.array([[[1.0, 4.0], [2.0, 2.0]]]), np.array([[[3.0, 6.0], [1.0, 5.0]]])
    >>> [[v.tolist() for v in best_of(a, f, rule)] for rule in ("person", "scene", "same")]
    [[[[1.0, 2.0]], [[1.0, 5.0]]], [[[2.0, 2.0]], [[1.0, 5.0]]], [[[1.0, 2.0]], [[3.0, 5.0]]]]
    """
    if rule == "scene":
        return _sample(ade, _of_scene(ade)), _sample(fde, _of_scene(fde))
    chosen = chosen_sample(ade, rule)
    return _sample(ade, chosen), _sample(fde, chosen if rule == "same" else _of_person(fde))


def miss_rate(fde: Floats, limit: float = MISS) -> float:
    """Return the share of scored people whose (best) FDE ``[W, A]`` is above ``limit`` [m]; NaN without people."""
    known = fde[~np.isnan(fde)]
    return float(np.mean(known > limit)) if len(known) else float("nan")


def mean_and_final(forecast: Forecast, distance: Floats, counted: Bools) -> tuple[Floats, Floats]:
    """Return ADE and FDE ``[W, K, A]`` [m] from the result of :func:`distances`."""
    count = counted.sum(axis=1)[:, None]
    steps = counted.shape[1]
    last = steps - 1 - np.argmax(counted[:, ::-1], axis=1)
    end = np.take_along_axis(distance, last[:, None, None], axis=2)[:, :, 0]
    counts = (count > 0) & (forecast.weight > 0.0)[:, :, None]
    mean = distance.sum(axis=2) / np.maximum(count, 1)
    return np.where(counts, mean, np.nan), np.where(counts, end, np.nan)


def check(forecast: Forecast, future: Windows) -> None:
    """Raise :class:`InputError` if a forecast does not match a future, see :func:`distances`."""
    W, _, T, A, _ = forecast.position.shape
    if future.present.shape != (W, T, A):
        raise InputError(
            f"forecast of {forecast.predictor} has W, T, A = {(W, T, A)}, the future has {future.present.shape};"
            " predict the past of the same windows with as many steps"
        )
    if abs(forecast.dt - future.dt) > 1e-9:
        raise InputError(f"forecast has steps of {forecast.dt} s, the future of {future.dt} s; they must be equal")
    missing = future.scored & ~forecast.valid
    if np.any(missing):
        window, person = np.argwhere(missing)[0]
        raise InputError(
            f"{forecast.predictor} did not predict person {future.id[window, person]} of window {window},"
            f" whom protocol {future.protocol!r} scores"
        )
    weight = forecast.weight
    shares = np.all(weight >= 0.0, axis=1) & (np.abs(weight.sum(axis=1) - 1.0) < SUM)
    for window in np.flatnonzero(future.scored.any(axis=1) & ~shares)[:1]:
        raise InputError(
            f"{forecast.predictor}: the weights of window {window} start at {weight[window].min():.4g} and sum to"
            f" {weight[window].sum():.4g}; they must be at least 0 and sum to 1"
        )
    unseen = future.scored & ~future.present.any(axis=1)
    if np.any(unseen):
        window, person = np.argwhere(unseen)[0]
        raise InputError(f"person {future.id[window, person]} of window {window} is scored but has no future")


def chosen_sample(error: Floats, rule: str) -> NDArray[np.int64]:
    """Return the sample ``[W, 1, A]`` (or ``[W, 1, 1]`` for a scene) with the smallest error."""
    if rule not in RULES:
        raise InputError(f"best-of rule {rule!r} is unknown, it must be one of {', '.join(RULES)}")
    return _of_scene(error) if rule == "scene" else _of_person(error)


def _of_person(error: Floats) -> NDArray[np.int64]:
    return np.asarray(np.argmin(np.where(np.isnan(error), np.inf, error), axis=1)[:, None])


def _of_scene(error: Floats) -> NDArray[np.int64]:
    void = np.isnan(error).all(axis=2)
    return np.asarray(np.argmin(np.where(void, np.inf, np.nansum(error, axis=2)), axis=1)[:, None, None])


def _sample(error: Floats, chosen: NDArray[np.int64]) -> Floats:
    return np.take_along_axis(error, np.broadcast_to(chosen, (error.shape[0], 1, error.shape[2])), axis=1)[:, 0]

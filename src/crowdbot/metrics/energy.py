"""Energy score: mean distance of the samples to the truth, minus half their mean distance from each other."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import InputError, did_you_mean, kernel
from crowdbot.data import Forecast, Windows
from crowdbot.typing import Bools, Floats, Ints

from .displacement import ade, check

OVER = ("steps", "path")


@kernel
def _distance(one: Floats, other: Floats, steps: int, path: bool) -> float:  # pragma: no cover - compiled
    """Return the distance over the first steps: the mean, or for a path the root mean square."""
    total = 0.0
    for t in range(steps):
        dx, dy = one[t, 0] - other[t, 0], one[t, 1] - other[t, 1]
        total += dx * dx + dy * dy if path else math.sqrt(dx * dx + dy * dy)
    return math.sqrt(total / steps) if path else total / steps


@kernel
def _scores(
    samples: Floats, weight: Floats, truth: Floats, there: Bools, window: Ints, person: Ints, path: bool
) -> Floats:  # pragma: no cover - compiled
    """Return the score ``[N]`` of each person of each window."""
    K, T = samples.shape[1], samples.shape[2]
    scores = np.zeros(len(window))
    own = np.empty((K + 1, T, 2))  # samples with weight, then the truth, at the existing steps
    share = np.empty(K + 1)
    for n in range(len(window)):
        w, a = window[n], person[n]
        kept, steps = 0, 0
        for t in range(T):
            if there[w, t, a]:
                kept = 0
                for k in range(K):
                    if weight[w, k] > 0.0:
                        own[kept, steps] = samples[w, k, t, a]
                        share[kept] = weight[w, k]
                        kept += 1
                own[kept, steps] = truth[w, t, a]
                steps += 1
        share[kept] = -1.0
        for k in range(kept):
            for other in range(k + 1, kept + 1):
                scores[n] -= share[k] * share[other] * _distance(own[k], own[other], steps, path)
    return scores


def energy_score(forecast: Forecast, future: Windows, over: str = "steps") -> Floats:
    """Return the energy score ``[W, A]`` [m] of weighted samples, lower is better; NaN for people who are not scored.

    ``sum_k w_k |x_k - y| - 1/2 sum_k sum_l w_k w_l |x_k - x_l|`` for samples x with weights w and the truth y. The
    score is proper: the true distribution minimises its expectation. For one sample it is the distance; with ``steps``,
    the score of a deterministic forecast is its ADE. More samples of the same distribution score slightly better:
    compare only equal numbers of samples.

    Args:
        forecast, future: forecast and future of the same windows.
        over: ``steps``: positions at each step, mean over the existing steps; ``path``: the whole trajectory as one
            vector, which includes the correlation of steps; ``|.|`` is the root mean square distance over the steps.

    The computing time grows with the square of the number of samples.

    Paper: Gneiting, Raftery (2007), doi 10.1198/016214506000001437, section 4.3 with beta = 1.

    Raises:
        InputError: forecast and future do not match, or ``over`` is unknown.

    >>> import numpy as np
    >>> here = np.ones((1, 1, 1), dtype=bool)
    >>> future = Windows(np.zeros((1, 1, 1, 2)), here, here[:, 0], ~here[:, 0], np.array([[7]]),
    ...     np.array([[10]]), 0.4, "all", "street")
    >>> around = np.array([[3.0, 0.0], [-3.0, 0.0]])[None, :, None, None]
    >>> [energy_score(Forecast.of(at, here[:, 0], 0.4, "me"), future).item() for at in (around, around[:, :1])]
    [1.5, 3.0]
    """
    check(forecast, future)
    if over not in OVER:
        raise InputError(f"energy score: over = {over!r} must be {' or '.join(OVER)}{did_you_mean(over, OVER)}")
    if forecast.samples == 1 and over == "steps":
        return ade(forecast, future)[:, 0]  # equal to the ADE; avoids loading a kernel
    result = np.full(future.scored.shape, np.nan)
    window, person = np.nonzero(future.scored)
    samples, weight = np.ascontiguousarray(forecast.position), np.ascontiguousarray(forecast.weight)
    truth, there = np.ascontiguousarray(future.position), np.ascontiguousarray(future.present)
    result[window, person] = _scores(samples, weight, truth, there, window, person, over == "path")
    return result

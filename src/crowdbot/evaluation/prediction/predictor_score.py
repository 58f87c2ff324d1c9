"""Score of one predictor over all windows of a recording, with timing."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable

from crowdbot.core import InputError, stream
from crowdbot.data import Forecast, Windows
from crowdbot.metrics import PersonErrors, Score, person_errors
from crowdbot.prediction import Predictor

CHUNK_NUMBERS = 4_000_000
"""Approximate number of predicted values in memory at once (32 MB per array)."""


def score_predictor(
    predictor: Predictor,
    past: Windows,
    future: Windows,
    samples: int = 1,
    best_of: str = "person",
    seed: int = 0,
    progress: Callable[[float], None] | None = None,
    chunk: int | None = None,
) -> Score:
    """Predict all windows and score the forecasts.

    The predictor receives ``past`` only. The result does not depend on the chunk size: each window has its own random
    stream, given by ``seed`` and the index of the window. One prediction is made before the timing starts, which
    excludes the compilation of kernels.

    Args:
        predictor: the predictor.
        past, future: windows of the same people.
        samples: number of futures per person.
        best_of: ``person``, ``scene`` or ``same``, see :func:`~crowdbot.metrics.best_of`.
        seed: seed of all random draws.
        progress: called with the completed share, 0 to 1.
        chunk: windows per call; None selects about 32 MB per array.

    Raises:
        InputError: past and future have different people, or there are no windows.
    """
    if past.id.shape != future.id.shape or (past.id != future.id).any():
        raise InputError("past and future have different people; create both with one call of Trajectories.windows")
    steps, people = future.present.shape[1:]
    size = chunk or max(1, CHUNK_NUMBERS // max(1, 2 * samples * steps * people))
    rng = stream(seed, "predict")
    errors: list[PersonErrors] = []
    last: Forecast | None = None
    seconds, drawn = 0.0, 1
    for first in range(0, len(past), size):
        part = slice(first, first + size)
        if last is None:
            predictor.predict(past[:1], steps, samples, stream(seed, "warm"))
        begin = time.perf_counter()
        last = predictor.predict(past[part], steps, samples, rng)
        seconds += time.perf_counter() - begin
        drawn = max(drawn, last.samples)
        errors.append(person_errors(last, future[part], best_of, past[part]))
        if progress is not None:
            progress(min(1.0, (first + size) / len(past)))
    if last is None:
        raise InputError(f"{past.source} has no windows")
    total = Score.of(PersonErrors.concatenate(errors), last.predictor, drawn, future, best_of)
    return dataclasses.replace(total, seconds_per_window=seconds / len(past))

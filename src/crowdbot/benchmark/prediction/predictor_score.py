"""One predictor over all windows of a recording: timed, in chunks that fit the memory, scored."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable

from crowdbot.core import InputError, stream
from crowdbot.data import Forecast, Windows
from crowdbot.metrics import PersonErrors, Score, person_errors
from crowdbot.prediction import Predictor

__all__ = ["evaluate"]

CHUNK_NUMBERS = 4_000_000
"""About so many predicted numbers are held at once (32 MB for each array of that size)."""


def evaluate(
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

    Only ``past`` is handed to the predictor. The result does not depend on the chunks: every window has its own stream
    of randomness, ``seed`` and its place among the windows decide it. Before the clock starts, the first window is
    predicted once, so that compiling kernels is not counted.

    Args:
        predictor: what predicts.
        past, future: windows of the same people.
        samples: futures per person.
        best_of: ``person``, ``scene`` or ``same``, see :func:`~crowdbot.metrics.best_of`.
        seed: of the randomness.
        progress: told the share that is done, 0 to 1.
        chunk: windows at a time; None means as many as fit into about 32 MB an array.

    Raises:
        InputError: past and future do not belong together, or nobody is scored.
    """
    if past.id.shape != future.id.shape or (past.id != future.id).any():
        raise InputError("past and future are not windows of the same people: cut both with one call")
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
        drawn = max(drawn, last.samples)  # futures may be fewer where there are fewer goals
        errors.append(person_errors(last, future[part], best_of))
        if progress is not None:
            progress(min(1.0, (first + size) / len(past)))
    if last is None:
        raise InputError(f"there is no window to predict in {past.source}")
    total = Score.of(PersonErrors.joined(errors), last.predictor, drawn, future, best_of)
    return dataclasses.replace(total, seconds_per_window=seconds / len(past))

"""Forecasts from the tracks of several environments at once."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Walls, stream
from crowdbot.data import Forecast, Windows
from crowdbot.prediction import Predictor

from .track_history import SAME, TrackHistory, forecast_problem

__all__ = ["forecast_tracks"]

SEEDS = 2**63
"""Predictors draw the seed of each window below this number; see ``crowdbot.prediction.window_streams``."""


class _WindowSeeds:
    """A generator that gives window k the first number of the random stream of environment k."""

    def __init__(self, seeds: NDArray[np.int64]) -> None:
        self._seeds, self._begin = seeds, 0

    def integers(self, low: int, high: int, size: int) -> NDArray[np.int64]:
        """Return the numbers of the next windows; every other use of the generator is an error."""
        if (low, high) != (0, SEEDS):
            raise InputError(f"forecast: the predictor draws from {low} to {high}, it must call window_streams")
        first, self._begin = self._begin, self._begin + size
        return self._seeds[first : self._begin]


def forecast_tracks(
    tracks: Sequence[TrackHistory],
    predictor: Predictor,
    seconds: float,
    steps: Sequence[float | None],
    walls: Walls,
    samples: int = 1,
    seed: int = 0,
) -> Forecast:
    """Return the forecasts from N histories as N windows, equal to :meth:`TrackHistory.forecast` of each.

    Args:
        tracks: the histories.
        predictor: the predictor; a built-in one predicts histories with equally many rows in one call.
        seconds: time to predict [s].
        steps: time between rows of each [s], None: between its two newest rows.
        walls: walls of the stage.
        samples: number of futures.
        seed: random seed.

    Raises:
        InputError: as :meth:`TrackHistory.forecast`, or the time steps differ.
    """
    if problem := forecast_problem(predictor, seconds):
        raise InputError(problem)
    pasts = [one.windows(step, walls) for one, step in zip(tracks, steps, strict=True)]
    dt, largest = pasts[0].dt, max(past.present.shape[2] for past in pasts)
    if any(abs(past.dt - dt) > SAME for past in pasts):
        raise InputError(f"forecast: the time steps differ, from {min(past.dt for past in pasts):g} s; give dt")
    groups: dict[tuple[float, int], list[int]] = {}
    for k, past in enumerate(pasts):
        together = type(predictor).__module__.startswith("crowdbot.prediction.")
        groups.setdefault((past.dt, past.position.shape[1]) if together else (float(k), -1), []).append(k)
    found: dict[int, Forecast] = {}
    for rows in groups.values():
        part = _predict(
            [pasts[k] for k in rows], predictor, math.ceil(seconds / pasts[rows[0]].dt - SAME), samples, seed
        )
        found |= {k: part[j : j + 1] for j, k in enumerate(rows)}
    return _join([found[k] for k in range(len(pasts))], largest)


def _predict(pasts: Sequence[Windows], predictor: Predictor, steps: int, samples: int, seed: int) -> Forecast:
    """Return the forecasts from windows with equally many rows."""
    streams = [stream(seed, "forecast", int(past.frame[0, -1])) for past in pasts]
    if len(pasts) == 1:
        return predictor.predict(pasts[0], steps, samples, streams[0])
    most = max(past.present.shape[2] for past in pasts)

    def joined(name: str, axis: int, fill: Any) -> NDArray[Any]:
        rows = []
        for past in pasts:
            value = getattr(past, name)
            pad = [(0, 0)] * value.ndim
            pad[axis] = (0, most - value.shape[axis])
            rows.append(np.pad(value, pad, constant_values=fill))
        return np.concatenate(rows)

    whole = dataclasses.replace(
        pasts[0],
        position=joined("position", 2, 0.0),
        present=joined("present", 2, False),
        scored=joined("scored", 1, False),
        robot=joined("robot", 1, False),
        id=joined("id", 1, -1),
        frame=np.concatenate([past.frame for past in pasts]),
    )
    seeds: Any = _WindowSeeds(np.array([rng.integers(0, SEEDS, size=1)[0] for rng in streams]))
    return predictor.predict(whole, steps, samples, seeds)


def _join(parts: Sequence[Forecast], agents: int) -> Forecast:
    """Return forecasts as the windows of one, padded to the number of agents, futures and rows of the largest."""
    K, T = (max(part.position.shape[axis] for part in parts) for axis in (1, 2))
    position = np.zeros((len(parts), K, T, agents, 2))
    weight, valid = np.zeros((len(parts), K)), np.zeros((len(parts), agents), dtype=np.bool_)
    for k, part in enumerate(parts):
        _, futures, rows, people, _ = part.position.shape
        position[k, :futures, :rows, : min(people, agents)] = part.position[0, :, :, :agents]
        weight[k, :futures], valid[k, : min(people, agents)] = part.weight[0], part.valid[0, :agents]
    return Forecast(position, weight, valid, parts[0].dt, parts[0].predictor)

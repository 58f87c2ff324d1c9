"""Stop-and-go waves: stops of each person, and the speed at which stops travel through a file of people.

Portz, Seyfried 2011, Analyzing stop-and-go waves by experiment and modeling, doi 10.1007/978-1-4419-9725-8_52.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crowdbot.core import InputError
from crowdbot.data import Trajectories
from crowdbot.typing import Floats

from .lanes import walking_direction
from .rows import check_metres, rows_at, table

if TYPE_CHECKING:
    import pandas as pd


SLOW = 0.1
"""People slower than this [m/s] stand."""
FEWEST = 10
"""Stops of a recording with waves."""
UNIFORM = 0.01
"""Without a larger deviation of the mean speeds in cells [m/s], there are no waves."""
SHORTEST = 0.5
"""Shorter stops [s] are sway."""


@dataclass(frozen=True)
class StopAndGo:
    """Stop-and-go figures of a recording.

    Fields:
        share: share of person time at a stop.
        stops_per_minute: stops per minute of a person.
        duration: mean duration of a stop [s]; NaN without stops.
        wave: speed of the stops along the axis [m/s]; NaN with fewer than 10 stops, in two-way flows
            (fewer than 9 of 10 people walk the same way along the axis), or if it is not defined.
    """

    share: float
    stops_per_minute: float
    duration: float
    wave: float


def compute_stops(
    tracks: Trajectories, speed: pd.DataFrame, slow: float = SLOW, shortest: float = SHORTEST
) -> pd.DataFrame:
    """Return every stop of every person: columns id, first_frame, last_frame, duration [s], x, y (at its begin) [m].

    Args:
        tracks: the recording.
        speed: result of :func:`~crowdbot.measurement.compute_individual_speed`.
        slow: speed below which a person stands [m/s].
        shortest: shortest duration of a stop [s].

    Raises:
        InputError: ``slow`` is not above 0 or ``shortest`` is negative.
        DataError: the tracks are in pixels.

    >>> from crowdbot.measurement import compute_individual_speed
    >>> x = [0.0, 1.0, 2.0, 2.0, 2.0, 3.0, 4.0]
    >>> tracks = Trajectories([1] * 7, range(7), x, [0.0] * 7, row_rate=1.0)
    >>> compute_stops(tracks, compute_individual_speed(tracks, 1))[["first_frame", "duration"]].to_numpy().tolist()
    [[3.0, 1.0]]
    """
    check_metres(tracks)
    if not slow > 0.0 or shortest < 0.0:
        raise InputError(f"a stop needs a speed above 0 and a duration of at least 0, not {slow} and {shortest}")
    order = np.lexsort((speed.frame.to_numpy(), speed.id.to_numpy()))
    id, frame, value = (speed[name].to_numpy()[order] for name in ("id", "frame", "speed"))
    standing = np.abs(value) < slow
    new = np.ones(len(id), dtype=np.bool_)
    new[1:] = (id[1:] != id[:-1]) | (np.diff(frame) > tracks.frame_step) | (standing[1:] != standing[:-1])
    first = np.flatnonzero(new)
    last = np.append(first[1:], len(id)) - 1 if len(id) else first
    seconds = (frame[last] - frame[first] + tracks.frame_step) / tracks.fps
    kept = standing[first] & (seconds >= shortest)
    first, last, seconds = first[kept], last[kept], seconds[kept]
    rows = rows_at(tracks, frame[first].astype(np.int64), id[first].astype(np.int64))
    return table(
        id=id[first], first_frame=frame[first], last_frame=frame[last], duration=seconds, x=tracks.x[rows],
        y=tracks.y[rows],
    )  # fmt: skip


def compute_stop_and_go(
    tracks: Trajectories, speed: pd.DataFrame, slow: float = SLOW, shortest: float = SHORTEST, axis: str = "x"
) -> StopAndGo:
    """Return how often and how long people stop, and the speed of the waves along ``axis``."""
    stops = compute_stops(tracks, speed, slow, shortest)
    minutes = len(speed) * tracks.dt / 60.0
    return StopAndGo(
        share=float(stops.duration.sum() / 60.0 / minutes) if minutes else math.nan,
        stops_per_minute=len(stops) / minutes if minutes else math.nan,
        duration=float(stops.duration.mean()) if len(stops) else math.nan,
        wave=wave_speed(tracks, speed, axis) if len(stops) >= FEWEST and _one_way(tracks, axis) else math.nan,
    )


def wave_speed(
    tracks: Trajectories,
    speed: pd.DataFrame,
    axis: str = "x",
    cell: float = 0.5,
    step: float = 0.5,
    fastest: float = 3.0,
) -> float:
    """Return the speed of waves of slow walking along a coordinate [m/s], NaN if it is not defined.

    Mean speeds in cells of space and time, less their mean, are correlated along lines ``x = c t`` for speeds c from
    ``-fastest`` to ``fastest``; the c with the largest variance of the sums along lines is returned (slant stack).
    Cells without people are ignored. At least 5 % of the variance must be explained by the lines.

    Args:
        tracks: the recording, all people walking the same way.
        speed: result of :func:`~crowdbot.measurement.compute_individual_speed`.
        axis: ``x`` or ``y``.
        cell, step: size of a cell in space [m] and time [s].
        fastest: largest speed of a wave that is searched [m/s].

    Raises:
        InputError: an argument is not allowed.
    """
    if axis not in ("x", "y") or not min(cell, step, fastest) > 0.0:
        raise InputError("the speed of a wave needs an axis x or y, and cells and a speed above 0")
    field = _field(tracks, speed, axis, cell, step)
    known = ~np.isnan(field)
    if known.sum() < 20 or np.nanstd(field) < UNIFORM:
        return math.nan
    time, place = np.nonzero(known)
    value = field[known] - np.nanmean(field)
    speeds = np.linspace(-fastest, fastest, 241)
    scores = [_explained(place * cell - c * time * step, value, cell) for c in speeds]
    best = int(np.argmax(scores))
    return float(speeds[best]) if scores[best] > 0.05 * float(np.var(value)) else math.nan


def _one_way(tracks: Trajectories, axis: str) -> bool:
    """Return whether at least 9 of 10 people who move along the axis walk the same way."""
    side = walking_direction(tracks, tracks.x if axis == "x" else tracks.y)
    people = side[np.unique(tracks.id, return_index=True)[1]]
    moving = people[people != 0.0]
    return len(moving) > 0 and abs(float(moving.mean())) >= 0.8


def _field(tracks: Trajectories, speed: pd.DataFrame, axis: str, cell: float, step: float) -> Floats:
    """Return mean speeds in cells ``[time, place]``, NaN without people."""
    joined = tracks.to_frame().merge(speed, on=["id", "frame"])
    along = joined[axis].to_numpy()
    if not len(along):
        return np.empty((0, 0))
    row = np.floor(joined.time.to_numpy() / step).astype(np.int64)
    column = np.floor((along - along.min()) / cell).astype(np.int64)
    shape = int(row.max()) + 1, int(column.max()) + 1
    flat = row * shape[1] + column
    count = np.bincount(flat, minlength=shape[0] * shape[1])
    total = np.bincount(flat, np.abs(joined.speed.to_numpy()), minlength=len(count))
    return np.where(count > 0, total / np.maximum(count, 1), np.nan).reshape(shape)


def _explained(phase: Floats, value: Floats, width: float) -> float:
    """Return the variance between lines of equal phase, less its expectation by chance."""
    line = np.floor(phase / width).astype(np.int64)
    line -= line.min()
    count = np.bincount(line)
    some = count > 0
    total = np.bincount(line, value)
    between = float(np.sum(total[some] ** 2 / count[some])) / len(value)
    return between - float(np.var(value)) * float(some.sum()) / len(value)

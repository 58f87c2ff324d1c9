"""Resampling of tracks to another time step: linear interpolation inside a track, no extrapolation."""

from __future__ import annotations

import dataclasses
import math
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError

from .source import MAX_ROWS
from .track_table import TrackTable

Tracks = TypeVar("Tracks", bound=TrackTable)

WHOLE = 1e-6
"""Tolerance for a new step that is a whole number of frames [frames]."""


def resample(tracks: Tracks, dt: float, gap: float | None) -> Tracks:
    """Return the tracks at steps of ``dt`` [s]; see :meth:`Trajectories.resample`."""
    for name, value in (("dt", dt), ("gap", gap)):
        if value is not None and not (value > 0.0 and math.isfinite(value)):
            raise InputError(f"resample: {name} {value} s must be above 0 and finite")
    fps = tracks.fps
    step = dt * fps
    whole = abs(step - round(step)) < WHOLE and round(step) >= 1
    step = float(round(step)) if whole else step
    bridge = max(dt, tracks.dt) * 1.001 if gap is None else gap
    order = np.lexsort((tracks.frame, tracks.id))
    id, x, y = tracks.id[order], tracks.x[order], tracks.y[order]
    since = (tracks.frame[order] - tracks.frame[0]).astype(np.float64)
    begins = np.flatnonzero(np.concatenate([[True], np.diff(id) != 0]))
    ends = np.concatenate([begins[1:], [len(id)]])
    if np.sum(since[ends - 1] - since[begins]) / step > MAX_ROWS:
        raise DataError(f"{tracks.name}: steps of {dt} s give more than {MAX_ROWS} rows; use a longer step")
    parts: list[tuple[NDArray[Any], ...]] = []
    for begin, end in zip(begins, ends, strict=True):
        own = since[begin:end]
        count = _steps_inside(own, step, bridge * fps)
        place = [np.interp(count * step, own, axis[begin:end]) for axis in (x, y)]
        parts.append((np.full(len(count), id[begin]), count, *place))
    ids, counts, xs, ys = (np.concatenate(column) for column in zip(*parts, strict=True))
    left = set(ids.tolist())
    return dataclasses.replace(
        tracks,
        id=ids,
        frame=tracks.frame[0] + counts * int(step) if whole else counts,
        x=xs,
        y=ys,
        row_rate=1.0 / dt,
        frame_step=int(step) if whole else 1,
        robots=tracks.robots & left,
        labels={key: label for key, label in tracks.labels.items() if key in left},
        scenes=(),
        clock_origin=tracks.clock_origin if whole else float(tracks.clock[0]),
    )


def _steps_inside(own: NDArray[np.float64], step: float, bridge: float) -> NDArray[np.int64]:
    """Return the multiples of ``step`` [frames] inside one track, but not inside a gap longer than ``bridge``."""
    tiny = 1e-9 * max(step, 1.0)
    count = np.arange(math.ceil((own[0] - tiny) / step), math.floor((own[-1] + tiny) / step) + 1, dtype=np.int64)
    holes = np.flatnonzero(np.diff(own) > bridge)
    if len(holes) == 0 or len(count) == 0:
        return count
    at = count * step
    before = np.clip(np.searchsorted(own, at + tiny, side="right") - 1, 0, len(own) - 1)
    lost = np.isin(before, holes) & (at - own[before] > tiny)
    return np.asarray(count[~lost])

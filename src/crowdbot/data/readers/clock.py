"""Clock of a recording with times instead of frames: its regular step, and rows at times beside it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crowdbot.core import DataError
from crowdbot.data.rows import frame_step, where
from crowdbot.typing import Floats, Ints

SLOWEST, FASTEST = 1000.0, 1e-4
"""Range of the time step [s]; other values are not times in seconds."""
SNAP = 0.25
"""Largest distance of a row from a regular time, in steps, at which the row is taken as it is."""
BRIDGE = 1.75
"""Longest gap, in steps, inside which positions at regular times are interpolated."""
FIRST_FIT = 64.0
"""Steps at the begin of a recording to which the clock is fitted first."""
MOST_STEPS = 1e12
"""Largest duration of a recording, in steps."""
TOLERANCE = 1e-6
"""Distance from regular times, in steps, that is not worth a note."""


class RegularRows(NamedTuple):
    """Rows at regular times: frames from 0 on, frames per second [1/s], a note, and the time of frame 0 [s]."""

    id: Ints
    frame: Ints
    x: Floats
    y: Floats
    fps: float
    note: str
    origin: float


def regular_rows(
    id: Ints, time: Floats, x: Floats, y: Floats, fps: float | None, name: str, line: Ints | None
) -> RegularRows:
    """Return the rows at regular times.

    A regular clock is fitted to all times, from the mean step of all tracks on. If every row is within a quarter of the
    step of a regular time, rows keep their positions. Otherwise positions are interpolated linearly at the regular
    times, but not across gaps, and a note says so.

    Args:
        id, time, x, y: ``[N]`` rows, times in seconds.
        fps: rows per second [1/s], or None.
        name, line: file and ``[N]`` lines, for messages.

    Raises:
        DataError: there are no rows, a time is missing, no track has two rows, a person has two rows at one time, or
            no track is long enough for positions at regular times.

    >>> rows = regular_rows(np.array([1, 1, 1]), np.array([0.0, 0.39, 0.8]), np.zeros(3), np.zeros(3), None, "f", None)
    >>> rows.frame.tolist(), round(rows.fps, 3)
    ([0, 1, 2], 2.5)
    """
    if len(time) == 0:
        raise DataError(f"{name} has no rows")
    if not np.all(np.isfinite(time)):
        raise DataError(f"{where(name, int(np.argmin(np.isfinite(time))), line)}: its time is missing or infinite")
    dt = _step(id, time, name, line) if fps is None else 1.0 / fps
    if not FASTEST <= dt <= SLOWEST:
        short = "time_ms" if dt < 2e3 else "time_us" if dt < 2e6 else "time_ns"
        hint = f"; give --columns {short}=COLUMN if they are in another unit" if dt > SLOWEST else ""
        raise DataError(f"{name}: the time step is {dt:.4g}; times must be in seconds{hint}")
    since = time - time.min()
    if not since.max() <= MOST_STEPS * dt or not np.isfinite(dt):
        last = int(np.argmax(np.abs(time - np.median(time))))
        raise DataError(
            f"{where(name, last, line)}: the time {time[last]:g} s is more than {MOST_STEPS:g} steps of {dt:.4g} s from"
            " the others; remove rows with wrong times"
        )
    frame, phase, fitted = _fit(since, dt, fps is None)
    off = float(np.max(np.abs(since - phase - frame * fitted)))
    if off > SNAP * fitted:
        return _interpolated(id, since, x, y, dt, off, name)._replace(origin=float(time.min()))
    origin = float(time.min() + phase + frame.min() * fitted)
    frame -= frame.min()
    if fps is None and frame.max() > 0:
        fitted = float(since.max() / frame.max()) if off <= TOLERANCE * fitted else fitted
    note = f"times are up to {off:.2g} s off a regular step of {fitted:.4g} s" if off > TOLERANCE * fitted else ""
    return RegularRows(id, frame.astype(np.int64), x, y, _short(1.0 / fitted), note, origin)


def row_rate_of_times(id: Ints, frame: Ints, time: Floats) -> float | None:
    """Return rows per second of a track [1/s], from the first and the last frame and their times."""
    known = np.flatnonzero(np.isfinite(time))
    if len(known) == 0:
        return None
    first, last = known[np.argmin(frame[known])], known[np.argmax(frame[known])]
    if not time[last] > time[first]:
        return None
    return _short(float((frame[last] - frame[first]) / (time[last] - time[first]) / frame_step(id, frame)))


def _step(id: Ints, time: Floats, name: str, line: Ints | None) -> float:
    """Return the time between rows of a track [s]."""
    order = np.lexsort((time, id))
    same = np.diff(id[order]) == 0
    steps = np.diff(time[order])[same]
    if np.any(steps <= 0.0):
        twice = int(order[1:][same][int(np.argmin(steps))])
        raise DataError(
            f"{where(name, twice, line)}: time {time[twice]}, id {id[twice]} is a duplicate;"
            " a person has one position per frame, remove the other row"
        )
    if len(steps) == 0:
        raise DataError(f"{name}: no track has rows at two times, so its frame rate is unknown; give fps")
    dt = float(np.median(steps))
    with np.errstate(over="ignore"):  # a wrong time may be as large as numbers get
        count = np.rint(steps / dt)
    near = (count >= 1) & (np.abs(steps - count * dt) <= 0.5 * dt)
    return float(np.sum(steps[near]) / np.sum(count[near])) if np.any(near) else dt


def _fit(since: Floats, dt: float, free: bool) -> tuple[Floats, float, float]:
    """Return the frame of each row, and the offset and the step [s] of the regular times.

    A step from jittered rows is too inexact for a long recording: it is fitted over 64 steps, then over twice as many,
    and so on, so that the frames of the next fit are known.
    """
    order = np.sort(since)
    span, phase = FIRST_FIT * dt, 0.0
    while True:
        part = order[order <= span]
        angle = 2.0 * np.pi * part / dt
        phase = float(np.arctan2(np.mean(np.sin(angle)), np.mean(np.cos(angle))) / (2.0 * np.pi) * dt)
        frame = np.rint((part - phase) / dt)
        if free and frame[-1] > frame[0]:
            middle = frame - frame.mean()
            dt = float(np.dot(middle, part) / np.dot(middle, middle))
            phase = float(np.mean(part) - dt * frame.mean())
        if span >= order[-1]:
            return np.rint((since - phase) / dt), phase, dt
        span *= 2.0


def _interpolated(id: Ints, since: Floats, x: Floats, y: Floats, dt: float, off: float, name: str) -> RegularRows:
    """Return positions at multiples of the step, inside tracks but not inside gaps."""
    order = np.lexsort((since, id))
    id, since, x, y = id[order], since[order], x[order], y[order]
    begins = np.flatnonzero(np.concatenate([[True], (np.diff(id) != 0) | (np.diff(since) > BRIDGE * dt)]))
    ends = np.concatenate([begins[1:], [len(id)]])
    parts = []
    for begin, end in zip(begins, ends, strict=True):
        own = since[begin:end]
        frame = np.arange(np.ceil(own[0] / dt - TOLERANCE), np.floor(own[-1] / dt + TOLERANCE) + 1, dtype=np.int64)
        place = [np.interp(frame * dt, own, axis[begin:end]) for axis in (x, y)]
        parts.append((np.full(len(frame), id[begin]), frame, *place))
    ids, frames, xs, ys = (np.concatenate(column) for column in zip(*parts, strict=True))
    if len(ids) == 0:
        raise DataError(f"{name}: no track has two rows within {BRIDGE * dt:.4g} s; times must be in seconds")
    note = f"times are irregular, up to {off:.2g} s off a step of {dt:.4g} s; positions are interpolated at this step"
    return RegularRows(ids, frames, xs, ys, _short(1.0 / dt), note, 0.0)


def _short(rate: float) -> float:
    """Return the rate without rounding errors: 2.5000000000000004 is 2.5."""
    short = float(f"{rate:.12g}")
    return short if abs(short - rate) < 1e-14 * rate else rate

"""Named columns and their usual names: ids, frames or times, positions, labels."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.data.rows import frame_step, integers, where

__all__ = [
    "Columns",
    "Lines",
    "check_columns",
    "find_columns",
    "frames_of_times",
    "ids",
    "labels",
    "numbers",
    "row_rate_of_times",
]

Columns = dict[str, NDArray[Any]]
Lines = NDArray[np.int64] | None

_NAMES = {
    "id": "id agent agent_id actor_id ped ped_id pedestrian pedestrian_id person person_id p track track_id trackid"
    " trajectory_id traj_id obj_id object_id",
    "frame": "frame frame_id frameid frame_number frame_index f step",
    "time": "time t timestamp time_s seconds sec",
    "x": "x pos_x x_pos position_x x_position x_est x_center xcenter",
    "y": "y pos_y y_pos position_y y_position y_est y_center ycenter",
    "label": "label class type agent_type category",
}
NAMES = {meaning: names.split() for meaning, names in _NAMES.items()}
"""Known names of each column, in lower case; x and y may have a unit, as in ``x_cm``, ``x/m`` or ``y [m]``."""

WITH_UNIT = re.compile(r"^(.*?[a-z])[\s_/]*[\[(/_\s]\s*(mm|cm|m|px)\s*[\])]?$")
SLOWEST, FASTEST = 1000.0, 1e-4
"""Range of the time step [s]; other values are not times in seconds."""


def find_columns(names: list[str]) -> tuple[dict[str, str], str]:
    """Return the column of each known quantity, and the unit in the names of x and y.

    >>> find_columns(["ID", "Frame", "x [cm]", "y [cm]"])
    ({'id': 'ID', 'frame': 'Frame', 'x': 'x [cm]', 'y': 'y [cm]'}, 'cm')
    """
    found: dict[str, str] = {}
    units = ""
    plain = {name: name.strip().lower() for name in names}
    for meaning, known in NAMES.items():
        for name, small in plain.items():
            unit = WITH_UNIT.match(small) if meaning in "xy" and small not in known else None
            if meaning not in found and (unit.group(1) if unit else small) in known:
                found[meaning] = name
                units = unit.group(2) if unit else units
    return found, units


def check_columns(found: dict[str, str], names: list[str], name: str) -> None:
    """Raise :class:`DataError` with the missing columns, the existing ones, and the accepted names."""
    missing = [meaning for meaning in ("id", "x", "y") if meaning not in found]
    if not {"frame", "time"} & set(found):
        missing.append("frame")
    if missing:
        known = "; ".join(f"{meaning} may be called {', '.join(NAMES[meaning])}" for meaning in missing)
        held = ", ".join(names[:20]) or "none"
        raise DataError(f"{name} has no column for {', '.join(missing)}; it has {held}; {known}")


def numbers(values: NDArray[Any], column: str, name: str, line: Lines) -> NDArray[np.float64]:
    """Return a column as float64; an empty cell is NaN.

    Raises:
        DataError: a cell is not a number.
    """
    try:
        return values.astype(np.float64)
    except (ValueError, TypeError):
        read = [_number(value) for value in values.tolist()]
    wrong = next((index for index, value in enumerate(read) if value is None), None)
    if wrong is not None:
        raise DataError(f"{where(name, wrong, line)}: {column} is {str(values[wrong])[:40]!r}, it must be a number")
    return np.asarray(read, dtype=np.float64)


def ids(values: NDArray[Any], column: str, name: str, line: Lines) -> tuple[NDArray[np.int64], str]:
    """Return ids and a note; words are numbered from 1 in order of appearance."""
    read = [_number(value) for value in values.tolist()]
    empty = next((index for index, value in enumerate(read) if value is not None and np.isnan(value)), None)
    if empty is not None:
        raise DataError(f"{where(name, empty, line)}: {column} is empty, but every row needs a value")
    if None not in read:
        return integers(values if values.dtype.kind in "iu" else np.asarray(read, np.float64), column, name, line), ""
    known = {word: number for number, word in enumerate(dict.fromkeys(map(str, values.tolist())), 1)}
    options = np.asarray([known[str(word)] for word in values.tolist()], dtype=np.int64)
    return options, f"ids are words; they are numbered in order of appearance, {next(iter(known))[:40]!r} is 1"


def labels(values: NDArray[Any], id: NDArray[np.int64]) -> dict[int, str]:
    """Return the first label of every id that has one."""
    found: dict[int, str] = {}
    for key, label in zip(id.tolist(), values.tolist(), strict=True):
        if label not in (None, "") and key not in found:
            found[key] = str(label)
    return found


def row_rate_of_times(id: NDArray[np.int64], frame: NDArray[np.int64], time: NDArray[np.float64]) -> float | None:
    """Return rows per second of a track [1/s], from the first and the last frame and their times."""
    known = np.flatnonzero(np.isfinite(time))
    if len(known) == 0:
        return None
    first, last = known[np.argmin(frame[known])], known[np.argmax(frame[known])]
    if not time[last] > time[first]:
        return None
    return _short(float((frame[last] - frame[first]) / (time[last] - time[first]) / frame_step(id, frame)))


def frames_of_times(
    id: NDArray[np.int64], time: NDArray[np.float64], fps: float | None, name: str, line: Lines
) -> tuple[NDArray[np.int64], float]:
    """Return frames numbered from 0, and frames per second [1/s], of rows that have times [s] only.

    Raises:
        DataError: a time is missing, or the times of a track are not regular.
    """
    if len(time) == 0:
        raise DataError(f"{name} has no rows")
    if not np.all(np.isfinite(time)):
        raise DataError(f"{where(name, int(np.argmin(np.isfinite(time))), line)}: its time is missing")
    order = np.lexsort((time, id))
    steps = np.diff(time[order])[(np.diff(id[order]) == 0) & (np.diff(time[order]) > 0.0)]
    if fps is None and len(steps) == 0:
        raise DataError(f"{name}: no track has rows at two times, so its frame rate is unknown; give fps")
    dt = float(np.median(steps)) if fps is None else 1.0 / fps
    if not FASTEST <= dt <= SLOWEST:
        raise DataError(f"{name}: the time step is {dt:.4g}; times must be in seconds")
    since = time - time.min()
    frame = np.rint(since / dt)
    if fps is None:
        dt = float(since.max() / frame.max())
        frame = np.rint(since / dt)
    off = np.abs(since - frame * dt)
    if off.max() > 0.25 * dt:
        index = int(np.argmax(off))
        raise DataError(
            f"{where(name, index, line)}: time {time[index]} is {off[index]:.3g} s off a regular step of {dt:.4g} s;"
            " give fps, or resample the tracks to regular times"
        )
    return frame.astype(np.int64), _short(1.0 / dt)


def _number(value: Any) -> float | None:
    if value is None or value == "":
        return np.nan
    try:
        return float(value)
    except (ValueError, TypeError):
        return None


def _short(rate: float) -> float:
    """Return the rate without rounding errors: 2.5000000000000004 is 2.5."""
    short = float(f"{rate:.12g}")
    return short if abs(short - rate) < 1e-14 * rate else rate

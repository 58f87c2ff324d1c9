"""Named columns and their usual names: ids, frames or times, positions, labels."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError, did_you_mean
from crowdbot.data.rows import integers, where

Columns = dict[str, NDArray[Any]]
Lines = NDArray[np.int64] | None

_NAMES = {
    "id": "id agent agent_id actor_id ped ped_id pedestrian pedestrian_id person person_id p track track_id trackid"
    " trajectory_id traj_id obj_id object_id",
    "frame": "frame frame_id frameid frame_number frame_index f step",
    "time": "time t timestamp time_s seconds sec secs header.stamp.sec header.stamp.secs stamp.sec stamp.secs",
    "x": "x pos_x x_pos position_x x_position x_est x_center xcenter",
    "y": "y pos_y y_pos position_y y_position y_est y_center ycenter",
    "label": "label class type agent_type category",
    "height": "z pos_z z_pos position_z z_position z_est z_center zcenter",
}
NAMES = {meaning: names.split() for meaning, names in _NAMES.items()}
"""Known names of each column, in lower case; x and y may have a unit, as in ``x_cm``, ``x/m`` or ``y [m]``."""
LONGITUDE, LATITUDE = ("lon", "lng", "long", "longitude"), ("lat", "latitude")
"""Names of columns in degrees, which are x and y where no column is called so."""
TIME_UNITS = {"milliseconds": 1e-3, "microseconds": 1e-6, "nanoseconds": 1e-9}
TIME_QUANTITIES = {"time_ms": "milliseconds", "time_us": "microseconds", "time_ns": "nanoseconds"}
"""Quantities that a user may name instead of ``time``, for times that are not in seconds."""
TIME_WITH_UNIT = re.compile(
    r"^(?:(.*?[a-z0-9])[\s_/]*[\[(/_\s]\s*)?"
    r"(?:(ms|msec|millis|milliseconds)|(us|µs|usec|micros|microseconds)|(ns|nsec|nanos|nanoseconds))\s*[\])]?$"
)

WHOLE_SECONDS = re.compile(r"^(.*?)secs?$")
DECIMAL_COMMA = re.compile(r"^[+-]?\d*(,\d*)?([eE][+-]?\d+)?$")
"""A number with a decimal comma; a table with such numbers has another delimiter."""
WITH_UNIT = re.compile(r"^(.*?[a-z])[\s_/]*[\[(/_\s]\s*(mm|cm|m|ft|px)\s*[\])]?$")


def find_columns(names: list[str], given: Mapping[str, str] | None = None) -> tuple[dict[str, str], str]:
    """Return the column of each known quantity, and the unit in the names of x and y.

    Args:
        names: the columns of the file.
        given: columns that the user names, by quantity; the others are found by their usual names. If only the time
            is named, frames are not looked for.

    >>> find_columns(["ID", "Frame", "x [cm]", "y [cm]"])
    ({'id': 'ID', 'frame': 'Frame', 'x': 'x [cm]', 'y': 'y [cm]'}, 'cm')
    >>> find_columns(["who", "t", "x", "y"], {"id": "who"})
    ({'id': 'who', 'time': 't', 'x': 'x', 'y': 'y'}, '')
    """
    chosen = {"time" if meaning in TIME_QUANTITIES else meaning: name for meaning, name in (given or {}).items()}
    found: dict[str, str] = {}
    units = ""
    plain = {name: name.strip().lower() for name in names}
    for meaning, known in NAMES.items():
        if meaning == "frame" and "time" in chosen and "frame" not in chosen:
            continue
        for name, small in plain.items():
            wanted = name == chosen[meaning] if meaning in chosen else None
            unit = WITH_UNIT.match(small) if meaning in "xy" and small not in known else None
            usual = (unit.group(1) if unit else small) in known or (meaning == "time" and _is_time_with_unit(small))
            usual = usual and name not in chosen.values()
            if meaning not in found and (usual if wanted is None else wanted):
                found[meaning] = name
                units = unit.group(2) if unit else units
    if not {"x", "y"} & {*found, *chosen}:
        east, north = (next((n for n in names if plain[n] in known), None) for known in (LONGITUDE, LATITUDE))
        found |= {"x": east, "y": north} if east is not None and north is not None else {}
    if plain.get(found.get("x", "")) in LONGITUDE and plain.get(found.get("y", "")) in LATITUDE:
        units = "deg"
    if plain.get(found.get("x", "")) in LATITUDE and plain.get(found.get("y", "")) in LONGITUDE:
        raise InputError(f"columns x={found['x']} y={found['y']}: x is the longitude and y the latitude, exchange them")
    return found, units


def time_unit(column: str, given: Mapping[str, str] | None = None) -> str:
    """Return the unit of a time column that the user or its name says, one of ``TIME_UNITS``; empty for seconds.

    >>> time_unit("timestamp_ms"), time_unit("clock [us]"), time_unit("stamp", {"time_ns": "stamp"}), time_unit("time")
    ('milliseconds', 'microseconds', 'nanoseconds', '')
    """
    named = next((unit for meaning, unit in TIME_QUANTITIES.items() if (given or {}).get(meaning) == column), "")
    if named:
        return named
    unit = TIME_WITH_UNIT.match(column.strip().lower())
    return next((long for long, short in zip(TIME_UNITS, unit.groups()[1:], strict=True) if short), "") if unit else ""


def parts_of_seconds(column: str, names: list[str]) -> str:
    """Return the column of nanoseconds beside one of whole seconds, as in the stamps of ROS; empty without one.

    >>> parts_of_seconds("header.stamp.sec", ["header.stamp.sec", "header.stamp.nanosec", "x"])
    'header.stamp.nanosec'
    """
    whole = WHOLE_SECONDS.match(column.strip().lower())
    if whole is None:
        return ""
    wanted = {f"{whole[1]}{word}" for word in ("nanosec", "nanosecs", "nsec", "nsecs")}
    return next((name for name in names if name.strip().lower() in wanted), "")


def _is_time_with_unit(small: str) -> bool:
    unit = TIME_WITH_UNIT.match(small)
    if not unit:
        return False
    return unit.group(1) in NAMES["time"] if unit.group(1) else small in TIME_UNITS


def check_columns(
    found: Mapping[str, str], names: list[str], name: str, given: Mapping[str, str] | None = None
) -> None:
    """Raise :class:`DataError` with the missing columns, the existing ones, and the accepted names."""
    held = ", ".join(names[:20]) or "none"
    for meaning, column in (given or {}).items():
        if column not in names:
            raise DataError(
                f"{name} has no column {column!r} for {meaning}{did_you_mean(column, names)}; it has {held}"
            )
    missing = [meaning for meaning in ("id", "x", "y") if meaning not in found]
    if not {"frame", "time"} & set(found):
        missing.append("frame")
    if missing:
        known = "; ".join(f"{meaning} may be called {', '.join(NAMES[meaning])}" for meaning in missing)
        raise DataError(
            f"{name} has no column for {', '.join(missing)}; it has {held}; {known};"
            " or name the columns (--columns id=NAME ...)"
        )


def check_quantities(given: Mapping[str, str]) -> None:
    """Raise :class:`InputError` for columns of unknown quantities."""
    known = [meaning for meaning in (*NAMES, *TIME_QUANTITIES) if meaning != "height"]
    for meaning in given:
        if meaning not in known:
            raise InputError(
                f"columns: unknown {meaning!r}{did_you_mean(meaning, known)}; known are {', '.join(known)}"
            )


def numbers(values: NDArray[Any], column: str, name: str, line: Lines) -> NDArray[np.float64]:
    """Return a column as float64; an empty cell is NaN.

    Raises:
        DataError: a cell is not a number.
    """
    try:
        return values.astype(np.float64)
    except (ValueError, TypeError):
        read = [_number(value) for value in _pointed(values.tolist())]
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
    result: dict[int, str] = {}
    for key, label in zip(id.tolist(), values.tolist(), strict=True):
        if label not in (None, "") and key not in result:
            result[key] = str(label)
    return result


def _pointed(values: list[Any]) -> list[Any]:
    """Return the cells with decimal points if all of them are numbers with at most one decimal comma."""
    words = [value for value in values if isinstance(value, str) and value != ""]
    if not any("," in word for word in words) or not all(DECIMAL_COMMA.match(word.strip()) for word in words):
        return values
    return [value.replace(",", ".") if isinstance(value, str) else value for value in values]


def _number(value: Any) -> float | None:
    if value is None or value == "":
        return np.nan
    try:
        return float(value)
    except (ValueError, TypeError):
        return None

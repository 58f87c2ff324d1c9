"""Recorded poses of a person: CSV or JSON lines."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from crowdbot.core import InputError

from .body_pose import ROW, BodyPose
from .pose_source import MAX_SPEED, PoseTrack

SEVEN = ("x", "y", "z", "qw", "qx", "qy", "qz")
HANDS = ("head", "left_hand", "right_hand")
COLUMNS = ("time", "x", "y", "heading", *(f"{part}_{name}" for part in HANDS for name in SEVEN))
"""Columns of a CSV file; only the first three are required."""
KEYS = ("time", "x", "y", "heading", *HANDS, "skeleton")
MOST_SAMPLES = 200_000


def read_pose_file(data: bytes, name: str, *, begin: float = 0.0, max_speed: float = MAX_SPEED) -> PoseTrack:
    r"""Return the poses of a file; ``time`` in it is in seconds and increases.

    A CSV file has a header with ``time``, ``x``, ``y`` and possibly ``heading`` and ``head_x`` to ``head_qz``,
    ``left_hand_x`` to ``left_hand_qz`` and ``right_hand_x`` to ``right_hand_qz``; a part whose cells are empty is not
    given. A file of JSON lines has one object per line, with the keys of :class:`BodyPose` and ``time``. Without
    ``heading``, a person looks along x.

    Args:
        data: content of the file.
        name: name of the file for messages; JSON lines end in ``.jsonl``, any other name is CSV.
        begin: time in the file at which the trial begins [s].
        max_speed: see :class:`PoseTrack`.

    Raises:
        InputError: the file is not valid; the message names the line.

    >>> track = read_pose_file(b"time,x,y,heading\n0,0,0,0\n1,2,0,0\n", "walk.csv")
    >>> track.at(0.5).x
    1.0
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{name} is not UTF-8 text") from None
    rows = _json_rows(text, name) if name.lower().endswith(".jsonl") else _csv_rows(text, name)
    times, poses = list[float](), list[Any]()
    for line, time, values in rows:
        if len(times) >= MOST_SAMPLES:
            raise InputError(f"{name} has more than {MOST_SAMPLES} samples")
        if isinstance(time, bool) or not isinstance(time, int | float) or not math.isfinite(time):
            raise InputError(f"{name}:{line}: time = {time!r} must be a finite number")
        if times and time <= times[-1] + begin:
            raise InputError(f"{name}:{line}: time {time:g} s must be later than in the line before")
        try:
            pose = BodyPose(**values)
        except (InputError, TypeError) as error:
            raise InputError(f"{name}:{line}: {str(error).removeprefix('BodyPose: ')}") from None
        times.append(float(time) - begin)
        poses.append(pose.row())
    if not times:
        raise InputError(f"{name} has no samples")
    return PoseTrack(np.array(times), np.array(poses).reshape(-1, ROW), max_speed=max_speed)


def _json_rows(text: str, name: str) -> Iterator[tuple[int, Any, dict[str, Any]]]:
    for line, part in enumerate(text.splitlines(), 1):
        if not part.strip():
            continue
        try:
            values = json.loads(part)
        except (ValueError, RecursionError) as error:
            raise InputError(f"{name}:{line}: this is not JSON: {error}") from None
        if not isinstance(values, dict):
            raise InputError(f"{name}:{line}: a line must be a JSON object with time, x and y")
        _check_names(values, KEYS, f"{name}:{line}")
        yield line, values.pop("time"), values


def _csv_rows(text: str, name: str) -> Iterator[tuple[int, Any, dict[str, Any]]]:
    try:
        rows = list(csv.reader(io.StringIO(text), strict=True))
    except csv.Error as error:
        raise InputError(f"{name} is not CSV: {error}") from None
    header = [cell.strip() for cell in rows[0]] if rows else []
    _check_names(header, COLUMNS, f"{name}:1")
    if len(set(header)) < len(header):
        raise InputError(f"{name}:1: a column has the same name as another")
    for part in HANDS:
        there = [f"{part}_{one}" in header for one in SEVEN]
        if any(there) and not all(there):
            raise InputError(f"{name}:1: {part} needs the columns {', '.join(f'{part}_{one}' for one in SEVEN)}")
    for line, cells in enumerate(rows[1:], 2):
        if not any(cell.strip() for cell in cells):
            continue
        if len(cells) != len(header):
            raise InputError(f"{name}:{line}: there are {len(cells)} cells, expected {len(header)} as in the header")
        numbers = {key: _number(cell, f"{name}:{line}: {key}") for key, cell in zip(header, cells, strict=True)}
        values: dict[str, Any] = {key: numbers[key] for key in ("x", "y", "heading") if numbers.get(key) is not None}
        for part in HANDS:
            seven = [numbers.get(f"{part}_{one}") for one in SEVEN]
            if any(one is not None for one in seven):
                values[part] = tuple(seven)
        _check_names(values, ("x", "y", "heading", *HANDS), f"{name}:{line}", ("x", "y"))
        yield line, numbers["time"], values


def _check_names(found: Any, known: tuple[str, ...], where: str, need: tuple[str, ...] = ("time", "x", "y")) -> None:
    for key in found:
        if key not in known:
            raise InputError(f"{where}: {str(key)[:40]!r} is unknown; known are {', '.join(known)}")
    missing = [key for key in need if key not in found]
    if missing:
        raise InputError(f"{where}: {', '.join(missing)} is missing")


def _number(cell: str, where: str) -> float | None:
    if not cell.strip():
        return None
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{where} = {cell.strip()[:40]!r} must be a finite number")
    return value

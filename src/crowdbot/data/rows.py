"""Rows of tracks as plain arrays: checks, and runs of consecutive rows.

A run is a part of one track without gaps. Windows are cut from runs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import DataError
from crowdbot.typing import Floats, Ints

LARGEST = 2.0**53
"""Largest range of integers that float64 represents exactly."""
FARTHEST = 1e12
"""Largest coordinate: a thousand times that of UTM in millimetres; a double has 1e-4 there."""


def where(name: str, index: int, line: Ints | None) -> str:
    """Return the location of a row for messages: its line in the file if known, else its row, counted from 1."""
    return f"{name} row {index + 1}" if line is None else f"{name} line {int(line[index])}"


def integers(values: ArrayLike, what: str, name: str, line: Ints | None = None) -> Ints:
    """Return ``values`` as int64.

    Raises:
        DataError: a value is not a whole number below 2**53.
    """
    array = np.asarray(values)
    if array.dtype.kind in "iu":
        return array.astype(np.int64)
    number = floats(array, what, name)
    with np.errstate(invalid="ignore"):
        wrong = ~((number == np.rint(number)) & (np.abs(number) < LARGEST))
    if np.any(wrong):
        index = int(np.argmax(wrong))
        raise DataError(f"{where(name, index, line)}: {what} is {number[index]}, it must be a whole number below 2**53")
    return number.astype(np.int64)


def floats(values: ArrayLike, what: str, name: str) -> Floats:
    """Return ``values`` as float64.

    Raises:
        DataError: a value is not a number.
    """
    try:
        return np.asarray(values, dtype=np.float64)
    except (ValueError, TypeError):
        raise DataError(f"{name}: the column {what} must hold numbers") from None


def check_rows(id: Ints, frame: Ints, x: Floats, y: Floats, name: str, line: Ints | None = None) -> NDArray[np.intp]:
    """Return the order that sorts the rows by frame, then id.

    Raises:
        DataError: there are no rows, a coordinate is not finite or above 1e12, or a (frame, id) pair is duplicated.
    """
    if len(frame) == 0:
        raise DataError(f"{name} has no rows")
    for axis, values in (("x", x), ("y", y)):
        wrong = ~np.isfinite(values)
        if np.any(wrong):
            index = int(np.argmax(wrong))
            raise DataError(
                f"{where(name, index, line)}: {axis} is {values[index]} for frame {frame[index]}, id {id[index]};"
                " coordinates must be finite, remove rows without a position"
            )
        if np.max(np.abs(values)) > FARTHEST:
            index = int(np.argmax(np.abs(values)))
            raise DataError(
                f"{where(name, index, line)}: {axis} is {values[index]} for frame {frame[index]}, id {id[index]};"
                f" coordinates must be at most {FARTHEST:g}, remove rows without a position"
            )
    order = np.lexsort((id, frame))
    twice = (np.diff(frame[order]) == 0) & (np.diff(id[order]) == 0)
    if np.any(twice):
        index = int(np.min(order[1:][twice]))
        raise DataError(
            f"{where(name, index, line)}: frame {frame[index]}, id {id[index]} is a duplicate;"
            " a person has one position per frame, remove the other row"
        )
    return order


def frame_step(id: Ints, frame: Ints) -> int:
    """Return the frames between two rows of a track: the most frequent difference.

    >>> frame_step(np.array([1, 1, 1, 2]), np.array([0, 10, 20, 10]))
    10
    """
    order = np.lexsort((frame, id))
    steps = np.diff(frame[order])[np.diff(id[order]) == 0]
    if len(steps) == 0:
        steps = np.diff(np.unique(frame))
    if len(steps) == 0:
        return 1
    values, counts = np.unique(steps, return_counts=True)
    return int(values[np.argmax(counts)])


@dataclass(frozen=True)
class Runs:
    """Rows sorted by id, then frame, and their positions in their runs.

    Fields:
        order: ``[N]`` the rows of the table in this order.
        instant: ``[N]`` position of the row's frame among the existing frames of the file.
        behind: ``[N]`` rows of the run up to and including this one.
        ahead: ``[N]`` rows of the run after this one.
        frames: ``[F]`` the existing frames.
    """

    order: NDArray[np.intp]
    instant: Ints
    behind: Ints
    ahead: Ints
    frames: Ints


def runs(id: Ints, frame: Ints, step: int | None = None) -> Runs:
    """Find the runs of a table.

    Args:
        id, frame: ``[N]``.
        step: frames between two rows of a run; None takes neighbours among the existing frames, so frames without
            people are not gaps (as in the loader of SGAN).
    """
    order = np.lexsort((frame, id))
    own, count = id[order], len(order)
    frames = np.unique(frame)
    instant = np.searchsorted(frames, frame[order]).astype(np.int64)
    away = np.diff(instant) == 1 if step is None else np.diff(frame[order]) == step
    begins = np.concatenate([[True], ~((np.diff(own) == 0) & away)])
    here = np.arange(count)
    first = np.maximum.accumulate(np.where(begins, here, 0))
    ends = np.concatenate([begins[1:], [True]])
    last = np.minimum.accumulate(np.where(ends, here, count)[::-1])[::-1]
    return Runs(order, instant, here - first + 1, last - here, frames)

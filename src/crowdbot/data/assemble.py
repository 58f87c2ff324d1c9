"""From the columns of a file to Trajectories: what the user says, what the file says, what the field assumes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import DataError, did_you_mean

from .rows import check_rows, floats, frame_step, integers
from .source import MAX_ROWS, Given, Source
from .trajectories import Trajectories

__all__ = ["PER_METRE", "assemble", "check_fps", "check_units"]

PER_METRE = {"m": 1.0, "cm": 100.0, "mm": 1000.0, "px": 1.0}
"""Units of a file in one metre; pixels stay pixels."""

VIDEO_FPS = {6: 15.0, 10: 25.0, 12: 30.0}
"""Rows of 0.4 s: ETH's own file, UCY and the leave-one-out files, and the TrajNet cut of the Stanford drone data."""

FASTEST = 10_000.0


def assemble(
    source: Source,
    given: Given,
    *,
    id: ArrayLike,
    frame: ArrayLike,
    x: ArrayLike,
    y: ArrayLike,
    counter_fps: float | None = None,
    row_fps: float | None = None,
    units: str = "m",
    note: str = "",
    line: NDArray[np.int64] | None = None,
    **rest: Any,
) -> Trajectories:
    """Make Trajectories out of the columns of a file.

    Args:
        source, given: the file, and what the user says about it.
        id, frame, x, y: columns ``[N]`` as they stand in the file.
        counter_fps: frames of the file's counter a second, when the file or its format says so.
        row_fps: rows of a track a second, when the file says that instead.
        units: ``m``, ``cm``, ``mm`` or ``px``, when the user does not say.
        note: what a reader of results should know.
        line: ``[N]`` line of each row in the file, for messages.
        rest: other fields of :class:`Trajectories`.

    Raises:
        DataError: a value is not allowed, or nobody knows the frame rate.
    """
    name = source.name
    if np.size(frame) > MAX_ROWS:
        raise DataError(f"{name} has {np.size(frame)} rows, more than the {MAX_ROWS} that are read; cut it in time")
    frames = integers(frame, "frame", name, line)
    ids = integers(id, "id", name, line)
    place = [floats(x, "x", name), floats(y, "y", name)]
    check_rows(ids, frames, place[0], place[1], name, line)
    step = int(rest.pop("frame_step", 0)) or frame_step(ids, frames)
    rate, assumed = _rate(step, given, name, row_fps if counter_fps is None else counter_fps / step)
    units = given.units or units
    if PER_METRE[units] != 1.0:
        place = [axis / PER_METRE[units] for axis in place]
    return Trajectories(
        id=ids,
        frame=frames,
        x=place[0],
        y=place[1],
        frame_rate=rate,
        frame_step=step,
        units="px" if units == "px" else "m",
        name=source.path.name,
        note="; ".join(part for part in (note, assumed) if part),
        **rest,
    )


def check_fps(fps: float, name: str = "") -> float:
    """Return ``fps`` [1/s] when it can be a frame rate.

    Raises:
        DataError: it is not above 0 and at most 10000.
    """
    if not 0.0 < fps <= FASTEST or not math.isfinite(fps):
        place = f"{name}: " if name else ""
        raise DataError(
            f"{place}fps {fps} is not allowed, it is the rows a second of one track: above 0, at most {FASTEST}"
        )
    return float(fps)


def check_units(units: str | None) -> None:
    """Raise :class:`DataError` unless the unit is known."""
    if units is not None and units not in PER_METRE:
        raise DataError(f"unknown units {units!r}{did_you_mean(units, PER_METRE)}; known are {', '.join(PER_METRE)}")


def _rate(step: int, given: Given, name: str, told: float | None) -> tuple[float, str]:
    if given.fps is not None:
        return check_fps(given.fps), ""
    if told is not None:
        return check_fps(told, name), ""
    if step in VIDEO_FPS:
        return VIDEO_FPS[step] / step, f"no frame rate in the file: {step} frames are taken as 0.4 s, as in ETH/UCY"
    raise DataError(
        f"{name} does not say its frame rate, and rows {step} frames apart are no convention of the field;"
        " give fps, the rows a second of one track"
    )

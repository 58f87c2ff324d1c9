"""Assemble Trajectories from the columns of a file; options of the user override the file and its conventions."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import DataError, did_you_mean
from crowdbot.data.rows import check_rows, floats, frame_step, integers
from crowdbot.data.source import MAX_ROWS, Source
from crowdbot.data.trajectories import Trajectories

from .reader import ReadOptions
from .time_base import check_walkers, row_rate_of

__all__ = ["PER_METRE", "assemble", "check_units"]

PER_METRE = {"m": 1.0, "cm": 100.0, "mm": 1000.0, "ft": 1.0 / 0.3048, "px": 1.0}
"""Units per metre; pixels are not converted."""


def assemble(
    source: Source,
    options: ReadOptions,
    *,
    id: ArrayLike,
    frame: ArrayLike,
    x: ArrayLike,
    y: ArrayLike,
    fps: float | None = None,
    row_rate: float | None = None,
    units: str = "m",
    note: str = "",
    line: NDArray[np.int64] | None = None,
    **rest: Any,
) -> Trajectories:
    """Assemble Trajectories from the columns of a file.

    Args:
        source, options: the file, and the options of the user.
        id, frame, x, y: columns ``[N]`` of the file.
        fps: frames per second of the frame counter [1/s], if the file or its format defines it.
        row_rate: rows per second of a track [1/s], if the file defines that instead.
        units: default units: ``m``, ``cm``, ``mm``, ``ft`` or ``px``.
        note: remarks on the data.
        line: ``[N]`` line of each row in the file, for messages.
        rest: other fields of :class:`Trajectories`.

    Raises:
        DataError: a value is not allowed, the frame rate is unknown, or ``options.fps`` is a row rate.
    """
    name = source.name
    if np.size(frame) > MAX_ROWS:
        raise DataError(f"{name} has {np.size(frame)} rows, more than the limit of {MAX_ROWS}; split it in time")
    frames = integers(frame, "frame", name, line)
    ids = integers(id, "id", name, line)
    place = [floats(x, "x", name), floats(y, "y", name)]
    check_rows(ids, frames, place[0], place[1], name, line)
    step = int(rest.pop("frame_step", 0)) or frame_step(ids, frames)
    rate, assumed = row_rate_of(step, options, name, fps, row_rate)
    units = options.units or units
    if PER_METRE[units] != 1.0:
        place = [axis / PER_METRE[units] for axis in place]
    tracks = Trajectories(
        id=ids,
        frame=frames,
        x=place[0],
        y=place[1],
        row_rate=rate,
        frame_step=step,
        units="px" if units == "px" else "m",
        name=source.path.name,
        note="; ".join(part for part in (note, assumed) if part),
        **rest,
    )
    return check_walkers(tracks, options)


def check_units(units: str | None) -> None:
    """Raise :class:`DataError` unless the unit is known."""
    if units is not None and units not in PER_METRE:
        raise DataError(f"unknown units {units!r}{did_you_mean(units, PER_METRE)}; known are {', '.join(PER_METRE)}")

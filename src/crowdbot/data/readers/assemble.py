"""Assemble Trajectories from the columns of a file; options of the user override the file and its conventions."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import DataError, did_you_mean
from crowdbot.data.rows import check_rows, floats, frame_step, integers
from crowdbot.data.source import MAX_ROWS, Source
from crowdbot.data.trajectories import Trajectories

from .plausibility import METRES_PER_DEGREE, FileColumns, check_walkers
from .reader import ReadOptions
from .time_base import row_rate_of

PER_METRE = {
    "m": 1.0, "cm": 100.0, "mm": 1000.0, "km": 0.001, "ft": 1.0 / 0.3048, "px": 1.0, "deg": 1.0 / METRES_PER_DEGREE,
}  # fmt: skip
"""Units per metre; pixels are not converted, and degrees of longitude depend on the latitude, too."""


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
    columns: FileColumns | None = None,
    **rest: Any,
) -> Trajectories:
    """Assemble Trajectories from the columns of a file.

    Args:
        source, options: the file, and the options of the user.
        id, frame, x, y: columns ``[N]`` of the file.
        fps: frames per second of the frame counter [1/s], if the file or its format defines it.
        row_rate: rows per second of a track [1/s], if the file defines that instead.
        units: default units, one of :data:`crowdbot.data.UNITS`.
        note: remarks on the data.
        line: ``[N]`` line of each row in the file, for messages.
        columns: names of the time column and of the third coordinate, for the plausibility check.
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
    columns = columns or FileColumns()
    if units == "deg":
        place, origin = _local_metres(place[0], place[1], name, columns.exchange)
        converted = f"degrees are converted to metres east (x) and north (y) of longitude {origin[0]:.7g}"
        note = "; ".join(filter(None, (note, f"{converted}, latitude {origin[1]:.7g}")))
        columns = columns._replace(origin=origin)
    elif PER_METRE[units] != 1.0:
        place = [axis / PER_METRE[units] for axis in place]
        if columns.heights is not None:
            columns = columns._replace(heights=columns.heights / PER_METRE[units])
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
    return check_walkers(tracks, options, columns)


def _local_metres(
    longitude: NDArray[np.float64], latitude: NDArray[np.float64], name: str, exchange: str
) -> tuple[list[NDArray[np.float64]], tuple[float, float]]:
    """Return metres to the east and north of the middle of all places [degrees], and that origin."""
    for what, values, largest in (("longitude", longitude, 180.0), ("latitude", latitude, 90.0)):
        if np.max(np.abs(values)) > largest:
            wrong = values[np.argmax(np.abs(values))]
            remedy = ""
            if what == "latitude" and abs(wrong) <= 180.0 and np.max(np.abs(longitude)) <= largest:
                remedy = f"; x is probably the latitude and y the longitude, {exchange}"
            raise DataError(f"{name}: {what} is {wrong:g}, but degrees of {what} are at most {largest:g}{remedy}")
    east, north = (0.5 * float(np.min(axis) + np.max(axis)) for axis in (longitude, latitude))
    x = (longitude - east) * METRES_PER_DEGREE * np.cos(np.radians(north))
    y = (latitude - north) * METRES_PER_DEGREE
    return [x, y], (east, north)


def check_units(units: str | None) -> None:
    """Raise :class:`DataError` unless the unit is known."""
    if units is not None and units not in PER_METRE:
        raise DataError(f"unknown units {units!r}{did_you_mean(units, PER_METRE)}; known are {', '.join(PER_METRE)}")

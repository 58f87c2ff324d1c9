"""People who pass the area between two parallel lines: density and speed of each passage.

Names and definitions are those of PedPy (doi 10.5281/zenodo.7194992).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.data import Trajectories

from .flow import compute_crossing_frames
from .geometry import MeasurementArea, MeasurementLine
from .rows import Integers, check_metres, table

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["compute_frame_range_in_area", "compute_passing_density", "compute_passing_speed"]


def compute_frame_range_in_area(
    tracks: Trajectories, line: MeasurementLine, width: float
) -> tuple[pd.DataFrame, MeasurementArea]:
    """Return when each person passes the area between a line and its parallel, and this area.

    A passage enters through one line and leaves through the other without leaving the area in between. Columns: id,
    entering_frame, leaving_frame (the first frame outside).

    Args:
        tracks: the recording.
        line: first line.
        width: distance of the second line [m], to the left of the way from start to end of the first; negative: right.

    Raises:
        InputError: the width is 0 or not finite.
        DataError: the tracks are in pixels.
    """
    check_metres(tracks)
    if not np.isfinite(width) or width == 0.0:
        raise InputError(f"the second line of a passage must be apart from the first, not {width} m")
    second = line.offset(width)
    area = MeasurementArea(np.asarray([line.start, line.end, second.end, second.start]))
    id, enter, leave = _stays(tracks, area.contains(tracks.position))
    met = [
        compute_crossing_frames(tracks, one, count_on_line=True).drop_duplicates().to_numpy() for one in (line, second)
    ]
    starts = [_pairs_in(id, enter, crossings) for crossings in met]
    ends = [_pairs_in(id, leave, crossings) for crossings in met]
    kept = (starts[0] & ends[1]) | (starts[1] & ends[0])
    order = np.lexsort((enter[kept], id[kept]))
    return table(id=id[kept][order], entering_frame=enter[kept][order], leaving_frame=leave[kept][order]), area


def compute_passing_density(density: pd.DataFrame, passages: pd.DataFrame) -> pd.DataFrame:
    """Return the mean density [1/m2] in the area during the passage of each person: columns id, density.

    Args:
        density: result of :func:`~crowdbot.measurement.compute_classic_density` in the area of the passages.
        passages: result of :func:`compute_frame_range_in_area`.
    """
    frame = density.frame.to_numpy()
    total = np.concatenate([[0.0], np.cumsum(density.density.to_numpy())])
    first = np.searchsorted(frame, passages.entering_frame.to_numpy())
    last = np.searchsorted(frame, passages.leaving_frame.to_numpy())
    return table(id=passages.id.to_numpy(), density=(total[last] - total[first]) / np.maximum(last - first, 1))


def compute_passing_speed(tracks: Trajectories, passages: pd.DataFrame, distance: float) -> pd.DataFrame:
    """Return the mean speed [m/s] of each passage: columns id, speed; distance [m] over the time in the area."""
    frames = passages.leaving_frame.to_numpy() - passages.entering_frame.to_numpy()
    return table(id=passages.id.to_numpy(), speed=tracks.fps * abs(distance) / frames)


def _stays(tracks: Trajectories, inside: NDArray[np.bool_]) -> tuple[Integers, Integers, Integers]:
    """Return id, first frame and the frame after the last of every uninterrupted stay inside."""
    rows = np.flatnonzero(inside)
    rows = rows[np.lexsort((tracks.frame[rows], tracks.id[rows]))]
    id, frame = tracks.id[rows], tracks.frame[rows]
    new = np.ones(len(rows), dtype=np.bool_)
    new[1:] = (id[1:] != id[:-1]) | (np.diff(frame) > tracks.frame_step)
    last = np.append(new[1:], True)[: len(rows)]
    return id[new], frame[new], frame[last] + tracks.frame_step


def _pairs_in(id: Integers, frame: Integers, crossings: Integers) -> NDArray[np.bool_]:
    known = {(int(who), int(when)) for who, when in crossings}
    return np.asarray([(int(who), int(when)) in known for who, when in zip(id, frame, strict=True)], dtype=np.bool_)

"""Speed and acceleration of each person, and their means in an area.

Definitions and names are those of PedPy (Schrödter et al., doi 10.5281/zenodo.7194992). ``v_i(t) = |x_i(t + n/fps) -
x_i(t - n/fps)| / (2 n / fps)`` with n the frame step.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import InputError, did_you_mean
from crowdbot.data import Trajectories

from .geometry import MeasurementArea
from .rows import Floats, Integers, check_metres, check_step, every_frame, rows_at, table

if TYPE_CHECKING:
    import pandas as pd

__all__ = [
    "BORDERS",
    "compute_individual_acceleration",
    "compute_individual_speed",
    "compute_mean_speed_per_frame",
    "compute_voronoi_speed",
]

BORDERS = {
    "exclude": "rows whose window is not complete are left out",
    "adaptive": "the window shrinks symmetrically towards the ends of a track",
    "single-sided": "at the ends of a track, only one half of the window is used",
}
"""What is done at the ends of a track."""


def compute_individual_speed(
    tracks: Trajectories, frame_step: int, direction: ArrayLike | None = None, border: str = "exclude"
) -> pd.DataFrame:
    """Return speed and velocity of every person and frame: columns id, frame, speed, v_x, v_y [m/s].

    Args:
        tracks: the recording.
        frame_step: frames of the recording before and after a frame that are compared.
        direction: ``[2]`` only the movement along this vector counts, signed (default: any direction).
        border: ``exclude``, ``adaptive`` or ``single-sided``, see ``BORDERS``.

    Raises:
        InputError: an argument is not allowed.
        DataError: the tracks are in pixels.

    >>> tracks = Trajectories([1, 1, 1], [0, 1, 2], [0.0, 0.5, 1.0], [0.0, 0.0, 0.0], row_rate=2.0)
    >>> compute_individual_speed(tracks, 1).speed.tolist()
    [1.0]
    >>> compute_individual_speed(tracks, 1, border="single-sided").speed.tolist()
    [1.0, 1.0, 1.0]
    """
    check_metres(tracks)
    check_step(tracks, frame_step)
    before, after = _window(tracks, frame_step, border)
    kept = (before >= 0) & (after >= 0) & (before != after)
    before, after = before[kept], after[kept]
    seconds = (tracks.frame[after] - tracks.frame[before]) / tracks.fps
    moved = tracks.position[after] - tracks.position[before]
    along, size = _project(moved, direction)
    velocity = along / seconds[:, None]
    return table(
        id=tracks.id[kept], frame=tracks.frame[kept], speed=size / seconds, v_x=velocity[:, 0], v_y=velocity[:, 1]
    )


def compute_individual_acceleration(
    tracks: Trajectories, frame_step: int, direction: ArrayLike | None = None
) -> pd.DataFrame:
    """Return the acceleration of every person and frame: columns id, frame, acceleration, a_x, a_y [m/s2].

    ``a_i(t) = |x(t) - 2 x(t - n/fps) + x(t - 2 n/fps)| / (n / fps)^2``; rows without both earlier rows are left out.

    Raises:
        InputError, DataError: as in :func:`compute_individual_speed`.

    >>> tracks = Trajectories([1, 1, 1], [0, 1, 2], [0.0, 0.5, 2.0], [0.0, 0.0, 0.0], row_rate=1.0)
    >>> compute_individual_acceleration(tracks, 1).acceleration.tolist()
    [1.0]
    """
    check_metres(tracks)
    check_step(tracks, frame_step)
    mid, start = rows_at(tracks, tracks.frame - frame_step), rows_at(tracks, tracks.frame - 2 * frame_step)
    kept = (mid >= 0) & (start >= 0)
    place = tracks.position
    change = (place[kept] - place[mid[kept]]) - (place[mid[kept]] - place[start[kept]])
    along, size = _project(change, direction)
    seconds2 = (frame_step / tracks.fps) ** 2
    vector = along / seconds2
    return table(
        id=tracks.id[kept], frame=tracks.frame[kept], acceleration=size / seconds2, a_x=vector[:, 0], a_y=vector[:, 1]
    )


def compute_mean_speed_per_frame(tracks: Trajectories, speed: pd.DataFrame, area: MeasurementArea) -> pd.DataFrame:
    """Return the mean speed of the people inside an area in each frame: columns frame, speed [m/s].

    Frames without people inside are NaN (PedPy: 0).

    Raises:
        InputError: the table of speeds lacks a row of the recording.

    >>> tracks = Trajectories([1, 2, 1, 2], [0, 0, 1, 1], [0.0, 1.0, 1.0, 4.0], [0.0] * 4, row_rate=1.0)
    >>> speed = compute_individual_speed(tracks, 1, border="single-sided")
    >>> area = MeasurementArea([(-1, -1), (3, -1), (3, 1), (-1, 1)])
    >>> compute_mean_speed_per_frame(tracks, speed, area).speed.tolist()
    [2.0, 1.0]
    """
    values = _speed_of_rows(tracks, speed)
    frames = every_frame(tracks)
    inside = area.contains(tracks.position)
    slot = (tracks.frame[inside] - frames[0]) // tracks.frame_step
    total = np.bincount(slot, values[inside], minlength=len(frames))
    count = np.bincount(slot, minlength=len(frames))
    return table(frame=frames, speed=np.where(count > 0, total / np.maximum(count, 1), np.nan))


def compute_voronoi_speed(
    tracks: Trajectories, speed: pd.DataFrame, polygons: pd.DataFrame, area: MeasurementArea
) -> pd.DataFrame:
    """Return the Voronoi speed of an area in each frame: columns frame, speed [m/s].

    ``v(t) = sum_i v_i(t) A(V_i(t) and M) / A(M)`` with the Voronoi cells V_i and the area M.

    Args:
        tracks: the recording.
        speed: result of :func:`compute_individual_speed` with a row for every person and frame.
        polygons: result of :func:`~crowdbot.measurement.compute_individual_voronoi_polygons`.
        area: area M.

    Raises:
        InputError: the table of speeds lacks a row.
    """
    import shapely

    joined = polygons.merge(speed, on=["id", "frame"], how="left")
    if joined.speed.isna().any():
        raise _missing_speed()
    weight = shapely.area(shapely.intersection(joined.polygon.to_numpy(), area.polygon)) / area.area
    frames = every_frame(tracks)
    slot = ((joined.frame - frames[0]) // tracks.frame_step).to_numpy()
    return table(frame=frames, speed=np.bincount(slot, weight * joined.speed.to_numpy(), minlength=len(frames)))


def _window(tracks: Trajectories, frame_step: int, border: str) -> tuple[Integers, Integers]:
    """Return the rows at the begin and at the end of the window of every row, -1 where there is none."""
    if border not in BORDERS:
        raise InputError(f"unknown border {border!r}{did_you_mean(border, BORDERS)}; known are {', '.join(BORDERS)}")
    step = np.full(len(tracks), frame_step)
    if border == "adaptive":
        who = np.searchsorted(tracks.ids, tracks.id)
        first = np.full(len(tracks.ids), tracks.frame[-1])
        last = np.full(len(tracks.ids), tracks.frame[0])
        np.minimum.at(first, who, tracks.frame)
        np.maximum.at(last, who, tracks.frame)
        step = np.minimum(step, np.minimum(tracks.frame - first[who], last[who] - tracks.frame))
    before, after = rows_at(tracks, tracks.frame - step), rows_at(tracks, tracks.frame + step)
    if border == "single-sided":
        here = np.arange(len(tracks))
        before, after = np.where(before < 0, here, before), np.where(after < 0, here, after)
    return before, after


def _project(moved: Floats, direction: ArrayLike | None) -> tuple[Floats, Floats]:
    """Return vectors along a direction and their signed lengths; all of them without a direction."""
    if direction is None:
        return moved, np.sqrt(moved[:, 0] ** 2 + moved[:, 1] ** 2)
    axis = np.asarray(direction, dtype=np.float64)
    if axis.shape != (2,) or not np.all(np.isfinite(axis)) or not np.any(axis):
        raise InputError("the direction of a movement must be two finite numbers that are not both 0")
    axis = axis / np.hypot(*axis)
    size = moved[:, 0] * axis[0] + moved[:, 1] * axis[1]
    return size[:, None] * axis, size


def _speed_of_rows(tracks: Trajectories, speed: pd.DataFrame) -> Floats:
    rows = rows_at(tracks, speed.frame.to_numpy(dtype=np.int64), speed.id.to_numpy(dtype=np.int64))
    values = np.full(len(tracks), np.nan)
    values[rows[rows >= 0]] = speed.speed.to_numpy()[rows >= 0]
    if np.any(np.isnan(values)):
        raise _missing_speed()
    return values


def _missing_speed() -> InputError:
    return InputError(
        "some people have a position but no speed; compute speeds with border='single-sided', or measure the inner part"
        " of the tracks only"
    )

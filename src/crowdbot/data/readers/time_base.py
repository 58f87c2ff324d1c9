"""Time base of a recording: frames per second, rows per second, and whether people can move at the resulting speeds.

``fps`` is frames per second of the frame counter. Rows of one track are ``step`` frames apart, so a row lasts
``step / fps`` seconds.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.data.trajectories import Trajectories

from .reader import ReadOptions

__all__ = ["RowRateError", "check_fps", "check_walkers", "row_rate_of"]

CONVENTIONAL_FPS = {6: 15.0, 10: 25.0, 12: 30.0}
"""fps by frame step of files with rows of 0.4 s: ETH, UCY and the leave-one-out files, and SDD in the TrajNet cut."""
MAX_FPS = 10_000.0
LONG_ROW, LONGEST_ROW = 1.0, 2.0
"""Time step [s] above which the speed decides whether ``fps`` is a row rate, and above which it always is one."""
MIN_ROW_RATE, MAX_ROW_RATE = 0.5, 15.0
"""Range of row rates of recordings of people [1/s]; another ``fps`` is not taken for one."""
SLOWEST, FASTEST = 0.02, 5.0
"""Range of the median speed of people [m/s]."""
SPEED_TIME = 0.4
"""Time over which speeds are measured in recordings with shorter steps [s]."""
MOVING, SLOW_WALK, FAST_WALK = 0.2, 0.3, 2.5
"""Speed above which people move, and range of the median speed of those who do [m/s]."""


class RowRateError(DataError):
    """``fps`` is given in rows per second; the attribute ``fps`` has it in frames per second [1/s]."""

    def __init__(self, message: str, fps: float) -> None:
        self.fps = fps
        super().__init__(message)


def check_fps(fps: float, name: str = "") -> float:
    """Return ``fps`` [1/s] as a float.

    Raises:
        DataError: it is not above 0 and at most 10000.
    """
    if not 0.0 < fps <= MAX_FPS or not math.isfinite(fps):
        place = f"{name}: " if name else ""
        raise DataError(
            f"{place}fps {fps} is not allowed, it is the number of frames per second: above 0, at most {MAX_FPS:g}"
        )
    return float(fps)


def row_rate_of(
    step: int, options: ReadOptions, name: str, fps: float | None, row_rate: float | None
) -> tuple[float, str]:
    """Return rows per second of a track [1/s], and a note if the value is assumed.

    The option ``fps`` wins over the ``fps`` of the file, that over its ``row_rate``, and that over the conventions.

    Args:
        step: frames between two rows of a track.
        options: options of the user.
        name: name of the file, for messages.
        fps: frames per second according to the file or its format.
        row_rate: rows per second according to the file.

    Raises:
        DataError: a rate is not allowed, or there is none.
    """
    if options.fps is not None:
        return check_fps(options.fps) / step, ""
    if fps is not None:
        return check_fps(fps / step, name), ""
    if row_rate is not None:
        return check_fps(row_rate, name), ""
    if step in CONVENTIONAL_FPS:
        note = f"no frame rate in the file: {step} frames are interpreted as 0.4 s, as in ETH/UCY; fps overrides this"
        return CONVENTIONAL_FPS[step] / step, note
    raise DataError(
        f"{name} has no frame rate, and a step of {step} frames is not a convention of the field;"
        f" give fps, the frames per second (rows of a track are then {step} / fps seconds apart)"
    )


def check_walkers(tracks: Trajectories, options: ReadOptions) -> Trajectories:
    """Return the tracks, with a warning in their note if their speeds are not those of people who walk.

    Raises:
        RowRateError: ``options.fps`` is 0.5 to 15 and makes the time step longer than 2 s, or longer than 1 s at a
            speed that is impossible, but possible with the same number as rows per second.
    """
    speed = _median_speed(tracks)
    fps, step = options.fps, tracks.frame_step
    if fps is not None and step > 1:
        slow = tracks.dt > LONG_ROW and _impossible(speed) and not _impossible(speed * step)
        if MIN_ROW_RATE <= fps <= MAX_ROW_RATE and (tracks.dt > LONGEST_ROW or slow):
            moved = "" if math.isnan(speed) else f" and the median speed {speed:.2g} m/s"
            raise RowRateError(
                f"{tracks.name}: fps {fps:g} makes the time step {tracks.dt:.4g} s ({step} frames per row){moved};"
                f" fps is frames per second, for {fps:g} rows per second give fps {fps * step:g}",
                fps * step,
            )
    given = fps is not None or options.units is not None
    if speed > FASTEST or (given and speed < SLOWEST):
        warning = f"warning: the median speed {speed:.2g} m/s is impossible for people, check fps and units"
    else:
        warning = _walking_warning(tracks)
    if not warning:
        return tracks
    return dataclasses.replace(tracks, note="; ".join(filter(None, (tracks.note, warning))))


def _walking_warning(tracks: Trajectories) -> str:
    """Return a warning if the people who move do not walk, else an empty text."""
    speed = _speeds(tracks)
    moving = speed[speed > MOVING]
    usual = float(np.median(moving)) if len(moving) > 0.1 * len(speed) else math.nan
    if SLOW_WALK <= usual <= FAST_WALK or math.isnan(usual):
        return ""
    return (
        f"warning: people who move have a median speed of {usual:.2g} m/s, people who walk {SLOW_WALK:g} to"
        f" {FAST_WALK:g} m/s; check fps and units"
    )


def _median_speed(tracks: Trajectories) -> float:
    """Return the median speed of people [m/s]; NaN if no one has two rows, or the units are pixels."""
    known = _speeds(tracks)
    return float(np.median(known)) if len(known) else math.nan


def _speeds(tracks: Trajectories) -> NDArray[np.float64]:
    """Return the speeds of people [m/s]; none if the units are pixels.

    Rows of a video are compared with those about 0.4 s before: boxes of whole pixels stand still from frame to frame.
    """
    if tracks.units != "m":
        return np.empty(0)
    others = sorted(tracks.robots | tracks.other_agents.keys())
    people = ~np.isin(tracks.id, np.asarray(others, dtype=np.int64))
    with np.errstate(over="ignore", invalid="ignore"):
        apart = _speeds_over(tracks, people, round(SPEED_TIME / tracks.dt))
        if len(apart):
            return apart
        velocity = tracks.velocities()[people]
        speed = np.hypot(velocity[:, 0], velocity[:, 1])
    return np.asarray(speed[~np.isnan(speed)])


def _speeds_over(tracks: Trajectories, people: NDArray[np.bool_], rows: int) -> NDArray[np.float64]:
    """Return the speeds of people between rows of a track that are this many rows apart [m/s]; none below 2 rows."""
    if rows < 2:
        return np.empty(0)
    order = np.lexsort((tracks.frame[people], tracks.id[people]))
    id, frame = tracks.id[people][order], tracks.frame[people][order]
    place = tracks.position[people][order]
    whole = (id[rows:] == id[:-rows]) & (frame[rows:] - frame[:-rows] == rows * tracks.frame_step)
    moved = (place[rows:] - place[:-rows])[whole]
    return np.asarray(np.hypot(moved[:, 0], moved[:, 1]) / (rows * tracks.dt))


def _impossible(speed: float) -> bool:
    return speed < SLOWEST or speed > FASTEST

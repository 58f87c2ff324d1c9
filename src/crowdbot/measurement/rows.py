"""Rows of tracks at other frames of the same person, and tables of results."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError
from crowdbot.data import Trajectories
from crowdbot.typing import Ints

if TYPE_CHECKING:
    import pandas as pd


def table(**columns: Any) -> pd.DataFrame:
    """Return a pandas table of columns of equal length."""
    import pandas as pd

    return pd.DataFrame(columns)


def check_metres(tracks: Trajectories) -> None:
    """Refuse tracks in pixels.

    Raises:
        DataError: the tracks are not in metres.
    """
    if tracks.units != "m":
        raise DataError(f"{tracks.name} is in pixels; measurements need metres, see Trajectories.metres")


def check_step(tracks: Trajectories, frame_step: int) -> None:
    """Refuse a frame step that no two rows of a track are apart.

    Raises:
        InputError: the step is not a positive multiple of the step of the recording.
    """
    if frame_step < 1 or frame_step % tracks.frame_step:
        raise InputError(
            f"frame step {frame_step}: it must be a positive multiple of {tracks.frame_step}, the frames between two"
            f" rows of {tracks.name}"
        )


def every_frame(tracks: Trajectories) -> Ints:
    """Return the frames from the first to the last of a recording, also those without people."""
    return np.arange(tracks.frame[0], tracks.frame[-1] + 1, tracks.frame_step)


def rows_at(tracks: Trajectories, frame: Ints, id: Ints | None = None) -> Ints:
    """Return the row of a person at a frame, -1 where there is none.

    Args:
        tracks: the recording.
        frame: ``[N]`` frames.
        id: ``[N]`` identities (default: those of the rows of the recording).

    >>> tracks = Trajectories([7, 7, 8], [0, 1, 1], [0.0, 1.0, 5.0], [0.0, 0.0, 0.0], row_rate=1.0)
    >>> rows_at(tracks, tracks.frame - 1).tolist()
    [-1, 0, -1]
    """
    who = tracks.id if id is None else id
    ids = tracks.ids
    rank = np.minimum(np.searchsorted(ids, who), len(ids) - 1)
    known = (ids[rank] == who) & (frame >= tracks.frame[0]) & (frame <= tracks.frame[-1])
    span = int(tracks.frame[-1] - tracks.frame[0]) + 1
    key = np.searchsorted(ids, tracks.id) * span + (tracks.frame - tracks.frame[0])
    order = np.argsort(key, kind="stable")
    wanted = np.where(known, rank * span + (frame - tracks.frame[0]), -1)
    index = np.minimum(np.searchsorted(key[order], wanted), len(order) - 1)
    return np.where(key[order][index] == wanted, order[index], -1)


def select_rows(tracks: Trajectories, rows: NDArray[np.bool_]) -> Trajectories:
    """Return the rows ``[N]`` of a recording that are True, with its time base.

    Raises:
        DataError: no row is left.

    >>> tracks = Trajectories([7, 7, 8], [0, 1, 1], [0.0, 1.0, 5.0], [0.0, 0.0, 0.0], row_rate=1.0)
    >>> select_rows(tracks, tracks.x < 3.0).ids.tolist()
    [7]
    """
    if not np.any(rows):
        raise DataError(f"{tracks.name}: no row is left to measure")
    arrays: dict[str, Any] = {name: getattr(tracks, name)[rows] for name in ("id", "frame", "x", "y")}
    ids = {int(id) for id in np.unique(arrays["id"])}
    labels = {id: label for id, label in tracks.labels.items() if id in ids}
    return dataclasses.replace(tracks, **arrays, robots=tracks.robots & ids, labels=labels, scenes=())

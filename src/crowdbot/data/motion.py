"""How fast people were walking, as it can be seen in the rows of a window."""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from .windows import Windows

__all__ = ["bridged", "cut", "observed_velocity"]


def cut(windows: Windows, first: int, last: int) -> Windows:
    """Return the rows ``first`` to ``last`` (not included) of every window."""
    rows = slice(first, last)
    return dataclasses.replace(
        windows,
        position=windows.position[:, rows],
        present=windows.present[:, rows],
        frame=windows.frame[:, rows],
    )


def bridged(windows: Windows) -> Windows:
    """Return the windows with the holes of every track filled by a straight, even walk; ends are left as they are.

    >>> import numpy as np
    >>> here = np.array([True, False, False, True, False])[None, :, None]
    >>> track = np.array([0.0, 0.0, 0.0, 6.0, 0.0])[None, :, None, None] * np.ones(2)
    >>> nobody = np.zeros((1, 1), dtype=bool)
    >>> windows = Windows(track, here, nobody, nobody, np.array([[7]]), np.arange(5)[None], 0.4, "all", "street")
    >>> bridged(windows).position[0, :, 0, 0].tolist()
    [0.0, 2.0, 4.0, 6.0, 0.0]
    """
    present = windows.present
    begun = np.logical_or.accumulate(present, axis=1)
    goes_on = np.logical_or.accumulate(present[:, ::-1], axis=1)[:, ::-1]
    hole = begun & goes_on & ~present
    if not np.any(hole):
        return windows
    row = np.arange(present.shape[1])[:, None]
    before = np.maximum.accumulate(np.where(present, row, 0), axis=1)
    after = np.minimum.accumulate(np.where(present, row, len(row) - 1)[:, ::-1], axis=1)[:, ::-1]
    share = (row - before) / np.maximum(after - before, 1)
    start = np.take_along_axis(windows.position, before[..., None], axis=1)
    end = np.take_along_axis(windows.position, after[..., None], axis=1)
    filled = np.where(hole[..., None], start + share[..., None] * (end - start), windows.position)
    return dataclasses.replace(windows, position=filled, present=present | hole)


def observed_velocity(past: Windows, displacements: int = 1) -> NDArray[np.float64]:
    """Return ``[W, A, 2]`` [m/s]: the mean velocity of every person over the last ``displacements`` steps.

    Holes are bridged; a track that begins later counts from its begin. Who was seen at the last row only, or is not
    there at the last row, gets 0.
    """
    known = bridged(past)
    now = known.position.shape[1] - 1
    first = max(0, now - displacements)
    since = first + np.argmax(known.present[:, first:], axis=1)
    start = np.take_along_axis(known.position, since[:, None, :, None], axis=1)[:, 0]
    time = np.maximum(now - since, 1) * past.dt
    velocity = (known.position[:, now] - start) / time[..., None]
    return np.where(known.present[:, now, :, None], velocity, 0.0)

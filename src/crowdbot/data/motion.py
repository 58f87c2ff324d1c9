"""Velocities estimated from the observed rows of windows, and gap filling."""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

from .windows import Windows

COMPANY = 8.0
"""Weight of the errors of the whole window, in rows: few rows of one track say little about its noise."""
TRUST = 20.0
"""Exponent of the errors in the weights of averages."""
CHUNK_NUMBERS = 2_000_000
"""Size of a chunk [numbers]."""


def slice_rows(windows: Windows, first: int, last: int) -> Windows:
    """Return the rows ``first`` to ``last`` (not included) of every window."""
    rows = slice(first, last)
    return dataclasses.replace(
        windows,
        position=windows.position[:, rows],
        present=windows.present[:, rows],
        frame=windows.frame[:, rows],
        covariance=None if windows.covariance is None else windows.covariance[:, rows],
    )


def fill_gaps(windows: Windows) -> Windows:
    """Return the windows with gaps inside tracks filled by linear interpolation.

    >>> import numpy as np
    >>> here = np.array([True, False, False, True, False])[None, :, None]
    >>> track = np.array([0.0, 0.0, 0.0, 6.0, 0.0])[None, :, None, None] * np.ones(2)
    >>> nobody = np.zeros((1, 1), dtype=bool)
    >>> windows = Windows(track, here, nobody, nobody, np.array([[7]]), np.arange(5)[None], 0.4, "all", "street")
    >>> fill_gaps(windows).position[0, :, 0, 0].tolist()
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


def resample_rows(windows: Windows, dt: float) -> Windows:
    """Return windows with rows every ``dt`` [s] back from the last row, interpolated linearly after gaps are filled.

    There are as many rows as the observed time contains, and at least two if two rows are observed. People observed for
    less than ``dt`` get a row before the last one from their :func:`steady_velocity`, so that they have a velocity.
    ``frame`` numbers the rows. Plans and covariances belong to the old rows and are left out.

    Raises:
        InputError: ``dt`` is not above 0 and finite.

    >>> import numpy as np
    >>> here = np.ones((1, 8, 1), dtype=bool)
    >>> track, nobody = 0.13 * np.arange(8.0)[None, :, None, None] * np.array([1.0, 0.0]), ~here[:, 0]
    >>> windows = Windows(track, here, nobody, nobody, np.array([[7]]), np.arange(8)[None], 0.1, "all", "street")
    >>> resample_rows(windows, 0.4).position[0, :, 0, 0].round(2).tolist()  # 1.3 m/s, up to 0.91 m
    [0.39, 0.91]
    """
    if not 0.0 < dt < np.inf:
        raise InputError(f"resample: dt = {dt} s must be above 0 and finite")
    known, rows = fill_gaps(windows), windows.position.shape[1]
    span = (rows - 1) * windows.dt
    count = max(int(span / dt + 1e-6) + 1, min(2, rows))
    at = rows - 1 - dt / windows.dt * np.arange(count - 1, -1, -1.0)
    near = np.round(at)
    at = np.where(np.abs(at - near) < 1e-6, near, at)
    before = np.clip(np.floor(at).astype(np.int64), 0, rows - 1)
    after = np.clip(np.ceil(at).astype(np.int64), 0, rows - 1)
    share = (at - before)[:, None, None]
    position = (1.0 - share) * known.position[:, before] + share * known.position[:, after]
    present = known.present[:, before] & known.present[:, after] & (at >= 0.0)[:, None]
    if count > 1:
        short = present[:, -1] & ~present[:, :-1].any(axis=1) & known.present[:, :-1].any(axis=1)
        back = position[:, -1] - dt * steady_velocity(known)
        position[:, -2] = np.where(short[..., None], back, position[:, -2])
        present[:, -2] |= short
    frame = np.broadcast_to(np.arange(count), (len(windows), count))
    position = np.where(present[..., None], position, 0.0)
    return dataclasses.replace(
        windows, position=position, present=present, frame=frame, dt=dt, plan=None, covariance=None
    )


def observed_velocity(past: Windows, displacements: int = 1) -> NDArray[np.float64]:
    """Return the mean velocity of every person over the last ``displacements`` steps, ``[W, A, 2]`` [m/s].

    Gaps are filled; a track that begins later counts from its first row. People who are present at the last row only,
    or absent at the last row, get 0.
    """
    known = fill_gaps(past)
    now = known.position.shape[1] - 1
    first = max(0, now - displacements)
    since = first + np.argmax(known.present[:, first:], axis=1)
    start = np.take_along_axis(known.position, since[:, None, :, None], axis=1)[:, 0]
    time = np.maximum(now - since, 1) * past.dt
    velocity = (known.position[:, now] - start) / time[..., None]
    return np.where(known.present[:, now, :, None], velocity, 0.0)


def steady_velocity(past: Windows) -> NDArray[np.float64]:
    """Return a velocity averaged according to the noise of the tracks, ``[W, A, 2]`` [m/s].

    The means of the last 1, 2, 3, ... displacements are weighted by how well each predicts observed rows from earlier
    ones: smooth tracks use the last displacement, noisy or swaying ones a long mean. The errors of all people in the
    window are pooled. Gaps are filled; people who are present at the last row only, or absent at the last row, get 0.

    >>> import numpy as np
    >>> x = np.array([0.0, 1.1, 1.9, 3.1, 3.9, 5.1, 5.9, 7.1])  # one metre a row, off by 0.1 m to and fro
    >>> here = np.ones((1, 8, 1), dtype=bool)
    >>> track, nobody = np.stack([x, 0.0 * x], axis=1)[None, :, None], ~here[:, 0]
    >>> windows = Windows(track, here, nobody, nobody, np.array([[7]]), np.arange(8)[None], 1.0, "all", "street")
    >>> round(float(observed_velocity(windows)[0, 0, 0]), 2), round(float(steady_velocity(windows)[0, 0, 0]), 2)
    (1.2, 1.0)
    """
    known = fill_gaps(past)
    W, T, A, _ = known.position.shape
    velocity = np.zeros((W, A, 2))
    lengths = _lengths(T - 1)
    size = max(1, CHUNK_NUMBERS // max(1, T * len(lengths) * A * 2))
    for first in range(0, W, size):
        part = slice(first, first + size)
        velocity[part] = _weighted_mean(known.position[part], known.present[part], lengths)
    return velocity / past.dt


def _lengths(most: int) -> NDArray[np.int64]:
    """Return the numbers of displacements to average: all up to 7, then growing by a third."""
    found = list(range(1, min(most, 7) + 1))
    while found and found[-1] < most:
        found.append(min(most, max(found[-1] + 1, found[-1] * 4 // 3)))
    return np.asarray(found, dtype=np.int64)


def _weighted_mean(
    position: NDArray[np.float64], present: NDArray[np.bool_], lengths: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return the weighted mean displacement ``[W, A, 2]`` [m] of tracks without gaps."""
    rows = position.shape[1]
    if rows < 2:
        return np.zeros_like(position[:, 0])
    begin = np.argmax(present, axis=1)
    row = np.arange(rows)
    whole = np.where((row[:, None] < begin[:, None])[..., None], _at(position, begin)[:, None], position)
    since = np.maximum(row[:, None] - lengths, 0)
    count = np.clip(row[:, None, None] - begin[:, None, None], 1, lengths[:, None])  # [W, T, K, A]
    mean = (whole[:, :, None] - whole[:, since]) / count[..., None]
    error, seen = _hindcast_errors(whole, present, mean, begin)
    people = np.maximum(np.sum(seen > 0.0, axis=-1), 1)[:, None]
    usual = np.sum(error, axis=-1) / people, np.sum(seen, axis=-1)[:, None] / people
    shared = (error + COMPANY * usual[0][..., None]) / np.maximum(seen[:, None] + COMPANY * usual[1][..., None], 1.0)
    tiny = np.finfo(np.float64).tiny
    weight = (np.maximum(shared.min(axis=1, keepdims=True), tiny) / np.maximum(shared, tiny)) ** TRUST
    weight /= np.sum(weight, axis=1, keepdims=True)
    best = np.sum(weight[..., None] * mean[:, -1], axis=1)
    return np.where(present[:, -1, :, None], best, 0.0)


def _hindcast_errors(
    whole: NDArray[np.float64], present: NDArray[np.bool_], mean: NDArray[np.float64], begin: NDArray[np.int64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return squared prediction errors of the means on observed rows ``[W, K, A]`` [m²], and counts ``[W, A]``."""
    W, T, A = present.shape
    error, seen = np.zeros((W, mean.shape[2], A)), np.zeros((W, A))
    walked = present & (np.arange(T)[:, None] > begin[:, None])  # a mean exists from the second row of a track on
    for ahead in sorted({max(1, round((T - 1) * share / 7)) for share in (1, 2, 3)}):
        ok = walked[:, :-ahead] & present[:, ahead:]
        off = (whole[:, ahead:] - whole[:, :-ahead])[:, :, None] - ahead * mean[:, :-ahead]
        squared = (off[..., 0] ** 2 + off[..., 1] ** 2) / ahead
        error += np.sum(np.where(ok[:, :, None], squared, 0.0), axis=1)
        seen += np.sum(ok, axis=1)
    return error, seen


def _at(position: NDArray[np.float64], row: NDArray[np.int64]) -> NDArray[np.float64]:
    return np.take_along_axis(position, row[:, None, :, None], axis=1)[:, 0]

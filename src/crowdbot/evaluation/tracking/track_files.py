"""Tracks of a tracker as a file that every reader of recordings reads."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from crowdbot.core import explain_write_errors
from crowdbot.perception import Tracks

COLUMNS = ("id", "time", "x", "y", "vx", "vy", "sd_x", "sd_y")


def write_tracks(tracks: Iterable[Tracks], file: Path) -> Path:
    """Write tracks as a table (CSV) of one row for each person and instant, and return the file.

    The columns are ``id``, ``time`` [s], ``x``, ``y`` [m], ``vx``, ``vy`` [m/s], and the standard deviations ``sd_x``
    and ``sd_y`` of the position [m]. :func:`crowdbot.data.load` and all commands for recordings read the file.

    Args:
        tracks: the tracks after each reading.
        file: output file.

    Raises:
        InputError: the file cannot be written.

    >>> import tempfile
    >>> from crowdbot.data import load
    >>> from crowdbot.perception import Detections, GlobalNearestNeighbor
    >>> tracker, tracks = GlobalNearestNeighbor(), []
    >>> state = tracker.begin()
    >>> for k in range(10):
    ...     found, state = tracker.update(Detections.of(0.1 * k, [[0.12 * k, 1.0]], 0.05), 0.1 * k, state)
    ...     tracks.append(found)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     load(write_tracks(tracks, Path(folder) / "tracks.csv")).y.mean().round(2).item()
    1.0
    """
    with explain_write_errors(file), file.open("w", newline="", encoding="utf-8") as stream:
        table = csv.writer(stream)
        table.writerow(COLUMNS)
        for row in tracks:
            spread = np.sqrt(np.diagonal(row.covariance, axis1=1, axis2=2)[:, :2])
            values = np.concatenate([row.position, row.velocity, spread], axis=1)
            for who, person in zip(row.ids.tolist(), values.tolist(), strict=True):
                table.writerow([who, f"{row.time:.3f}", *(f"{value:.3f}" for value in person)])
    return file

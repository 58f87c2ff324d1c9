"""Beams: fixed directions in the sensor frame, sorted into cells to test each shape with few beams."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crowdbot.core import kernel
from crowdbot.core.windows import hull_in_view, hull_levels, hull_width
from crowdbot.typing import Floats, Ints

PER_CELL = 2.0
"""Mean number of beams per cell."""
TURN = 2.0 * math.pi
MARGIN = 1e-9
"""Margin [rad] of windows against rounding."""


class Beams(NamedTuple):
    """Unit vectors in cells of equal elevation (rows) and azimuth (columns).

    Fields:
        x, y, z: ``[R]``, sorted by row, then by column.
        order: ``[R]`` index of each sorted beam in the input.
        begin: ``[rows * columns + 1]`` index of the first beam of each cell.
        low, tall: lower elevation of row 0 and height of a row [rad].
        left, wide: left azimuth of column 0 and width of a column [rad].
        down, up: tangents of the lowest and the highest elevation, at most 0 and at least 0.
    """

    x: Floats
    y: Floats
    z: Floats
    order: Ints
    begin: Ints
    rows: int
    columns: int
    low: float
    tall: float
    left: float
    wide: float
    down: float
    up: float


@kernel
def first_cells(left: float, bottom: float, top: float, beams: Beams) -> tuple[int, int, float]:
    """Return the cells of a window of azimuth and elevation: first and last row, and start relative to column 0."""
    first, last = 0, 0
    if beams.rows > 1:
        first = max(0, math.floor((bottom - MARGIN - beams.low) / beams.tall))
        last = min(beams.rows - 1, math.floor((top + MARGIN - beams.low) / beams.tall))
    return first, last, (left - MARGIN - beams.left) % TURN


@kernel
def hull_cells(corner: Floats, count: int, beams: Beams) -> tuple[int, int, float, float]:
    """Return the cells of a hull as :func:`first_cells` does, and the width of its window [rad]."""
    left, width = hull_width(corner, count)
    bottom, top = 0.0, 0.0
    if beams.rows > 1:
        bottom, top = hull_levels(corner, count, width >= TURN)
    first, last, start = first_cells(left, bottom, top, beams)
    return first, last, start, width


@kernel
def sees_hull(corner: Floats, count: int, limit: float, beams: Beams) -> bool:
    """Return whether a hull is within range and between the lowest and the highest beam."""
    return hull_in_view(corner, count, limit, beams.down, beams.up)


@kernel
def cell_columns(start: float, width: float, turn: int, beams: Beams) -> tuple[int, int]:
    """Return the first and last column of a window in turn 0 or 1; the first is above the last if it has none."""
    a = max(0, math.floor((start - turn * TURN) / beams.wide))
    return a, min(beams.columns - 1, math.floor((start - turn * TURN + width + 2.0 * MARGIN) / beams.wide))


def sort_beams(directions: Floats) -> Beams:
    """Return unit vectors ``[R, 3]`` sorted into cells.

    >>> found = sort_beams(unit_vectors(np.linspace(-1.0, 1.0, 81)))
    >>> found.rows, found.columns, found.order[:3].tolist()
    (1, 40, [0, 1, 2])
    """
    x, y, z = directions.T
    elevation = np.arcsin(np.clip(z, -1.0, 1.0))
    azimuth = np.arctan2(y, x)
    low, high = float(elevation.min()), float(elevation.max())
    left, right = float(azimuth.min()), float(azimuth.max())
    tall, wide = max(high - low, 1e-9), max(right - left, 1e-9)
    cells = max(1.0, len(x) / PER_CELL)
    levels = len(np.unique(np.round(elevation, 9)))
    rows = int(np.clip(round(math.sqrt(cells * tall / wide)), 1, 1024)) if high - low > 1e-9 else 1
    rows = levels if levels <= 2 * rows else rows  # rings have rows of their own
    columns = int(np.clip(round(cells / rows), 1, 8192))
    row = np.minimum((elevation - low) / tall * rows, rows - 1).astype(np.int64)
    column = np.minimum((azimuth - left) / wide * columns, columns - 1).astype(np.int64)
    cell = row * columns + column
    order = np.argsort(cell, kind="stable")
    begin = np.searchsorted(cell[order], np.arange(rows * columns + 1))
    steepest = 0.5 * math.pi - 1e-6
    return Beams(
        np.ascontiguousarray(x[order]),
        np.ascontiguousarray(y[order]),
        np.ascontiguousarray(z[order]),
        order,
        begin.astype(np.int64),
        rows,
        columns,
        low,
        tall / rows,
        left,
        wide / columns,
        math.tan(max(min(low, 0.0), -steepest)) - 1e-12,
        math.tan(min(max(high, 0.0), steepest)) + 1e-12,
    )


def unit_vectors(azimuth: Floats, elevation: Floats | float = 0.0) -> Floats:
    """Return the unit vectors ``[..., 3]`` of azimuths and elevations [rad] that broadcast."""
    flat = np.cos(elevation)
    parts = np.broadcast_arrays(flat * np.cos(azimuth), flat * np.sin(azimuth), np.sin(elevation))
    return np.ascontiguousarray(np.stack(parts, axis=-1))


def cone_directions(half_angle: float, count: int) -> Floats:
    """Return ``count`` unit vectors ``[R, 3]`` spread evenly over the solid angle of a cone about x, the axis first.

    A sunflower: the square of the sine of half the angle grows evenly, each beam is turned by the golden angle.

    >>> cone_directions(0.5, 1).tolist()
    [[1.0, 0.0, 0.0]]
    """
    share = np.arange(count) / max(1, count - 1)
    off = 2.0 * np.arcsin(np.sqrt(share) * math.sin(0.5 * half_angle))
    turn = math.pi * (3.0 - math.sqrt(5.0)) * np.arange(count)
    return np.stack([np.cos(off), np.sin(off) * np.cos(turn), np.sin(off) * np.sin(turn)], axis=-1)

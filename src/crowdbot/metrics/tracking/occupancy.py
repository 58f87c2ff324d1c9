"""Scores of predicted scans: occupied cells before the sensor, ranges, and time to collision."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import InputError, check_number
from crowdbot.typing import Bools, Floats


@dataclass(frozen=True)
class OccupancyGrid:
    """Square cells before a sensor: x from 0 to ``cells * size``, y to the same width on both sides of the axis.

    The default is that of Xie and Dames (2023), Stochastic occupancy grid map prediction in dynamic scenes,
    https://proceedings.mlr.press/v229/xie23a.html: 64 x 64 cells of 0.1 m.

    Fields:
        cells: number of cells along each side.
        size: side of a cell [m].
        dilation: number of cells by which occupied cells grow in all directions.

    Raises:
        InputError: a value is not allowed.

    >>> OccupancyGrid(cells=4, size=1.0, dilation=0).occupied([[[2.5, -0.5]]])[0].astype(int).tolist()
    [[0, 0, 0, 0], [0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0]]
    """

    cells: int = 64
    size: float = 0.1
    dilation: int = 1

    def __post_init__(self) -> None:
        check_number("OccupancyGrid", "cells", self.cells, min=1, whole=True)
        check_number("OccupancyGrid", "size", self.size, "m", exclusive_min=0.0)
        check_number("OccupancyGrid", "dilation", self.dilation, min=0, whole=True)

    def occupied(self, points: ArrayLike) -> Bools:
        """Return which cells ``[..., N, N]`` (x, y) have one of the points ``[..., R, 2]`` of the sensor frame [m].

        Points with NaN and points outside the grid are left out.
        """
        from scipy.ndimage import maximum_filter

        given = np.asarray(points, dtype=np.float64)
        shift = np.array([0.0, 0.5 * self.cells])
        scaled = np.where(np.isfinite(given), given / self.size + shift, -1.0)
        index = np.floor(scaled).astype(np.int64)
        inside = ((index >= 0) & (index < self.cells)).all(axis=-1)
        batch = given.shape[:-2]
        result = np.zeros((*batch, self.cells, self.cells), dtype=np.bool_)
        where = np.nonzero(inside)
        result[(*where[:-1], index[where][:, 0], index[where][:, 1])] = True
        if self.dilation == 0:
            return result
        width = (1,) * len(batch) + (2 * self.dilation + 1,) * 2
        return np.asarray(maximum_filter(result, size=width, mode="constant"))


def occupancy_iou(truth: ArrayLike, predicted: ArrayLike) -> Floats:
    """Return intersection over union of occupied cells ``[..., N, N]``, NaN where both are empty.

    Args:
        truth: bool.
        predicted: bool, or a probability, which counts as occupied from 0.5.

    >>> float(occupancy_iou([[True, True]], [[0.2, 0.7]]))
    0.5
    """
    one, other = np.asarray(truth, dtype=np.bool_), np.asarray(predicted, dtype=np.float64) >= 0.5
    both = np.count_nonzero(one & other, axis=(-2, -1))
    either = np.count_nonzero(one | other, axis=(-2, -1))
    return np.asarray(np.where(either > 0, both / np.maximum(either, 1), np.nan))


def weighted_squared_error(truth: ArrayLike, predicted: ArrayLike) -> Floats:
    """Return the mean squared error of probabilities ``[..., N, N]``, in which both classes weigh the same.

    The mean over occupied cells and that over free cells are averaged, as by weights of inverse class frequency (Xie
    and Dames 2023); NaN without occupied cells.

    >>> float(weighted_squared_error([[True, False, False]], [[0.5, 0.0, 1.0]]))
    0.375
    """
    one, other = np.asarray(truth, dtype=np.float64), np.asarray(predicted, dtype=np.float64)
    square = (one - other) ** 2
    full, total = one.sum(axis=(-2, -1)), one.shape[-1] * one.shape[-2]
    on = (square * one).sum(axis=(-2, -1)) / np.where(full > 0, full, np.nan)
    off = (square * (1.0 - one)).sum(axis=(-2, -1)) / np.where(full < total, total - full, np.nan)
    return np.asarray(0.5 * (on + off))


def structural_similarity(truth: ArrayLike, predicted: ArrayLike, sd: float = 1.5) -> Floats:
    """Return the mean structural similarity of grids ``[..., N, N]`` with values from 0 to 1.

    Wang, Bovik, Sheikh and Simoncelli (2004), Image quality assessment, https://doi.org/10.1109/TIP.2003.819861, with
    Gaussian windows of 11 x 11 cells and K1 = 0.01, K2 = 0.03.

    >>> float(structural_similarity(np.eye(16), np.eye(16)))
    1.0
    """
    from scipy.ndimage import gaussian_filter

    one, other = np.asarray(truth, dtype=np.float64), np.asarray(predicted, dtype=np.float64)
    if one.shape != other.shape:
        raise InputError(f"grids of shapes {list(one.shape)} and {list(other.shape)} cannot be compared")
    spread = (0.0,) * (one.ndim - 2) + (sd, sd)

    def blur(values: Floats) -> Floats:
        return np.asarray(gaussian_filter(values, spread, truncate=5.0 / sd))

    a, b = blur(one), blur(other)
    aa, bb, ab = blur(one * one) - a * a, blur(other * other) - b * b, blur(one * other) - a * b
    first, second = 0.01**2, 0.03**2
    index = (2 * a * b + first) * (2 * ab + second) / ((a * a + b * b + first) * (aa + bb + second))
    return np.asarray(index.mean(axis=(-2, -1)))


def range_error(truth: ArrayLike, predicted: ArrayLike, range_max: float) -> Floats:
    """Return the mean absolute difference of ranges ``[..., R]`` [m]; missing returns count as ``range_max``.

    >>> float(range_error([1.0, np.inf], [2.0, 9.0], 10.0))
    1.0
    """
    one = np.minimum(np.asarray(truth, dtype=np.float64), range_max)
    other = np.minimum(np.asarray(predicted, dtype=np.float64), range_max)
    return np.asarray(np.abs(np.maximum(one, 0.0) - np.maximum(other, 0.0)).mean(axis=-1))


SLOWEST = 0.05
"""A robot that is slower [m/s] has no time to collision."""


def scan_time_to_collision(points: ArrayLike, velocity: ArrayLike, radius: float, limit: float) -> Floats:
    """Return the time ``[...]`` until a disc that keeps its velocity touches a return of a scan [s].

    The returns stay where they are: with points ``p``, speed ``v`` along the unit vector ``u`` and radius ``r``, the
    time is the smallest ``(p . u - sqrt(r^2 - |p x u|^2)) / v`` of the points ahead with ``|p x u| < r``.

    Args:
        points: ``[..., R, 2]`` end points of the beams from the centre of the disc [m], NaN without a return.
        velocity: ``[..., 2]`` velocity of the disc in the frame of the points [m/s].
        radius: radius of the disc [m]; a point inside it gives 0.
        limit: largest time [s], also without a collision.

    Returns:
        Times up to the limit; NaN below a speed of 0.05 m/s.

    >>> float(scan_time_to_collision([[2.3, 0.1], [1.0, 2.0]], [1.0, 0.0], 0.1 * 5**0.5, 5.0).round(6))
    2.1
    """
    place, speed = np.asarray(points, dtype=np.float64), np.asarray(velocity, dtype=np.float64)
    size = np.hypot(speed[..., 0], speed[..., 1])
    moving = size >= SLOWEST
    unit = speed / np.where(moving, size, 1.0)[..., None]
    ahead = place[..., 0] * unit[..., None, 0] + place[..., 1] * unit[..., None, 1]
    aside = place[..., 1] * unit[..., None, 0] - place[..., 0] * unit[..., None, 1]
    room = radius * radius - aside * aside
    with np.errstate(invalid="ignore"):
        path = ahead - np.sqrt(np.maximum(room, 0.0))
        inside = ahead * ahead <= room
        meets = inside | ((room > 0.0) & (ahead > 0.0))
    nearest = np.where(meets, np.where(inside, 0.0, path), np.inf).min(axis=-1, initial=np.inf)
    time = np.minimum(nearest / np.where(moving, size, 1.0), limit)
    return np.asarray(np.where(moving, time, np.nan))

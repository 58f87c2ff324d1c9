"""Functions for headings: unit vectors, turns, extrapolation and the weighted median."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdbot.typing import Floats

MOVING = 0.2
"""Minimum speed [m/s] for a valid heading, above the sway of standing people."""


def length(vector: Floats) -> Floats:
    """Return the lengths ``[...]`` of vectors ``[..., 2]``."""
    return np.asarray(np.sqrt(vector[..., 0] ** 2 + vector[..., 1] ** 2))


def unit(vector: Floats) -> Floats:
    """Return vectors ``[..., 2]`` of length 1; 0 stays 0."""
    size = length(vector)[..., None]
    return vector / np.where(size > 0.0, size, 1.0)


def angle_between(start: Floats, end: Floats) -> Floats:
    """Return the angle [rad] from ``start`` to ``end`` ``[..., 2]``, positive to the left, in (-pi, pi].

    >>> import numpy as np
    >>> round(float(angle_between(np.array([1.0, 0.0]), np.array([0.0, 2.0]))), 4)
    1.5708
    """
    cross = start[..., 0] * end[..., 1] - start[..., 1] * end[..., 0]
    dot = start[..., 0] * end[..., 0] + start[..., 1] * end[..., 1]
    return np.asarray(np.arctan2(cross, dot))


def rotate(vector: Floats, angle: Floats) -> Floats:
    """Return vectors ``[..., 2]`` rotated to the left by ``angle`` ``[...]`` [rad]."""
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = vector[..., 0], vector[..., 1]
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)


def extrapolate(place: Floats, here: NDArray[np.bool_], velocity: Floats, seconds: float) -> Floats:
    """Return the extrapolated positions after ``seconds``, ``[W, A, 2]`` [m]; 0 for absent people."""
    return np.where(here[..., None], place + seconds * velocity, 0.0)


def median(value: Floats, weight: Floats) -> Floats:
    """Return the interpolated weighted median ``[...]`` of values ``[..., N]``; 0 without weight.

    Each value is at the centre of its weight, which makes the median continuous in the weights.

    >>> import numpy as np
    >>> float(median(np.array([0.0, 4.0, 2.0]), np.array([1.0, 1.0, 2.0])))
    2.0
    """
    order = np.argsort(value, axis=-1, kind="stable")
    value, weight = np.take_along_axis(value, order, axis=-1), np.take_along_axis(weight, order, axis=-1)
    total = np.cumsum(weight, axis=-1)
    middle = total - 0.5 * weight
    half = 0.5 * total[..., -1:]
    above = np.clip(np.sum(middle < half, axis=-1, keepdims=True), 1, max(1, value.shape[-1] - 1))
    if value.shape[-1] == 1:
        return np.where(total[..., -1] > 0.0, value[..., 0], 0.0)
    start, end = np.take_along_axis(middle, above - 1, axis=-1), np.take_along_axis(middle, above, axis=-1)
    share = np.clip((half - start) / np.where(end > start, end - start, 1.0), 0.0, 1.0)
    low, high = np.take_along_axis(value, above - 1, axis=-1), np.take_along_axis(value, above, axis=-1)
    return np.where(total[..., -1] > 0.0, (low + share * (high - low))[..., 0], 0.0)

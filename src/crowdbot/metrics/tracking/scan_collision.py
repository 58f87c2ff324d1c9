"""Time to collision of a robot with the returns of a scan."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.typing import Floats

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

"""Motion metrics of a logged robot: path length, stops and smoothness.

A log is sampled at ``times [T]`` [s], increasing; ``position [T, 2]`` [m], ``velocity [T, 2]`` [m/s], ``heading [T]``.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.typing import Floats

JERK_STEP = 0.1
"""Step [s] at which velocities are differentiated: jerk grows with one over its square."""
STALL_SPEED = 0.05
"""A robot slower than this [m/s] is at rest."""


def path_length(position: Floats) -> float:
    """Return the length of the path through the samples [m], ``sum |p_k+1 - p_k|``.

    >>> path_length(np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 4.0]]))
    7.0
    """
    step = np.diff(position, axis=0)
    return float(np.sum(np.hypot(step[:, 0], step[:, 1])))


def path_efficiency(position: Floats) -> float:
    """Return straight distance between both ends over path length, in (0, 1]; NaN without motion.

    >>> round(path_efficiency(np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 4.0]])), 4)
    0.7143
    """
    length = path_length(position)
    if length == 0.0:
        return math.nan
    return min(1.0, math.dist(position[0], position[-1]) / length)


def stalled_time(times: Floats, velocity: Floats, speed: float = STALL_SPEED) -> float:
    """Return the time at rest [s]: the sum of time steps at whose end the speed is below ``speed`` [m/s].

    Turning on the spot counts as rest.

    >>> stalled_time(np.array([0.0, 0.5, 1.0]), np.array([[1.0, 0.0], [0.0, 0.0], [1.0, 0.0]]))
    0.5
    """
    return float(np.sum(np.diff(times)[_stands(velocity, speed)[1:]]))


def longest_stall(times: Floats, velocity: Floats, speed: float = STALL_SPEED) -> float:
    """Return the longest continuous time at rest [s], as defined in :func:`stalled_time`.

    >>> v = np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [0.0, 0.0], [0.0, 0.0]])
    >>> longest_stall(np.arange(5.0), v)
    2.0
    """
    longest = current = 0.0
    for stands, step in zip(_stands(velocity, speed)[1:], np.diff(times), strict=True):
        current = current + float(step) if stands else 0.0
        longest = max(longest, current)
    return longest


def jerk(times: Floats, velocity: Floats, step: float = JERK_STEP) -> Floats:
    """Return the magnitude of the jerk ``[S]`` [m/s3]: second difference of the velocity over ``step`` squared.

    The velocity is first interpolated linearly at every ``step`` [s] (the mean step of the log if longer), because a
    finite difference depends on its step. The result is empty for fewer than three samples.

    >>> t = np.arange(0.0, 1.05, 0.1)
    >>> jerk(t, np.stack([t**2, 0 * t], axis=1)).round(6).max().item()
    2.0
    """
    if len(times) < 3:
        return np.zeros(0)
    step = max(step, float(times[-1] - times[0]) / (len(times) - 1))
    count = math.floor((times[-1] - times[0]) / step + 1e-6) + 1
    moments = times[0] + step * np.arange(count)
    speeds = np.stack([np.interp(moments, times, velocity[:, axis]) for axis in range(2)], axis=1)
    change = np.diff(speeds, n=2, axis=0) / step**2
    return np.hypot(change[:, 0], change[:, 1])


def heading_change(heading: Floats) -> float:
    """Return the cumulative heading change [rad] of ``heading [T]``, ``sum |wrap(h_k+1 - h_k)|``.

    >>> round(heading_change(np.array([3.0, -3.0, 3.0])), 4)
    0.5664
    """
    turned = np.diff(heading)
    return float(np.sum(np.abs((turned + math.pi) % (2.0 * math.pi) - math.pi)))


def _stands(velocity: Floats, speed: float) -> NDArray[np.bool_]:
    return np.asarray(np.hypot(velocity[:, 0], velocity[:, 1]) < speed)

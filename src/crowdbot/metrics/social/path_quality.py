"""Path metrics: success weighted by length and time, and similarity to the shortest path (dynamic time warping)."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.metrics.motion import heading_change, path_length
from crowdbot.typing import Floats

from .metric import undefined_metrics
from .robot_log import RobotLog

SPACING = 0.25
"""Distance [m] of the points of both paths that dynamic time warping compares."""


def path_metrics(log: RobotLog) -> dict[str, float]:
    """Return the metrics of the family ``path``; NaN without a shortest path."""
    if log.path is None:
        return undefined_metrics("path")
    best = max(0.0, path_length(log.path) - log.tolerance)
    length, wins = path_length(log.position), float(log.success)
    fastest = best / log.max_speed if log.max_speed > 0.0 else math.nan
    line, walk = sample_path(log.path, SPACING), sample_path(log.position, SPACING)
    likeness = math.exp(-time_warping_distance(line, walk) / (len(line) * max(log.tolerance, 1e-9)))
    moves = log.speed > 0.05
    direction = np.arctan2(log.velocity[moves, 1], log.velocity[moves, 0])
    return {
        "shortest_length": best,
        "spl": wins * _ratio(best, length),
        "stl": wins * _ratio(fastest, log.duration),
        "ndtw": likeness,
        "sdtw": wins * likeness,
        "heading_change_excess": heading_change(direction) - heading_change(_directions(log.path)),
    }


def _ratio(best: float, real: float) -> float:
    """Return ``best / max(best, real)``; 1 if both are 0."""
    worst = max(best, real)
    return best / worst if worst > 0.0 else 1.0


def _directions(path: Floats) -> Floats:
    step = np.diff(path, axis=0)
    step = step[np.hypot(step[:, 0], step[:, 1]) > 1e-9]
    return np.asarray(np.arctan2(step[:, 1], step[:, 0]))


def sample_path(path: Floats, spacing: float) -> Floats:
    """Return points ``[M, 2]`` on a path ``[K, 2]``, ``spacing`` [m] apart along it, with both ends.

    >>> sample_path(np.array([[0.0, 0.0], [1.0, 0.0]]), 0.5).tolist()
    [[0.0, 0.0], [0.5, 0.0], [1.0, 0.0]]
    """
    step = np.hypot(*np.diff(path, axis=0).T) if len(path) > 1 else np.zeros(0)
    along = np.concatenate([[0.0], np.cumsum(step)])
    if along[-1] == 0.0:
        return path[:1].copy()
    marks = np.linspace(0.0, along[-1], max(2, round(along[-1] / spacing) + 1))
    return np.stack([np.interp(marks, along, path[:, axis]) for axis in range(2)], axis=1)


def time_warping_distance(first: Floats, second: Floats) -> float:
    """Return the dynamic time warping distance [m] of two paths ``[N, 2]`` and ``[M, 2]``.

    The least sum of distances over monotone alignments that match all points of both.

    >>> time_warping_distance(np.array([[0.0, 0.0], [1.0, 0.0]]), np.array([[0.0, 1.0], [1.0, 1.0]]))
    2.0
    """
    cost = np.hypot(*np.moveaxis(first[:, None] - second[None], -1, 0))
    rows, columns = cost.shape
    table = np.full((rows + 1, columns + 1), np.inf)
    table[0, 0] = 0.0
    for diagonal in range(2, rows + columns + 1):
        i = np.arange(max(1, diagonal - columns), min(rows, diagonal - 1) + 1)
        j = diagonal - i
        least = np.minimum(np.minimum(table[i - 1, j], table[i, j - 1]), table[i - 1, j - 1])
        table[i, j] = cost[i - 1, j - 1] + least
    return float(table[rows, columns])

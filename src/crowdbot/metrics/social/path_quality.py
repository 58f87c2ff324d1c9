"""Quality of paths and motion: length and time, jerk, energy, smoothness, freezing, and legibility."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.metrics.motion import JERK_STEP, heading_change, jerk, longest_stall, path_length
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


ANGLES = (-90.0, -45.0, 0.0, 45.0, 90.0)
"""Directions [degrees] of possible goals as seen from the start, relative to the true one."""


def legibility_metrics(log: RobotLog) -> dict[str, float]:
    """Return the metric of the family ``legibility``; NaN without a goal or a time above 0."""
    if log.goal is None or log.duration <= 0.0:
        return undefined_metrics("legibility")
    turns = np.radians(ANGLES)
    way = log.goal - log.position[0]
    goals = log.position[0] + np.stack(
        [np.cos(turns) * way[0] - np.sin(turns) * way[1], np.sin(turns) * way[0] + np.cos(turns) * way[1]], axis=1
    )
    return {"legibility": legibility(log.times, log.position, goals, ANGLES.index(0.0))}


def legibility(times: Floats, position: Floats, goals: Floats, goal: int) -> float:
    """Return the legibility of a path, 0 to 1: the probability of its goal, early samples weighted more.

    ``sum P(G | path to t) (T - t) dt / sum (T - t) dt`` with ``P(G) ~ exp(-(L(t) + |G - x(t)| - |G - x(0)|))``, L(t)
    the length of the path so far [m]. Dragan, Lee, Srinivasa 2013, https://doi.org/10.1109/HRI.2013.6483603.

    Args:
        times, position: ``[T]`` [s], ``[T, 2]`` [m].
        goals: possible goals ``[G, 2]`` [m], all equally likely at first.
        goal: index of the true one.

    >>> t = np.linspace(0.0, 1.0, 11)
    >>> straight = np.stack([5.0 * t, 0.0 * t], axis=1)
    >>> round(legibility(t, straight, np.array([[5.0, 0.0], [0.0, 5.0]]), 0), 3)
    0.777
    """
    left = np.hypot(*np.moveaxis(goals[None] - position[:, None], -1, 0))
    # the length so far is the same for all goals and cancels
    score = left[0] - left
    share = np.exp(score - score.max(axis=1, keepdims=True))
    chance = share[:, goal] / share.sum(axis=1)
    weight = (times[-1] - times) * np.diff(times, append=times[-1])
    return float(np.sum(chance * weight) / np.sum(weight))


FREEZE = 5.0
"""Time at rest [s] above which the robot is frozen."""
CUT_OFF = 10.0
"""Largest frequency [Hz] of the spectral arc length, or the Nyquist frequency if lower."""
LEAST_AMPLITUDE = 0.05
"""Frequencies above the last one with this share of the largest amplitude are left out."""


def motion_metrics(log: RobotLog) -> dict[str, float]:
    """Return the metrics of the family ``motion``."""
    speed, gain, change = log.speed, accelerations(log.times, log.velocity), jerk(log.times, log.velocity)
    steps = np.diff(log.times)
    return {
        "min_speed": float(np.min(speed)),
        "mean_speed": float(np.mean(speed)),
        "max_speed": float(np.max(speed)),
        "min_acceleration": _least(gain),
        "mean_acceleration": float(np.mean(gain)) if len(gain) else math.nan,
        "max_acceleration": float(np.max(gain)) if len(gain) else math.nan,
        "min_jerk": _least(change),
        "rms_jerk": float(np.sqrt(np.mean(change**2))) if len(change) else math.nan,
        "motion_energy": float(np.sum(speed[1:] ** 2 * steps)),
        "path_irregularity": path_irregularity(log),
        "spectral_arc_length": spectral_arc_length(log.times, speed),
        "freezing": float(longest_stall(log.times, log.velocity) > FREEZE),
    }


def _least(values: Floats) -> float:
    return float(np.min(values)) if len(values) else math.nan


def accelerations(times: Floats, velocity: Floats, step: float = JERK_STEP) -> Floats:
    """Return the magnitude of the acceleration ``[S]`` [m/s2]: difference of the velocity at every ``step`` [s].

    The velocity is interpolated linearly, as for :func:`crowdbot.metrics.jerk`; the mean step of the log if longer.

    >>> accelerations(np.array([0.0, 0.1, 0.2]), np.array([[0.0, 0.0], [0.1, 0.0], [0.2, 0.0]])).round(6).tolist()
    [1.0, 1.0]
    """
    if len(times) < 2:
        return np.zeros(0)
    step = max(step, float(times[-1] - times[0]) / (len(times) - 1))
    moments = times[0] + step * np.arange(math.floor((times[-1] - times[0]) / step + 1e-6) + 1)
    speeds = np.stack([np.interp(moments, times, velocity[:, axis]) for axis in range(2)], axis=1)
    return np.asarray(np.hypot(*np.diff(speeds, axis=0).T) / step)


def path_irregularity(log: RobotLog) -> float:
    """Return the mean angle [rad] between the direction of motion and that to the goal, over samples in motion."""
    if log.goal is None:
        return math.nan
    toward = log.goal - log.position
    moves = (log.speed > 0.05) & (np.hypot(*toward.T) > 1e-9)
    if not moves.any():
        return math.nan
    cross = log.velocity[:, 0] * toward[:, 1] - log.velocity[:, 1] * toward[:, 0]
    inner = np.sum(log.velocity * toward, axis=1)
    return float(np.mean(np.abs(np.arctan2(cross, inner))[moves]))


def spectral_arc_length(times: Floats, speed: Floats, step: float = JERK_STEP) -> float:
    """Return the spectral arc length (SPARC) of a speed profile ``[T]``; the nearer to 0, the smoother.

    The arc length of the amplitude spectrum over frequency, both divided by their largest values, negative.
    Balasubramanian et al. 2015, On the analysis of movement smoothness, https://doi.org/10.1186/s12984-015-0090-9.

    >>> t = np.arange(0.0, 10.0, 0.1)
    >>> smooth, rough = (spectral_arc_length(t, 1 + part) for part in (-np.cos(t), np.sin(9 * t)))
    >>> smooth > rough
    True
    """
    if len(times) < 3 or not np.any(speed > 0.0):
        return math.nan
    step = max(step, float(times[-1] - times[0]) / (len(times) - 1))
    moments = times[0] + step * np.arange(math.floor((times[-1] - times[0]) / step + 1e-6) + 1)
    count = 2 ** (math.ceil(math.log2(len(moments))) + 4)
    amplitude = np.abs(np.fft.rfft(np.interp(moments, times, speed), count))
    frequency = np.fft.rfftfreq(count, step)
    amplitude = amplitude / amplitude.max()
    kept = frequency <= CUT_OFF
    last = int(np.flatnonzero((amplitude >= LEAST_AMPLITUDE) & kept)[-1])
    part, spectrum = frequency[: last + 1], amplitude[: last + 1]
    if last == 0:
        return 0.0
    width = part[-1] - part[0]
    return -float(np.sum(np.hypot(np.diff(part) / width, np.diff(spectrum))))

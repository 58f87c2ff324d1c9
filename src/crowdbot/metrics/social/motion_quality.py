"""Motion quality: speeds, accelerations, jerk, energy, irregularity, spectral smoothness, freezing."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.metrics.motion import JERK_STEP, jerk, longest_stall
from crowdbot.typing import Floats

from .robot_log import RobotLog

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

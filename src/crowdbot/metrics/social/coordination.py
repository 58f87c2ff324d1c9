"""Coordination of a follower with a leader who moves forward and backward: distance, lag, gain and phase."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError
from crowdbot.typing import Floats

LARGEST_GAP = 1.0 / 4.0
"""Part of a period between two samples of the leader across which the leader is not interpolated."""
LAGS = 100
"""Number of trial lags in a period of the leader."""
PEAK = 8
"""Number of trial lags on each side of the best one to which the peak is fitted."""
HIGHEST_FREQUENCY = 2.0
"""Highest frequency of a leader [Hz] that is searched; people cannot go to and fro faster."""
SMALLEST_MOTION = 1e-6
"""Amplitude of the leader [m] below which there is nothing to follow."""


class Coordination(NamedTuple):
    """How a follower keeps the distance to a leader.

    The leader moves as ``a sin(w t)`` along a line, the follower as ``g a sin(w t - phi)``.

    Fields:
        distance: mean distance of the two [m].
        distance_sd: standard deviation of the distance [m].
        lag: delay of the follower at the maximum of the cross-correlation [s].
        correlation: that maximum, at most 1.
        frequency: frequency of the leader [Hz].
        amplitude: amplitude of the leader [m].
        gain: g, amplitude of the follower at that frequency in relation to the leader.
        phase: phi [rad], from -pi to pi; above 0 the follower is late.
    """

    distance: float
    distance_sd: float
    lag: float
    correlation: float
    frequency: float
    amplitude: float
    gain: float
    phase: float


def coordination(
    leader_time: ArrayLike,
    leader: ArrayLike,
    follower_time: ArrayLike,
    follower: ArrayLike,
    *,
    frequency: float | None = None,
) -> Coordination:
    """Return the coordination of a follower with a leader.

    Both may be sampled at different and irregular times, and samples may be missing: rows that are not finite are left
    out. Positions are projected on the main direction of the leader, so a common turn or shift changes nothing. Gain
    and phase are from least-squares fits of a sine with a linear drift to the samples themselves. The lag is that of
    the largest correlation of the follower with the delayed leader, within half a period.

    Source: Ducourant, Vieilledent, Kerlirzin, Berthoz (2005), Timing and distance characteristics of interpersonal
    coordination during locomotion, doi 10.1016/j.neulet.2005.06.052.

    Args:
        leader_time, follower_time: ``[T]`` and ``[S]`` ascending times [s] of one clock.
        leader, follower: ``[T, 2]`` and ``[S, 2]`` positions [m].
        frequency: frequency of the leader [Hz]; default: fitted to the leader.

    Raises:
        InputError: shapes do not fit, times do not ascend, fewer than 8 samples, less than one period in common, or
            the leader does not move.

    >>> time = np.arange(0.0, 20.0, 0.05)
    >>> lead, follow = 0.5 * np.sin(0.8 * time), 0.4 * np.sin(0.8 * (time - 0.3))
    >>> zero = np.zeros_like(time)
    >>> found = coordination(time, np.stack([lead, zero], 1), time, np.stack([1.5 + follow, zero], 1))
    >>> round(found.gain, 3), round(found.lag, 2), round(found.phase, 3)
    (0.8, 0.3, 0.24)
    """
    time, place = _samples("leader", leader_time, leader)
    other_time, other = _samples("follower", follower_time, follower)
    axis = _main_direction(place, other)
    along, beside = place @ axis, other @ axis
    if frequency is None:
        frequency = _fitted_frequency(time, along)
    elif not (math.isfinite(frequency) and frequency > 0.0):
        raise InputError(f"frequency = {frequency} Hz must be above 0")
    lead, along = _sine(time, along, frequency)
    follow, beside = _sine(other_time, beside, frequency)
    if abs(lead) < SMALLEST_MOTION:
        raise InputError("the leader does not move; there is nothing to follow")
    common = min(time[-1], other_time[-1]) - max(time[0], other_time[0])
    if common * frequency < 1.0:
        raise InputError(
            f"leader and follower have {max(common, 0.0):.3g} s in common, less than one period of "
            f"{1.0 / frequency:.3g} s; give a longer recording"
        )
    phase = float(np.angle(lead * np.conj(follow)))
    lag, correlation = _lag(time, along, other_time, beside, 1.0 / frequency)
    distance = _distances(time, place, other_time, other, LARGEST_GAP / frequency)
    return Coordination(
        float(distance.mean()),
        float(distance.std()),
        lag,
        correlation,
        frequency,
        abs(lead),
        abs(follow) / abs(lead),
        phase,
    )


def _samples(name: str, time: ArrayLike, place: ArrayLike) -> tuple[Floats, Floats]:
    """Return checked times and positions of the finite rows."""
    times, places = np.asarray(time, dtype=np.float64), np.asarray(place, dtype=np.float64)
    if times.ndim != 1 or places.shape != (len(times), 2):
        raise InputError(
            f"{name}: times have the shape {times.shape} and positions {places.shape}; they must be [T] and [T, 2]"
        )
    kept = np.isfinite(times) & np.isfinite(places).all(axis=1)
    times, places = times[kept], places[kept]
    if len(times) < 8:
        raise InputError(f"{name}: {len(times)} samples are known; at least 8 are needed")
    if (np.diff(times) <= 0.0).any():
        row = int(np.argmax(np.diff(times) <= 0.0)) + 1
        raise InputError(f"{name}: time {times[row]:.6g} s follows {times[row - 1]:.6g} s; times must ascend")
    return times, places


def _main_direction(leader: Floats, follower: Floats) -> Floats:
    """Return the unit vector of the largest motion of the leader, towards the follower."""
    values, vectors = np.linalg.eigh(np.cov(leader.T))
    axis = np.asarray(vectors[:, int(np.argmax(values))])
    towards = follower.mean(axis=0) - leader.mean(axis=0)
    return axis if axis @ towards >= 0.0 else -axis


def _design(time: Floats, frequency: float) -> Floats:
    angle = 2.0 * math.pi * frequency * time
    return np.stack([np.ones_like(time), time - time.mean(), np.cos(angle), np.sin(angle)], axis=1)


def _sine(time: Floats, value: Floats, frequency: float) -> tuple[complex, Floats]:
    """Return ``a`` of the least-squares fit ``c + d t + Re(a exp(i w t))``, and the values without ``c + d t``."""
    design = _design(time, frequency)
    solution = np.linalg.lstsq(design, value, rcond=None)[0]
    return complex(solution[2], -solution[3]), value - design[:, :2] @ solution[:2]


def _fitted_frequency(time: Floats, value: Floats) -> float:
    """Return the frequency [Hz] with the smallest residual: the best of a grid, refined."""
    from scipy import optimize  # takes longer to import than the rest

    span = float(time[-1] - time[0])
    highest = min(0.5 / float(np.median(np.diff(time))), HIGHEST_FREQUENCY)
    grid = np.arange(0.75, highest * span, 0.25) / span
    if not len(grid):
        raise InputError(f"the leader has {len(time)} samples over {span:.3g} s, too few to find a frequency")

    def residual(frequency: float) -> float:
        design = _design(time, frequency)
        return float(np.sum((value - design @ np.linalg.lstsq(design, value, rcond=None)[0]) ** 2))

    best = float(grid[int(np.argmin([residual(item) for item in grid]))])
    edges = (max(best - 0.25 / span, 0.5 / span), best + 0.25 / span)
    return float(optimize.minimize_scalar(residual, bounds=edges, method="bounded").x)


def _known(at: Floats, time: Floats, gap: float) -> NDArray[np.bool_]:
    """Return which times lie between two samples that are close enough."""
    after = np.clip(np.searchsorted(time, at), 1, len(time) - 1)
    return np.asarray((at >= time[0]) & (at <= time[-1]) & (time[after] - time[after - 1] <= gap))


def _lag(time: Floats, leader: Floats, other_time: Floats, follower: Floats, period: float) -> tuple[float, float]:
    """Return the delay [s] of the largest correlation within half a period, and the correlation.

    The peak is flat and noise makes it rough, so a polynomial of fourth order is fitted to the lags around it.
    """
    gap = LARGEST_GAP * period
    lags = period / LAGS * np.arange(-LAGS // 2, LAGS // 2 + 1)
    found = np.array([_correlation(time, leader, other_time, follower, lag, gap) for lag in lags])
    if not np.isfinite(found).any():
        raise InputError(f"the leader has gaps above {gap:.3g} s everywhere; no delay can be found")
    best = int(np.nanargmax(found))
    near = np.arange(max(best - PEAK, 0), min(best + PEAK + 1, len(lags)))
    near = near[np.isfinite(found[near])]
    peak = np.polynomial.Polynomial.fit(lags[near], found[near], min(4, len(near) - 1))
    turns = [root.real for root in peak.deriv().roots() if abs(root.imag) < 1e-9]
    inside = [turn for turn in turns if lags[near[0]] <= turn <= lags[near[-1]]]
    lag = max([float(lags[best]), *inside], key=peak)
    return float(lag), min(float(peak(lag)), 1.0)


def _correlation(time: Floats, leader: Floats, other_time: Floats, follower: Floats, lag: float, gap: float) -> float:
    """Return the correlation of the follower with the leader ``lag`` seconds before; both oscillate about 0."""
    from scipy import interpolate  # takes longer to import than the rest

    known = _known(other_time - lag, time, gap)
    if known.sum() < 8:
        return math.nan
    one, other = interpolate.Akima1DInterpolator(time, leader)(other_time[known] - lag), follower[known]
    scale = float(np.linalg.norm(one) * np.linalg.norm(other))
    return float(one @ other) / scale if scale > 0.0 else math.nan


def _distances(time: Floats, leader: Floats, other_time: Floats, follower: Floats, longest: float) -> Floats:
    """Return the distances [m] at the times of the follower at which the leader is known."""
    known = _known(other_time, time, longest)
    x, y = (np.interp(other_time, time, column) for column in leader.T)
    gap = np.hypot(follower[:, 0] - x, follower[:, 1] - y)[known]
    if not len(gap):
        raise InputError("leader and follower have no time in common")
    return np.asarray(gap)

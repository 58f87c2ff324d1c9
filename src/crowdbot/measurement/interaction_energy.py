"""Energy of the interaction of people by their time to collision, with intervals.

Karamouzas, Skinner, Guy 2014, Universal power law governing pedestrian interactions,
doi 10.1103/PhysRevLett.113.238701: E(tau) = ln(1 / g(tau)) up to a constant, and E is proportional to 1 / tau^2 at
small tau.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import InputError, stream
from crowdbot.data import Trajectories
from crowdbot.metrics import draw_counts, percentile_interval
from crowdbot.typing import Floats

from .encounters import REACH, compute_encounters, expected_times, time_edges
from .rows import table

if TYPE_CHECKING:
    import pandas as pd


FIT_RANGE = (0.2, 3.0)
"""Times to collision [s] of the fit; the paper finds the power law below its cut-off of about 3 s."""
EXPONENTS = np.arange(0.25, 6.001, 0.05)
FEWEST = 5
"""Pairs that a bin needs for the fit."""
BLOCKS = 20
RESAMPLES = 500


@dataclass(frozen=True, eq=False)
class InteractionEnergy:
    """Result of :func:`compute_interaction_energy`.

    Fields:
        table: columns ttc (middle of the bin) [s], count, expected, g, low, high (95 % interval of g), energy =
            ln(1 / g), energy_low, energy_high, fit (in the bins of the fit); NaN without values.
        exponent: n of ``E(tau) = k tau^-n + c``; NaN if the energy does not rise towards small tau.
        exponent_low, exponent_high: its 95 % interval.
        strength: k [s^n], 0 without an interaction.
    """

    table: pd.DataFrame
    exponent: float
    exponent_low: float
    exponent_high: float
    strength: float


def compute_interaction_energy(
    tracks: Trajectories,
    velocity: pd.DataFrame,
    radius: float,
    bin_size: float = 0.1,
    longest: float = 8.0,
    shuffles: int = 4,
    seed: int = 0,
) -> InteractionEnergy:
    """Return the energy of the interaction of people over their time to collision, with 95 % intervals.

    The recording is cut into 20 pieces of equal duration. The intervals come from the bootstrap over pieces.

    Args:
        tracks, velocity, radius: as in :func:`~crowdbot.measurement.compute_encounters`.
        bin_size, longest, shuffles, seed: as in
            :func:`~crowdbot.measurement.compute_time_to_collision_distribution`.

    Raises:
        InputError: an argument is not above 0.

    >>> from crowdbot.measurement import compute_individual_speed
    >>> x = [0.0, 4.0, 1.0, 3.0]
    >>> tracks = Trajectories([1, 2, 1, 2], [0, 0, 1, 1], x, [0.0] * 4, row_rate=1.0)
    >>> speed = compute_individual_speed(tracks, 1, border="single-sided")
    >>> found = compute_interaction_energy(tracks, speed, radius=0.5, bin_size=0.5)
    >>> found.table["count"].sum(), found.exponent
    (np.int64(2), nan)
    """
    edges = time_edges(bin_size, longest, shuffles)
    pairs = compute_encounters(tracks, velocity, radius, reach=REACH)
    when = pairs.ttc.to_numpy()
    frame = pairs.frame.to_numpy()
    span = max(1, int(np.ptp(frame)) + 1) if len(frame) else 1
    piece = (frame - frame.min()) * BLOCKS // span if len(frame) else frame
    met = when > 0.0
    found = np.stack([np.histogram(when[met & (piece == b)], edges)[0] for b in range(BLOCKS)])
    size = np.bincount(piece, minlength=BLOCKS)[:BLOCKS]
    share = expected_times(tracks, velocity, radius, edges, shuffles, seed)
    return _energy_of(edges[:-1] + 0.5 * bin_size, found, share * size[:, None], seed)


def pool_interaction_energy(found: Sequence[pd.DataFrame], seed: int = 0) -> InteractionEnergy:
    """Return the energy over several recordings or starts, with 95 % intervals by the bootstrap over them.

    Args:
        found: tables of :func:`compute_interaction_energy` with the same bins, one for each recording.
        seed: seed of the bootstrap.

    Raises:
        InputError: there are fewer than two tables, or their bins differ.

    >>> one = table(ttc=np.arange(0.25, 3.0, 0.1), count=np.full(28, 90), expected=np.full(28, 100.0))
    >>> pool_interaction_energy([one, one]).table.g[0]
    np.float64(0.9)
    """
    if len(found) < 2 or any(not np.array_equal(one.ttc, found[0].ttc) for one in found):
        raise InputError("a pooled interaction energy needs at least two tables with the same bins")
    count, expected = (np.stack([one[name].to_numpy() for one in found]) for name in ("count", "expected"))
    return _energy_of(found[0].ttc.to_numpy(), count, expected, seed)


def _energy_of(middle: Floats, found: Floats, expected: Floats, seed: int) -> InteractionEnergy:
    """Return the energy of counts and expected counts ``[B, N]`` of B pieces or recordings, drawn with replacement."""
    B = len(found)
    drawn = draw_counts(stream(seed, "interaction energy"), B, RESAMPLES)
    count, free = found.sum(axis=0), expected.sum(axis=0)
    g = _ratio(count, free)
    counts, frees = (np.einsum("rb,bn->rn", drawn, values) for values in (found, expected))
    ratios = _ratio(counts, frees)
    low, high = percentile_interval(ratios)  # NaN where nothing is expected in a draw
    exponent, strength, offset = fit_interaction_energy(middle, g, count)
    fits = [fit_interaction_energy(middle, *draw)[0] for draw in zip(ratios, counts, strict=True)]
    known = np.asarray([fit for fit in fits if not np.isnan(fit)])
    sure = not np.isnan(exponent) and len(known) >= 0.9 * RESAMPLES
    ends = percentile_interval(known) if sure else (np.nan, np.nan)
    near = (middle >= FIT_RANGE[0]) & (middle <= FIT_RANGE[1]) & (count >= FEWEST)
    fit = np.where(near, strength * middle ** -(0.0 if np.isnan(exponent) else exponent) + offset, np.nan)
    rows = table(
        ttc=middle, count=count, expected=free, g=g, low=low, high=high, energy=_energy(g),
        energy_low=_energy(high), energy_high=_energy(low), fit=fit,
    )  # fmt: skip
    return InteractionEnergy(rows, exponent, float(ends[0]), float(ends[1]), strength)


def fit_interaction_energy(
    ttc: ArrayLike,
    g: ArrayLike,
    count: ArrayLike,
    ends: tuple[float, float] = FIT_RANGE,
    offset: float | None = None,
) -> tuple[float, float, float]:
    """Return n, k and c of ``ln(1 / g) = k tau^-n + c``, by least squares weighted with the counts.

    The constant c takes the normalisation of g, unless it is given. Bins in a range of times with at least 5 pairs
    count. n is NaN and k is 0 if there are fewer than 5 such bins, or the energy does not rise towards small tau. The
    exponent depends on the range and on c: give both.

    Args:
        ttc: ``[N]`` times to collision [s].
        g: ``[N]`` frequency over that without interaction.
        count: ``[N]`` number of pairs.
        ends: range of times to collision of the fit [s] (default: 0.2 to 3 s).
        offset: the constant c, such as 0 for a g that is 1 at long times (default: part of the fit).

    Raises:
        InputError: the arrays differ in length.

    >>> tau = np.arange(0.25, 3.0, 0.1)
    >>> n, k, c = fit_interaction_energy(tau, np.exp(-0.8 / tau**2 - 0.1), np.full(len(tau), 100))
    >>> round(n, 2), round(k, 2), round(c, 2)
    (2.0, 0.8, 0.1)
    """
    tau, ratio, number = (np.asarray(item, dtype=np.float64) for item in (ttc, g, count))
    if not tau.shape == ratio.shape == number.shape or tau.ndim != 1:
        raise InputError("times to collision, g and counts must be columns of equal length")
    used = (tau >= ends[0]) & (tau <= ends[1]) & (number >= FEWEST) & (ratio > 0.0)
    if np.sum(used) < FEWEST:
        return float("nan"), 0.0, 0.0
    x, y, w = tau[used] ** -EXPONENTS[:, None], -np.log(ratio[used]), number[used] / number[used].sum()
    mean_x, mean_y = (x * w).sum(axis=1), float(np.sum(y * w))
    if offset is not None:
        mean_x, mean_y = np.zeros(len(x)), offset
    away = x - mean_x[:, None]
    k = (away * (y - mean_y) * w).sum(axis=1) / np.maximum((away**2 * w).sum(axis=1), 1e-300)
    rest = (((y - mean_y) - k[:, None] * away) ** 2 * w).sum(axis=1)
    best = int(np.argmin(rest))
    if k[best] <= 0.0:
        return float("nan"), 0.0, mean_y
    return float(EXPONENTS[best]), float(k[best]), float(mean_y - k[best] * mean_x[best])


def _ratio(found: Floats, expected: Floats) -> Floats:
    return np.where(expected > 0.0, found / np.where(expected > 0.0, expected, 1.0), np.nan)


def _energy(g: Floats) -> Floats:
    known = g > 0.0
    return np.where(known, -np.log(np.where(known, g, 1.0)), np.nan)

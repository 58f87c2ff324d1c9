"""Encounters of pairs of people: time to collision and clearance, with their distributions.

Time to collision and the interaction energy: Karamouzas, Skinner, Guy 2014, Universal power law governing pedestrian
interactions, doi 10.1103/PhysRevLett.113.238701. There, g(tau) is the frequency of times to collision over that of
people who do not interact, and E(tau) is proportional to ln(1 / g(tau)).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crowdbot.core import InputError, stream
from crowdbot.data import Trajectories
from crowdbot.typing import Floats, Ints

from .rows import check_metres, rows_at, table

if TYPE_CHECKING:
    import pandas as pd


REACH = 1e3
"""Distance [m] beyond which pairs are not counted in distributions of times."""


def compute_encounters(
    tracks: Trajectories, velocity: pd.DataFrame, radius: float, reach: float = 10.0
) -> pd.DataFrame:
    """Return all pairs of people in reach in each frame: columns id, other_id, frame, clearance [m], ttc [s].

    ``clearance = |x_j - x_i| - 2 r``. ``ttc`` is the time until two discs of radius r touch at constant velocities:
    0 in contact, infinite without a collision.

    Args:
        tracks: the recording.
        velocity: result of :func:`~crowdbot.measurement.compute_individual_speed`, without a direction; rows without a
            velocity are left out.
        radius: radius of all people r [m].
        reach: largest distance of centres [m].

    Raises:
        InputError: the radius or the reach is not above 0.
        DataError: the tracks are in pixels.

    >>> from crowdbot.measurement import compute_individual_speed
    >>> x = [0.0, 4.0, 1.0, 3.0]
    >>> tracks = Trajectories([1, 2, 1, 2], [0, 0, 1, 1], x, [0.0] * 4, row_rate=1.0)
    >>> pairs = compute_encounters(tracks, compute_individual_speed(tracks, 1, border="single-sided"), radius=0.5)
    >>> pairs.clearance.tolist(), pairs.ttc.tolist()
    ([3.0, 1.0], [1.5, 0.5])
    """
    check_metres(tracks)
    if not radius > 0.0 or not reach > 0.0:
        raise InputError(f"encounters need a radius and a reach above 0, not {radius} and {reach}")
    rows = rows_at(tracks, velocity.frame.to_numpy(np.int64), velocity.id.to_numpy(np.int64))
    kept = rows >= 0
    rows, speed = rows[kept], velocity[["v_x", "v_y"]].to_numpy()[kept]
    one, other = _pairs(tracks, rows, tracks.frame[rows], reach)
    away = tracks.position[rows[other]] - tracks.position[rows[one]]
    clearance = np.hypot(away[:, 0], away[:, 1]) - 2.0 * radius
    return table(
        id=tracks.id[rows[one]],
        other_id=tracks.id[rows[other]],
        frame=tracks.frame[rows[one]],
        clearance=clearance,
        ttc=_time_to_collision(away, speed[other] - speed[one], 2.0 * radius),
    )


def compute_time_to_collision_distribution(
    tracks: Trajectories,
    velocity: pd.DataFrame,
    radius: float,
    bin_size: float = 0.1,
    longest: float = 8.0,
    shuffles: int = 4,
    seed: int = 0,
) -> pd.DataFrame:
    """Return the distribution of times to collision against people who do not interact.

    For people who do not interact, the frames of all rows (with their velocities) are shuffled. A fast decay of g
    towards small tau shows that people avoid collisions.

    Args:
        tracks, velocity, radius: as in :func:`compute_encounters`.
        bin_size: width of the bins [s].
        longest: longest time [s].
        shuffles: how often frames are shuffled.
        seed: seed of the shuffles.

    Returns:
        Columns ttc (middle of the bin) [s], count, expected (per shuffle), g, energy = ln(1 / g); NaN without values.

    Raises:
        InputError: an argument is not above 0.
    """
    edges = time_edges(bin_size, longest, shuffles)
    pairs = compute_encounters(tracks, velocity, radius, reach=REACH)
    found = np.histogram(pairs.ttc.to_numpy()[pairs.ttc.to_numpy() > 0.0], edges)[0]
    expected = expected_times(tracks, velocity, radius, edges, shuffles, seed) * len(pairs)
    known = (expected > 0.0) & (found > 0)
    g = np.where(expected > 0.0, found / np.where(expected > 0.0, expected, 1.0), np.nan)
    energy = np.where(known, -np.log(np.where(known, g, 1.0)), np.nan)
    return table(ttc=edges[:-1] + 0.5 * bin_size, count=found, expected=expected, g=g, energy=energy)


def time_edges(bin_size: float, longest: float, shuffles: int) -> Floats:
    """Return the edges of bins of times to collision [s].

    Raises:
        InputError: an argument is not above 0.

    >>> time_edges(0.5, 1.0, 1).tolist()
    [0.0, 0.5, 1.0]
    """
    if not bin_size > 0.0 or not longest >= bin_size or shuffles < 1:
        raise InputError("a distribution of times needs a bin size above 0, a longer range and at least 1 shuffle")
    return np.arange(0.0, longest + 0.5 * bin_size, bin_size)


def expected_times(
    tracks: Trajectories, velocity: pd.DataFrame, radius: float, edges: Floats, shuffles: int, seed: int
) -> Floats:
    """Return the share of pairs ``[N]`` in bins of time to collision if people do not interact: with shuffled frames.

    Args:
        tracks, velocity, radius: as in :func:`compute_encounters`.
        edges: ``[N + 1]`` edges of the bins [s].
        shuffles: how often frames are shuffled.
        seed: seed of the shuffles.

    >>> from crowdbot.measurement import compute_individual_speed
    >>> x = [0.0, 4.0, 1.0, 3.0]
    >>> tracks = Trajectories([1, 2, 1, 2], [0, 0, 1, 1], x, [0.0] * 4, row_rate=1.0)
    >>> speed = compute_individual_speed(tracks, 1, border="single-sided")
    >>> float(expected_times(tracks, speed, 0.5, np.array([0.0, 8.0]), 4, 0)[0])
    1.0
    """
    rows = rows_at(tracks, velocity.frame.to_numpy(np.int64), velocity.id.to_numpy(np.int64))
    place, speed = tracks.position[rows], velocity[["v_x", "v_y"]].to_numpy()
    rng = stream(seed, "times to collision")
    free, count = np.zeros(len(edges) - 1), 0
    for _ in range(shuffles):
        one, other = _pairs(tracks, rows, rng.permutation(tracks.frame[rows]), REACH)
        one, other = _strangers(tracks.id[rows], one, other)
        when = _time_to_collision(place[other] - place[one], speed[other] - speed[one], 2.0 * radius)
        free += np.histogram(when[when > 0.0], edges)[0]
        count += len(one)
    return np.asarray(free / max(count, 1))


def distribution(values: Floats, bin_size: float, low: float, high: float) -> pd.DataFrame:
    """Return a histogram of finite values: columns value (middle of the bin), count, density, cumulative.

    ``density`` integrates to the share of the values in the range, ``cumulative`` is the share of all values, including
    infinite ones, below the upper end of the bin.

    Raises:
        InputError: the bins are empty.

    >>> distribution(np.array([0.1, 0.2, 1.5, np.inf]), 1.0, 0.0, 2.0).cumulative.tolist()
    [0.5, 0.75]
    """
    if not bin_size > 0.0 or not high >= low + bin_size:
        raise InputError(f"bins of {bin_size} do not fit between {low} and {high}")
    known = values[~np.isnan(values)]
    edges = np.arange(low, high + 0.5 * bin_size, bin_size)
    count = np.histogram(known[np.isfinite(known)], edges)[0]
    total = max(len(known), 1)
    below = np.searchsorted(np.sort(known), edges[1:], side="left")
    return table(
        value=edges[:-1] + 0.5 * bin_size, count=count, density=count / total / bin_size, cumulative=below / total
    )


def _pairs(tracks: Trajectories, rows: Ints, frame: Ints, reach: float) -> tuple[Ints, Ints]:
    """Return pairs of numbers in ``rows`` with the same frame whose centres are in reach, each pair once."""
    place = tracks.position[rows]
    order = np.lexsort((tracks.id[rows], frame))
    one, other = [np.empty(0, np.int64)], [np.empty(0, np.int64)]
    for group in np.split(order, np.flatnonzero(np.diff(frame[order])) + 1):
        a, b = np.triu_indices(len(group), 1)
        away = place[group[b]] - place[group[a]]
        near = away[:, 0] ** 2 + away[:, 1] ** 2 <= reach**2
        one.append(group[a[near]])
        other.append(group[b[near]])
    return np.concatenate(one), np.concatenate(other)


def _strangers(id: Ints, one: Ints, other: Ints) -> tuple[Ints, Ints]:
    """Return the pairs of different people."""
    apart = id[one] != id[other]
    return one[apart], other[apart]


def _time_to_collision(away: Floats, relative: Floats, size: float) -> Floats:
    """Return the smallest t >= 0 with ``|away + relative t| = size``; 0 in contact, infinite if there is none."""
    gap = away[:, 0] ** 2 + away[:, 1] ** 2 - size**2
    nearing = away[:, 0] * relative[:, 0] + away[:, 1] * relative[:, 1]
    inside = nearing**2 - (relative[:, 0] ** 2 + relative[:, 1] ** 2) * gap
    meets = (nearing < 0.0) & (inside > 0.0)
    root = np.sqrt(np.where(meets, inside, 0.0))
    when = np.where(meets, gap / np.where(meets, root - nearing, 1.0), np.inf)
    return np.where(gap <= 0.0, 0.0, when)

"""Distances of people: headways and the pair distribution function.

Pair distribution: Cordes, Schadschneider, Nicolas 2024, Dimensionless numbers reveal distinct regimes in the structure
and dynamics of pedestrian crowds, doi 10.1093/pnasnexus/pgae120. Headway in single file: Seyfried et al. 2005,
doi 10.1088/1742-5468/2005/10/P10002.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import InputError, stream
from crowdbot.data import Trajectories
from crowdbot.typing import Floats

from .rows import check_metres, table

if TYPE_CHECKING:
    import pandas as pd


def compute_headways(tracks: Trajectories, axis: str = "x", length: float | None = None) -> pd.DataFrame:
    """Return the gaps of a single file along an axis: columns id, frame, ahead, behind [m], density [1/m].

    ``ahead`` and ``behind`` are distances between centres to the next person with the larger and the smaller
    coordinate, NaN where there is none. ``density = 2 / (ahead + behind)``.

    Args:
        tracks: the recording.
        axis: ``x`` or ``y``, the coordinate along the file.
        length: length of a closed track [m] (default: open); coordinates may count rounds.

    Raises:
        InputError: the axis is unknown, or the length is not above 0.
        DataError: the tracks are in pixels.

    >>> tracks = Trajectories([1, 2, 3], [0, 0, 0], [0.0, 1.0, 3.0], [0.0] * 3, row_rate=1.0)
    >>> compute_headways(tracks).ahead.tolist(), compute_headways(tracks, length=4.0).behind.tolist()
    ([1.0, 2.0, nan], [1.0, 1.0, 2.0])
    """
    check_metres(tracks)
    if axis not in ("x", "y"):
        raise InputError(f"the axis of a single file is x or y, not {axis!r}")
    if length is not None and not length > 0.0:
        raise InputError(f"the length of a closed track must be above 0, not {length}")
    along = tracks.x if axis == "x" else tracks.y
    if length is not None:
        along = np.mod(along, length)
    order = np.lexsort((along, tracks.frame))
    ahead, behind = np.full(len(tracks), np.nan), np.full(len(tracks), np.nan)
    for rows in np.split(order, np.flatnonzero(np.diff(tracks.frame[order])) + 1):
        gap = np.diff(along[rows])
        ahead[rows[:-1]] = gap
        behind[rows[1:]] = gap
        if length is not None:
            ahead[rows[-1]] = behind[rows[0]] = along[rows[0]] + length - along[rows[-1]]
    with np.errstate(divide="ignore"):
        density = 2.0 / (ahead + behind)
    return table(id=tracks.id, frame=tracks.frame, ahead=ahead, behind=behind, density=density)


def compute_pair_distribution_function(
    tracks: Trajectories, bin_size: float, farthest: float | None = None, shuffles: int = 1, seed: int = 0
) -> pd.DataFrame:
    """Return the pair distribution function g(r): columns radius (upper end of the bin) [m], g.

    ``g(r) = P(r) / P_ni(r)``: the frequency of distances in the same frame over that of people who do not interact, for
    whom the frames of all rows are shuffled. g is 1 without interaction; NaN where no shuffled pair has the distance.
    PedPy has the same function without a seed and a largest distance; it needs 4 to 17 times as long.

    Args:
        tracks: the recording.
        bin_size: width of the bins [m].
        farthest: largest distance [m] (default: the largest one in the recording).
        shuffles: how often the frames are shuffled; more make the denominator smoother.
        seed: seed of the shuffles.

    Raises:
        InputError: an argument is not above 0.
        DataError: the tracks are in pixels.
    """
    check_metres(tracks)
    if not bin_size > 0.0 or shuffles < 1 or (farthest is not None and not farthest > bin_size):
        raise InputError("a pair distribution needs a bin size above 0, at least 1 shuffle and a distance beyond a bin")
    real = _pair_distances(tracks.position, tracks.frame)
    rng = stream(seed, "pair distribution")
    mixed = [_pair_distances(tracks.position, rng.permutation(tracks.frame)) for _ in range(shuffles)]
    free = np.concatenate(mixed)
    end = farthest if farthest is not None else float(real.max(initial=bin_size))
    edges = np.arange(0.0, end + 0.5 * bin_size, bin_size)
    found, expected = (np.histogram(part, edges)[0] / max(len(part), 1) for part in (real, free))
    g = np.where(expected > 0.0, found / np.where(expected > 0.0, expected, 1.0), np.nan)
    return table(radius=edges[1:], g=g)


def _pair_distances(place: ArrayLike, frame: ArrayLike) -> Floats:
    """Return the distances of all pairs of rows with the same frame."""
    from scipy.spatial.distance import pdist

    points, when = np.asarray(place), np.asarray(frame)
    order = np.argsort(when, kind="stable")
    parts = np.split(order, np.flatnonzero(np.diff(when[order])) + 1)
    return np.concatenate([np.empty(0), *(pdist(points[rows]) for rows in parts if len(rows) > 1)])

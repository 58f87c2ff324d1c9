"""Order of lanes in a two-way flow.

Rex, Löwen 2007, doi 10.1103/PhysRevE.75.051402; Nowak, Schadschneider 2012, doi 10.1103/PhysRevE.85.046128.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crowdbot.core import InputError
from crowdbot.data import Trajectories
from crowdbot.typing import Floats

from .rows import check_metres, table

if TYPE_CHECKING:
    import pandas as pd


LANE_BAND = 0.3
"""Width of the band of a person: lateral distance [m]."""


def lane_order(y: Floats, direction: Floats, width: float = LANE_BAND) -> float:
    """Return the order of lanes of two directions: 0 random, 1 complete, NaN without neighbors.

    For each person i with m others in its band (lateral distance below ``width``, anywhere along the corridor), phi_i =
    (like - unlike)^2 / m^2 (Rex & Löwen 2007). Small bands are ordered by chance. The mean of phi is therefore compared
    with its expectation for a random permutation of the directions (the reduced order parameter of Nowak &
    Schadschneider 2012): (mean phi - expected) / (1 - expected). For a band of m this is (1 + (m - 1) q) / m, with q =
    ((sum of directions)^2 - N) / (N (N - 1)).

    Args:
        y: ``[N]`` lateral positions [m].
        direction: ``[N]`` +1 or -1.
        width: width of a band [m].

    >>> lane_order(np.array([0.0, 0.1, 2.0, 2.1]), np.array([1.0, 1.0, -1.0, -1.0]))
    1.0
    """
    N = len(y)
    near = np.abs(y[:, None] - y[None, :]) < width
    np.fill_diagonal(near, False)
    band = near.sum(axis=1)
    some = band > 0
    if not np.any(some) or N < 3:
        return float("nan")
    m = band[some].astype(np.float64)
    phi = float(np.mean((near[some] @ direction) ** 2 / m**2))
    q = (float(direction.sum()) ** 2 - N) / (N * (N - 1))
    chance = float(np.mean((1.0 + (m - 1.0) * q) / m))
    return 1.0 if chance >= 1.0 else (phi - chance) / (1.0 - chance)


def compute_lane_order(
    tracks: Trajectories, axis: str = "x", every: float = 1.0, least: int = 5, width: float = LANE_BAND
) -> pd.DataFrame:
    """Return the order of lanes over time: columns frame, time [s], order, positive, negative (people each way).

    The direction of a person is the sign of its way from the first to the last row along the axis.

    Args:
        tracks: the recording; cut it to the section of the corridor first.
        axis: ``x`` or ``y``, the coordinate along the corridor.
        every: time between two values [s].
        least: minimum number of people in each direction; other frames are left out.
        width: width of a band, see :func:`lane_order`.

    Raises:
        InputError: an argument is not allowed.
        DataError: the tracks are in pixels.
    """
    check_metres(tracks)
    if axis not in ("x", "y") or not every > 0.0 or least < 1 or not width > 0.0:
        raise InputError("lane order needs an axis x or y, and a time, a number of people and a width above 0")
    along, across = (tracks.x, tracks.y) if axis == "x" else (tracks.y, tracks.x)
    side = walking_direction(tracks, along)
    rows = []
    for frame in np.unique(tracks.frame)[:: max(1, round(every / tracks.dt))]:
        here = (tracks.frame == frame) & (side != 0.0)
        positive, negative = int(np.sum(side[here] > 0.0)), int(np.sum(side[here] < 0.0))
        if min(positive, negative) >= least:
            rows.append((int(frame), lane_order(across[here], side[here], width), positive, negative))
    frames, order, positives, negatives = (
        np.asarray(column) for column in (zip(*rows, strict=True) if rows else ([], [], [], []))
    )
    time = (frames - tracks.frame[0]) / tracks.fps
    return table(frame=frames, time=time, order=order, positive=positives, negative=negatives)


def walking_direction(tracks: Trajectories, along: Floats) -> Floats:
    """Return the sign ``[N]`` of the way of each row's person from its first to its last row along a coordinate."""
    first = np.unique(tracks.id, return_index=True)[1]
    last = len(tracks) - 1 - np.unique(tracks.id[::-1], return_index=True)[1]
    return np.asarray(np.sign(along[last] - along[first])[np.searchsorted(tracks.ids, tracks.id)])

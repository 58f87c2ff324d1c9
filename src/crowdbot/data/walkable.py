"""The walkable area of a recording, from its walls or its positions."""

from __future__ import annotations

import numpy as np

from crowdbot.typing import Floats

from .track_table import TrackTable

HALF = 0.01
"""Half width of a thin wall [m]."""


def walkable_rings(tracks: TrackTable, margin: float = 1.0) -> tuple[Floats, list[Floats]]:
    """Return the border of the walkable area and its obstacles, as rings ``[N, 2]`` in the units of the recording.

    The largest clockwise ring of ``tracks.walls`` is the border, counter-clockwise rings are obstacles, walls of two
    points are obstacles 2 cm wide. Without a border, it is the box around all positions and ``margin``.

    >>> from crowdbot.data import Trajectories
    >>> walkable_rings(Trajectories([1, 1], [0, 1], [0.0, 4.0], [0.0, 0.0], row_rate=1.0))[0].tolist()
    [[-1.0, -1.0], [5.0, -1.0], [5.0, 1.0], [-1.0, 1.0]]
    """
    rings = [np.asarray(ring, dtype=np.float64) for ring in tracks.walls if len(ring) > 2]
    borders = [ring for ring in rings if _signed_area(ring) < 0.0]
    solids = [ring for ring in rings if _signed_area(ring) > 0.0]
    solids += [_thick(np.asarray(wall, dtype=np.float64)) for wall in tracks.walls if len(wall) == 2]
    if borders:
        return max(borders, key=lambda ring: -_signed_area(ring)), solids
    x0, x1, y0, y1 = tracks.x.min() - margin, tracks.x.max() + margin, tracks.y.min() - margin, tracks.y.max() + margin
    return np.asarray([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]), solids


def _thick(wall: Floats) -> Floats:
    """Return the rectangle ``[4, 2]`` around a wall ``[2, 2]``."""
    along = wall[1] - wall[0]
    away = HALF * np.asarray([-along[1], along[0]]) / max(float(np.hypot(*along)), 1e-12)
    return np.asarray([wall[0] + away, wall[0] - away, wall[1] - away, wall[1] + away])


def _signed_area(ring: Floats) -> float:
    x, y = ring.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))

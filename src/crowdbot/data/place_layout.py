"""Walls and exits of the place of a recording, and its walkable area."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.typing import Floats

from .track_table import TrackTable

Ring = tuple[tuple[float, float], ...]

MOST = 20_000
"""Largest number of positions that are compared with the walls."""
NEAR = 0.05
"""Positions within this distance outside of a border, or inside of an obstacle, count as walkable [m]."""


@dataclass(frozen=True)
class PlaceLayout:
    """Walls and exits of a place, in the coordinates of the recording [m].

    Fields:
        walls: rings as in :class:`crowdbot.core.Walls`: clockwise around the walkable area, counter-clockwise around
            obstacles, two points for a thin wall.
        exits: ``(start, end)`` of each exit; both are the same for a point.
        name: name of the file, for messages.

    Raises:
        DataError: a coordinate is not finite, or a wall has fewer than two points.

    >>> layout = PlaceLayout((((0, 0), (0, 4), (4, 4), (4, 0)),), name="room.wkt")
    >>> layout.outside([(1.0, 1.0), (5.0, 1.0)]).tolist()
    [False, True]
    """

    walls: tuple[Ring, ...]
    exits: tuple[Ring, ...] = ()
    name: str = "layout"

    def __post_init__(self) -> None:
        for what, rings in (("walls", self.walls), ("exits", self.exits)):
            made = tuple(tuple((float(x), float(y)) for x, y in ring) for ring in rings)
            if any(len(ring) < 2 or not np.all(np.isfinite(ring)) for ring in made):
                raise DataError(f"{self.name}: {what} need at least two finite points each")
            object.__setattr__(self, what, made)

    @property
    def rings(self) -> tuple[Floats, ...]:
        """The walls as arrays ``[N, 2]``."""
        return tuple(np.asarray(ring, dtype=np.float64) for ring in self.walls)

    def outside(self, points: object) -> NDArray[np.bool_]:
        """Return which of the points ``[N, 2]`` are not walkable: outside of all borders, or in an obstacle."""
        import shapely

        places = shapely.points(np.asarray(points, dtype=np.float64))
        polygons = [shapely.polygons(ring) for ring in self.rings if len(ring) > 2]
        clockwise = [not shapely.is_ccw(polygon.exterior) for polygon in polygons]
        borders = [polygon for polygon, turned in zip(polygons, clockwise, strict=True) if turned]
        solids = [polygon for polygon, turned in zip(polygons, clockwise, strict=True) if not turned]
        out = np.zeros(len(places), dtype=np.bool_)
        if borders:
            out |= ~shapely.intersects(shapely.union_all(borders).buffer(NEAR), places)
        if solids:
            out |= shapely.intersects(shapely.union_all(solids).buffer(-NEAR), places)
        return out

    def remark(self, position: Floats) -> str:
        """Return a sentence if more than 2 % of the positions ``[N, 2]`` are not walkable, else an empty text."""
        some = position[:: 1 + len(position) // MOST]
        share = float(np.mean(self.outside(some)))
        if share <= 0.02:
            return ""
        return f"warning: {share:.0%} of the positions are in walls or outside of {self.name}; check its coordinates"


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

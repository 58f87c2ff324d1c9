"""Free space between walls for a body of a given radius, and the corners of shortest paths."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from crowdbot.core import Walls
from crowdbot.typing import Floats

if TYPE_CHECKING:
    import shapely


SHARPEST = math.pi / 4.0
"""Largest turn [rad] at one point of a path around a corner."""
FLAT = 1e-6
"""Corners below this angle [rad] are ignored."""
ROUND = 8
"""Segments per quarter circle in the outline of free space."""
MARGIN = 100.0
"""Distance [m] from the last wall at which unbounded free space ends."""
EXACT = 1.0 - 1e-9


def inside(walls: Walls) -> shapely.Geometry:
    """Return the area open to people of radius 0: outside solid polygons, and inside a room if one encloses everything.

    Inner rings take precedence over outer ones: an obstacle in a room, a courtyard in a building.

    >>> inside(Walls.of([[(0, 0), (2, 0), (2, 2), (0, 2)]])).area == 202 * 202 - 4
    True
    """
    import shapely

    rings = sorted(_rings(walls), key=lambda ring: -abs(_area(ring)))
    points = np.concatenate([walls.start, np.zeros((1, 2))]) if len(walls) == 0 else walls.start
    low, high = points.min(axis=0) - MARGIN, points.max(axis=0) + MARGIN
    whole: shapely.Geometry = shapely.box(*low, *high)
    if rings and _area(rings[0]) < 0.0:
        whole = shapely.Polygon()
    for ring in rings:
        solid = shapely.make_valid(shapely.Polygon(ring))
        whole = whole.difference(solid) if _area(ring) > 0.0 else whole.union(solid)
    return whole


def room_for(walls: Walls, radius: float) -> list[Any]:
    """Return the connected parts (shapely polygons) of the free space of a body of this radius [m]."""
    import shapely

    lines = shapely.multilinestrings(shapely.linestrings(walls.segments().reshape(-1, 2, 2)))
    free = inside(walls).difference(lines.buffer(radius, quad_segs=ROUND))
    return [part for part in shapely.get_parts(free) if part.geom_type == "Polygon" and part.area > 0.0]


def corners(walls: Walls, radius: float) -> Floats:
    """Return the points ``[N, 2]`` [m] at which shortest paths of a body of this radius [m] bend.

    These are the corners of an outline around each wall corner whose tangents have the distance ``radius`` from it.

    >>> corners(Walls.of([[(0, 0), (4, 0)]]), 1.0).round(2).tolist()[:2]
    [[-1.0, -0.41], [-1.0, 0.41]]
    """
    import shapely

    segments = walls.segments()
    if len(segments) == 0:
        return np.zeros((0, 2))
    found = []
    for corner, directions in _incident(segments):
        for begin, width in _corner_sectors(directions):
            count = math.ceil(width / SHARPEST - FLAT)
            angle = begin + (np.arange(count) + 0.5) * (width / count)
            far = radius / math.cos(0.5 * width / count)
            found.append(corner + far * np.stack([np.cos(angle), np.sin(angle)], axis=-1))
    points = np.unique(np.concatenate(found).round(9), axis=0) if found else np.zeros((0, 2))
    tree = shapely.STRtree(shapely.linestrings(segments.reshape(-1, 2, 2)))
    places = shapely.points(points)
    rows, away = tree.query_nearest(places, return_distance=True, all_matches=False)
    clear = np.zeros(len(points), dtype=np.bool_)
    clear[rows[0]] = away >= radius * EXACT - 2e-9
    whole = inside(walls)
    shapely.prepare(whole)
    return np.ascontiguousarray(points[clear & shapely.contains(whole, places)])


def _incident(segments: Floats) -> list[tuple[Floats, Floats]]:
    """Return each wall end with the sorted directions [rad] of the walls that leave it."""
    ends = np.concatenate([segments[:, :2], segments[:, 2:]])
    away = np.concatenate([segments[:, 2:], segments[:, :2]]) - ends
    points, which = np.unique(ends, axis=0, return_inverse=True)
    angle = np.arctan2(away[:, 1], away[:, 0])
    order = np.lexsort((angle, which.reshape(-1)))
    borders = np.searchsorted(which.reshape(-1)[order], np.arange(len(points) + 1))
    return [(points[k], angle[order[borders[k] : borders[k + 1]]]) for k in range(len(points))]


def _corner_sectors(directions: Floats) -> list[tuple[float, float]]:
    """Return start and width [rad] of the sectors in which the corner itself is the nearest point."""
    following = np.append(directions[1:], directions[0] + 2.0 * math.pi)
    gaps = following - directions
    return [
        (float(at) + 0.5 * math.pi, float(gap) - math.pi)
        for at, gap in zip(directions, gaps, strict=True)
        if gap > math.pi + FLAT
    ]


def _rings(walls: Walls) -> list[Floats]:
    """Return the rings ``[N, 2]`` of the walls, without thin walls."""
    rings, begin = [], 0
    while begin < len(walls):
        end = int(walls.previous[begin]) + 1
        if end - begin > 2:
            rings.append(walls.start[begin:end])
        begin = end
    return rings


def _area(ring: Floats) -> float:
    x, y = ring[:, 0], ring[:, 1]
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))

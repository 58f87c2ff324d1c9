"""Geometry of measurements: areas, lines and the walkable area."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError
from crowdbot.data import Trajectories, walkable_rings
from crowdbot.typing import Floats


@dataclass(frozen=True, eq=False)
class MeasurementArea:
    """A polygon in which density, speed and flow are measured.

    Fields:
        corners: ``[N, 2]`` corners [m], N at least 3; the polygon is closed automatically.

    Raises:
        InputError: there are fewer than three corners, edges intersect, or the area is 0.

    >>> MeasurementArea([(0, 0), (2, 0), (2, 1), (0, 1)]).area
    2.0
    """

    corners: ArrayLike

    def __post_init__(self) -> None:
        object.__setattr__(self, "corners", _points(self.corners, "a measurement area", 3))
        polygon = self.polygon
        if not polygon.is_valid or not polygon.area > 0.0:
            raise InputError("the edges of a measurement area intersect, or its area is 0; name its corners in order")

    @property
    def polygon(self) -> Any:
        """The area as a shapely polygon."""
        import shapely

        return shapely.Polygon(self.corners)

    @property
    def area(self) -> float:
        """The size of the area [m2]."""
        return float(self.polygon.area)

    def contains(self, position: ArrayLike) -> NDArray[np.bool_]:
        """Return whether points ``[N, 2]`` [m] are inside; points on the border are not."""
        import shapely

        place = np.asarray(position, dtype=np.float64)
        polygon = self.polygon
        shapely.prepare(polygon)
        return np.asarray(shapely.contains_xy(polygon, place[:, 0], place[:, 1]))


@dataclass(frozen=True, eq=False)
class MeasurementLine:
    """A straight line from one point to another at which flow is measured.

    Fields:
        start, end: ends [m].

    Raises:
        InputError: the ends are not two finite coordinates each, or are equal.

    >>> line = MeasurementLine((0, 0), (0, 2))
    >>> line.length, line.normal.tolist()
    (2.0, [1.0, 0.0])
    """

    start: tuple[float, float]
    end: tuple[float, float]

    def __post_init__(self) -> None:
        ends = _points([self.start, self.end], "a measurement line", 2)
        if np.array_equal(ends[0], ends[1]):
            raise InputError("the two ends of a measurement line are equal")
        object.__setattr__(self, "start", (float(ends[0, 0]), float(ends[0, 1])))
        object.__setattr__(self, "end", (float(ends[1, 0]), float(ends[1, 1])))

    @property
    def line(self) -> Any:
        """The line as a shapely line string."""
        import shapely

        return shapely.LineString([self.start, self.end])

    @property
    def length(self) -> float:
        """The length of the line [m]."""
        return math.dist(self.start, self.end)

    @property
    def normal(self) -> Floats:
        """``[2]`` unit vector to the right of the way from start to end; species and line flow count along it."""
        along = np.subtract(self.end, self.start)
        return np.asarray([along[1], 0.0 - along[0]]) / self.length


@dataclass(frozen=True, eq=False)
class WalkableArea:
    """A polygon in which people can walk, with obstacles.

    Fields:
        border: ``[N, 2]`` corners [m].
        obstacles: rings ``[N, 2]`` [m] inside the border.

    Raises:
        InputError: the border or an obstacle is not a polygon, or nothing is left to walk on.

    >>> WalkableArea([(0, 0), (4, 0), (4, 3), (0, 3)], [[(1, 1), (2, 1), (2, 2), (1, 2)]]).area
    11.0
    """

    border: ArrayLike
    obstacles: Sequence[ArrayLike] = ()

    def __post_init__(self) -> None:
        import shapely

        object.__setattr__(self, "border", _points(self.border, "a walkable area", 3))
        rings = tuple(_points(ring, "an obstacle", 3) for ring in self.obstacles)
        object.__setattr__(self, "obstacles", rings)
        polygon = shapely.Polygon(self.border)
        if not polygon.is_valid:
            raise InputError("the edges of a walkable area intersect; name its corners in order")
        for ring in rings:
            solid = shapely.Polygon(ring)
            if not solid.is_valid:
                raise InputError("the edges of an obstacle intersect; name its corners in order")
            polygon = polygon.difference(solid)
        if not polygon.area > 0.0:
            raise InputError("nothing is left of the walkable area")
        object.__setattr__(self, "_polygon", polygon)

    @property
    def polygon(self) -> Any:
        """The area as a shapely polygon."""
        return self.__dict__["_polygon"]

    @property
    def area(self) -> float:
        """The size of the area [m2]."""
        return float(self.polygon.area)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """The smallest and largest x and y: x0, y0, x1, y1 [m]."""
        return tuple(self.polygon.bounds)

    def covers(self, position: ArrayLike) -> NDArray[np.bool_]:
        """Return whether points ``[N, 2]`` [m] are inside or on the border."""
        import shapely

        polygon = self.polygon
        shapely.prepare(polygon)
        return np.asarray(shapely.covers(polygon, shapely.points(np.asarray(position, dtype=np.float64))))

    @classmethod
    def of(cls, tracks: Trajectories, margin: float = 1.0) -> WalkableArea:
        """Return the walkable area of a recording.

        The largest clockwise ring of ``tracks.walls`` is the border, counter-clockwise rings are obstacles, walls of
        two points are obstacles 2 cm wide. Without a border, it is the box around all positions and ``margin`` [m].
        """
        return cls(*walkable_rings(tracks, margin))


def _points(values: Any, what: str, least: int) -> Floats:
    try:
        points = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        points = np.empty(0)
    if points.ndim != 2 or points.shape[1] != 2 or len(points) < least or not np.all(np.isfinite(points)):
        raise InputError(f"{what} needs at least {least} points with finite x and y")
    return points

"""Walls: polygons and lines that block people and rays, as arrays of edges."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from .errors import InputError

CACHE = "_derived"
"""Name of the cache in the dictionary of walls."""
Value = TypeVar("Value")


@dataclass(frozen=True)
class Walls:
    """Directed edges and their adjacent edges in each ring; the solid side is on the left of an edge.

    A counter-clockwise ring is a solid obstacle; a clockwise ring encloses free space; two points are a thin wall with
    two sides.

    Fields:
        start, end: ``[M, 2]`` [m].
        previous, next: ``[M]`` index of the previous and the next edge of the ring.
        convex: ``[M]`` bool, whether the corner of the solid at ``start`` is convex.

    >>> Walls.of([[(0, 0), (2, 0), (2, 1), (0, 1)]]).start.shape
    (4, 2)
    """

    start: NDArray[np.float64]
    end: NDArray[np.float64]
    previous: NDArray[np.int64]
    next: NDArray[np.int64]
    convex: NDArray[np.bool_]

    @classmethod
    def of(cls, polygons: Iterable[Any] | Walls = ()) -> Walls:
        """Make walls from rings ``[N, 2]`` (N >= 2), or from shapely geometry (polygons are solid).

        Raises:
            InputError: a coordinate is not finite, or a ring has fewer than two different points.
        """
        if isinstance(polygons, Walls):
            return polygons
        edges: list[NDArray[np.float64]] = []
        previous: list[int] = []
        following: list[int] = []
        convex: list[bool] = []
        for number, polygon in enumerate(polygons):
            for points in _rings(polygon):
                ring = _clean(points, number)
                first, count = len(previous), len(ring)
                edges.append(np.stack([ring, np.roll(ring, -1, axis=0)], axis=1))
                previous += [first + (k - 1) % count for k in range(count)]
                following += [first + (k + 1) % count for k in range(count)]
                convex += _convex(ring).tolist()
        stacked = np.concatenate(edges) if edges else np.zeros((0, 2, 2))
        return cls(
            np.ascontiguousarray(stacked[:, 0]),
            np.ascontiguousarray(stacked[:, 1]),
            np.asarray(previous, dtype=np.int64),
            np.asarray(following, dtype=np.int64),
            np.asarray(convex, dtype=np.bool_),
        )

    @classmethod
    def around(cls, walkable: Any) -> Walls:
        """Make the walls of a walkable area: a shapely polygon (holes are obstacles) or one ring ``[N, 2]``."""
        if hasattr(walkable, "exterior"):
            inside = [_orient(np.asarray(r.coords)[:, :2], clockwise=False) for r in walkable.interiors]
            return cls.of([_orient(np.asarray(walkable.exterior.coords)[:, :2], clockwise=True), *inside])
        return cls.of([_orient(_clean(walkable, 0), clockwise=True)])

    def __len__(self) -> int:
        """Return the number of directed edges."""
        return len(self.start)

    def segments(self) -> NDArray[np.float64]:
        """Return the edges ``[N, 4]`` as x, y, x, y [m]; a thin wall is one segment.

        All calls return the same array: copy it before you change it.
        """
        return self.derive(_segments)

    def derive(self, make: Callable[[Walls], Value]) -> Value:
        """Return ``make(self)``, which is computed at the first call and kept as long as the walls.

        Args:
            make: a function of the walls alone, defined at the top of a module.

        >>> walls = Walls.of([[(0, 0), (2, 0)]])
        >>> walls.derive(len), walls.segments() is walls.segments()
        (2, True)
        """
        try:
            return cast(Value, self.__dict__[CACHE][make])
        except KeyError:
            value = self.__dict__.setdefault(CACHE, {})[make] = make(self)
            return value

    def __getstate__(self) -> dict[str, Any]:
        """Return the fields: copies and pickles do not contain the derived values."""
        return {part.name: getattr(self, part.name) for part in dataclasses.fields(self)}


def _segments(walls: Walls) -> NDArray[np.float64]:
    both = np.concatenate([walls.start, walls.end], axis=1)
    thin = walls.previous == walls.next
    return np.asarray(both[~thin | (np.arange(len(both)) < walls.next)])


def _rings(polygon: Any) -> list[Any]:
    if hasattr(polygon, "geoms"):
        return [ring for part in polygon.geoms for ring in _rings(part)]
    if hasattr(polygon, "exterior"):
        outer = _orient(np.asarray(polygon.exterior.coords)[:, :2], clockwise=False)
        return [outer, *(_orient(np.asarray(r.coords)[:, :2], clockwise=True) for r in polygon.interiors)]
    if hasattr(polygon, "coords"):  # an open shapely line: one thin wall per piece
        line = np.asarray(polygon.coords)[:, :2]
        return [line[k : k + 2] for k in range(len(line) - 1)]
    return [polygon]


def _clean(points: Any, number: int) -> NDArray[np.float64]:
    ring: NDArray[np.float64] = np.asarray(points, dtype=np.float64)
    if ring.ndim != 2 or ring.shape[1] != 2:
        raise InputError(f"wall {number} has shape {list(ring.shape)}, it must be a list of points [N, 2]")
    if not np.all(np.isfinite(ring)):
        raise InputError(f"wall {number} has a coordinate that is not finite")
    keep = np.any(ring != np.roll(ring, 1, axis=0), axis=1)
    ring = ring[keep]
    if len(ring) < 2:
        raise InputError(f"wall {number} has no length: it needs at least two different points")
    return ring


def _orient(ring: NDArray[np.float64], clockwise: bool) -> NDArray[np.float64]:
    x, y = ring[:, 0], ring[:, 1]
    area = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    return ring[::-1] if (area > 0.0) == clockwise else ring


def _convex(ring: NDArray[np.float64]) -> NDArray[np.bool_]:
    if len(ring) == 2:
        return np.ones(2, dtype=np.bool_)
    arriving = ring - np.roll(ring, 1, axis=0)
    leaving = np.roll(ring, -1, axis=0) - ring
    return np.asarray(arriving[:, 0] * leaving[:, 1] - arriving[:, 1] * leaving[:, 0] >= 0.0)

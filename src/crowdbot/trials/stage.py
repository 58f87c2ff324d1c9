"""Stage: where people and robots can be, and its geometry."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Walls

from .attribute import attribute, check, children
from .notation import Points

__all__ = ["Obstacle", "Stage", "Wall", "area"]


@dataclass(frozen=True)
class Wall:
    """A thin wall along a line of points.

    >>> Wall([(0, 0), (4, 0)]).points
    ((0.0, 0.0), (4.0, 0.0))
    """

    points: Points = attribute(about="corners of the line x,y", unit="m", points=2)

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True)
class Obstacle:
    """A solid polygon, listed either way round."""

    points: Points = attribute(about="corners of the polygon x,y", unit="m", points=3)

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True)
class Stage:
    """Walls, obstacles and, when given, the walkable area: its border is a wall, and nobody can be outside.

    >>> stage = Stage(walkable=[(0, 0), (8, 0), (8, 4), (0, 4)], obstacles=[Obstacle([(3, 1), (4, 1), (4, 2)])])
    >>> len(stage.rings), stage.clearance([(1.0, 2.0), (3.9, 1.5), (9.0, 9.0)]).tolist()
    (2, [1.0, 0.0, 0.0])
    """

    walkable: Points = attribute(Points(), about="corners of the area that can be walked on x,y", unit="m")
    walls: tuple[Wall, ...] = children("wall", about="thin walls")
    obstacles: tuple[Obstacle, ...] = children("obstacle", about="solid polygons")

    def __post_init__(self) -> None:
        check(self)

    @property
    def rings(self) -> tuple[NDArray[np.float64], ...]:
        """Rings ``[N, 2]`` [m] as :meth:`crowdbot.core.Walls.of` takes them: solid on the left of each edge."""
        lines = [np.array(w.points[k : k + 2]) for w in self.walls for k in range(len(w.points) - 1)]
        solids = [_turned(o.points, counter_clockwise=True) for o in self.obstacles]
        around = [_turned(self.walkable, counter_clockwise=False)] if self.walkable else []
        return (*lines, *solids, *around)

    def as_walls(self) -> Walls:
        """Return the walls of a scene on this stage."""
        return Walls.of(self.rings)

    def clearance(self, points: Any) -> NDArray[np.float64]:
        """Return ``[N]`` how far points ``[N, 2]`` are from the nearest solid [m]; 0 inside it or off the area."""
        import shapely

        places = shapely.points(np.asarray(points, dtype=np.float64))
        away = np.full(len(places), np.inf)
        if len(self._solids):
            index, distance = self._solids.query_nearest(places, return_distance=True, all_matches=False)
            away[index[0]] = distance
        if self.walkable:
            away = np.where(shapely.covers(self._area, places), away, 0.0)
        return away

    def holds(self, shape: Any) -> bool:
        """Return whether a shapely geometry lies in the walkable area; without one everything does."""
        return not self.walkable or bool(self._area.buffer(1e-9).covers(shape))

    def meets(self, shape: Any) -> bool:
        """Return whether a shapely geometry has a part in the walkable area; without one everything has."""
        return not self.walkable or bool(self._area.intersects(shape))

    def obstacle_around(self, shape: Any) -> int | None:
        """Return the index of an obstacle that a shapely geometry lies in, None when there is none."""
        found = self._blocks.query(shape, predicate="covered_by")
        return int(found.min()) if len(found) else None

    @functools.cached_property
    def _area(self) -> Any:
        import shapely

        polygon = area(self.walkable)
        shapely.prepare(polygon)
        return polygon

    @functools.cached_property
    def _blocks(self) -> Any:
        import shapely

        return shapely.STRtree([area(obstacle.points) for obstacle in self.obstacles])

    @functools.cached_property
    def _solids(self) -> Any:
        """The edges of walls and of the walkable area, and the obstacles, for the search of the nearest."""
        import shapely

        lines = [np.array(wall.points) for wall in self.walls]
        lines += [np.array([*self.walkable, self.walkable[0]])] if self.walkable else []
        edges = [np.stack([line[:-1], line[1:]], axis=1) for line in lines]
        pieces = list(shapely.linestrings(np.concatenate(edges))) if edges else []
        return shapely.STRtree([*pieces, *self._blocks.geometries])


def area(points: Points) -> Any:
    """Return the shapely polygon with these corners."""
    import shapely

    return shapely.Polygon(points)


def _turned(points: Points, counter_clockwise: bool) -> NDArray[np.float64]:
    ring = np.array(points)
    x, y = ring[:, 0], ring[:, 1]
    doubled = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    return ring if (doubled > 0.0) == counter_clockwise else np.asarray(ring[::-1])

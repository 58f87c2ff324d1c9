"""Stage: walls, obstacles, props, walkable area, and their geometry."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Walls
from crowdbot.core.fields import Points, attribute, check, children, quote_value
from crowdbot.world import Appearance, Chair, Cube, Door, Light, Table, Tree, add_rings

from .files.stage_maps import FARTHEST_FILE, FilePlacement, area_of, map_of
from .files.trial_files import resolve_file
from .ground.elements import GroundElement, Platform, Ramp, Stairs, Threshold, ground_of

if TYPE_CHECKING:
    from crowdbot.world import PhysicsStage


TWO_GROUNDS = "has both walkable and area; give one of them"
NOTHING_PLACED = "acts on area and map only, and the stage has neither; move the points of the trial instead"


@dataclass(frozen=True)
class Wall:
    """A thin wall along a line of points.

    >>> Wall([(0, 0), (4, 0)]).points
    ((0.0, 0.0), (4.0, 0.0))
    """

    points: Points = attribute(about="corners x,y of the line", unit="m", points=2)

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True)
class Obstacle:
    """A solid polygon; its corners may be in either order."""

    points: Points = attribute(about="corners x,y of the polygon", unit="m", points=3)

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True)
class Stage:
    """Walls, obstacles, props and an optional walkable area. Its border is a wall; its outside is not accessible.

    In the planar world the outlines of props are solid (of a tree, its trunk). Props move in the physics world only.
    Uneven ground is part of the physics world only.

    >>> stage = Stage(walkable=[(0, 0), (8, 0), (8, 4), (0, 4)], obstacles=[Obstacle([(3, 1), (4, 1), (4, 2)])])
    >>> len(stage.rings), stage.clearance([(1.0, 2.0), (3.9, 1.5), (9.0, 9.0)]).tolist()
    (2, [1.0, 0.0, 0.0])
    >>> Stage(area="POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0), (4 4, 5 4, 5 5, 4 5, 4 4))").clearance([(4, 3), (4.5, 4.5)])
    array([1., 0.])
    """

    walkable: Points = attribute(Points(), about="corners x,y of the walkable area", unit="m")
    area: str = attribute("", about="walkable area as WKT, or the name of a WKT or GeoJSON file", unit="m")
    map: str = attribute("", about="name of the .yaml file of a ROS map; occupied cells are solid")
    unknown: str = attribute("occupied", about="treatment of unknown cells of the map", choices=("occupied", "free"))
    offset: Points = attribute(
        Points(),
        about="shift x,y of area and map, to the coordinates of the trial",
        unit="m",
        points=1,
        max=FARTHEST_FILE,
    )
    rotation: float = attribute(
        0.0,
        about="turn of area and map about the origin of the trial after the shift, counter-clockwise",
        unit="rad",
        min=-2.0 * math.pi,
        max=2.0 * math.pi,
    )
    wall_height: float = attribute(2.5, about="height of walls and obstacles", unit="m", min=0.001, max=100.0)
    building: str = attribute(
        "",
        about="name of a .glb file that is drawn instead of the walls; its walls are those of the stage",
        pattern=r"([A-Za-z0-9_. -]{1,80}\.glb)?",
    )
    friction: float = attribute(
        1.0, about="friction coefficient of the floor in the physics world", exclusive_min=0.0, max=10.0
    )
    walls: tuple[Wall, ...] = children("wall", about="thin walls")
    obstacles: tuple[Obstacle, ...] = children("obstacle", about="solid polygons")
    props: tuple[Cube | Table | Chair | Tree, ...] = children(
        {"cube": Cube, "table": Table, "chair": Chair, "tree": Tree}, about="furniture and plants"
    )
    lights: tuple[Light, ...] = children("light", about="lamps (default: daylight)", max=50)
    ground: tuple[GroundElement, ...] = children(
        {"ramp": Ramp, "stairs": Stairs, "platform": Platform, "threshold": Threshold}, about="uneven ground", max=1000
    )
    doors: tuple[Door, ...] = children("door", about="doors", max=100)
    appearance: tuple[Appearance, ...] = children("appearance", about="surfaces, sky and light in images", max=1)
    folder: Path | None = dataclasses.field(default=None, compare=False, repr=False)
    trust: bool = dataclasses.field(default=True, compare=False, repr=False)
    """Folder of the files, and whether files may lie outside; not part of the XML."""

    def __post_init__(self) -> None:
        check(self)
        if self.walkable and self.area:
            raise InputError(TWO_GROUNDS)
        if len(self.offset) > 1:
            raise InputError(f"Stage: offset={quote_value(self.offset)} must be one point x,y")
        for name in ("offset", "rotation"):
            if getattr(self, name) and not (self.area or self.map):
                raise InputError(f"Stage: {name} {NOTHING_PLACED}")
        try:
            if self.building:
                resolve_file(self.building, self.folder, self.trust)
        except InputError as error:
            raise InputError(f"building={quote_value(self.building)}: {error}") from None
        for word, name in (("area", "_ground"), ("map", "_map")):
            try:
                getattr(self, name)
            except InputError as error:
                raise InputError(f"{word}={quote_value(getattr(self, word))} {error}") from None

    @property
    def bounded(self) -> bool:
        """Whether the stage has a walkable area."""
        return bool(self.walkable or self.area)

    @property
    def rings(self) -> tuple[NDArray[np.float64], ...]:
        """Rings ``[N, 2]`` [m] as :meth:`crowdbot.core.Walls.of` takes them: solid on the left of each edge."""
        lines = [np.array(wall.points[k : k + 2]) for wall in self.walls for k in range(len(wall.points) - 1)]
        solids = [_orient(obstacle.points, counter_clockwise=True) for obstacle in self.obstacles]
        around = [_orient(self.walkable, counter_clockwise=False)] if self.walkable else []
        fixed = (*lines, *solids, *around, *_rings(self._ground, solid=False), *_rings(self._map, solid=True))
        return (*fixed, *(prop.ring for prop in self.props))

    def as_walls(self, props: bool = True) -> Walls:
        """Return the walls of a scene on this stage, with the outlines of props or without."""
        return Walls.of(self.rings if props else self.rings[: len(self.rings) - len(self.props)])

    def walking_walls(self) -> Walls:
        """Return the walls for the paths of people: with edges that are too high for them, without doors."""
        ground = ground_of(self.ground)
        return self.as_walls() if ground is None else add_rings(self.as_walls(), ground.people_barriers())

    def driving_walls(self, max_step: float, max_slope: float) -> Walls:
        """Return the walls for the paths of a robot: with steps [m] and slopes that it cannot pass, without doors."""
        ground = ground_of(self.ground)
        return self.as_walls() if ground is None else add_rings(self.as_walls(), ground.barriers(max_step, max_slope))

    def physical(self) -> PhysicsStage:
        """Return props, lights and heights for the physics world."""
        from crowdbot.world import PhysicsStage, read_building

        return PhysicsStage(
            self.wall_height, self.friction, self.props, self.lights, ground=ground_of(self.ground), doors=self.doors,
            appearance=self.appearance[0] if self.appearance else Appearance(),
            building=read_building(resolve_file(self.building, self.folder, self.trust)) if self.building else None,
        )  # fmt: skip

    @property
    def shapes(self) -> tuple[tuple[Any, ...], Any]:
        """Solid lines and polygons, and the walkable area (None without one), as shapely geometries."""
        return tuple(self._solids.geometries), self._area if self.bounded else None

    def clearance(self, points: Any) -> NDArray[np.float64]:
        """Return ``[N]`` the distance [m] of points ``[N, 2]`` to the nearest solid; 0 in it or outside the area."""
        import shapely

        places = shapely.points(np.asarray(points, dtype=np.float64))
        away = np.full(len(places), np.inf)
        if len(self._solids):
            index, distance = self._solids.query_nearest(places, return_distance=True, all_matches=False)
            away[index[0]] = distance
        if self.bounded:
            away = np.where(shapely.covers(self._area, places), away, 0.0)
        return away

    def fills(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return ``[N]`` whether boxes, from ``low`` to ``high`` ``[N, 2]``, lie in one solid or outside the area."""
        import shapely

        boxes = shapely.box(*low.T, *high.T)
        outside = shapely.disjoint(self._area, boxes) if self.bounded else np.zeros(len(boxes), dtype=np.bool_)
        outside[self._blocks.query(boxes, predicate="covered_by")[0]] = True
        return np.asarray(outside)

    def holds(self, shape: Any) -> bool:
        """Return whether a shapely geometry lies in the walkable area; always true without one."""
        return not self.bounded or bool(self._area.buffer(1e-9).covers(shape))

    def meets(self, shape: Any) -> bool:
        """Return whether a shapely geometry intersects the walkable area; always true without one."""
        return not self.bounded or bool(self._area.intersects(shape))

    def block_around(self, shape: Any) -> str:
        """Return the name of the solid that contains a shapely geometry, empty if there is none."""
        found = self._blocks.query(shape, predicate="covered_by")
        return self._block_names[int(found.min())] if len(found) else ""

    def block_in(self, shape: Any, smallest: float) -> str:
        """Return the name of a solid that overlaps a shapely geometry by more than ``smallest`` [m2], or nothing."""
        near = sorted(self._blocks.query(shape, predicate="intersects").tolist())
        blocks = self._blocks.geometries
        return next((self._block_names[k] for k in near if shape.intersection(blocks[k]).area > smallest), "")

    @functools.cached_property
    def _ground(self) -> tuple[Any, ...]:
        """The polygons of the area."""
        import shapely

        if not self.area:
            return ()
        placement = _placement(self.offset, self.rotation)
        return tuple(shapely.get_parts(area_of(self.area, self.folder, self.trust, placement)))

    @functools.cached_property
    def _map(self) -> tuple[Any, ...]:
        if not self.map:
            return ()
        return map_of(self.map, self.unknown, self.folder, self.trust, _placement(self.offset, self.rotation))

    @functools.cached_property
    def _area(self) -> Any:
        import shapely

        whole = shapely.union_all(self._ground) if self.area else area(self.walkable)
        shapely.prepare(whole)
        return whole

    @functools.cached_property
    def _blocks(self) -> Any:
        import shapely

        solids = [area(obstacle.points) for obstacle in self.obstacles]
        props = [shapely.Polygon(prop.ring) for prop in self.props]
        return shapely.STRtree([*solids, *self._map, *props])

    @functools.cached_property
    def _block_names(self) -> list[str]:
        """Names of the blocks in messages."""
        solids = [f"obstacle {k + 1} of the stage" for k in range(len(self.obstacles))]
        props = [f"prop {k + 1} of the stage" for k in range(len(self.props))]
        return [*solids, *("a solid of the map" for _ in self._map), *props]

    @functools.cached_property
    def _solids(self) -> Any:
        """Spatial index of walls, borders of the walkable area, and blocks."""
        import shapely

        lines = [np.array(wall.points) for wall in self.walls]
        lines += [np.array([*self.walkable, self.walkable[0]])] if self.walkable else []
        lines += [np.array(ring.coords) for part in self._ground for ring in (part.exterior, *part.interiors)]
        edges = [np.stack([line[:-1], line[1:]], axis=1) for line in lines]
        pieces = list(shapely.linestrings(np.concatenate(edges))) if edges else []
        return shapely.STRtree([*pieces, *self._blocks.geometries])


def _placement(offset: Points, rotation: float) -> FilePlacement:
    """Return the place of area and map in the trial."""
    return FilePlacement(offset[0] if offset else (0.0, 0.0), rotation)


def _rings(polygons: Sequence[Any], solid: bool) -> list[NDArray[np.float64]]:
    """Return the rings of solid polygons, or of a walkable area."""
    rings = []
    for polygon in polygons:
        rings.append(_orient(polygon.exterior.coords[:-1], counter_clockwise=solid))
        rings += [_orient(inner.coords[:-1], counter_clockwise=not solid) for inner in polygon.interiors]
    return rings


def area(points: Points) -> Any:
    """Return the shapely polygon with these corners."""
    import shapely

    return shapely.Polygon(points)


def _orient(points: Any, counter_clockwise: bool) -> NDArray[np.float64]:
    ring = np.array(points)
    x, y = ring[:, 0], ring[:, 1]
    doubled = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    return ring if (doubled > 0.0) == counter_clockwise else np.asarray(ring[::-1])

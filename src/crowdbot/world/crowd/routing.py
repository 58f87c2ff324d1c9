"""Router: shortest paths around walls for a whole crowd."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import CHUNK, SMALL, InputError, Scene, Walls, did_you_mean, kernel, prange
from crowdbot.typing import Floats, Rows

from .agent_arrays import BOOL, FLOAT, dense
from .wall_cells import WallCells, distance2, sees, wall_cells

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


@kernel(parallel=True)
def _connect(wall: Floats, first: Rows, member: Rows, frame: Floats, node: Floats, length: Floats) -> None:
    """Compute the distances between corners in sight of each other."""
    for i in prange(len(node)):
        for j in range(i):
            x, y, tx, ty = node[i, 0], node[i, 1], node[j, 0], node[j, 1]
            if sees(wall, first, member, frame, x, y, tx, ty, 1.0):
                length[i, j] = length[j, i] = math.sqrt((tx - x) ** 2 + (ty - y) ** 2)


@kernel
def _shorten(length: Floats, after: Rows) -> None:
    """Compute shortest path lengths from leg lengths, and the corner after i on the path to j (Floyd-Warshall)."""
    N = len(length)
    for k in range(N):
        for i in range(N):
            head = length[i, k]
            if head == math.inf or i == k:
                continue
            step = after[i, k]
            for j in range(N):
                total = head + length[k, j]
                if total < length[i, j]:
                    length[i, j] = total
                    after[i, j] = step


def corner_graph(cells: WallCells, node: Floats) -> tuple[Floats, Rows]:
    """Return the lengths of shortest paths between all corners, and the corner after i on the path to j."""
    N = len(node)
    length = np.full((N, N), np.inf)
    _connect(*cells, node, length)
    np.fill_diagonal(length, 0.0)
    after = np.where(np.isfinite(length), np.arange(N, dtype=np.int32), np.int32(-1)).astype(np.int32)
    _shorten(length, after)
    return length, after


WAY = "way"
"""Name in the memory of a scene ``[E, A, 9]``: the path of each agent."""
CUT = 0.5
"""An agent within this share of the radius of the next leg may take it before it is in sight."""
MOVED = 1.0
"""A goal that moves farther than this [m] triggers a new plan, even if it is in sight of the last corner."""
MOST_CORNERS = 3000
CHOICES = ("error", "nearest")

ASKED, AIM, FROM, CORNER, LAST, BENT = 0, 2, 4, 6, 7, 8
COLUMNS = 9
"""Columns of a path: requested goal x, y; end of the path x, y; start of the current leg x, y; next corner; last
corner; whether the path ends elsewhere than requested.
"""
STRAIGHT, UNPLANNED, LOST = -1, -2, -3
"""Special values of the next corner: the end is in sight; not planned; no path found."""


class _Map(NamedTuple):
    """Data of a router for kernels."""

    wall: Floats
    first: Rows
    member: Rows
    frame: Floats
    node: Floats
    length: Floats
    after: Rows


class Ways(NamedTuple):
    """Next points and paths of a crowd.

    Fields:
        subgoal: ``[E, A, 2]`` next point of the path, in sight [m].
        length: ``[E, A]`` length of the path to the goal [m].
        way: ``[E, A, 9]`` paths, an argument of the next step.
    """

    subgoal: Floats
    length: Floats
    way: Floats


@kernel
def _far(ax: float, ay: float, bx: float, by: float) -> float:
    return math.sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay))


@kernel
def _plan(
    map_: _Map, x: float, y: float, gx: float, gy: float, seen: NDArray[np.int64], reach: Floats
) -> tuple[int, int]:
    """Return the first and last corner of the shortest path from x, y to g; STRAIGHT twice, or LOST twice."""
    wall, first, member, frame, node, length, _after = map_
    if sees(wall, first, member, frame, x, y, gx, gy, 1.0):
        return STRAIGHT, STRAIGHT
    count = 0
    for v in range(len(node)):
        if sees(wall, first, member, frame, node[v, 0], node[v, 1], gx, gy, 1.0):
            seen[count], reach[count] = v, _far(node[v, 0], node[v, 1], gx, gy)
            count += 1
    best, begin, last = math.inf, LOST, LOST
    for u in range(len(node)):
        head = _far(x, y, node[u, 0], node[u, 1])
        if head + _far(node[u, 0], node[u, 1], gx, gy) >= best:
            continue
        if not sees(wall, first, member, frame, x, y, node[u, 0], node[u, 1], 1.0):
            continue
        for n in range(count):
            total = head + length[u, seen[n]] + reach[n]
            if total < best:
                best, begin, last = total, u, seen[n]
    return begin, last


@kernel
def _keep(map_: _Map, x: float, y: float, way: Floats) -> int:
    """Advance along a path as far as it is in sight and return the next corner; UNPLANNED if the path is lost.

    Between corners, walls are at least one radius from a leg of the path. An agent closer to the leg than this can walk
    straight to its end, although its own line may pass a wall at less than the radius.
    """
    wall, first, member, frame, node, _length, after = map_
    gx, gy = way[AIM], way[AIM + 1]
    u, w = int(way[CORNER]), int(way[LAST])
    if u >= 0 and sees(wall, first, member, frame, x, y, gx, gy, 1.0):
        way[FROM], way[FROM + 1] = x, y
        return STRAIGHT
    while u >= 0:
        ux, uy = node[u, 0], node[u, 1]
        tx, ty, following = gx, gy, STRAIGHT
        if u != w:
            following = int(after[u, w])
            tx, ty = node[following, 0], node[following, 1]
        on_leg = distance2(x, y, ux, uy, tx, ty) < (CUT * frame[5]) ** 2
        if not sees(wall, first, member, frame, x, y, tx, ty, 0.0 if on_leg else 1.0):
            break
        way[FROM], way[FROM + 1] = ux, uy
        u = following
    tx, ty = (node[u, 0], node[u, 1]) if u >= 0 else (gx, gy)
    on_leg = distance2(x, y, way[FROM], way[FROM + 1], tx, ty) < frame[5] ** 2
    return u if sees(wall, first, member, frame, x, y, tx, ty, 0.0 if on_leg else 1.0) else UNPLANNED


@kernel(parallel=True)
def _follow(map_: _Map, place: Floats, goal: Floats, asking: NDArray[np.bool_], way: Floats) -> None:
    """Follow or plan the paths of all rows."""
    for part in prange((len(way) + CHUNK - 1) // CHUNK):
        _follow_part(part * CHUNK, min((part + 1) * CHUNK, len(way)), map_, place, goal, asking, way)


@kernel
def _follow_part(
    begin: int, end: int, map_: _Map, place: Floats, goal: Floats, asking: NDArray[np.bool_], way: Floats
) -> None:
    wall, first, member, frame, node = map_[:5]
    seen, reach = np.empty(len(node), dtype=np.int64), np.empty(len(node))
    for row in range(begin, end):
        if not asking[row]:
            continue
        mine = way[row]
        x, y, gx, gy = place[row, 0], place[row, 1], goal[row, 0], goal[row, 1]
        same = gx == mine[ASKED] and gy == mine[ASKED + 1]
        u = int(mine[CORNER])
        if not same and mine[BENT] == 0.0 and u > UNPLANNED and _far(gx, gy, mine[ASKED], mine[ASKED + 1]) <= MOVED:
            mine[AIM], mine[AIM + 1] = gx, gy
            w = int(mine[LAST])
            same = u < 0 or sees(wall, first, member, frame, node[w, 0], node[w, 1], gx, gy, 1.0)
        if not same:
            mine[ASKED], mine[ASKED + 1], mine[AIM], mine[AIM + 1], mine[BENT] = gx, gy, gx, gy, 0.0
            u = UNPLANNED
        if u > UNPLANNED:
            u = _keep(map_, x, y, mine)
        if u <= UNPLANNED:
            u, last = _plan(map_, x, y, mine[AIM], mine[AIM + 1], seen, reach)
            mine[LAST], mine[FROM], mine[FROM + 1] = last, x, y
        mine[CORNER] = u


@kernel
def _measure(map_: _Map, place: Floats, asking: NDArray[np.bool_], way: Floats, next_: Floats, length: Floats) -> bool:
    """Write the next point and the length of each path; return whether planning failed for somebody."""
    node, between = map_[4], map_[5]
    failed = False
    for row in range(len(way)):
        next_[row, 0], next_[row, 1], length[row] = place[row, 0], place[row, 1], 0.0
        if not asking[row]:
            continue
        gx, gy, u, rest = way[row, AIM], way[row, AIM + 1], int(way[row, CORNER]), 0.0
        failed = failed or u == LOST
        next_[row, 0], next_[row, 1] = gx, gy
        if u >= 0:
            w = int(way[row, LAST])
            next_[row, 0], next_[row, 1] = node[u, 0], node[u, 1]
            rest = between[u, w] + math.hypot(node[w, 0] - gx, node[w, 1] - gy)
        length[row] = math.hypot(next_[row, 0] - place[row, 0], next_[row, 1] - place[row, 1]) + rest
    return failed


@kernel
def _look_ahead(
    position: Floats, goal: Floats, subgoal: Floats, length: Floats, way: Floats, asking: NDArray[np.bool_], aim: Floats
) -> None:
    """Write goals on the next straight section of each path, at the distance of the path length."""
    for e in range(len(asking)):
        for a in range(asking.shape[1]):
            aim[e, a, 0], aim[e, a, 1] = goal[e, a, 0], goal[e, a, 1]
            if not asking[e, a]:
                continue
            x, y = position[e, a, 0], position[e, a, 1]
            aim[e, a, 0], aim[e, a, 1] = subgoal[e, a, 0], subgoal[e, a, 1]
            dx, dy = subgoal[e, a, 0] - x, subgoal[e, a, 1] - y
            distance = math.sqrt(dx * dx + dy * dy)
            if way[e, a, CORNER] != STRAIGHT and distance > 0.0:
                share = length[e, a] / max(distance, 1e-12)
                aim[e, a, 0], aim[e, a, 1] = x + dx * share, y + dy * share


@dataclass(frozen=True, eq=False)
class Router:
    """Shortest paths around walls for bodies of one size, computed once for a stage; see :meth:`of`.

    Paths bend at corners (visibility graph). Each person walks to the farthest visible corner of their path, and
    replans if pushed so far from the path that the next corner is out of sight. A person closer to a wall than the
    radius still finds a path. Corners may be cut to half the radius; people therefore do not queue at a single point.

    Fields:
        radius: distance of paths to walls [m]; typically the largest radius of a body.
        unreachable: handling of a goal inside or behind walls: ``error``, or ``nearest`` to walk to the nearest
            reachable point.
        walls: the walls.

    >>> router = Router.of([[(2.0, -3.0), (2.0, 1.0)]], radius=0.25)
    >>> router.towards([[0.0, 0.0], [0.0, 2.0]], [[4.0, 0.0], [4.0, 2.0]]).round(2).tolist()
    [[1.9, 1.25], [4.0, 2.0]]
    """

    radius: float
    unreachable: str
    walls: Walls = field(repr=False)
    _map: _Map = field(repr=False)
    _parts: list[Any] = field(repr=False)

    @classmethod
    def of(cls, walls: Any, radius: float = 0.3, unreachable: str = "error") -> Router:
        """Create a router from walls (anything that :meth:`crowdbot.core.Walls.of` takes).

        Raises:
            InputError: a value is not allowed, there is no free space, or there are too many corners.
        """
        walls = Walls.of(walls)
        if not 0.0 < radius < math.inf:
            raise InputError(f"Router: radius {radius} m must be finite and above 0")
        if unreachable not in CHOICES:
            near = did_you_mean(str(unreachable), CHOICES)
            raise InputError(f"Router: unreachable = {unreachable!r} is unknown{near}; use {' or '.join(CHOICES)}")
        node, parts = corners(walls, radius), room_for(walls, radius)
        if len(node) > MOST_CORNERS:
            raise InputError(
                f"Router: the walls have {len(node)} corners, at most {MOST_CORNERS} are allowed;"
                " simplify the walls (shapely.simplify)"
            )
        if not parts:
            raise InputError(f"Router: no space between the walls is wide enough for a body of radius {radius} m")
        cells = wall_cells(walls.segments(), radius)
        length, after = corner_graph(cells, node)
        return cls(radius, unreachable, walls, _Map(*cells, node, length, after), parts)

    def towards(self, position: ArrayLike, goal: ArrayLike) -> Floats:
        """Return the next point of the shortest path from each position ``[..., 2]`` [m] to its goal ``[..., 2]``.

        Raises:
            InputError: a goal cannot be reached, or a number is not finite.
        """
        place = np.asarray(position, dtype=np.float64)
        batch = place.reshape(1, -1, 2)
        aims = np.broadcast_to(np.asarray(goal, dtype=np.float64), place.shape).reshape(1, -1, 2)
        if not (np.all(np.isfinite(batch)) and np.all(np.isfinite(aims))):
            raise InputError("Router: a position or goal is not finite")
        return self.follow(batch, aims).subgoal.reshape(place.shape)

    def follow(
        self, position: Floats, goal: Floats, way: Floats | None = None, asking: NDArray[np.bool_] | None = None
    ) -> Ways:
        """Return the next point of each path. Following an existing path is fast.

        Args:
            position, goal: ``[E, A, 2]`` [m].
            way: ``[E, A, 9]`` paths of the previous step; None plans new ones.
            asking: ``[E, A]`` agents that need a path; None: all.

        Raises:
            InputError: a goal cannot be reached.
        """
        E, A = position.shape[:2]
        asks = np.ones((E, A), np.bool_) if asking is None else dense(asking, (E, A), BOOL)
        new = fresh((E, A)) if way is None else np.array(way, dtype=np.float64, order="C")
        rows, asked = new.reshape(-1, COLUMNS), asks.reshape(-1)
        place = dense(position, (E, A, 2), FLOAT).reshape(-1, 2)
        aims = dense(goal, (E, A, 2), FLOAT).reshape(-1, 2)
        map_: Any = tuple(self._map)
        if len(rows) <= SMALL:
            _follow_part(0, len(rows), map_, place, aims, asked, rows)
        else:
            _follow(map_, place, aims, asked, rows)
        next_, length = np.empty((len(rows), 2)), np.empty(len(rows))
        if _measure(map_, place, asked, rows, next_, length):
            for k in np.flatnonzero(asked & (rows[:, CORNER] == LOST)):
                point = self._rescue(rows[k], place[k], divmod(int(k), A))
                next_[k] = point
                length[k] = np.hypot(*(point - place[k])) + self._remaining_length(rows[k : k + 1])[0]
        return Ways(next_.reshape(E, A, 2), length.reshape(E, A), new)

    def guide(self, scene: Scene, asking: NDArray[np.bool_] | None = None) -> Scene:
        """Return the scene with each goal on the next straight section of the path, at the distance of the path length.

        Args:
            scene: its memory contains the paths of the previous step.
            asking: ``[E, A]``, agents to guide (default: all who walk).

        Raises:
            InputError: a goal cannot be reached.
        """
        if asking is None:
            asking = scene.active & ~scene.external
        subgoal, length, way = self.follow(scene.position, scene.goal, scene.memory.get(WAY), asking)
        shape = scene.shape
        pairs = (*shape, 2)
        position, goal, aim = dense(scene.position, pairs, FLOAT), dense(scene.goal, pairs, FLOAT), np.empty(pairs)
        _look_ahead(position, goal, subgoal, length, way, dense(asking, shape, BOOL), aim)
        return scene.replace(goal=aim, memory={**scene.memory, WAY: way})

    def holds(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Return ``[N]`` whether points ``[N, 2]`` [m] have room for a body."""
        import shapely

        places = shapely.points(np.asarray(points, dtype=np.float64))
        return np.asarray(np.any([shapely.intersects(part, places) for part in self._parts], axis=0))

    def _next(self, rows: Floats) -> Floats:
        corner = rows[:, CORNER].astype(np.int64)
        turning = corner >= 0
        out = rows[:, AIM : AIM + 2].copy()
        out[turning] = self._map.node[corner[turning]]
        return out

    def _remaining_length(self, rows: Floats) -> Floats:
        """Return the path lengths from the next corner to the end."""
        out = np.zeros(len(rows))
        turning = np.flatnonzero(rows[:, CORNER] >= 0)
        corner, last = rows[turning, CORNER].astype(np.int64), rows[turning, LAST].astype(np.int64)
        tail = np.hypot(*(self._map.node[last] - rows[turning, AIM : AIM + 2]).T)
        out[turning] = self._map.length[corner, last] + tail
        return out

    def _rescue(self, way: Floats, place: Floats, who: tuple[int, int]) -> Floats:
        """Fill the path of an agent for which planning failed, and return its next point.

        Either the goal is unreachable, or the agent is in a space so narrow that no corner is in sight; then it leaves
        that space.
        """
        import shapely

        goal = way[ASKED : ASKED + 2].copy()
        part = int(np.argmin(shapely.distance(self._parts, shapely.Point(place))))
        if not self._reaches(part, goal):
            if self.unreachable == "error":
                raise InputError(
                    f"Router: the goal ({goal[0]:g}, {goal[1]:g}) of agent {who[1]} in environment {who[0]} "
                    f"cannot be"
                    f" reached from ({place[0]:g}, {place[1]:g}) by a body of radius {self.radius} m: it lies in or"
                    " behind walls; move it, or set unreachable='nearest'"
                )
            way[AIM : AIM + 2], way[BENT] = self._nearest(part, goal), 1.0
        seen, reach = np.empty(len(self._map.node), dtype=np.int64), np.empty(len(self._map.node))
        way[CORNER], way[LAST] = _plan(self._map, place[0], place[1], way[AIM], way[AIM + 1], seen, reach)
        if way[CORNER] != LOST:
            return np.asarray(self._next(way[None])[0])
        way[CORNER] = UNPLANNED
        return self._nearest(part, place)

    def _reaches(self, part: int, goal: Floats) -> bool:
        """Return whether a goal is in this part of free space, or between it and a wall."""
        import shapely

        away = shapely.distance(self._parts, shapely.Point(goal))
        end = self._nearest(part, goal)
        cells = self._map[:4]
        return bool(away[part] <= away.min() and sees(*cells, end[0], end[1], goal[0], goal[1], 1.0))

    def _nearest(self, part: int, place: Floats) -> Floats:
        import shapely

        line = shapely.shortest_line(self._parts[part], shapely.Point(place))
        return np.asarray(shapely.get_coordinates(line)[0])


def fresh(shape: tuple[int, int]) -> Floats:
    """Return unplanned paths ``[E, A, 9]``."""
    way = np.full((*shape, COLUMNS), np.nan)
    way[..., CORNER] = UNPLANNED
    way[..., BENT] = 0.0
    return way

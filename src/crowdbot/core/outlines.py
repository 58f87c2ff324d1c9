"""Outlines: convex polygons in the plane, and their signed distance to points, segments, discs and each other.

An outline is an array ``[K, 2]`` of corners [m], counter-clockwise, in the frame of its body. Kernels read the rows
``first`` to ``last - 1`` of a table of corners, without a slice: each access to a view counts references. They take
points and segments in the frame of the outline, so that two points are turned instead of K corners.

The distance of two bodies that overlap is minus the length of the shortest translation that separates them. It is exact
for convex shapes: a face of one of the two is the separating direction (Gilbert and Foo 1990,
doi:10.1109/70.88117).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.typing import Floats, Ints

from .errors import InputError
from .geometry import nearest_on_segment, time_to_contact, time_to_segment
from .kernels import kernel

ROUND = 0.98
"""Smallest ratio of inscribed to circumscribed radius at which a polygon stands for a disc."""
FLAT = 1e-3
"""Corners that stand out less than this [m] from the line of their neighbors are left out of an outline."""
SPACING = 0.02
"""Largest distance [m] that a point of one body moves relative to the other between two poses of a sweep."""
MOST_POSES = 64
"""Largest number of intervals of a sweep."""


def convex_hull(points: ArrayLike) -> Floats:
    """Return the convex hull ``[M, 2]`` of points ``[N, 2]``, counter-clockwise from the lowest leftmost point.

    >>> convex_hull([[0, 0], [2, 0], [1, 0.5], [2, 1], [0, 1]]).tolist()
    [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]
    """
    rows = sorted({(round(float(x), 9), round(float(y), 9)) for x, y in np.asarray(points, dtype=np.float64)})
    if len(rows) < 3:
        return np.array(rows).reshape(-1, 2)
    halves = []
    for order in (rows, rows[::-1]):
        chain: list[tuple[float, float]] = []
        for p in order:
            while len(chain) > 1 and _left(chain[-2], chain[-1], p) <= 1e-12:
                chain.pop()
            chain.append(p)
        halves.append(chain[:-1])
    return np.array(halves[0] + halves[1])


def _left(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def inscribed_radius(outline: Floats) -> float:
    """Return the distance [m] from the origin to the nearest line through a side; negative if the origin is outside.

    >>> inscribed_radius(np.array([[-0.4, -0.3], [0.5, -0.3], [0.5, 0.3], [-0.4, 0.3]]))
    0.3
    """
    side = np.roll(outline, -1, axis=0) - outline
    return float(((outline[:, 0] * side[:, 1] - outline[:, 1] * side[:, 0]) / np.hypot(side[:, 0], side[:, 1])).min())


def outline_of(footprint: ArrayLike) -> Floats | None:
    """Return the outline of a footprint ``[N, 2]`` [m], its convex hull; None if it is a disc around the origin.

    A polygon is a disc if its inscribed radius is at least 0.98 of its circumscribed radius. Corners that stand out
    less than 1 mm are left out.

    Raises:
        InputError: the footprint has no area.

    >>> outline_of([[0.4, 0.3], [-0.4, 0.3], [0.0, 0.1], [-0.4, -0.3], [0.4, -0.3]]).tolist()
    [[-0.4, -0.3], [0.4, -0.3], [0.4, 0.3], [-0.4, 0.3]]
    >>> turn = np.linspace(0.0, 2.0 * np.pi, 32, endpoint=False)
    >>> outline_of(0.3 * np.stack([np.cos(turn), np.sin(turn)], axis=1)) is None
    True
    """
    hull = convex_hull(footprint)
    if len(hull) < 3:
        raise InputError(f"outline: the footprint of {len(np.asarray(footprint))} points has no area")
    if inscribed_radius(hull) >= ROUND * float(np.hypot(hull[:, 0], hull[:, 1]).max()):
        return None
    rows, k = hull.tolist(), 0
    while k < len(rows) and len(rows) > 4:
        a, b = rows[k - 1], rows[(k + 1) % len(rows)]
        height = -_left(a, b, rows[k]) / math.hypot(b[0] - a[0], b[1] - a[1])
        if height < FLAT:
            del rows[k]
            k += 1  # its neighbor stays, or a circle would lose all its corners
        else:
            k += 1
    return np.array(rows)


class Outlines(NamedTuple):
    """The outlines of the agents of a scene, for kernels; an agent without one is a disc.

    Fields:
        corner: ``[C, 2]`` corners of all outlines [m].
        first: ``[A + 1]`` index of the first corner of each agent; equal to the next for a disc.
    """

    corner: Floats
    first: Ints

    @classmethod
    def of(cls, outlines: Mapping[int, Floats], agents: int) -> Outlines:
        """Return the table of outlines ``[K, 2]`` by agent.

        >>> Outlines.of({1: np.array([[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]])}, agents=3).first.tolist()
        [0, 0, 3, 3]
        """
        count = [len(outlines.get(agent, ())) for agent in range(agents)]
        rows = [outlines[agent] for agent in range(agents) if agent in outlines]
        corner = np.concatenate(rows) if rows else np.zeros((0, 2))
        return cls(np.ascontiguousarray(corner, dtype=np.float64), np.concatenate([[0], np.cumsum(count)]).astype("i8"))


@kernel
def to_frame(x: float, y: float, px: float, py: float, cos: float, sin: float) -> tuple[float, float]:
    """Return a point x, y in the frame at p with the given cosine and sine of its heading."""
    dx, dy = x - px, y - py
    return cos * dx + sin * dy, cos * dy - sin * dx


@kernel
def point_to_outline(x: float, y: float, corner: Floats, first: int, last: int) -> tuple[float, float, float]:
    """Return the distance of a point to an outline, negative inside, and the nearest point of its border."""
    inside, least, px, py = True, math.inf, 0.0, 0.0
    k = last - 1
    for n in range(first, last):
        ax, ay, bx, by = corner[k, 0], corner[k, 1], corner[n, 0], corner[n, 1]
        if (bx - ax) * (y - ay) - (by - ay) * (x - ax) < 0.0:
            inside = False
        qx, qy = nearest_on_segment(x, y, ax, ay, bx, by)
        d2 = (x - qx) * (x - qx) + (y - qy) * (y - qy)
        if d2 < least:
            least, px, py = d2, qx, qy
        k = n
    distance = math.sqrt(least)
    return (-distance if inside else distance), px, py


@kernel
def segment_to_outline(
    ax: float, ay: float, bx: float, by: float, corner: Floats, first: int, last: int
) -> tuple[float, float, float, float, float]:
    """Return the distance of segment a-b to an outline, negative for overlap, and the nearest points of both.

    The point of the outline comes first. For overlap, the two points are those that separate last.
    """
    apart, px, py, qx, qy = -math.inf, 0.0, 0.0, 0.0, 0.0
    k = last - 1
    for n in range(first, last):
        ux, uy = corner[n, 1] - corner[k, 1], corner[k, 0] - corner[n, 0]
        length = math.sqrt(ux * ux + uy * uy)
        ux, uy = ux / length, uy / length
        above_a = (ax - corner[k, 0]) * ux + (ay - corner[k, 1]) * uy
        above_b = (bx - corner[k, 0]) * ux + (by - corner[k, 1]) * uy
        height = min(above_a, above_b)
        if height > apart:
            apart = height
            qx, qy = (ax, ay) if above_a <= above_b else (bx, by)
            px, py = qx - height * ux, qy - height * uy
        k = n
    ex, ey = bx - ax, by - ay
    length = math.sqrt(ex * ex + ey * ey)
    if length > 0.0:
        ux, uy = -ey / length, ex / length
        for side in (1.0, -1.0):
            height, deepest = math.inf, first
            for n in range(first, last):
                above = side * ((corner[n, 0] - ax) * ux + (corner[n, 1] - ay) * uy)
                if above < height:
                    height, deepest = above, n
            if height > apart:
                apart, px, py = height, corner[deepest, 0], corner[deepest, 1]
                qx, qy = px - side * height * ux, py - side * height * uy
    if apart <= 0.0:
        return apart, px, py, qx, qy
    least, px, py = point_to_outline(ax, ay, corner, first, last)
    qx, qy = ax, ay
    other, ox, oy = point_to_outline(bx, by, corner, first, last)
    if other < least:
        least, px, py, qx, qy = other, ox, oy, bx, by
    for n in range(first, last):
        x, y = corner[n, 0], corner[n, 1]
        nx, ny = nearest_on_segment(x, y, ax, ay, bx, by)
        away = math.sqrt((x - nx) * (x - nx) + (y - ny) * (y - ny))
        if away < least:
            least, px, py, qx, qy = away, x, y, nx, ny
    return least, px, py, qx, qy


@kernel
def _faces_gap(
    x: float, y: float, cos: float, sin: float, corner: Floats, first: int, last: int, begin: int, end: int
) -> float:
    """Return the largest distance of an outline from the line through a side of another, negative for overlap.

    The sides are those of ``first`` to ``last``; the other outline stands at x, y in their frame.
    """
    apart = -math.inf
    k = last - 1
    for n in range(first, last):
        ux, uy = corner[n, 1] - corner[k, 1], corner[k, 0] - corner[n, 0]
        length = math.sqrt(ux * ux + uy * uy)
        ux, uy = ux / length, uy / length
        height = math.inf
        for m in range(begin, end):
            cx, cy = x + cos * corner[m, 0] - sin * corner[m, 1], y + sin * corner[m, 0] + cos * corner[m, 1]
            height = min(height, (cx - corner[k, 0]) * ux + (cy - corner[k, 1]) * uy)
        apart = max(apart, height)
        k = n
    return apart


@kernel
def outline_to_outline(
    x: float, y: float, turn: float, corner: Floats, first: int, last: int, begin: int, end: int
) -> float:
    """Return the distance of two outlines, negative for overlap.

    Args:
        x, y, turn: pose of the second in the frame of the first [m], [rad].
        corner: corners of both: ``first`` to ``last - 1`` and ``begin`` to ``end - 1``.
    """
    cos, sin = math.cos(turn), math.sin(turn)
    bx, by = -cos * x - sin * y, sin * x - cos * y
    apart = max(
        _faces_gap(x, y, cos, sin, corner, first, last, begin, end),
        _faces_gap(bx, by, cos, -sin, corner, begin, end, first, last),
    )
    if apart <= 0.0:
        return apart
    least = math.inf
    k = end - 1
    for n in range(begin, end):
        ax, ay = x + cos * corner[k, 0] - sin * corner[k, 1], y + sin * corner[k, 0] + cos * corner[k, 1]
        cx, cy = x + cos * corner[n, 0] - sin * corner[n, 1], y + sin * corner[n, 0] + cos * corner[n, 1]
        least = min(least, segment_to_outline(ax, ay, cx, cy, corner, first, last)[0])
        k = n
    return least


@kernel
def body_gap(
    ax: float, ay: float, turn: float, radius: float, first: int, last: int,
    bx: float, by: float, turned: float, size: float, begin: int, end: int, corner: Floats,
) -> float:  # fmt: skip
    """Return the clearance of two bodies [m], each a disc (without corners) or an outline at a pose."""
    if first == last and begin == end:
        return math.sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay)) - radius - size
    if first == last:
        x, y = to_frame(ax, ay, bx, by, math.cos(turned), math.sin(turned))
        gap: float = point_to_outline(x, y, corner, begin, end)[0] - radius
        return gap
    x, y = to_frame(bx, by, ax, ay, math.cos(turn), math.sin(turn))
    if begin == end:
        gap = point_to_outline(x, y, corner, first, last)[0] - size
        return gap
    gap = outline_to_outline(x, y, turned - turn, corner, first, last, begin, end)
    return gap


@kernel
def wall_gap(
    x: float, y: float, heading: float, corner: Floats, first: int, last: int,
    ax: float, ay: float, bx: float, by: float,
) -> float:  # fmt: skip
    """Return the clearance [m] of an outline at a pose to the wall a-b, negative for overlap."""
    cos, sin = math.cos(heading), math.sin(heading)
    ax, ay = to_frame(ax, ay, x, y, cos, sin)
    bx, by = to_frame(bx, by, x, y, cos, sin)
    gap: float = segment_to_outline(ax, ay, bx, by, corner, first, last)[0]
    return gap


@kernel
def time_to_outline(
    x: float, y: float, vx: float, vy: float, size: float, turn: float, radius: float, corner: Floats, first: int,
    last: int,
) -> float:  # fmt: skip
    """Return the time [s] until a disc touches a body that keeps its heading; 0 in contact, inf without one.

    Args:
        x, y, vx, vy: position and velocity of the disc relative to the body [m], [m/s].
        size: radius of the disc [m].
        turn: heading of the body [rad].
        radius: radius of the body [m], which is a disc if it has no corners.
        corner: corners of the outline from ``first`` to ``last - 1``.
    """
    best: float = time_to_contact(x, y, vx, vy, radius + size)
    if first == last or best == math.inf:
        return best
    cos, sin = math.cos(turn), math.sin(turn)
    x, y = to_frame(x, y, 0.0, 0.0, cos, sin)
    vx, vy = to_frame(vx, vy, 0.0, 0.0, cos, sin)
    if point_to_outline(x, y, corner, first, last)[0] <= size:
        return 0.0
    best = math.inf
    k = last - 1
    for n in range(first, last):
        t = time_to_segment(x, y, vx, vy, size, corner[k, 0], corner[k, 1], corner[n, 0], corner[n, 1])
        best = min(best, t)
        k = n
    return best


@kernel
def _wrapped(angle: float) -> float:
    return angle - 2.0 * math.pi * math.floor((angle + math.pi) / (2.0 * math.pi))


@kernel
def _intervals(travel: float) -> int:
    return min(max(1, math.ceil(travel / SPACING)), MOST_POSES)


@kernel
def swept_gap(
    ax: float, ay: float, turn: float, cx: float, cy: float, turn_to: float, radius: float, first: int, last: int,
    bx: float, by: float, turned: float, dx: float, dy: float, turned_to: float, size: float, begin: int, end: int,
    corner: Floats, limit: float,
) -> float:  # fmt: skip
    """Return the smallest clearance [m] of two bodies that move from a to c and from b to d.

    Positions and headings change uniformly. The clearance is that of poses between which no point of a body moves more
    than 2 cm relative to the other. Bodies whose circumscribed discs stay ``limit`` apart get that clearance, a lower
    bound.
    """
    rx, ry = bx - ax, by - ay
    sx, sy = dx - cx - rx, dy - cy - ry
    nx, ny = nearest_on_segment(0.0, 0.0, rx, ry, rx + sx, ry + sy)
    bound = math.sqrt(nx * nx + ny * ny) - radius - size
    if bound >= limit:
        return bound
    spin = _wrapped(turn_to - turn) if last > first else 0.0
    other = _wrapped(turned_to - turned) if end > begin else 0.0
    count = _intervals(math.sqrt(sx * sx + sy * sy) + radius * abs(spin) + size * abs(other))
    least = math.inf
    for k in range(count + 1):
        t = k / count
        gap = body_gap(
            ax + t * (cx - ax), ay + t * (cy - ay), turn + t * spin, radius, first, last,
            bx + t * (dx - bx), by + t * (dy - by), turned + t * other, size, begin, end, corner,
        )  # fmt: skip
        least = min(least, gap)
    return least


@kernel
def swept_wall_gap(
    ax: float, ay: float, turn: float, cx: float, cy: float, turn_to: float, radius: float, corner: Floats,
    first: int, last: int, wall: Floats,
) -> float:  # fmt: skip
    """Return the smallest clearance [m] of an outline that moves from a to c to walls ``[M, 4]``; inf without walls.

    The poses are those of :func:`swept_gap`; ``radius`` is that of the circumscribed disc.
    """
    spin = _wrapped(turn_to - turn)
    dx, dy = cx - ax, cy - ay
    travel = math.sqrt(dx * dx + dy * dy)
    count = _intervals(travel + radius * abs(spin))
    least = math.inf
    for k in range(count + 1):
        t = k / count
        x, y, heading = ax + t * dx, ay + t * dy, turn + t * spin
        for m in range(len(wall)):
            nx, ny = nearest_on_segment(x, y, wall[m, 0], wall[m, 1], wall[m, 2], wall[m, 3])
            if math.sqrt((nx - x) * (nx - x) + (ny - y) * (ny - y)) - radius < least:
                gap = wall_gap(x, y, heading, corner, first, last, wall[m, 0], wall[m, 1], wall[m, 2], wall[m, 3])
                least = min(least, gap)
    return least

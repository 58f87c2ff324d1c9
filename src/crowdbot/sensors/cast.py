"""Rays: where beams from a pose meet limbs, discs, walls, props, skins and the floor.

Everything is brought into the sensor's frame. There each shape covers a window of azimuth and elevation, and only the
beams of the cells in it are tried, as a picture is drawn with a depth buffer. So the time goes with what is seen and
hardly with the number of shapes times beams. Environments are independent of each other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene, SpatialPose
from crowdbot.core.kernels import kernel
from crowdbot.core.rays import BOX, CAPSULE, CYLINDER, TRIANGLE, WALL, WIDTH, meet, normal_at, within

from .beams import Beams
from .shapes import Shapes, gathered

__all__ = ["Hits", "cast"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
TURN = 2.0 * math.pi
MARGIN = 1e-9
"""Windows are this much larger [rad] at every side, against rounding."""
MANY = 4
"""From this many environments on, threads share them."""


@kernel
def _wrapped(angle: float) -> float:
    return angle - TURN * math.floor((angle + math.pi) / TURN)


@kernel
def _gap(ax: float, ay: float, bx: float, by: float) -> float:
    """Return the distance of the origin to segment a-b in the plane."""
    ex, ey = bx - ax, by - ay
    length2 = ex * ex + ey * ey
    s = 0.0
    if length2 > 0.0:
        s = min(1.0, max(0.0, -(ax * ex + ay * ey) / length2))
    return math.hypot(ax + s * ex, ay + s * ey)


@kernel
def _bounds(corner: Floats, count: int, radius: float) -> tuple[float, float, float, float, float]:
    """Return lowest, highest, nearest and farthest point (z, z, in the plane) and their mean azimuth, of a hull."""
    low, high, far, cx, cy = math.inf, -math.inf, 0.0, 0.0, 0.0
    for i in range(count):
        low, high = min(low, corner[i, 2] - radius), max(high, corner[i, 2] + radius)
        far = max(far, math.hypot(corner[i, 0], corner[i, 1]) + radius)
        cx += corner[i, 0]
        cy += corner[i, 1]
    near = math.inf
    for i in range(count):
        for j in range(i):
            near = min(near, _gap(corner[i, 0], corner[i, 1], corner[j, 0], corner[j, 1]) - radius)
    return low, high, max(near, 0.0), far, math.atan2(cy, cx)


@kernel
def _width(corner: Floats, count: int, radius: float, middle: float) -> tuple[float, float]:
    """Return azimuth at which a hull begins and how wide it is, a full turn when it holds the origin from above."""
    least, most = math.inf, -math.inf
    for i in range(count):
        away = math.hypot(corner[i, 0], corner[i, 1])
        if away <= radius or away == 0.0:
            return -math.pi, TURN
        half = math.asin(radius / away)
        off = _wrapped(math.atan2(corner[i, 1], corner[i, 0]) - middle)
        least, most = min(least, off - half), max(most, off + half)
    if most - least >= math.pi - 1e-6:
        return -math.pi, TURN
    return middle + least, most - least


@kernel
def _try(kind: int, s: Floats, number: int, begin: int, end: int, beams: Beams, distance: Floats, which: Ints) -> None:
    for k in range(begin, end):
        reach = meet(kind, beams.x[k], beams.y[k], beams.z[k], s)
        if reach < distance[k]:
            distance[k] = reach
            which[k] = number


@kernel
def _draw(
    kind: int, s: Floats, number: int, corner: Floats, count: int, radius: float, limit: float, beams: Beams,
    distance: Floats, which: Ints,
) -> bool:  # fmt: skip
    """Try a shape on the beams in its window; return whether it can be seen at all."""
    low, high, near, far, middle = _bounds(corner, count, radius)
    if not near <= limit or not far < math.inf:
        return False
    if low > far * beams.steep[1] or high < far * beams.steep[0] or low > limit or high < -limit:
        return False
    if within(kind, s):
        for k in range(len(distance)):
            distance[k] = 0.0
            which[k] = number
        return True
    bottom = math.atan2(low, far if low > 0.0 else near) - MARGIN
    top = math.atan2(high, near if high > 0.0 else far) + MARGIN
    first = max(0, math.floor((bottom - beams.low) / beams.tall))
    last = min(beams.rows - 1, math.floor((top - beams.low) / beams.tall))
    if first > last:
        return False
    left, width = _width(corner, count, radius, middle)
    columns = beams.columns
    if width >= TURN:
        for row in range(first, last + 1):
            begin, end = beams.begin[row * columns], beams.begin[(row + 1) * columns]
            _try(kind, s, number, begin, end, beams, distance, which)
        return True
    start = (left - MARGIN - beams.left) % TURN
    for part in range(2):
        low_column = math.floor((start - part * TURN) / beams.wide)
        high_column = math.floor((start - part * TURN + width + 2.0 * MARGIN) / beams.wide)
        a, b = max(0, low_column), min(columns - 1, high_column)
        if a > b:
            continue
        for row in range(first, last + 1):
            begin, end = beams.begin[row * columns + a], beams.begin[row * columns + b + 1]
            _try(kind, s, number, begin, end, beams, distance, which)
    return True


@kernel
def _turned(turn: Floats, x: float, y: float, z: float, out: Floats, at: int) -> None:
    """Write the vector x, y, z of the world in the sensor's frame."""
    out[at] = turn[0, 0] * x + turn[1, 0] * y + turn[2, 0] * z
    out[at + 1] = turn[0, 1] * x + turn[1, 1] * y + turn[2, 1] * z
    out[at + 2] = turn[0, 2] * x + turn[1, 2] * y + turn[2, 2] * z


@kernel
def _moved(e: int, kind: int, n: int, shapes: Shapes, place: Floats, turn: Floats, s: Floats, corner: Floats) -> int:
    """Write shape ``n`` of a kind in the sensor's frame: its row and the corners of its hull; return how many."""
    if kind == TRIANGLE:
        for k in range(3):
            p = shapes.vertices[e, shapes.faces[n, k]]
            _turned(turn, p[0] - place[0], p[1] - place[1], p[2] - place[2], s, 3 * k)
            corner[k] = s[3 * k : 3 * k + 3]
        return 3
    row = shapes.rows[e, n]
    _turned(turn, row[0] - place[0], row[1] - place[1], row[2] - place[2], s, 0)
    if kind == BOX:
        for k in range(3):
            _turned(turn, row[3 + 3 * k], row[4 + 3 * k], row[5 + 3 * k], s, 3 + 3 * k)
            s[12 + k] = row[12 + k]
        for k in range(8):
            for c in range(3):
                a, b, d = s[12] * s[3 + c], s[13] * s[6 + c], s[14] * s[9 + c]
                corner[k, c] = s[c] + (a if k & 1 else -a) + (b if k & 2 else -b) + (d if k & 4 else -d)
        return 8
    _turned(turn, row[3], row[4], row[5], s, 3)
    if kind == WALL:
        _turned(turn, row[6], row[7], row[8], s, 6)
        s[9] = row[9]
        for k in range(4):
            for c in range(3):
                corner[k, c] = s[c] + (s[3 + c] if k & 1 else 0.0) + (s[9] * s[6 + c] if k & 2 else 0.0)
        return 4
    s[6], s[7] = row[6], row[7]
    for c in range(3):
        corner[0, c] = s[c]
        corner[1, c] = s[c] + s[6] * s[3 + c]
    return 2


@kernel
def _one(
    e: int, place: Floats, turn: Floats, shapes: Shapes, beams: Beams, limit: float,
    distance: Floats, facing: Floats, normal: Floats, hit: Ints, part: Ints,
) -> None:  # fmt: skip
    count = len(beams.x)
    total = len(shapes.kind)
    reach = np.full(count, np.inf)
    which = np.full(count, -1)
    rows = np.empty((total, WIDTH))
    corner = np.empty((8, 3))
    for n in range(total):
        if not shapes.present[e, n]:
            continue
        kind, s = shapes.kind[n], rows[n]
        points = _moved(e, kind, n, shapes, place, turn, s, corner)
        radius = s[7] if kind == CAPSULE or kind == CYLINDER else 0.0
        _draw(kind, s, n, corner, points, radius, limit, beams, reach, which)
    up = turn[2]
    for k in range(count):
        x, y, z = beams.x[k], beams.y[k], beams.z[k]
        down = x * up[0] + y * up[1] + z * up[2]
        nx, ny, nz = up[0], up[1], up[2]
        owner, label = shapes.nothing, -1
        if shapes.floor and down < 0.0 and place[2] > 0.0 and -place[2] / down < reach[k]:
            reach[k] = -place[2] / down
            owner = shapes.ground
        elif which[k] >= 0:
            n = which[k]
            owner, label = shapes.owner[n], shapes.part[n]
            if reach[k] > 0.0:
                nx, ny, nz = normal_at(shapes.kind[n], reach[k] * x, reach[k] * y, reach[k] * z, rows[n])
                if nx * x + ny * y + nz * z > 0.0:
                    nx, ny, nz = -nx, -ny, -nz
            else:
                nx, ny, nz = -x, -y, -z
        i = beams.order[k]
        distance[i], hit[i], part[i] = reach[k], owner, label
        if reach[k] < math.inf:
            facing[i] = -(nx * x + ny * y + nz * z)
            for c in range(3):
                normal[i, c] = turn[c, 0] * nx + turn[c, 1] * ny + turn[c, 2] * nz


@kernel
def _serial(
    place: Floats, turn: Floats, shapes: Shapes, beams: Beams, limit: float,
    distance: Floats, facing: Floats, normal: Floats, hit: Ints, part: Ints,
) -> None:  # fmt: skip
    for e in range(len(place)):
        _one(e, place[e], turn[e], shapes, beams, limit, distance[e], facing[e], normal[e], hit[e], part[e])


@dataclass(frozen=True)
class Hits:
    """What R beams met in E environments.

    Fields:
        distance: ``[E, R]`` [m], inf for nothing; 0 when the sensor is inside a shape.
        facing: ``[E, R]`` cosine of the angle between beam and surface normal, 1 for nothing.
        normal: ``[E, R, 3]`` unit normal of the surface in the world, towards the sensor; 0 for nothing.
        hit: ``[E, R]`` index of an agent or one of the values of :mod:`crowdbot.sensors.shapes`.
        part: ``[E, R]`` index into ``scene.bodies.parts``, -1 where there is none.
    """

    distance: Floats
    facing: Floats
    normal: Floats
    hit: Ints
    part: Ints


def cast(scene: Scene, pose: SpatialPose, beams: Beams, limit: float, *, skins: bool = False) -> Hits:
    """Return what beams from ``pose`` meet within ``limit`` [m].

    Agents are seen by their limbs, with ``skins`` by their triangle skins; those that have none are upright
    cylinders. Absent agents are not seen.

    Raises:
        InputError: ``skins`` is asked for and the scene has none.

    >>> from crowdbot.sensors.beams import beams, fan
    >>> hits = cast(Scene.of([[3.0, 0.0]], radius=0.5), SpatialPose.of((0, 0, 1.0)), beams(fan(np.zeros(1))), 10.0)
    >>> hits.distance.tolist(), hits.normal.tolist(), hits.hit.tolist()
    ([[2.5]], [[[-1.0, 0.0, 0.0]]], [[0]])
    """
    shapes = gathered(scene, skins)
    size = (len(pose.position), len(beams.x))
    hits = Hits(
        np.empty(size), np.ones(size), np.zeros((*size, 3)), np.empty(size, dtype=np.int64), np.empty(size, np.int64)
    )
    place = np.ascontiguousarray(pose.position)
    _serial(
        place, pose.matrix, shapes, beams, float(limit), hits.distance, hits.facing, hits.normal, hits.hit, hits.part
    )
    return hits

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




@kernel
def _gap(corner: Floats, i: int, j: int, axes: int) -> float:
    """Return the distance of the origin to the segment between two corners, in the plane (2 axes) or in space (3)."""
    length2, along, s, gap2 = 0.0, 0.0, 0.0, 0.0
    for c in range(axes):
        step = corner[j, c] - corner[i, c]
        length2 += step * step
        along -= corner[i, c] * step
    if length2 > 0.0:
        s = min(1.0, max(0.0, along / length2))
    for c in range(axes):
        place = corner[i, c] + s * (corner[j, c] - corner[i, c])
        gap2 += place * place
    return math.sqrt(gap2)


@kernel
def _heights(corner: Floats, count: int, radius: float) -> tuple[float, float, float]:
    """Return the lowest and highest z of a hull and how far it reaches in the plane."""
    low, high, far2 = math.inf, -math.inf, 0.0
    for i in range(count):
        low, high = min(low, corner[i, 2]), max(high, corner[i, 2])
        far2 = max(far2, corner[i, 0] * corner[i, 0] + corner[i, 1] * corner[i, 1])
    return low - radius, high + radius, math.sqrt(far2) + radius


@kernel
def _nearest(corner: Floats, count: int, radius: float, axes: int) -> float:
    near = math.inf
    for i in range(count):
        for j in range(i):
            near = min(near, _gap(corner, i, j, axes))
    return max(0.0, near - radius)


@kernel
def _width(corner: Floats, count: int, radius: float) -> tuple[float, float]:
    """Return azimuth at which a hull begins and how wide it is, a full turn when it holds the origin from above."""
    least, most, cx, cy = math.inf, -math.inf, 0.0, 0.0
    for i in range(count):
        cx += corner[i, 0]
        cy += corner[i, 1]
    middle = math.atan2(cy, cx)
    for i in range(count):
        away = math.sqrt(corner[i, 0] * corner[i, 0] + corner[i, 1] * corner[i, 1])
        if away <= radius or away == 0.0:
            return -math.pi, TURN
        half = math.asin(radius / away)
        off = math.atan2(corner[i, 1], corner[i, 0]) - middle
        off -= TURN * math.floor((off + math.pi) / TURN)
        least, most = min(least, off - half), max(most, off + half)
    if most - least >= math.pi - 1e-6:
        return -math.pi, TURN
    return middle + least, most - least


@kernel
def _can_be_seen(corner: Floats, count: int, radius: float, limit: float, beams: Beams) -> bool:
    """Return whether a hull is within reach and between the lowest and the highest beam."""
    low, high, far = _heights(corner, count, radius)
    if low > far * beams.steep[1] or high < far * beams.steep[0]:
        return False
    return _nearest(corner, count, radius, 2) <= limit


@kernel
def _try(
    kind: int, s: Floats, number: int, begin: int, end: int, near: float, beams: Beams, distance: Floats, which: Ints
) -> None:
    for k in range(begin, end):
        if near < distance[k]:
            reach = meet(kind, beams.x[k], beams.y[k], beams.z[k], s)
            if reach < distance[k]:
                distance[k] = reach
                which[k] = number


@kernel
def _draw(
    kind: int, s: Floats, number: int, corner: Floats, count: int, radius: float, nearest: float, beams: Beams,
    distance: Floats, which: Ints,
) -> None:  # fmt: skip
    """Try a shape on the beams in its window."""
    if nearest == 0.0 and within(kind, s):
        for k in range(len(distance)):
            if distance[k] > 0.0:
                distance[k] = 0.0
                which[k] = number
        return
    low, high, far = _heights(corner, count, radius)
    near = _nearest(corner, count, radius, 2)
    left, width = _width(corner, count, radius)
    if width >= TURN:
        near = 0.0
    bottom = math.atan2(low, far if low > 0.0 else near) - MARGIN
    top = math.atan2(high, near if high > 0.0 else far) + MARGIN
    first = max(0, math.floor((bottom - beams.low) / beams.tall))
    last = min(beams.rows - 1, math.floor((top - beams.low) / beams.tall))
    columns = beams.columns
    start = (left - MARGIN - beams.left) % TURN
    for turn in range(2):
        a = max(0, math.floor((start - turn * TURN) / beams.wide))
        b = min(columns - 1, math.floor((start - turn * TURN + width + 2.0 * MARGIN) / beams.wide))
        for row in range(first, last + 1 if a <= b else first):
            begin, end = beams.begin[row * columns + a], beams.begin[row * columns + b + 1]
            _try(kind, s, number, begin, end, nearest, beams, distance, which)


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
def _worth(rows: Floats, e: int, n: int, px: float, py: float, pz: float, turn: Floats, limit: float, beams: Beams) -> bool:
    """Return whether the ball around a capsule or cylinder may be within reach and between the outer beams."""
    half = 0.5 * rows[e, n, 6]
    x = rows[e, n, 0] + half * rows[e, n, 3] - px
    y = rows[e, n, 1] + half * rows[e, n, 4] - py
    z = rows[e, n, 2] + half * rows[e, n, 5] - pz
    slope = turn[0, 2] * rows[e, n, 3] + turn[1, 2] * rows[e, n, 4] + turn[2, 2] * rows[e, n, 5]
    radius = rows[e, n, 7]
    away = math.sqrt(x * x + y * y + z * z)
    far = away + half + radius
    height = turn[0, 2] * x + turn[1, 2] * y + turn[2, 2] * z
    tall = half * abs(slope) + radius + 1e-9
    if away - half - radius > limit:
        return False
    return height - tall <= far * beams.steep[1] and height + tall >= far * beams.steep[0]


@kernel
def _one(
    e: int, place: Floats, turn: Floats, shapes: Shapes, beams: Beams, limit: float,
    distance: Floats, facing: Floats, normal: Floats, hit: Ints, part: Ints,
) -> None:  # fmt: skip
    count, total = len(beams.x), len(shapes.kind)
    reach = np.full(count, np.inf)
    which = np.full(count, -1)
    rows = np.empty((total, WIDTH))
    corner = np.empty((8, 3))
    seen, nearest, kept = np.empty(total, dtype=np.int64), np.empty(total), 0
    px, py, pz = place[0], place[1], place[2]
    for n in range(total):
        kind = shapes.kind[n]
        rod = kind == CAPSULE or kind == CYLINDER
        if shapes.present[e, n] and (not rod or _worth(shapes.rows, e, n, px, py, pz, turn, limit, beams)):
            points = _moved(e, kind, n, shapes, place, turn, rows[n], corner)
            radius = rows[n, 7] if rod else 0.0
            if _can_be_seen(corner, points, radius, limit, beams):
                seen[kept] = n
                # of boxes and walls only the distance from above is sure, their inner points may be the nearest
                nearest[kept] = _nearest(corner, points, radius, 3 if points == 2 else 2) * (1.0 - 1e-12)
                kept += 1
    for i in np.argsort(nearest[:kept], kind="mergesort"):  # so that what is behind is rarely tried
        n = seen[i]
        kind = shapes.kind[n]
        points = _moved(e, kind, n, shapes, place, turn, rows[n], corner)
        radius = rows[n, 7] if kind == CAPSULE or kind == CYLINDER else 0.0
        _draw(kind, rows[n], n, corner, points, radius, nearest[i], beams, reach, which)
    up = turn[2]
    for k in range(count):
        x, y, z = beams.x[k], beams.y[k], beams.z[k]
        down = x * up[0] + y * up[1] + z * up[2]
        nx, ny, nz = up[0], up[1], up[2]
        owner, label = shapes.nothing, -1
        if down < 0.0 and place[2] > 0.0 and -place[2] / down < reach[k]:
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

"""Ray casting: intersections of beams with limbs, discs, walls, props, skins and the floor.

Shapes are transformed to the sensor frame. There each shape covers a window of azimuth and elevation, and only the
beams of the cells in this window are tested, as in rasterisation with a depth buffer. The run time depends on the
visible shapes, hardly on the number of shapes times beams. Environments are independent of each other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import STAGE, InputError, Scene, SpatialPose, kernel, prange
from crowdbot.core.rays import (
    BOX,
    CAPSULE,
    CYLINDER,
    TRIANGLE,
    WALL,
    WIDTH,
    normal_at,
    ray_to_box,
    ray_to_capsule,
    ray_to_cylinder,
    ray_to_wall,
    within,
)
from crowdbot.core.windows import (
    ball_in_view,
    hull_gap,
    hull_width,
    rod_gap,
    rod_levels,
    rod_width,
)
from crowdbot.typing import Floats, Ints

from .beams import TURN, Beams, cell_columns, first_cells, hull_cells, sees_hull
from .ray_shapes import FLOOR, NOTHING, PROP, RayShapes, collect_shapes
from .skin_casting import SkinCasting, skin_casting

SKIN = -2
"""Index of the shape of the first triangle of skins; those of the others are below."""
NOBODY = np.zeros(0, dtype=np.int64)
MANY = 4
"""Minimum number of environments for multi-threading."""


@kernel
def _try(
    kind: int, s: Floats, n: int, begin: int, end: int, near: float, beams: Beams, distance: Floats, which: Ints
) -> None:
    """Test a shape on some beams, unless they already have a closer intersection."""
    a, b, c, d, e, f, g, h, i, j = s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], s[8], s[9]
    for k in range(begin, end):
        if near < distance[k]:
            x, y, z = beams.x[k], beams.y[k], beams.z[k]
            if kind == CAPSULE:
                reach = ray_to_capsule(x, y, z, a, b, c, d, e, f, g, h)
            elif kind == WALL:
                reach = ray_to_wall(x, y, z, a, b, c, d, e, f, g, h, i, j)
            elif kind == CYLINDER:
                reach = ray_to_cylinder(x, y, z, a, b, c, d, e, f, g, h)
            else:
                reach = ray_to_box(x, y, z, s)
            if reach < distance[k]:
                distance[k] = reach
                which[k] = n


@kernel
def _draw(
    kind: int, s: Floats, n: int, corner: Floats, near: float, beams: Beams, distance: Floats, which: Ints
) -> None:
    """Test a shape on the beams in its window."""
    if near == 0.0 and within(kind, s):
        for k in range(len(distance)):
            if distance[k] > 0.0:
                distance[k] = 0.0
                which[k] = n
        return
    if kind in (CAPSULE, CYLINDER):
        bottom, top = 0.0, 0.0
        ax, ay, az, length, radius = s[0], s[1], s[2], s[6], s[7]
        bx, by, bz = ax + length * s[3], ay + length * s[4], az + length * s[5]
        left, width = rod_width(ax, ay, bx, by, radius)
        if beams.rows > 1:
            bottom, top = rod_levels(ax, ay, az, bx, by, bz, radius, width >= TURN)
        first, last, start = first_cells(left, bottom, top, beams)
    else:
        first, last, start, width = hull_cells(corner, 4 if kind == WALL else 8, beams)
    for turn in range(2):
        a, b = cell_columns(start, width, turn, beams)
        for row in range(first, last + 1 if a <= b else first):
            begin, end = beams.begin[row * beams.columns + a], beams.begin[row * beams.columns + b + 1]
            _try(kind, s, n, begin, end, near, beams, distance, which)


@kernel
def _turned(turn: Floats, x: float, y: float, z: float, out: Floats, at: int) -> None:
    """Write the vector x, y, z of the world in the sensor frame."""
    out[at] = turn[0, 0] * x + turn[1, 0] * y + turn[2, 0] * z
    out[at + 1] = turn[0, 1] * x + turn[1, 1] * y + turn[2, 1] * z
    out[at + 2] = turn[0, 2] * x + turn[1, 2] * y + turn[2, 2] * z


@kernel
def _moved(e: int, kind: int, n: int, shapes: RayShapes, place: Floats, turn: Floats, s: Floats, corner: Floats) -> int:
    """Write shape ``n`` of a kind in the sensor frame: its row and the corners of its hull; return their number."""
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
def _bring(
    table: Floats, kinds: Ints, present: NDArray[np.bool_], place: Floats, turn: Floats, limit: float, down: float,
    up: float, rows: Floats, seen: Ints, nearest: Floats,
) -> int:  # fmt: skip
    """Write the visible rods in the sensor frame and their distances; return their number."""
    kept = 0
    px, py, pz = place[0], place[1], place[2]
    a, b, c = turn[0, 2], turn[1, 2], turn[2, 2]
    for n in range(len(kinds)):
        if not present[n] or (kinds[n] not in (CAPSULE, CYLINDER)):
            continue
        ux, uy, uz, length, radius = table[n, 3], table[n, 4], table[n, 5], table[n, 6], table[n, 7]
        x, y, z, half = table[n, 0] - px, table[n, 1] - py, table[n, 2] - pz, 0.5 * length
        mx, my, mz = x + half * ux, y + half * uy, z + half * uz
        slope, height = a * ux + b * uy + c * uz, a * mx + b * my + c * mz
        if ball_in_view(mx, my, mz, slope, height, half, radius, limit, down, up):
            for k in range(3):
                rows[n, k] = turn[0, k] * x + turn[1, k] * y + turn[2, k] * z
                rows[n, 3 + k] = turn[0, k] * ux + turn[1, k] * uy + turn[2, k] * uz
            rows[n, 6], rows[n, 7] = length, radius
            nearest[kept] = rod_gap(x, y, z, ux, uy, uz, length, radius) * (1.0 - 1e-12)
            seen[kept] = n
            kept += 1
    return kept


@kernel
def _bring_flat(
    e: int, shapes: RayShapes, place: Floats, turn: Floats, limit: float, beams: Beams, rows: Floats, corner: Floats,
    seen: Ints, nearest: Floats, kept: int,
) -> int:  # fmt: skip
    """Write the other visible shapes in the same way."""
    for n in range(len(shapes.kind)):
        kind = shapes.kind[n]
        if not shapes.present[e, n] or kind in (CAPSULE, CYLINDER):
            continue
        count = _moved(e, kind, n, shapes, place, turn, rows[n], corner)
        if sees_hull(corner, count, limit, beams):
            around = hull_width(corner, count)[1] >= TURN
            nearest[kept] = 0.0 if around else hull_gap(corner, count) * (1.0 - 1e-12)
            seen[kept] = n
            kept += 1
    return kept


@kernel
def _skin_normal(e: int, f: int, shapes: RayShapes, place: Floats, turn: Floats) -> tuple[float, float, float]:
    """Return the unit normal of a triangle in the sensor frame."""
    s = np.empty(WIDTH)
    for k in range(3):
        p = shapes.vertices[e, shapes.faces[f, k]]
        _turned(turn, p[0] - place[0], p[1] - place[1], p[2] - place[2], s, 3 * k)
    return normal_at(TRIANGLE, 0.0, 0.0, 0.0, s)


@kernel
def _tell(
    e: int, shapes: RayShapes, rows: Floats, place: Floats, turn: Floats, beams: Beams, reach: Floats,
    which: Ints, distance: Floats, cos_incidence: Floats, normal: Floats, hit: Ints, part: Ints,
) -> None:  # fmt: skip
    """Write the intersection of each beam, in the order of the input."""
    ox, oy, oz, height = turn[2, 0], turn[2, 1], turn[2, 2], place[2]
    told = len(normal) > 0
    kind, owner, label = shapes.kind, shapes.owner, shapes.part
    before, fx, fy, fz = -1, 0.0, 0.0, 0.0
    for k in range(len(reach)):
        x, y, z, d, n, i = beams.x[k], beams.y[k], beams.z[k], reach[k], which[k], beams.order[k]
        fall = x * ox + y * oy + z * oz
        nx, ny, nz = ox, oy, oz
        hit[i], part[i] = NOTHING, -1
        if fall < 0.0 and height > 0.0 and height < -fall * d:
            d = -height / fall
            hit[i] = FLOOR
        elif n != -1:
            f = SKIN - n
            hit[i], part[i] = (owner[n], label[n]) if n >= 0 else (shapes.face_owner[f], shapes.face_part[f])
            hit[i] = PROP if hit[i] == STAGE else hit[i]
            if d == 0.0:
                nx, ny, nz = -x, -y, -z
            elif n >= 0 and kind[n] == CAPSULE:
                s = (d * x - rows[n, 0]) * rows[n, 3] + (d * y - rows[n, 1]) * rows[n, 4]
                s = min(rows[n, 6], max(0.0, s + (d * z - rows[n, 2]) * rows[n, 5]))
                over = 1.0 / rows[n, 7]
                nx = (d * x - rows[n, 0] - s * rows[n, 3]) * over
                ny = (d * y - rows[n, 1] - s * rows[n, 4]) * over
                nz = (d * z - rows[n, 2] - s * rows[n, 5]) * over
            else:
                if n < 0 and n != before:
                    fx, fy, fz = _skin_normal(e, f, shapes, place, turn)
                elif n >= 0 and (n != before or kind[n] in (CYLINDER, BOX)):
                    fx, fy, fz = normal_at(kind[n], d * x, d * y, d * z, rows[n])
                before = n  # flat shapes have the same normal at the next beam
                nx, ny, nz = fx, fy, fz
                if nx * x + ny * y + nz * z > 0.0:
                    nx, ny, nz = -nx, -ny, -nz
        distance[i] = d
        if d < math.inf:
            cos_incidence[i] = -(nx * x + ny * y + nz * z)
            if told:
                for c in range(3):
                    normal[i, c] = turn[c, 0] * nx + turn[c, 1] * ny + turn[c, 2] * nz


@kernel
def _take_skins(near: Floats, face: Ints, reach: Floats, which: Ints) -> None:
    """Enter triangles that are nearer than the shapes so far."""
    for k in range(len(near)):
        if near[k] < reach[k]:
            reach[k], which[k] = near[k], SKIN - face[k]


@kernel
def _one(
    e: int, place: Floats, turn: Floats, shapes: RayShapes, near: Floats, face: Ints, beams: Beams, limit: float,
    distance: Floats, cos_incidence: Floats, normal: Floats, hit: Ints, part: Ints,
) -> None:  # fmt: skip
    count, total = len(beams.x), len(shapes.kind)
    reach, which = np.full(count, np.inf), np.full(count, -1)
    rows, corner = np.empty((total, WIDTH)), np.empty((8, 3))
    seen, nearest = np.empty(total, dtype=np.int64), np.empty(total)
    down, up = beams.down, beams.up
    kept = _bring(shapes.rows[e], shapes.kind, shapes.present[e], place, turn, limit, down, up, rows, seen, nearest)
    kept = _bring_flat(e, shapes, place, turn, limit, beams, rows, corner, seen, nearest, kept)
    waiting = True  # skins come after rods around the sensor, before all others
    for i in np.argsort(nearest[:kept], kind="mergesort"):  # nearest first: hidden shapes are rarely tested
        n = seen[i]
        kind = shapes.kind[n]
        rod = kind in (CAPSULE, CYLINDER)
        if waiting and not (rod and nearest[i] == 0.0):
            _take_skins(near, face, reach, which)
            waiting = False
        if not rod:
            _moved(e, kind, n, shapes, place, turn, rows[n], corner)
        _draw(kind, rows[n], n, corner, nearest[i], beams, reach, which)
    if waiting:
        _take_skins(near, face, reach, which)
    _tell(e, shapes, rows, place, turn, beams, reach, which, distance, cos_incidence, normal, hit, part)


@kernel
def _matrix(rotation: Floats) -> Floats:
    """Return the rotation matrix of a quaternion, as :attr:`SpatialPose.matrix` does."""
    size = math.sqrt(rotation[0] ** 2 + rotation[1] ** 2 + rotation[2] ** 2 + rotation[3] ** 2)
    w, x, y, z = rotation[0] / size, rotation[1] / size, rotation[2] / size, rotation[3] / size
    turn = np.empty((3, 3))
    turn[0, 0], turn[0, 1], turn[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    turn[1, 0], turn[1, 1], turn[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    turn[2, 0], turn[2, 1], turn[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
    return turn


@kernel
def _serial(
    place: Floats, rotation: Floats, shapes: RayShapes, near: Floats, face: Ints, beams: Beams, limit: float,
    distance: Floats, cos_incidence: Floats, normal: Floats, hit: Ints, part: Ints,
) -> None:  # fmt: skip
    for e in range(len(place)):
        turn = _matrix(rotation[e])
        _one(
            e, place[e], turn, shapes, near[e], face[e], beams, limit, distance[e], cos_incidence[e], normal[e],
            hit[e], part[e],
        )  # fmt: skip


@kernel(parallel=True)
def _shared(
    place: Floats, rotation: Floats, shapes: RayShapes, near: Floats, face: Ints, beams: Beams, limit: float,
    distance: Floats, cos_incidence: Floats, normal: Floats, hit: Ints, part: Ints,
) -> None:  # fmt: skip
    for k in prange(len(place)):
        e: Any = np.int64(k)  # the index is unsigned: the call would be compiled twice
        turn = _matrix(rotation[e])
        _one(
            e, place[e], turn, shapes, near[e], face[e], beams, limit, distance[e], cos_incidence[e], normal[e],
            hit[e], part[e],
        )  # fmt: skip


@dataclass(frozen=True)
class RayHits:
    """Intersections of R beams in E environments.

    Fields:
        distance: ``[E, R]`` [m], inf without a hit; 0 if the sensor is inside a shape.
        cos_incidence: ``[E, R]`` cosine of the angle between beam and surface normal, 1 without a hit.
        normal: ``[E, R, 3]`` unit normal of the surface in the world, towards the sensor; 0 without a hit.
        hit: ``[E, R]`` index of an agent or one of the values of :mod:`crowdbot.sensors.ray_shapes`.
        part: ``[E, R]`` index into ``scene.bodies.parts``, -1 where there is none.
    """

    distance: Floats
    cos_incidence: Floats
    normal: Floats
    hit: Ints
    part: Ints


def cast_rays(
    scene: Scene, pose: SpatialPose, beams: Beams, limit: float, *, skins: bool = False, normals: bool = True
) -> RayHits:
    """Return the first intersections of beams from ``pose`` within ``limit`` [m].

    Agents are represented by their limbs, with ``skins`` by their triangle skins, otherwise by upright cylinders.
    Inactive agents are ignored. Without ``normals`` that array is empty, which saves time.

    Raises:
        InputError: ``skins`` is requested and the scene has none.

    >>> from crowdbot.sensors.beams import sort_beams, unit_vectors
    >>> scene, ahead = Scene.of([[3.0, 0.0]], radius=0.5), sort_beams(unit_vectors(np.zeros(1)))
    >>> hits = cast_rays(scene, SpatialPose.of((0, 0, 1.0)), ahead, 10.0)
    >>> hits.distance.tolist(), hits.normal.tolist(), hits.hit.tolist()
    ([[2.5]], [[[-1.0, 0.0, 0.0]]], [[0]])
    """
    casting = _trees_of(scene) if skins else None
    skin = scene.bodies.skins if casting is not None and scene.bodies is not None else None
    shapes = collect_shapes(scene, skin, NOBODY if casting is None else casting.tree.person)
    size = (len(pose.position), len(beams.x))
    normal = np.zeros((size[0], size[1] if normals else 0, 3))
    hits = RayHits(np.empty(size), np.ones(size), normal, np.empty(size, np.int64), np.empty(size, np.int64))
    place, rotation = np.ascontiguousarray(pose.position), np.ascontiguousarray(pose.rotation)
    near, face = np.full((size[0], 0 if casting is None else size[1]), np.inf), np.empty((size[0], 0), dtype=np.int64)
    if casting is not None:
        face = np.full(size, -1)
        for e in range(size[0]):
            turn = _matrix(rotation[e])
            casting.cast(shapes.vertices[e], scene.active[e], place[e], turn, limit, beams, near[e], face[e])
    work = _serial if size[0] < MANY else _shared
    work(
        place, rotation, shapes, near, face, beams, float(limit), hits.distance, hits.cos_incidence, hits.normal,
        hits.hit, hits.part,
    )  # fmt: skip
    return hits


def _trees_of(scene: Scene) -> SkinCasting:
    if scene.bodies is None or scene.bodies.skins is None:
        raise InputError("skins: the scene has no triangle skins; give Scene.bodies skins, or leave skins=False")
    return skin_casting(scene.bodies.skins)

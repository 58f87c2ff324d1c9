"""Casting of beams at triangle skins: the nearest triangle of each beam, the same as if all were tested one by one."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import Skins, kernel, prange
from crowdbot.core.rays import ray_to_triangle
from crowdbot.sensors.beams import Beams, cell_columns, hull_cells, sees_hull
from crowdbot.typing import Bools, Floats, Ints

from .skin_boxes import EDGE_ON, SkinBoxes, fit_boxes
from .skin_tree import SkinTree, plant_tree, sort_triangles

BLOCK = 256
"""Number of beams that a thread casts at a time."""
DEEP = 128
"""Largest number of open nodes of a beam."""
CLEAR = 1e-13
"""A beam that passes the edges of a triangle by more than this share of distance squared meets it without doubt."""
KEPT = 4
"""Number of topologies whose trees are kept."""


@kernel
def _may_meet(corner: Floats, row: int, k: int, limit: float, beams: Beams) -> bool:
    """Return whether beam ``k`` in a row of cells is in the window of a triangle within range."""
    if not sees_hull(corner, 3, limit, beams):
        return False
    first, last, start, width = hull_cells(corner, 3, beams)
    found = False
    for turn in range(2):
        a, b = cell_columns(start, width, turn, beams)
        if a <= b and first <= row <= last:
            cell = row * beams.columns
            found |= beams.begin[cell + a] <= k < beams.begin[cell + b + 1]
    return found


@kernel
def _confirm(
    face: Ints, points: Floats, row: int, k: int, reach: float, limit: float, beams: Beams
) -> bool:  # fmt: skip
    """Return whether a met triangle counts: rounding can accept beams that pass it closely, outside its window."""
    corner = np.empty((3, 3))
    for i in range(3):
        corner[i] = points[face[i]]
    x, y, z = beams.x[k], beams.y[k], beams.z[k]
    least, most, size = math.inf, -math.inf, 0.0
    for i in range(3):
        a, b = corner[i], corner[(i + 1) % 3]
        side = x * (a[1] * b[2] - a[2] * b[1]) + y * (a[2] * b[0] - a[0] * b[2]) + z * (a[0] * b[1] - a[1] * b[0])
        least, most = min(least, side), max(most, side)
        size = max(size, abs(a[0]), abs(a[1]), abs(a[2]))
    edge = CLEAR * size * size
    if (least > edge or most < -edge) and abs(z) < 0.999 and reach < 0.999 * limit:
        return True
    return _may_meet(corner, row, k, limit, beams)


@kernel(inline=True)
def _enter(box: Floats, node: int, ix: float, iy: float, iz: float) -> tuple[float, float]:
    """Return where a beam with inverse direction enters and leaves a box."""
    ax, bx = box[node, 0] * ix, box[node, 3] * ix
    ay, by = box[node, 1] * iy, box[node, 4] * iy
    az, bz = box[node, 2] * iz, box[node, 5] * iz
    enter = max(min(ax, bx), min(ay, by), min(az, bz), 0.0)
    return enter, min(max(ax, bx), max(ay, by), max(az, bz))


@kernel
def _inverse(value: float) -> float:
    """Return the inverse of a component of a direction, finite for 0."""
    if abs(value) < 1e-30:
        return 1e30
    return 1.0 / value


@kernel
def _pierce(
    p: int, k: int, row: int, most: float, limit: float, tree: SkinTree, boxes: SkinBoxes, beams: Beams,
    heap: Ints, entry: Floats, reach: Floats, which: Ints,
) -> None:  # fmt: skip
    """Find the nearest triangle of a person on beam ``k`` within ``most``, nearer child first."""
    x, y, z = beams.x[k], beams.y[k], beams.z[k]
    ix, iy, iz = _inverse(x), _inverse(y), _inverse(z)
    begin, size, leaves, node = tree.begin[p], tree.begin[p + 1] - tree.begin[p], tree.leaves[p], tree.node[p]
    best, face = reach[k], which[k]
    most = min(most, best)
    open_, heap[0], entry[0] = 1, 1, 0.0
    while open_ > 0:
        open_ -= 1
        i = heap[open_]
        if entry[open_] > most:
            continue
        while i < leaves:
            one, far_one = _enter(boxes.box, node + 2 * i, ix, iy, iz)
            two, far_two = _enter(boxes.box, node + 2 * i + 1, ix, iy, iz)
            in_one, in_two = one <= min(far_one, most), two <= min(far_two, most)
            if in_one and in_two:
                nearer = 0 if one <= two else 1
                heap[open_], entry[open_] = 2 * i + 1 - nearer, max(one, two)
                open_ += 1
                i = 2 * i + nearer
            elif in_one:
                i = 2 * i
            elif in_two:
                i = 2 * i + 1
            else:
                i = 0
                break
        if i == 0:
            continue
        leaf = i - leaves
        for slot in range(begin + leaf * size // leaves, begin + (leaf + 1) * size // leaves):
            c = tree.corner[slot]
            u, v, w = boxes.points[c[0]], boxes.points[c[1]], boxes.points[c[2]]
            away = ray_to_triangle(x, y, z, u[0], u[1], u[2], v[0], v[1], v[2], w[0], w[1], w[2])
            if away > best or away == math.inf or (away == best and tree.order[slot] > face):
                continue
            f = tree.order[slot]
            if _confirm(tree.faces[f], boxes.points, row, k, away, limit, beams):
                best, face = away, f
                most = min(most, best)
    reach[k], which[k] = best, face


@kernel
def _cast_block(
    begin: int, end: int, near: Ints, floor: Floats, limit: float, tree: SkinTree, boxes: SkinBoxes,
    beams: Beams, reach: Floats, which: Ints,
) -> None:  # fmt: skip
    """Cast some beams at people in the given order."""
    heap, entry = np.empty(DEEP, dtype=np.int64), np.empty(DEEP)
    for p in near:
        gap, start, width = boxes.gap[p], boxes.span[p, 0], boxes.span[p, 1]
        for turn in range(2):
            a, b = cell_columns(start, width, turn, beams)
            for row in range(boxes.rows[p, 0], boxes.rows[p, 1] + 1 if a <= b else boxes.rows[p, 0]):
                cell = row * beams.columns
                for k in range(max(begin, beams.begin[cell + a]), min(end, beams.begin[cell + b + 1])):
                    if gap <= min(reach[k], floor[k]):
                        _pierce(p, k, row, floor[k], limit, tree, boxes, beams, heap, entry, reach, which)


@kernel(parallel=True)
def _cast(
    near: Ints, place: Floats, turn: Floats, limit: float, tree: SkinTree, boxes: SkinBoxes, beams: Beams,
    reach: Floats, which: Ints,
) -> None:  # fmt: skip
    """Cast all beams in blocks; hits behind the floor are not looked for."""
    total = len(reach)
    floor = np.empty(total)
    blocks = (total + BLOCK - 1) // BLOCK
    step = max(1, int(0.618 * blocks))
    while math.gcd(step, blocks) > 1:
        step += 1
    for i in prange(blocks):  # neighbouring blocks, which are similar, go to different threads
        begin = i * step % blocks * BLOCK
        end = min(total, begin + BLOCK)
        for k in range(begin, end):
            fall = beams.x[k] * turn[2, 0] + beams.y[k] * turn[2, 1] + beams.z[k] * turn[2, 2]
            floor[k] = 1.000001 * place[2] / -fall if fall < 0.0 and place[2] > 0.0 else math.inf
        _cast_block(begin, end, near, floor, limit, tree, boxes, beams, reach, which)


@kernel
def _test_each(
    chosen: Ints, faces: Ints, points: Floats, limit: float, beams: Beams, reach: Floats, which: Ints
) -> None:
    """Test triangles one by one on the beams in their windows; the first of two at the same distance is kept."""
    corner = np.empty((3, 3))
    for f in chosen:
        total = 0.0
        for i in range(3):
            corner[i] = points[faces[f, i]]
            total += abs(corner[i, 0]) + abs(corner[i, 1]) + abs(corner[i, 2])
        if not total < math.inf or not sees_hull(corner, 3, limit, beams):
            continue
        a, b, c = corner[0], corner[1], corner[2]
        first, last, start, width = hull_cells(corner, 3, beams)
        for turn in range(2):
            low, high = cell_columns(start, width, turn, beams)
            for row in range(first, last + 1 if low <= high else first):
                cell = row * beams.columns
                for k in range(beams.begin[cell + low], beams.begin[cell + high + 1]):
                    x, y, z = beams.x[k], beams.y[k], beams.z[k]
                    away = ray_to_triangle(x, y, z, a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2])
                    if away < reach[k]:
                        reach[k], which[k] = away, f


class SkinCasting:
    """The trees of the skins of one topology, and arrays for the boxes of the last scans."""

    def __init__(self, skins: Skins) -> None:
        self.tree = plant_tree(skins)
        self._spare: list[SkinBoxes] = []

    def is_of(self, skins: Skins) -> bool:
        """Return whether these are trees of ``skins``."""
        ours = self.tree
        if ours.faces is skins.faces and ours.owner is skins.owner:
            return True
        return np.array_equal(ours.faces, skins.faces) and np.array_equal(ours.owner, skins.owner)

    def cast(
        self, vertices: Floats, active: Bools, place: Floats, turn: Floats, limit: float, beams: Beams,
        reach: Floats, which: Ints, each: bool = False,
    ) -> None:  # fmt: skip
        """Write the distance of the nearest triangle of each beam ``[R]`` and its index; nothing for no triangle.

        Args:
            vertices: ``[V, 3]`` [m] in the world.
            active: ``[A]`` which agents are there.
            place, turn: position ``[3]`` and rotation matrix of the sensor.
            limit: range [m]; triangles beyond it are not met.
            beams: beams in the sensor frame.
            reach, which: ``[R]``, inf and -1 before.
            each: test the triangles one by one, for comparison; the result is the same.
        """
        tree = self.tree
        if not tree.ready.all():
            sort_triangles(vertices, tree)
        boxes = self._spare.pop() if self._spare else None
        if boxes is None or len(boxes.points) != len(vertices):
            boxes = SkinBoxes.empty(tree, len(vertices))
        fit_boxes(tree, vertices, active, place, turn, limit, beams, boxes)
        near = np.flatnonzero(boxes.gap < np.inf)
        near = near[np.argsort(boxes.gap[near], kind="stable")]
        if each:
            there = np.isin(tree.owner, tree.person[near])
            _test_each(np.flatnonzero(there), tree.faces, boxes.points, limit, beams, reach, which)
        else:
            edge_on = np.flatnonzero(boxes.state == EDGE_ON)
            _test_each(edge_on, tree.faces, boxes.points, limit, beams, reach, which)
            _cast(near, place, turn, limit, tree, boxes, beams, reach, which)
        self._spare.append(boxes)


_kept: list[SkinCasting] = []
"""Trees of the last topologies, the latest first."""


def skin_casting(skins: Skins) -> SkinCasting:
    """Return the trees of ``skins``, the same for the same triangles and owners."""
    for casting in _kept:
        if casting.is_of(skins):
            return casting
    casting = SkinCasting(skins)
    _kept.insert(0, casting)
    del _kept[KEPT:]
    return casting

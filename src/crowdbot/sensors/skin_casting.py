"""Rays at triangle skins: a tree of boxes for each person, and the casting of beams through it."""

from __future__ import annotations

import itertools
import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Skins, kernel, prange
from crowdbot.core.rays import ray_to_triangle
from crowdbot.typing import Bools, Floats, Ints

from .beams import TURN, Beams, cell_columns, hull_cells, sees_hull

MOST = 6
"""Largest number of triangles of a leaf."""


class SkinTree(NamedTuple):
    """Trees over F triangles of M people; they depend on the topology only, and their boxes follow the vertices.

    The tree of a person is complete: node 1 is the root, nodes 2 i and 2 i + 1 are below node i, and the leaves are the
    last nodes. Each leaf holds an equal share of the triangles.

    Fields:
        faces, owner: of the skins, ``[F, 3]`` and ``[F]``.
        order: ``[F]`` index of the triangle in each slot; the slots of a person are consecutive.
        corner: ``[F, 3]`` vertices of the triangle in each slot.
        person: ``[M]`` owner of each tree.
        begin: ``[M + 1]`` first slot.
        leaves: ``[M]`` number of leaves, a power of two.
        node: ``[M + 1]`` first node.
        low, high: ``[M]`` range of vertices, both included.
        ready: ``[M]`` whether the triangles are sorted.
    """

    faces: Ints
    owner: Ints
    order: Ints
    corner: NDArray[np.int32]
    person: Ints
    begin: Ints
    leaves: Ints
    node: Ints
    low: Ints
    high: Ints
    ready: NDArray[np.bool_]


def plant_tree(skins: Skins) -> SkinTree:
    """Return the trees of all owners of ``skins`` with unsorted triangles.

    >>> skins = Skins.of(np.eye(3), [[0, 1, 2], [2, 1, 0], [0, 1, 2]], owner=[4, -1, 4])
    >>> tree = plant_tree(skins)
    >>> tree.person.tolist(), tree.order.tolist(), tree.begin.tolist()
    ([-1, 4], [1, 0, 2], [0, 1, 3])
    """
    order = np.argsort(skins.owner, kind="stable")
    person, first = np.unique(skins.owner[order], return_index=True)
    begin = np.append(first, len(order)).astype(np.int64)
    size = np.diff(begin)
    leaves = np.array([1 << max(0, int(-(-n // MOST) - 1).bit_length()) for n in size.tolist()], dtype=np.int64)
    corner = skins.faces[order].astype(np.int32)
    low = np.array([corner[a:b].min() for a, b in itertools.pairwise(begin)], dtype=np.int64)
    high = np.array([corner[a:b].max() for a, b in itertools.pairwise(begin)], dtype=np.int64)
    node = np.concatenate([[0], np.cumsum(2 * leaves)]).astype(np.int64)
    ready = np.zeros(len(person), dtype=np.bool_)
    return SkinTree(skins.faces, skins.owner, order, corner, person, begin, leaves, node, low, high, ready)


@kernel
def _longest_axis(centre: Floats, chosen: Ints) -> int:
    """Return the axis along which the chosen points extend most."""
    best, axis = -1.0, 0
    for c in range(3):
        low, high = np.inf, -np.inf
        for i in chosen:
            low, high = min(low, centre[i, c]), max(high, centre[i, c])
        if high - low > best:
            best, axis = high - low, c
    return axis


@kernel
def _sort_person(p: int, points: Floats, tree: SkinTree) -> None:
    """Halve the triangles of a person along the longest axis, again and again; absent ones are left as they are."""
    begin, size, leaves = tree.begin[p], tree.begin[p + 1] - tree.begin[p], tree.leaves[p]
    centre = np.empty((size, 3))
    for i in range(size):
        for c in range(3):
            corner = tree.corner[begin + i]
            centre[i, c] = points[corner[0], c] + points[corner[1], c] + points[corner[2], c]
            if not abs(centre[i, c]) < np.inf:
                return
    place, width = np.arange(size), leaves
    while width > 1:
        for part in range(leaves // width):
            a, b = part * width * size // leaves, (part + 1) * width * size // leaves
            chosen = place[a:b].copy()
            place[a:b] = chosen[np.argsort(centre[chosen, _longest_axis(centre, chosen)], kind="mergesort")]
        width //= 2
    order, corner = tree.order[begin : begin + size].copy(), tree.corner[begin : begin + size].copy()
    for i in range(size):
        tree.order[begin + i] = order[place[i]]
        tree.corner[begin + i] = corner[place[i]]
    tree.ready[p] = True


@kernel(parallel=True)
def sort_triangles(points: Floats, tree: SkinTree) -> None:
    """Sort the triangles of people whose vertices ``[V, 3]`` are all known and that are not sorted yet."""
    for p in prange(len(tree.person)):
        if not tree.ready[p]:
            who: Any = np.int64(p)  # the index is unsigned: the call would be compiled twice
            _sort_person(who, points, tree)


PAD = 4e-6
"""Margin of boxes as a share of the largest coordinate of their triangles."""
FLAT = 1e-8
"""Smallest volume of the tetrahedron of origin and triangle, as a share of distance squared times length of an edge.

Rays that the rounded test accepts are then within 3e-6 of the largest coordinate of the triangle, which is less than
``PAD``. The other triangles are seen edge-on or have no area; they are not found by boxes.
"""
CHUNK = 4096
"""Number of vertices that a thread turns at a time."""
IN_BOX, EDGE_ON, ABSENT = 0, 1, 2


class SkinBoxes(NamedTuple):
    """What a sensor sees of the trees of M people with N nodes and V vertices, in the sensor frame.

    Fields:
        points: ``[V, 3]`` [m].
        box: ``[N, 6]`` lower and upper corners [m].
        state: ``[F]`` whether a triangle is within its boxes, edge-on (to be tested without boxes) or absent.
        gap: ``[M]`` distance of the outer box [m], inf for people who are not seen.
        rows: ``[M, 2]`` first and last row of cells.
        span: ``[M, 2]`` start relative to the first column and width [rad].
    """

    points: Floats
    box: Floats
    state: NDArray[np.uint8]
    gap: Floats
    rows: Ints
    span: Floats

    @classmethod
    def empty(cls, tree: SkinTree, vertices: int) -> SkinBoxes:
        """Return boxes without values."""
        people = len(tree.person)
        return cls(
            np.empty((vertices, 3)),
            np.empty((int(tree.node[-1]), 6)),
            np.empty(len(tree.order), dtype=np.uint8),
            np.empty(people),
            np.empty((people, 2), dtype=np.int64),
            np.empty((people, 2)),
        )


@kernel
def _is_flat(points: Floats, corner: NDArray[np.int32], size: float) -> bool:
    """Return whether a triangle is seen edge-on, has no area or is not finite, see ``FLAT``."""
    a, b, c = points[corner[0]], points[corner[1]], points[corner[2]]
    ex, ey, ez = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    fx, fy, fz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    nx, ny, nz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
    longest = 4.0 * max(abs(ex), abs(ey), abs(ez), abs(fx), abs(fy), abs(fz))
    volume = abs(a[0] * nx + a[1] * ny + a[2] * nz)
    return not FLAT * size * size * longest <= volume < math.inf


@kernel
def _fit_leaf(first: int, last: int, tree: SkinTree, boxes: SkinBoxes, out: Floats) -> None:
    """Write the box of the triangles in some slots."""
    lx, ly, lz, hx, hy, hz = math.inf, math.inf, math.inf, -math.inf, -math.inf, -math.inf
    for slot in range(first, last):
        corner = tree.corner[slot]
        a, b, c = boxes.points[corner[0]], boxes.points[corner[1]], boxes.points[corner[2]]
        x, y, z = min(a[0], b[0], c[0]), min(a[1], b[1], c[1]), min(a[2], b[2], c[2])
        u, v, w = max(a[0], b[0], c[0]), max(a[1], b[1], c[1]), max(a[2], b[2], c[2])
        size = max(-x, -y, -z, u, v, w)
        if _is_flat(boxes.points, corner, size):
            boxes.state[tree.order[slot]] = EDGE_ON
        else:
            boxes.state[tree.order[slot]] = IN_BOX
            lx, ly, lz = min(lx, x), min(ly, y), min(lz, z)
            hx, hy, hz = max(hx, u), max(hy, v), max(hz, w)
    pad = PAD * max(-lx, -ly, -lz, hx, hy, hz)
    if lx > hx:
        pad = 0.0
    out[0], out[1], out[2] = lx - pad, ly - pad, lz - pad
    out[3], out[4], out[5] = hx + pad, hy + pad, hz + pad


@kernel
def _fit_person(p: int, tree: SkinTree, boxes: SkinBoxes) -> None:
    """Fit all boxes of a person, from the leaves to the root."""
    begin, size, leaves, node = tree.begin[p], tree.begin[p + 1] - tree.begin[p], tree.leaves[p], tree.node[p]
    for leaf in range(leaves):
        first, last = begin + leaf * size // leaves, begin + (leaf + 1) * size // leaves
        _fit_leaf(first, last, tree, boxes, boxes.box[node + leaves + leaf])
    for i in range(leaves - 1, 0, -1):
        out, one, two = boxes.box[node + i], boxes.box[node + 2 * i], boxes.box[node + 2 * i + 1]
        for c in range(3):
            out[c], out[3 + c] = min(one[c], two[c]), max(one[3 + c], two[3 + c])


@kernel
def _survey(p: int, tree: SkinTree, boxes: SkinBoxes, limit: float, beams: Beams) -> None:
    """Write the distance and the window of a person, from the range of all their vertices."""
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for v in range(tree.low[p], tree.high[p] + 1):
        for c in range(3):
            value = boxes.points[v, c]
            if abs(value) < np.inf:
                low[c], high[c] = min(low[c], value), max(high[c], value)
    boxes.gap[p] = np.inf
    if not (low[0] <= high[0] and low[1] <= high[1] and low[2] <= high[2]):
        return
    pad = 2.0 * PAD * max(-low.min(), high.max())
    corner, away, flat = np.empty((8, 3)), 0.0, 0.0
    for c in range(3):
        low[c] -= pad
        high[c] += pad
        beside = max(0.0, low[c], -high[c])
        away += beside * beside
        flat += beside * beside if c < 2 else 0.0
        for k in range(8):
            corner[k, c] = high[c] if (k >> c) & 1 else low[c]
    if flat > 0.0 and not sees_hull(corner, 8, limit, beams):
        return
    first, last, start, width = 0, beams.rows - 1, 0.0, TURN
    if flat > 0.0:
        first, last, start, width = hull_cells(corner, 8, beams)
    boxes.rows[p, 0], boxes.rows[p, 1] = first, last
    boxes.span[p, 0], boxes.span[p, 1] = start, width
    boxes.gap[p] = math.sqrt(away)


@kernel
def _turn_points(begin: int, end: int, vertices: Floats, place: Floats, turn: Floats, points: Floats) -> None:
    """Write some vertices in the sensor frame."""
    x, y, z = place[0], place[1], place[2]
    for v in range(begin, end):
        px, py, pz = vertices[v, 0] - x, vertices[v, 1] - y, vertices[v, 2] - z
        points[v, 0] = turn[0, 0] * px + turn[1, 0] * py + turn[2, 0] * pz
        points[v, 1] = turn[0, 1] * px + turn[1, 1] * py + turn[2, 1] * pz
        points[v, 2] = turn[0, 2] * px + turn[1, 2] * py + turn[2, 2] * pz


@kernel
def _fit_if_seen(
    p: int, tree: SkinTree, active: NDArray[np.bool_], limit: float, beams: Beams, boxes: SkinBoxes
) -> None:
    """Fit the boxes of a person who may be seen, otherwise mark all triangles as absent."""
    who = tree.person[p]
    boxes.gap[p] = np.inf
    if who < 0 or (who < len(active) and active[who]):
        _survey(p, tree, boxes, limit, beams)
    if boxes.gap[p] < np.inf:
        _fit_person(p, tree, boxes)
    else:
        for slot in range(tree.begin[p], tree.begin[p + 1]):
            boxes.state[tree.order[slot]] = ABSENT


@kernel(parallel=True)
def fit_boxes(
    tree: SkinTree, vertices: Floats, active: NDArray[np.bool_], place: Floats, turn: Floats, limit: float,
    beams: Beams, boxes: SkinBoxes,
) -> None:  # fmt: skip
    """Bring the vertices ``[V, 3]`` into the sensor frame, and fit the boxes of the people who may be seen."""
    # a parallel loop may only call: the compiler takes what it writes into a tuple of arrays for unused
    for chunk in prange((len(vertices) + CHUNK - 1) // CHUNK):
        end = min(len(vertices), (chunk + 1) * CHUNK)
        _turn_points(chunk * CHUNK, end, vertices, place, turn, boxes.points)
    for p in prange(len(tree.person)):
        who: Any = np.int64(p)
        _fit_if_seen(who, tree, active, limit, beams, boxes)


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

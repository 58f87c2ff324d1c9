"""Boxes of the trees of skins, fitted to the vertices in the sensor frame, and what a sensor can see of them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel, prange
from crowdbot.sensors.beams import TURN, Beams, hull_cells, sees_hull
from crowdbot.typing import Floats, Ints

from .skin_tree import SkinTree

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
        _fit_if_seen(p, tree, active, limit, beams, boxes)

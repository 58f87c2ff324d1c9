"""Kernels of the rasteriser: projection, binning and coverage of triangles with homogeneous edge functions.

They use sums, products, quotients and square roots only, which IEEE 754 rounds in one way: the same triangles give the
same pixels on every machine.

Source of the edge functions: Olano and Greer 1997, Triangle Scan Conversion using 2D Homogeneous Coordinates,
doi:10.1145/258694.258723.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel, prange
from crowdbot.typing import Floats, Ints

Labels = NDArray[np.int32]
Depths = NDArray[np.float32]
BAND = 16
"""Rows of pixels that one thread draws at a time."""
SLIVER = 1e-14


@kernel
def _edges(m: Floats, out: Floats) -> float:
    """Write the coefficients of the edge functions of three projected points ``m [3, 3]``; return the determinant."""
    out[0, 0] = m[1, 1] * m[2, 2] - m[1, 2] * m[2, 1]
    out[0, 1] = m[1, 2] * m[2, 0] - m[1, 0] * m[2, 2]
    out[0, 2] = m[1, 0] * m[2, 1] - m[1, 1] * m[2, 0]
    out[1, 0] = m[2, 1] * m[0, 2] - m[2, 2] * m[0, 1]
    out[1, 1] = m[2, 2] * m[0, 0] - m[2, 0] * m[0, 2]
    out[1, 2] = m[2, 0] * m[0, 1] - m[2, 1] * m[0, 0]
    out[2, 0] = m[0, 1] * m[1, 2] - m[0, 2] * m[1, 1]
    out[2, 1] = m[0, 2] * m[1, 0] - m[0, 0] * m[1, 2]
    out[2, 2] = m[0, 0] * m[1, 1] - m[0, 1] * m[1, 0]
    det: float = m[0, 0] * out[0, 0] + m[0, 1] * out[0, 1] + m[0, 2] * out[0, 2]
    if det > SLIVER or det < -SLIVER:
        for i in range(3):
            for k in range(3):
                out[i, k] /= det
    return det


@kernel
def _box(m: Floats, near: float, width: int, height: int, box: Ints) -> None:
    """Write the pixels ``x0, x1, y0, y1`` (ends excluded) that the part of a triangle beyond ``near`` can touch."""
    low_x, low_y, high_x, high_y = 1e18, 1e18, -1e18, -1e18
    for i in range(3):
        j = (i + 1) % 3
        for part in range(2):
            x, y, w = m[i, 0], m[i, 1], m[i, 2]
            if part == 1:
                if (m[i, 2] >= near) == (m[j, 2] >= near):
                    continue
                share = (near - m[i, 2]) / (m[j, 2] - m[i, 2])
                x, y, w = x + share * (m[j, 0] - x), y + share * (m[j, 1] - y), near
            if w < near:
                continue
            low_x, high_x = min(low_x, x / w), max(high_x, x / w)
            low_y, high_y = min(low_y, y / w), max(high_y, y / w)
    box[0], box[1], box[2], box[3] = 0, 0, 0, 0
    if high_x < 0.0 or high_y < 0.0 or low_x > width or low_y > height or low_x > high_x:
        return
    box[0], box[1] = int(max(low_x, 0.0)), int(min(high_x + 1.0, float(width)))
    box[2], box[3] = int(max(low_y, 0.0)), int(min(high_y + 1.0, float(height)))


@kernel(parallel=True)
def project(
    vertex: Floats, faces: Ints, closed: NDArray[np.bool_], camera: Floats, near: float, width: int, height: int,
    edges: Floats, box: Ints,
) -> None:  # fmt: skip
    """Write edge functions ``[T, 3, 3]`` and pixel boxes ``[T, 4]`` of triangles; a box is empty if it is not seen.

    ``camera [4, 3]`` has the position and the axes that give column, row (times depth) and depth. Triangles of closed
    surfaces that face away are left out.
    """
    for chunk in prange((len(faces) + 511) // 512):
        m = np.empty((3, 3))
        for t in range(chunk * 512, min(len(faces), chunk * 512 + 512)):
            box[t, 1] = 0
            box[t, 0] = 0
            deepest = -1.0
            for i in range(3):
                v = faces[t, i]
                x, y, z = vertex[v, 0] - camera[0, 0], vertex[v, 1] - camera[0, 1], vertex[v, 2] - camera[0, 2]
                for k in range(3):
                    m[i, k] = camera[k + 1, 0] * x + camera[k + 1, 1] * y + camera[k + 1, 2] * z
                deepest = max(deepest, m[i, 2])
            if deepest < near:
                continue
            det = _edges(m, edges[t])
            if -SLIVER <= det <= SLIVER or (closed[t] and det > 0.0):
                continue
            _box(m, near, width, height, box[t])


@kernel
def bin_triangles(box: Ints, bands: int) -> tuple[Ints, Ints]:
    """Return the triangles that touch each band of rows: the start of each band ``[bands + 1]``, and their numbers."""
    first = np.zeros(bands + 1, dtype=np.int64)
    for t in range(len(box)):
        if box[t, 1] > box[t, 0] and box[t, 3] > box[t, 2]:
            for b in range(box[t, 2] // BAND, (box[t, 3] - 1) // BAND + 1):
                first[b + 1] += 1
    for b in range(bands):
        first[b + 1] += first[b]
    fill, found = first[:-1].copy(), np.empty(first[-1], dtype=np.int64)
    for t in range(len(box)):
        if box[t, 1] > box[t, 0] and box[t, 3] > box[t, 2]:
            for b in range(box[t, 2] // BAND, (box[t, 3] - 1) // BAND + 1):
                found[fill[b]] = t
                fill[b] += 1
    return first, found


@kernel(parallel=True)
def start_depth(plane: Floats, far: float, samples: Floats, floor: int, depth: Depths, who: Labels) -> None:
    """Fill the buffers ``[H, W, S]`` with the floor (``1 / depth`` is ``plane . (x, y, 1)``) or with nothing."""
    for y in prange(depth.shape[0]):
        for x in range(depth.shape[1]):
            for s in range(depth.shape[2]):
                inverse = plane[0] * (x + samples[s, 0]) + plane[1] * (y + samples[s, 1]) + plane[2]
                seen = inverse * far > 1.0
                depth[y, x, s] = inverse if seen else 1.0 / far
                who[y, x, s] = floor if seen else -1


@kernel(inline=True)
def _cover_one(
    t: int, e: Floats, box: Ints, first: int, last: int, most: float, offset: Floats, depth: Depths, who: Labels
) -> None:
    """Draw a triangle into the rows from ``first`` to ``last``."""
    count = depth.shape[2]
    a0, b0, c0 = e[0, 0], e[0, 1], e[0, 2]
    a1, b1, c1 = e[1, 0], e[1, 1], e[1, 2]
    a2, b2, c2 = e[2, 0], e[2, 1], e[2, 2]
    for y in range(max(box[2], first), min(box[3], last)):
        r0, r1, r2 = b0 * y + c0, b1 * y + c1, b2 * y + c2
        begin, end = box[0], box[1]
        if end - begin > 12:
            low, high = float(begin), float(end)
            for i in range(3):
                a, rest = e[i, 0], e[i, 1] * y + e[i, 2]
                slack = max(0.0, e[i, 1])
                if a > 0.0:
                    low = max(low, -(rest + slack) / a - 1.0)
                elif a < 0.0:
                    high = min(high, -(rest + slack) / a + 1.0)
            begin, end = max(begin, int(min(low, 1e6))), min(end, int(max(high, -1.0)) + 1)
        for x in range(begin, end):
            f0, f1, f2 = a0 * x + r0, a1 * x + r1, a2 * x + r2
            for s in range(count):
                g0, g1, g2 = f0 + offset[0, s], f1 + offset[1, s], f2 + offset[2, s]
                if g0 >= 0.0 and g1 >= 0.0 and g2 >= 0.0:
                    inverse = np.float32(g0 + g1 + g2)
                    if depth[y, x, s] < inverse <= most:
                        depth[y, x, s] = inverse
                        who[y, x, s] = t


@kernel(parallel=True)
def cover(
    edges: Floats, box: Ints, first: Ints, found: Ints, near: float, samples: Floats, depth: Depths, who: Labels
) -> None:
    """Draw triangles into the buffers of inverse depth and of triangle numbers ``[H, W, S]``."""
    for band in prange(len(first) - 1):
        offset = np.empty((3, depth.shape[2]))
        for k in range(first[band], first[band + 1]):
            t = found[k]
            for i in range(3):
                for s in range(depth.shape[2]):
                    offset[i, s] = edges[t, i, 0] * samples[s, 0] + edges[t, i, 1] * samples[s, 1]
            last = min((band + 1) * BAND, depth.shape[0])
            _cover_one(t, edges[t], box[t], band * BAND, last, 1.0 / near, offset, depth, who)


@kernel
def vertex_normals(points: Floats, faces: Ints, out: Floats) -> None:
    """Write unit normals ``[V, 3]`` of vertices, weighted by area; up for vertices without faces."""
    out[:] = 0.0
    for t in range(len(faces)):
        i, j, k = faces[t, 0], faces[t, 1], faces[t, 2]
        ux, uy, uz = points[j, 0] - points[i, 0], points[j, 1] - points[i, 1], points[j, 2] - points[i, 2]
        vx, vy, vz = points[k, 0] - points[i, 0], points[k, 1] - points[i, 1], points[k, 2] - points[i, 2]
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        for c in range(3):
            v = faces[t, c]
            out[v, 0] += nx
            out[v, 1] += ny
            out[v, 2] += nz
    for v in range(len(out)):
        size = np.sqrt(out[v, 0] ** 2 + out[v, 1] ** 2 + out[v, 2] ** 2)
        if size > 1e-12:
            for c in range(3):
                out[v, c] /= size
        else:
            out[v, 2] = 1.0


@kernel(parallel=True)
def place_shapes(
    corner: Floats, slope: Floats, starts: Ints, turn: Floats, place: Floats, vertex: Floats, normal: Floats
) -> None:
    """Write corners and normals of rigid shapes in the world; shape k has the triangles from ``starts[k]`` on."""
    for k in prange(len(turn)):
        for v in range(3 * starts[k], 3 * starts[k + 1]):
            for r in range(3):
                a, b, c = turn[k, r, 0], turn[k, r, 1], turn[k, r, 2]
                vertex[v, r] = a * corner[v, 0] + b * corner[v, 1] + c * corner[v, 2] + place[k, r]
                normal[v, r] = a * slope[v, 0] + b * slope[v, 1] + c * slope[v, 2]

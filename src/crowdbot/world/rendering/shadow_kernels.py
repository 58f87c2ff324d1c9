"""Kernels of the shadow map: the distance of the first surface along the direction of the light."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel, prange
from crowdbot.typing import Floats, Ints

from .raster_kernels import BAND

BLOCK = 8
"""Side [pixels] of the blocks of the shadow map whose limits are known; at least the softest edge of a shadow."""


@kernel(parallel=True)
def project_shadow(
    vertex: Floats, faces: Ints, closed: NDArray[np.bool_], axes: Floats, size: int, plane: Floats, box: Ints
) -> None:
    """Write edge functions and depth of triangles ``plane [T, 4, 3]``, and pixel boxes ``[T, 4]``.

    Triangles of closed surfaces that face away from the light are left out.
    ``axes``: origin, then the axes that give column, row and depth [m] of a point.
    """
    for chunk in prange((len(faces) + 511) // 512):
        p = np.empty((3, 3))
        for t in range(chunk * 512, min(len(faces), chunk * 512 + 512)):
            box[t, :] = 0
            for i in range(3):
                v = faces[t, i]
                x, y, z = vertex[v, 0] - axes[0, 0], vertex[v, 1] - axes[0, 1], vertex[v, 2] - axes[0, 2]
                for k in range(3):
                    p[i, k] = axes[k + 1, 0] * x + axes[k + 1, 1] * y + axes[k + 1, 2] * z
            area = (p[1, 0] - p[0, 0]) * (p[2, 1] - p[0, 1]) - (p[2, 0] - p[0, 0]) * (p[1, 1] - p[0, 1])
            if -1e-9 < area < 1e-9 or (closed[t] and area > 0.0):
                continue
            for i in range(3):
                j, k = (i + 1) % 3, (i + 2) % 3
                plane[t, i, 0] = (p[j, 1] - p[k, 1]) / area
                plane[t, i, 1] = (p[k, 0] - p[j, 0]) / area
                plane[t, i, 2] = (p[j, 0] * p[k, 1] - p[k, 0] * p[j, 1]) / area
            for k in range(3):
                plane[t, 3, k] = plane[t, 0, k] * p[0, 2] + plane[t, 1, k] * p[1, 2] + plane[t, 2, k] * p[2, 2]
            low_x, high_x = min(p[0, 0], p[1, 0], p[2, 0]), max(p[0, 0], p[1, 0], p[2, 0])
            low_y, high_y = min(p[0, 1], p[1, 1], p[2, 1]), max(p[0, 1], p[1, 1], p[2, 1])
            if high_x < 0.0 or high_y < 0.0 or low_x > size or low_y > size:
                continue
            box[t, 0], box[t, 1] = int(max(low_x, 0.0)), int(min(high_x + 1.0, float(size)))
            box[t, 2], box[t, 3] = int(max(low_y, 0.0)), int(min(high_y + 1.0, float(size)))


@kernel(parallel=True)
def cover_shadow(
    plane: Floats, box: Ints, first: Ints, found: Ints, out: NDArray[np.float32], block: NDArray[np.float32]
) -> None:
    """Write the smallest depth of the triangles at the centre of each pixel ``[S, S]``, and its limits in blocks."""
    for band in prange(len(first) - 1):
        begin, end = band * BAND, min((band + 1) * BAND, out.shape[0])
        out[begin:end] = np.inf
        for n in range(first[band], first[band + 1]):
            t = found[n]
            for y in range(max(begin, box[t, 2]), min(end, box[t, 3])):
                v = y + 0.5
                r0 = plane[t, 0, 1] * v + plane[t, 0, 2]
                r1 = plane[t, 1, 1] * v + plane[t, 1, 2]
                r2 = plane[t, 2, 1] * v + plane[t, 2, 2]
                for x in range(box[t, 0], box[t, 1]):
                    u = x + 0.5
                    if plane[t, 0, 0] * u + r0 < 0.0 or plane[t, 1, 0] * u + r1 < 0.0 or plane[t, 2, 0] * u + r2 < 0.0:
                        continue
                    deep = np.float32(plane[t, 3, 0] * u + plane[t, 3, 1] * v + plane[t, 3, 2])
                    out[y, x] = min(out[y, x], deep)
        for row in range(begin // BLOCK, end // BLOCK):
            for column in range(out.shape[1] // BLOCK):
                low, high = np.float32(np.inf), np.float32(-np.inf)
                for y in range(row * BLOCK, (row + 1) * BLOCK):
                    for x in range(column * BLOCK, (column + 1) * BLOCK):
                        low, high = min(low, out[y, x]), max(high, out[y, x])
                block[row, column, 0], block[row, column, 1] = low, high


@kernel(parallel=True)
def spread_limits(block: NDArray[np.float32], out: NDArray[np.float32]) -> None:
    """Write the limits ``[S / 8, S / 8, 2]`` of the depth in each block and those around it."""
    count = len(block)
    for row in prange(count):
        for column in range(count):
            low, high = np.float32(np.inf), np.float32(-np.inf)
            for y in range(max(0, row - 1), min(count, row + 2)):
                for x in range(max(0, column - 1), min(count, column + 2)):
                    low, high = min(low, block[y, x, 0]), max(high, block[y, x, 1])
            out[row, column, 0], out[row, column, 1] = low, high

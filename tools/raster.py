"""Draw triangles with a depth buffer, shaded by one light."""

from __future__ import annotations

import numpy as np
from numba import njit

FINER = 2
"""Pixels are averaged over so many in a row and column."""


def drawn(
    triangles: np.ndarray,
    colors: np.ndarray,
    normals: np.ndarray,
    azimuth: float,
    elevation: float,
    scale: float,
    margin: float = 0.08,
) -> np.ndarray:
    """Image ``[H, W, 3]`` (uint8) of triangles ``[M, 3, 3]`` [m] with colours ``[M, 3]``, seen from far away.

    Args:
        triangles, colors: what is drawn; those that are turned away are not.
        normals: ``[M, 3, 3]`` of the corners, which shade.
        azimuth, elevation: where the eye is [rad].
        scale: pixels per metre.
        margin: around what is drawn [m].
    """
    eye = np.array([np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation), np.sin(elevation)])
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    up = np.cross(eye, right)
    light = eye + 0.8 * up - 0.4 * right
    light /= np.linalg.norm(light)
    flat = np.stack([triangles @ right, triangles @ up, triangles @ eye], axis=-1)
    low, high = flat[..., :2].min((0, 1)) - margin, flat[..., :2].max((0, 1)) + margin
    scale *= FINER
    size = np.ceil((high - low) * scale / FINER).astype(int) * FINER
    shade = 0.42 + 0.5 * np.clip(normals @ light, 0.0, 1.0) + 0.12 * np.clip(normals[..., 2], 0.0, 1.0)
    image = np.ones((size[1], size[0], 3))
    depth = np.full((size[1], size[0]), -np.inf)
    _fill((flat - np.append(low, 0.0)) * [scale, scale, 1.0], colors, shade, image, depth)
    small = image[::-1].reshape(size[1] // FINER, FINER, size[0] // FINER, FINER, 3).mean(axis=(1, 3))
    return np.round(255.0 * small).astype(np.uint8)


def corner_normals(vertex: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Smooth normals ``[F, 3, 3]`` of the corners of faces; vertices at the same place are one."""
    a, b, c = (vertex[faces[:, k]] for k in range(3))
    flat = np.cross(b - a, c - a)
    _, same = np.unique(np.round(vertex, 4), axis=0, return_inverse=True)
    same = same.ravel()
    total = np.zeros((same.max() + 1, 3))
    for k in range(3):
        np.add.at(total, same[faces[:, k]], flat)
    total /= np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-12)
    return total[same][faces]


@njit(cache=False)
def _fill(points, colors, shade, image, depth):
    for m in range(len(points)):
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = points[m, 0], points[m, 1], points[m, 2]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if area <= 1e-12:
            continue
        for y in range(max(0, int(min(ay, by, cy))), min(len(depth) - 1, int(max(ay, by, cy)) + 1) + 1):
            for x in range(max(0, int(min(ax, bx, cx))), min(depth.shape[1] - 1, int(max(ax, bx, cx)) + 1) + 1):
                px, py = x + 0.5, y + 0.5
                u = ((bx - px) * (cy - py) - (by - py) * (cx - px)) / area
                v = ((cx - px) * (ay - py) - (cy - py) * (ax - px)) / area
                w = 1.0 - u - v
                if u < -1e-9 or v < -1e-9 or w < -1e-9:
                    continue
                z = u * az + v * bz + w * cz
                if z > depth[y, x]:
                    depth[y, x] = z
                    light = u * shade[m, 0] + v * shade[m, 1] + w * shade[m, 2]
                    image[y, x] = np.minimum(colors[m] * light, 1.0)

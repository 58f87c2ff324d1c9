"""Coarse meshes as thick as fine ones: thinning alone makes limbs thin, as its vertices lie on the fine surface."""

from __future__ import annotations

import numpy as np


def normals(place: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Unit normals ``[..., V, 3]`` of vertices."""
    a, b, c = (place[..., faces[:, k], :] for k in range(3))
    flat = np.cross(b - a, c - a)
    out = np.zeros_like(place)
    for k in range(3):
        for p in range(len(place)) if place.ndim == 3 else [...]:
            np.add.at(out[p], faces[:, k], flat[p])
    return out / np.maximum(np.linalg.norm(out, axis=-1, keepdims=True), 1e-12)


def thicker(fine: np.ndarray, place: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """How far ``[V]`` vertices of a coarse mesh move outward until the fine points lie on it on average."""
    found = np.zeros(len(place))
    for _ in range(4):
        face, gap = nearest(fine, place + found[:, None] * normals(place, faces), faces)
        total, count = np.zeros(len(place)), np.full(len(place), 1e-9)
        for corner in range(3):
            np.add.at(total, faces[face, corner], gap)
            np.add.at(count, faces[face, corner], 1.0)
        found += 0.8 * np.clip(total / count, -0.02, 0.02)
    return np.clip(found, -0.004, 0.03)


def nearest(points: np.ndarray, vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The nearest face of every point, and the distance to it, above 0 outside."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    face, gap = np.zeros(len(points), dtype=np.int64), np.zeros(len(points))
    for first in range(0, len(points), 256):
        part = points[first : first + 256, None]
        away = np.min(
            [_to_plane(part, a, b, c), _to_edge(part, a, b), _to_edge(part, b, c), _to_edge(part, c, a)], axis=0
        )
        best = away.argmin(axis=1)
        rows = np.arange(len(best))
        side = np.sign(((part[:, 0] - a[best]) * normal[best]).sum(-1))
        face[first : first + 256], gap[first : first + 256] = best, side * away[rows, best]
    return face, gap


def _to_plane(p: np.ndarray, a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Distance to the inside of every triangle, infinite where the foot point lies outside."""
    ab, ac, ap = b - a, c - a, p - a
    d00, d01, d11 = (ab * ab).sum(-1), (ab * ac).sum(-1), (ac * ac).sum(-1)
    d1, d2 = (ap * ab).sum(-1), (ap * ac).sum(-1)
    whole = d00 * d11 - d01**2 + 1e-18
    v, w = (d11 * d1 - d01 * d2) / whole, (d00 * d2 - d01 * d1) / whole
    away = np.linalg.norm(ap - v[..., None] * ab - w[..., None] * ac, axis=-1)
    return np.where((v >= 0) & (w >= 0) & (v + w <= 1), away, np.inf)


def _to_edge(p: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    edge = b - a
    t = np.clip(((p - a) * edge).sum(-1) / ((edge**2).sum(-1) + 1e-18), 0.0, 1.0)
    return np.linalg.norm(p - a - t[..., None] * edge, axis=-1)

"""Levels of detail of a character: dense meshes by clusters of points, coarser levels edge by edge.

Source of the clusters: Rossignac and Borrel 1993, Multi-resolution 3D approximations for rendering complex scenes,
doi:10.1007/978-3-642-78114-8_29.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.humans.asset import shapes
from crowdbot.typing import Floats, Ints

from .edge_collapse import EdgeCollapse
from .rigged_body import RiggedLevel

TRIANGLES = (30_000, 3000, 900)
"""Largest number of triangles of each level of detail."""
DENSE = 10_000
"""Largest number of triangles from which edges are collapsed."""
FINEST, COARSEST = 1e-4, 0.3
"""Edges of the cells [m]."""
INFLUENCES = 4
FACE = 6.0
"""Weight of the triangles of the head."""


class _Mesh(NamedTuple):
    """Points ``[V, 3]``, shares of bones ``[V, 28]``, triangles ``[F, 3]``, uv of corners ``[F, 3, 2]``, closed."""

    points: Floats
    weights: Floats
    faces: Ints
    uv: Floats
    closed: NDArray[np.bool_]


def detail_levels(
    vertices: Floats, weights: Floats, faces: Ints, uv: Floats, closed: NDArray[np.bool_]
) -> tuple[RiggedLevel, ...]:
    """Return the levels of detail of a mesh, the finest first.

    Args:
        vertices: ``[V, 3]`` [m].
        weights: shares of the bones ``[V, 28]``.
        faces: ``[F, 3]``.
        uv: texture coordinates of the corners ``[F, 3, 2]``.
        closed: whether the back of a triangle is never seen ``[F]``.
    """
    whole = _Mesh(vertices, weights, faces, uv, closed)
    finest = _thinned(whole, TRIANGLES[0])
    base = _thinned(finest, DENSE)
    if not len(base.faces):
        return tuple(_level(base) for _ in TRIANGLES)
    chart, wedge = _charts(base)
    care = np.where(np.argmax(base.weights, axis=1) == shapes().bone("head"), FACE, 1.0)
    thinning = EdgeCollapse(base.points, base.faces, chart, care)
    found = [_level(finest)]
    for most in TRIANGLES[1:]:
        thinning.collapse(most)
        order, corners = thinning.remaining()
        rows = zip(chart[order].tolist(), corners.tolist(), strict=True)
        coordinates = np.array([[wedge[part, v] for v in face] for part, face in rows])
        now = _Mesh(base.points, base.weights, corners, coordinates.reshape(-1, 3, 2), base.closed[order])
        found.append(_level(_thinned(now, most)))
    return tuple(found)


def _charts(mesh: _Mesh) -> tuple[Ints, dict[tuple[int, int], Floats]]:
    """Return the connected part of the texture of each triangle ``[F]``, and the coordinates of points in each part."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    rounded = np.round(mesh.uv.reshape(-1, 2) * 8192.0).astype(np.int64)
    corner = np.unique(np.column_stack([mesh.faces.ravel(), rounded]), axis=0, return_inverse=True)[1].reshape(-1, 3)
    ends = np.concatenate([corner[:, :2], corner[:, 1:]])
    count = int(corner.max()) + 1
    graph = coo_array((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(count, count))
    chart = connected_components(graph, directed=False)[1].astype(np.int64)[corner[:, 0]]
    wedge: dict[tuple[int, int], Floats] = {}
    for part, face, uv in zip(chart.tolist(), mesh.faces.tolist(), mesh.uv, strict=True):
        for k in range(3):
            wedge.setdefault((part, face[k]), uv[k])
    return chart, wedge


def _thinned(mesh: _Mesh, most: int) -> _Mesh:
    """Return a mesh with points of the same place as one, and at most ``most`` triangles by clusters."""
    main = np.argmax(mesh.weights, axis=1)
    low, high = FINEST, COARSEST
    nearest, kept = _clustered(mesh.points, main, mesh.faces, low)
    if len(kept) > most:
        for _ in range(12):
            middle = float(np.sqrt(low * high))
            if len(_clustered(mesh.points, main, mesh.faces, middle)[1]) > most:
                low = middle
            else:
                high = middle
        nearest, kept = _clustered(mesh.points, main, mesh.faces, high)
    rows, renamed = np.unique(nearest[mesh.faces[kept]], return_inverse=True)
    faces = renamed.reshape(-1, 3).astype(np.int64)
    return _Mesh(mesh.points[rows], mesh.weights[rows], faces, mesh.uv[kept], mesh.closed[kept])


def _level(mesh: _Mesh) -> RiggedLevel:
    bones, shares = _strongest(mesh.weights)
    return RiggedLevel(mesh.points, mesh.faces, mesh.uv, bones, shares, mesh.closed)


def _clustered(vertices: Floats, main: Ints, faces: Ints, size: float) -> tuple[Ints, Ints]:
    """Return the point ``[V]`` that stands for each point with cells of a size [m], and the triangles that remain."""
    cell = np.floor(vertices / size + 0.5).astype(np.int64)
    group = np.unique(np.concatenate([cell, main[:, None]], axis=1), axis=0, return_inverse=True)[1].reshape(-1)
    count = np.bincount(group)
    mean = np.stack([np.bincount(group, column) for column in vertices.T], axis=1) / count[:, None]
    order = np.lexsort((np.sum((vertices - mean[group]) ** 2, axis=1), group))
    nearest = order[np.searchsorted(group[order], np.arange(len(count)))][group]
    return nearest, _kept(vertices, faces, nearest[faces])


def _kept(vertices: Floats, faces: Ints, corners: Ints) -> Ints:
    """Return the triangles that keep three different corners and their direction, each once, the largest first."""
    a, b, c = corners.T
    before, after = (np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]) for p in (vertices[faces], vertices[corners]))
    same = np.sum(before * after, axis=1) > 0.0
    whole = np.flatnonzero((a != b) & (b != c) & (a != c) & same)
    whole = whole[np.argsort(-np.sum(before[whole] ** 2, axis=1), kind="stable")]
    first = np.unique(np.sort(corners[whole], axis=1), axis=0, return_index=True)[1]
    return np.sort(whole[first])


def _strongest(weights: Floats) -> tuple[Ints, Floats]:
    """Return the bones ``[V, 4]`` with the largest weights, and these with the sum 1."""
    bones = np.argsort(-weights, axis=1, kind="stable")[:, :INFLUENCES]
    shares = np.take_along_axis(weights, bones, axis=1)
    return bones.astype(np.int64), shares / np.maximum(shares.sum(axis=1, keepdims=True), 1e-9)

"""Levels of detail of a character.

Source: Garland and Heckbert 1997, Surface simplification using quadric error metrics, doi:10.1145/258734.258849.

Source of the clusters: Rossignac and Borrel 1993, Multi-resolution 3D approximations for rendering complex scenes,
doi:10.1007/978-3-642-78114-8_29.
"""

from __future__ import annotations

import heapq
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.humans.asset import shapes
from crowdbot.typing import Floats, Ints

from .rigged_body import RiggedLevel

Point = tuple[float, ...]
BORDER = 30.0
"""Weight of planes that hold the lines between labels, over those of the faces."""


class EdgeCollapse:
    """Moves points into neighbours, so that all that stay are old ones.

    Lines between labels and open borders are held: their points move along them only, ends and forks stay.

    Args:
        points: ``[V, 3]`` [m].
        faces: ``[F, 3]``.
        label: label of each triangle ``[F]``.
        care: weight of the faces of each point ``[V]``.
    """

    def __init__(self, points: Floats, faces: Ints, label: Ints, care: Floats) -> None:
        self.p: list[Point] = [tuple(x) for x in points.tolist()]
        self.faces: dict[int, list[int]] = dict(enumerate(faces.tolist()))
        self.label: list[int] = label.tolist()
        self.of: list[set[int]] = [set() for _ in self.p]
        for f, face in self.faces.items():
            for v in face:
                self.of[v].add(f)
        self.line: list[set[int]] = [set() for _ in self.p]
        self.quadric: list[Point] = [tuple(q) for q in self._quadrics(points, faces, care).tolist()]
        self.version = [0] * len(self.p)
        self.heap: list[tuple[float, int, int, int, int]] = []
        for v in range(len(self.p)):
            self._push(v)

    def _quadrics(self, points: Floats, faces: Ints, care: Floats) -> Floats:
        """Return the quadrics ``[V, 10]`` of all points, and note the lines that are held."""
        quadrics = np.zeros((len(points), 10))
        a, b, c = (points[faces[:, k]] for k in range(3))
        normal = np.cross(b - a, c - a)
        size = np.linalg.norm(normal, axis=1, keepdims=True)
        normal = normal / np.maximum(size, 1e-12)
        for k in range(3):
            weight = size[:, 0] * care[faces[:, k]]
            np.add.at(quadrics, faces[:, k], weight[:, None] * _planes(normal, a))
        edges: dict[tuple[int, int], list[int]] = {}
        for f, face in self.faces.items():
            for k in range(3):
                i, j = face[k], face[(k + 1) % 3]
                edges.setdefault((min(i, j), max(i, j)), []).append(f)
        for (i, j), own in edges.items():
            if len(own) == 2 and self.label[own[0]] == self.label[own[1]]:
                continue
            self.line[i].add(j)
            self.line[j].add(i)
            edge = points[j] - points[i]
            for f in own:
                aside = np.cross(edge, normal[f])
                long = np.linalg.norm(aside)
                if long > 1e-12:
                    plane = _planes((aside / long)[None], points[i][None])[0] * BORDER * float(edge @ edge)
                    quadrics[i] += plane
                    quadrics[j] += plane
        return quadrics

    def _around(self, v: int) -> set[int]:
        return {w for f in self.of[v] for w in self.faces[f]} - {v}

    def _push(self, v: int) -> None:
        """Note the best way of a point into a neighbour."""
        self.version[v] += 1
        fixed = self.line[v]
        if fixed and len(fixed) != 2:
            return
        best = None
        for w in fixed or self._around(v):
            cost = _error(self.quadric[v], self.p[w]) + _error(self.quadric[w], self.p[w])
            far = sum((x - y) ** 2 for x, y in zip(self.p[v], self.p[w], strict=True))
            cost += 1e-9 * far
            if (best is None or cost < best[0]) and self._allowed(v, w):
                best = (cost, w)
        if best is not None:
            heapq.heappush(self.heap, (best[0], v, self.version[v], best[1], self.version[best[1]]))

    def _allowed(self, v: int, w: int) -> bool:
        shared = self.of[v] & self.of[w]
        common = self._around(v) & self._around(w)
        if len(common) != len(shared) or not shared:
            return False  # the surface would close on itself
        if self.line[v] and len(self.line[v] & self.line[w]) > 0:
            return False  # a ring of three stays one
        if any(len(self.of[u]) <= 3 and not self.line[u] for u in common):
            return False
        for f in self.of[v] - shared:
            before = [self.p[u] for u in self.faces[f]]
            after = [self.p[w if u == v else u] for u in self.faces[f]]
            n, m = _cross(before), _cross(after)
            dot = n[0] * m[0] + n[1] * m[1] + n[2] * m[2]
            size = ((n[0] ** 2 + n[1] ** 2 + n[2] ** 2) * (m[0] ** 2 + m[1] ** 2 + m[2] ** 2)) ** 0.5
            if dot < 0.15 * size or size < 1e-18:
                return False
        return True

    def collapse(self, count: int) -> None:
        """Collapse edges until ``count`` triangles are left, or as far as it goes."""
        while len(self.faces) > count and self.heap:
            _, v, own, w, other = heapq.heappop(self.heap)
            if own != self.version[v]:
                continue
            if other != self.version[w] or not self.of[w] or not self._allowed(v, w):
                self._push(v)
                continue
            self._merge(v, w)

    def _merge(self, v: int, w: int) -> None:
        near = self._around(v) | self._around(w)
        for f in self.of[v] & self.of[w]:
            for u in self.faces.pop(f):
                self.of[u].discard(f)
        for f in self.of[v]:
            self.faces[f] = [w if u == v else u for u in self.faces[f]]
            self.of[w].add(f)
        self.of[v] = set()
        self.quadric[w] = tuple(x + y for x, y in zip(self.quadric[v], self.quadric[w], strict=True))
        for u in self.line[v]:
            self.line[u].discard(v)
            if u != w:
                self.line[u].add(w)
                self.line[w].add(u)
        self.line[v] = set()
        self.version[v] += 1
        for u in near | {w}:
            if self.of[u]:
                self._push(u)

    def remaining(self) -> tuple[Ints, Ints]:
        """Return the numbers of the triangles that are left ``[F]``, and their points ``[F, 3]``."""
        order = sorted(self.faces)
        corners = np.array([self.faces[f] for f in order], dtype=np.int64).reshape(-1, 3)
        return np.array(order, dtype=np.int64), corners


def _planes(normal: Floats, point: Floats) -> Floats:
    """Return the quadrics ``[N, 10]`` of planes."""
    a, b, c = normal.T
    d = -(normal * point).sum(axis=1)
    return np.stack([a * a, a * b, a * c, a * d, b * b, b * c, b * d, c * c, c * d, d * d], axis=1)


def _error(q: Point, p: Point) -> float:
    x, y, z = p
    return (
        x * (q[0] * x + 2 * (q[1] * y + q[2] * z + q[3]))
        + y * (q[4] * y + 2 * (q[5] * z + q[6]))
        + z * (q[7] * z + 2 * q[8])
        + q[9]
    )


def _cross(t: list[Point]) -> Point:
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = t
    ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


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

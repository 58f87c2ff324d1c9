"""Meshes for the bodies: cut along lines, thinned out edge by edge, and made as thick again as they were."""

from __future__ import annotations

import heapq
from dataclasses import dataclass, replace

import numpy as np

SNAP = 0.04
"""Cuts this near to the end of an edge, as a share of it, go through its vertex."""
BORDER = 30.0
"""Weight of planes that hold the lines between regions, over those of the faces."""


@dataclass(frozen=True)
class Mesh:
    """``rows [V, K]`` of base vertices with ``shares [V, K]`` each, ``faces [F, 3]`` and regions ``label [F]``."""

    rows: np.ndarray
    shares: np.ndarray
    faces: np.ndarray
    label: np.ndarray

    def of(self, values: np.ndarray) -> np.ndarray:
        """Values of base vertices ``[..., V, C]`` at the vertices of this mesh."""
        return (values[..., self.rows, :] * self.shares[:, :, None]).sum(axis=-2)

    def picked(self, faces: np.ndarray) -> Mesh:
        """The same with these faces only, without the vertices that no face has."""
        used, index = np.unique(self.faces[faces], return_inverse=True)
        return Mesh(self.rows[used], self.shares[used], index.reshape(-1, 3), self.label[faces])


def mesh(quads: np.ndarray, place: np.ndarray, label: int) -> Mesh:
    """Quadrilaterals as triangles, each cut along its shorter diagonal."""
    used, index = np.unique(quads, return_inverse=True)
    q = index.reshape(-1, 4)
    p = place[used]
    short = np.linalg.norm(p[q[:, 0]] - p[q[:, 2]], axis=1) <= np.linalg.norm(p[q[:, 1]] - p[q[:, 3]], axis=1)
    one = np.where(short[:, None], q[:, [0, 1, 2]], q[:, [0, 1, 3]])
    two = np.where(short[:, None], q[:, [0, 2, 3]], q[:, [1, 2, 3]])
    faces = np.concatenate([one, two])
    faces = faces[(faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])]
    rows = np.repeat(used[:, None], 4, axis=1)
    return Mesh(rows, np.tile([1.0, 0.0, 0.0, 0.0], (len(used), 1)), faces, np.full(len(faces), label))


def cut(m: Mesh, value: np.ndarray, old: tuple[int, ...], new: int) -> Mesh:
    """Cut faces of the labels ``old`` along the line where ``value [V]`` is 0; above 0 they become ``new``."""
    sign_of = np.sign(value).astype(int).tolist()
    open_ = np.isin(m.label, old)
    rows, shares = list(m.rows), list(m.shares)
    points: dict[tuple[int, int], int] = {}
    faces, label = [], []

    def between(a: int, b: int) -> int:
        key = (min(a, b), max(a, b))
        if key not in points:
            t = value[key[0]] / (value[key[0]] - value[key[1]])
            row = np.concatenate([m.rows[key[0]], m.rows[key[1]]])
            share = np.concatenate([(1 - t) * m.shares[key[0]], t * m.shares[key[1]]])
            order = np.argsort(-share, kind="stable")[: m.rows.shape[1]]
            rows.append(row[order])
            shares.append(share[order] / share[order].sum())
            points[key] = len(rows) - 1
        return points[key]

    for face, own, may in zip(m.faces.tolist(), m.label.tolist(), open_, strict=True):
        sides = [sign_of[v] for v in face]
        if not may or min(sides) >= 0 or max(sides) <= 0:
            faces.append(face)
            label.append(new if may and max(sides) > 0 else own)
            continue
        for sign in (1, -1):
            ring = []
            for k in range(3):
                a, b = face[k], face[(k + 1) % 3]
                if sides[k] * sign >= 0:
                    ring.append(a)
                if sides[k] * sides[(k + 1) % 3] < 0:
                    ring.append(between(a, b))
            for k in range(1, len(ring) - 1):
                faces.append([ring[0], ring[k], ring[k + 1]])
                label.append(new if sign > 0 else own)
    return Mesh(np.array(rows), np.array(shares), np.array(faces), np.array(label))


def snapped(m: Mesh, value: np.ndarray) -> np.ndarray:
    """The values with those set to 0 that are near to 0 next to an edge that crosses 0, so that no slivers are cut."""
    out = value.copy()
    for a, b in ((0, 1), (1, 2), (2, 0)):
        i, j = m.faces[:, a], m.faces[:, b]
        crosses = value[i] * value[j] < 0
        for p, q in ((i, j), (j, i)):
            near = crosses & (np.abs(value[p]) < SNAP * np.abs(value[p] - value[q]))
            out[p[near]] = 0.0
    return out


class Thinning:
    """Edge by edge thinning (Garland & Heckbert 1997): vertices go into neighbours, so that all that stay are old ones.

    Lines between labels and open borders are held: their vertices move along them only, ends and forks stay.
    """

    def __init__(self, place: np.ndarray, m: Mesh, care: np.ndarray) -> None:
        """``care [V]`` weighs the faces of each vertex."""
        self.p = [tuple(x) for x in place.tolist()]
        self.faces = dict(enumerate(m.faces.tolist()))
        self.label = m.label.tolist()
        self.of: list[set[int]] = [set() for _ in self.p]
        for f, face in self.faces.items():
            for v in face:
                self.of[v].add(f)
        self.q = np.zeros((len(place), 10))
        self.line: list[set[int]] = [set() for _ in self.p]
        self._quadrics(place, m, care)
        self.quadric = [tuple(q) for q in self.q.tolist()]
        self.version = [0] * len(self.p)
        self.heap: list[tuple[float, int, int, int, int]] = []
        for v in range(len(self.p)):
            self._push(v)

    def _quadrics(self, place: np.ndarray, m: Mesh, care: np.ndarray) -> None:
        a, b, c = (place[m.faces[:, k]] for k in range(3))
        normal = np.cross(b - a, c - a)
        size = np.linalg.norm(normal, axis=1, keepdims=True)
        normal = normal / np.maximum(size, 1e-12)
        for k in range(3):
            weight = size[:, 0] * care[m.faces[:, k]]
            np.add.at(self.q, m.faces[:, k], weight[:, None] * _plane(normal, a))
        edges: dict[tuple[int, int], list[int]] = {}
        for f, face in enumerate(m.faces.tolist()):
            for k in range(3):
                i, j = face[k], face[(k + 1) % 3]
                edges.setdefault((min(i, j), max(i, j)), []).append(f)
        for (i, j), own in edges.items():
            if len(own) == 2 and self.label[own[0]] == self.label[own[1]]:
                continue
            self.line[i].add(j)
            self.line[j].add(i)
            edge = place[j] - place[i]
            for f in own:
                aside = np.cross(edge, normal[f])
                long = np.linalg.norm(aside)
                if long > 1e-12:
                    plane = _plane((aside / long)[None], place[i][None])[0] * BORDER * float(edge @ edge)
                    self.q[i] += plane
                    self.q[j] += plane

    def _around(self, v: int) -> set[int]:
        return {w for f in self.of[v] for w in self.faces[f]} - {v}

    def _push(self, v: int) -> None:
        """Note the best way of ``v`` into a neighbour."""
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

    def down_to(self, count: int) -> None:
        """Thin out to ``count`` faces, or as far as it goes."""
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

    def result(self, m: Mesh) -> tuple[Mesh, np.ndarray]:
        """The mesh as it is now, and which vertices of the first one it has."""
        order = sorted(self.faces)
        faces = np.array([self.faces[f] for f in order])
        used, index = np.unique(faces, return_inverse=True)
        now = replace(m, rows=m.rows[used], shares=m.shares[used], faces=index.reshape(-1, 3), label=m.label[order])
        return now, used


def _plane(normal: np.ndarray, point: np.ndarray) -> np.ndarray:
    """Quadrics ``[N, 10]`` of planes."""
    a, b, c = normal.T
    d = -(normal * point).sum(axis=1)
    return np.stack([a * a, a * b, a * c, a * d, b * b, b * c, b * d, c * c, c * d, d * d], axis=1)


def _error(q: tuple, p: tuple) -> float:
    x, y, z = p
    return (
        x * (q[0] * x + 2 * (q[1] * y + q[2] * z + q[3]))
        + y * (q[4] * y + 2 * (q[5] * z + q[6]))
        + z * (q[7] * z + 2 * q[8])
        + q[9]
    )


def _cross(t: list[tuple]) -> tuple[float, float, float]:
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = t
    ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx

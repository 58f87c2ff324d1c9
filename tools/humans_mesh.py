"""Meshes for the bodies: cut along lines, thinned out edge by edge, and made as thick again as they were."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from crowdbot.humans.rigged.simplify import EdgeCollapse

SNAP = 0.04
"""Cuts this near to the end of an edge, as a share of it, go through its vertex."""


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


class Thinning(EdgeCollapse):
    """Edge by edge thinning of a mesh with shares of base vertices."""

    def __init__(self, place: np.ndarray, m: Mesh, care: np.ndarray) -> None:
        """``care [V]`` weighs the faces of each vertex."""
        super().__init__(place, m.faces, m.label, care)

    def result(self, m: Mesh) -> tuple[Mesh, np.ndarray]:
        """The mesh as it is now, and which vertices of the first one it has."""
        order, faces = self.remaining()
        used, index = np.unique(faces, return_inverse=True)
        now = replace(m, rows=m.rows[used], shares=m.shares[used], faces=index.reshape(-1, 3), label=m.label[order])
        return now, used

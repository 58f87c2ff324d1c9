"""Triangles of the shapes of the engine: boxes, round shapes and meshes, with normals and texture coordinates."""

from __future__ import annotations

import functools
import math
from typing import Any, NamedTuple

import numpy as np

from crowdbot.typing import Floats
from crowdbot.world.physics.engine import engine

AROUND, ALONG = 20, 6
"""Segments of round shapes around their axis, and of half a sphere along it."""


class ShapeMesh(NamedTuple):
    """Triangles: corners ``[T, 3, 3]`` [m] in the frame of the shape, their normals, and texture coordinates [m]."""

    corner: Floats
    normal: Floats
    uv: Floats
    closed: bool


def box_mesh(half: Floats) -> ShapeMesh:
    """Return a box of half sizes ``[3]`` [m]."""
    corner, normal = [], []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            a, b = (axis + 1) % 3, (axis + 2) % 3
            square = np.zeros((4, 3))
            square[:, axis] = sign
            square[:, a] = np.array([-1.0, 1.0, 1.0, -1.0]) * sign
            square[:, b] = (-1.0, -1.0, 1.0, 1.0)
            corner += [square[[0, 1, 2]], square[[0, 2, 3]]]
            flat = np.zeros(3)
            flat[axis] = sign
            normal += [np.tile(flat, (3, 1))] * 2
    placed = np.array(corner) * half
    return ShapeMesh(placed, np.array(normal), flat_uv(placed, np.array(normal)), True)


def cylinder_mesh(radius: float, half: float) -> ShapeMesh:
    """Return a cylinder along z with this radius and half length [m]."""
    unit = _unit_cylinder()
    size = np.array([radius, radius, half])
    return ShapeMesh(unit.corner * size, unit.normal, unit.uv, True)


@functools.cache
def _unit_cylinder() -> ShapeMesh:
    return _round_mesh(np.ones(3), 1.0, True)


def ellipsoid_mesh(radius: Floats) -> ShapeMesh:
    """Return an ellipsoid of radii ``[3]`` [m]."""
    return _round_mesh(radius, 0.0, False)


def flat_uv(corner: Floats, normal: Floats) -> Floats:
    """Return texture coordinates [m] ``[T, 3, 2]`` from positions: across and up on walls, x and y on level faces."""
    face = normal.mean(axis=1, keepdims=True)
    size = np.sqrt(face[..., :1] ** 2 + face[..., 1:2] ** 2)
    steep = size > 0.5
    across = (-face[..., 1:2] * corner[..., :1] + face[..., :1] * corner[..., 1:2]) / np.maximum(size, 1e-9)
    u = np.where(steep, across, corner[..., :1])
    v = np.where(steep, -corner[..., 2:3], corner[..., 1:2])
    return np.concatenate([u, v], axis=-1)


def _round_mesh(radius: Floats, half: float, flat: bool) -> ShapeMesh:
    """Return an ellipsoid of radii ``[3]``, or a capsule (``half`` length), or a cylinder (``flat`` ends)."""
    turn = np.arange(AROUND) * (2.0 * math.pi / AROUND)
    ring = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    if flat:
        levels = [(0.0, -1.0, -half, -1.0), (1.0, -1.0, -half, -1.0), (1.0, 0.0, -half, 0.0), (1.0, 0.0, half, 0.0),
                  (1.0, 1.0, half, 1.0), (0.0, 1.0, half, 1.0)]  # fmt: skip
    else:
        rise = np.linspace(-0.5 * math.pi, 0.5 * math.pi, 2 * ALONG + 1)
        levels = []
        for k, angle in enumerate(rise):
            shift = -half if k <= ALONG else half
            row = (math.cos(angle), 0.0, math.sin(angle) * radius[2] + shift, math.sin(angle))
            levels += [(*row[:2], math.sin(angle) * radius[2] - half, row[3]), row] if k == ALONG and half else [row]
    points, normals = [], []
    for size, cap, height, tall in levels:
        points.append(np.column_stack([ring * radius[:2] * size, np.full(AROUND, height)]))
        if flat:
            normals.append(np.column_stack([ring * (cap == 0.0), np.full(AROUND, tall)]))
        else:
            slope = np.column_stack([ring * size / radius[:2], np.full(AROUND, tall / radius[2])])
            normals.append(slope / np.linalg.norm(slope, axis=1, keepdims=True))
    corner, normal = [], []
    for k in range(len(levels) - 1):
        if flat and k in (1, 3):
            continue
        for n in range(AROUND):
            m = (n + 1) % AROUND
            for places in (((k, n), (k, m), (k + 1, m)), ((k, n), (k + 1, m), (k + 1, n))):
                triangle = np.array([points[a][b] for a, b in places])
                area = np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0])
                if area @ area > 1e-20:
                    corner.append(triangle)
                    normal.append(np.array([normals[a][b] for a, b in places]))
    placed, slopes = np.array(corner), np.array(normal)
    return ShapeMesh(placed, slopes, flat_uv(placed, slopes), True)


def geom_mesh(model: Any, geom: int) -> ShapeMesh | None:
    """Return the triangles of a shape of a model of the engine; None for shapes without, such as planes."""
    kinds, size = engine().mjtGeom, model.geom_size[geom]
    kind = model.geom_type[geom]
    if kind == kinds.mjGEOM_BOX:
        return box_mesh(size)
    if kind == kinds.mjGEOM_SPHERE:
        return _round_mesh(np.repeat(size[0], 3), 0.0, False)
    if kind == kinds.mjGEOM_ELLIPSOID:
        return _round_mesh(size, 0.0, False)
    if kind == kinds.mjGEOM_CAPSULE:
        return _round_mesh(np.repeat(size[0], 3), float(size[1]), False)
    if kind == kinds.mjGEOM_CYLINDER:
        return _round_mesh(np.array([size[0], size[0], size[1]]), float(size[1]), True)
    return _stored_mesh(model, int(model.geom_dataid[geom])) if kind == kinds.mjGEOM_MESH else None


def _stored_mesh(model: Any, mesh: int) -> ShapeMesh:
    first, count = int(model.mesh_faceadr[mesh]), int(model.mesh_facenum[mesh])
    rows = slice(first, first + count)
    corner = model.mesh_vert[model.mesh_vertadr[mesh] + model.mesh_face[rows]].astype(np.float64)
    normal = model.mesh_normal[model.mesh_normaladr[mesh] + model.mesh_facenormal[rows]].astype(np.float64)
    if model.mesh_texcoordadr[mesh] >= 0:
        uv = model.mesh_texcoord[model.mesh_texcoordadr[mesh] + model.mesh_facetexcoord[rows]].astype(np.float64)
    else:
        uv = flat_uv(corner, normal)
    return ShapeMesh(corner, normal, uv, False)


def flat_mesh(mesh: ShapeMesh) -> ShapeMesh:
    """Return the triangles of a closed surface with sharp edges."""
    a, b = mesh.corner[:, 1] - mesh.corner[:, 0], mesh.corner[:, 2] - mesh.corner[:, 0]
    face = np.cross(a, b)
    face /= np.maximum(np.sqrt(np.sum(face * face, axis=1, keepdims=True)), 1e-12)
    normal = np.repeat(face[:, None], 3, axis=1)
    return ShapeMesh(mesh.corner, normal, flat_uv(mesh.corner, normal), True)

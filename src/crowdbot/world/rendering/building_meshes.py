"""Triangles of a building as shapes of the engine."""

from __future__ import annotations

from typing import Any

import numpy as np

from crowdbot.world.buildings.building import BuildingPart
from crowdbot.world.physics.engine import engine

__all__ = ["CEILINGS", "add_building_part"]

CEILINGS = 1
"""Group of ceilings, roofs and lintels, which pictures from above leave out."""
FEWEST = 2
"""Smallest number of triangles of a mesh of the engine."""


def add_building_part(spec: Any, number: int, part: BuildingPart) -> None:
    """Add triangles of a building with their material to a model of the engine, for pictures only."""
    if len(part.corner) < FEWEST:
        return
    mj, name = engine(), f"building{number}"
    corners = part.corner if part.closed else np.concatenate([part.corner, part.corner[:, ::-1]])
    uv = part.uv if part.closed else np.concatenate([part.uv, part.uv[:, ::-1]])
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = np.where(size > 1e-12, normal / np.maximum(size, 1e-12), (0.0, 0.0, 1.0))
    index = np.arange(3 * len(corners), dtype=np.int32)
    spec.add_mesh(
        name=name,
        inertia=mj.mjtMeshInertia.mjMESH_INERTIA_SHELL,
        uservert=corners.ravel(),
        usernormal=np.repeat(normal, 3, axis=0).ravel(),
        userface=index,
        userfacenormal=index,
        usertexcoord=(uv.reshape(-1, 2) * (1.0, -1.0) + (0.0, 1.0)).ravel(),
        userfacetexcoord=index,
    )
    material = spec.add_material(name=name, specular=0.05, shininess=0.1)
    if part.picture is None:
        material.rgba = (*part.color, 1.0)
    else:
        high, wide = part.picture.shape[:2]
        texture = spec.add_texture(name=name, type=mj.mjtTexture.mjTEXTURE_2D, width=wide, height=high)
        texture.nchannel = 3
        texture.data = np.ascontiguousarray(part.picture[::-1]).tobytes()
        material.textures[mj.mjtTextureRole.mjTEXROLE_RGB] = name
    kind = "floor" if part.kind == "floor" else "wall"
    spec.worldbody.add_geom(
        name=f"{kind}/{name}", type=mj.mjtGeom.mjGEOM_MESH, meshname=name, material=name, contype=0, conaffinity=0,
        group=CEILINGS if part.kind == "ceiling" else 0, mass=0.0,
    )  # fmt: skip

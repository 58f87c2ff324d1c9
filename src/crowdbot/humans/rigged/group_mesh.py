"""GroupMesh: one list of vertices and triangles for people of included and imported bodies."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.humans.asset import Level, shapes

from .rigged_body import RiggedBody

__all__ = ["GroupMesh", "group_mesh"]

Ints = NDArray[np.int64]


class GroupMesh(NamedTuple):
    """Triangles of the included bodies, followed by those of each imported body.

    Fields:
        faces: ``[F, 3]`` indices of vertices.
        points: first vertex of the included bodies and of each imported one, and the number of vertices ``[K + 2]``.
        triangles: the same of the triangles ``[K + 2]``.
        included: the level of detail of the included bodies.
    """

    faces: Ints
    points: tuple[int, ...]
    triangles: tuple[int, ...]
    included: Level

    def vertex_span(self, own: int) -> slice:
        """Return the vertices of an imported body by its number, or of the included ones for -1."""
        return slice(self.points[own + 1], self.points[own + 2])

    def face_span(self, own: int) -> slice:
        """Return the triangles of an imported body by its number, or of the included ones for -1."""
        return slice(self.triangles[own + 1], self.triangles[own + 2])


def group_mesh(own: tuple[RiggedBody, ...], level: int) -> GroupMesh:
    """Return the mesh of a group with some imported bodies at a level of detail."""
    included = shapes().levels[level]
    faces, points, triangles = [included.faces], [0, included.rest.shape[1]], [0, len(included.faces)]
    for body in own:
        mesh = body.levels[level]
        faces.append(mesh.faces + points[-1])
        points.append(points[-1] + len(mesh.rest))
        triangles.append(triangles[-1] + len(mesh.faces))
    whole = np.concatenate(faces) if own else included.faces
    return GroupMesh(whole, tuple(points), tuple(triangles), included)

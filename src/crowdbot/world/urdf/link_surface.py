"""Triangles of the visible shapes of a link, for viewers."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.typing import Floats, Ints

from .model import Link, LinkShape
from .shapes import Box, Capsule, Cylinder, Mesh, Shape, Texture
from .transforms import transform_points

AROUND, ALONG = 20, 8
"""Edges around a round shape, and from pole to pole of a ball."""
PLAIN = (0.62, 0.65, 0.69, 1.0)
"""Colour of shapes without one."""
BOX_FACES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
     [1, 5, 7], [1, 7, 3]]
)  # fmt: skip


class LinkSurface(NamedTuple):
    """Triangles of a link in its frame.

    Fields:
        vertices: vertices ``[N, 3]`` [m].
        faces: triangles ``[M, 3]``, counter-clockwise from outside.
        colors: red, green, blue, alpha of the triangles ``[M, 4]``, 0 to 255; with a texture, the factor of its image.
        uv: texture coordinates ``[N, 2]`` of the vertices, from the lower left corner; 0 without a texture.
        textures: images on some of the triangles.
    """

    vertices: Floats
    faces: Ints
    colors: NDArray[np.uint8]
    uv: Floats
    textures: tuple[Texture, ...] = ()


def link_surface(link: Link) -> LinkSurface | None:
    """Return the triangles of the visual shapes of a link, or of its colliders if it has none; None without shapes.

    Round shapes have 20 edges around. A colour in the robot file replaces colours and textures of a mesh file.

    >>> from crowdbot.world import Robot
    >>> surface = link_surface(Robot.load("turtlebot2").model.links["wheel_left"])
    >>> surface.vertices.shape[1], bool(surface.faces.max() < len(surface.vertices)), surface.colors.dtype.name
    (3, True, 'uint8')
    """
    parts = [_placed(visual) for visual in link.visuals or link.collisions]
    if not parts:
        return None
    starts = np.cumsum([0] + [len(vertices) for vertices, _, _ in parts])
    return LinkSurface(
        np.concatenate([vertices for vertices, _, _ in parts]),
        np.concatenate([faces + first for (_, faces, _), first in zip(parts, starts[:-1], strict=True)]),
        np.concatenate([colors for _, _, colors in parts]),
        *_textured(link, parts),
    )


def _textured(link: Link, parts: list[tuple[Floats, Ints, NDArray[np.uint8]]]) -> tuple[Floats, tuple[Texture, ...]]:
    """Return texture coordinates of all vertices, and the textures with the numbers of their triangles."""
    coordinates, textures, first = [], [], 0
    for visual, (vertices, faces, _) in zip(link.visuals or link.collisions, parts, strict=True):
        mesh = visual.shape if isinstance(visual.shape, Mesh) and visual.color is None else None
        uv = None if mesh is None else mesh.uv
        coordinates.append(np.zeros((len(vertices), 2)) if uv is None else uv)
        for image in () if mesh is None or uv is None else mesh.textures:
            textures.append(image._replace(first=first + image.first, last=first + image.last))
        first += len(faces)
    return np.concatenate(coordinates), tuple(textures)


def _placed(part: LinkShape) -> tuple[Floats, Ints, NDArray[np.uint8]]:
    vertices, faces = _triangles(part.shape)
    if np.linalg.det(part.origin[:3, :3]) < 0.0:
        faces = faces[:, ::-1]
    own = part.shape.colors if isinstance(part.shape, Mesh) and part.color is None else None
    plain = np.tile(np.round(255.0 * np.clip(part.color or PLAIN, 0.0, 1.0)).astype(np.uint8), (len(faces), 1))
    return transform_points(part.origin, vertices), faces, plain if own is None else own


def _triangles(shape: Shape) -> tuple[Floats, Ints]:
    if isinstance(shape, Mesh):
        return shape.vertices, shape.faces
    if isinstance(shape, Box):
        return shape.points(), BOX_FACES
    if isinstance(shape, Cylinder):
        half = 0.5 * shape.length
        return _turned([(0.0, -half), (shape.radius, -half), (shape.radius, half), (0.0, half)])
    reach = 0.5 * shape.length if isinstance(shape, Capsule) else 0.0
    polar = np.linspace(-0.5 * math.pi, 0.5 * math.pi, ALONG + 1)
    low, high = polar[: ALONG // 2 + 1], polar[ALONG // 2 + (0 if reach > 0.0 else 1) :]
    below = [(shape.radius * math.cos(a), shape.radius * math.sin(a) - reach) for a in low]
    above = [(shape.radius * math.cos(a), shape.radius * math.sin(a) + reach) for a in high]
    return _turned(below + above)


def _turned(profile: list[tuple[float, float]]) -> tuple[Floats, Ints]:
    """Return the surface of a profile of radius and height, from the lower to the upper pole, turned about z."""
    angle = np.arange(AROUND) * (2.0 * math.pi / AROUND)
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    rings = [np.column_stack([r * around, np.full(AROUND, z)]) for r, z in profile]
    a = np.arange(AROUND)
    b = (a + 1) % AROUND
    faces = []
    for k in range(len(profile) - 1):
        lower, upper = k * AROUND, (k + 1) * AROUND
        if profile[k][0] > 1e-9:
            faces.append(np.stack([lower + a, lower + b, upper + b], axis=1))
        if profile[k + 1][0] > 1e-9:
            faces.append(np.stack([lower + a, upper + b, upper + a], axis=1))
    return np.concatenate(rings), np.concatenate(faces)

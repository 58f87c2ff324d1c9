"""Shapes of links: boxes, cylinders, spheres, capsules and meshes, with their volume and inertia."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.typing import Floats

from .transforms import transform_points

ROUND = np.linspace(0.0, 2.0 * math.pi, 64, endpoint=False)


class Solid(NamedTuple):
    """A body of density 1: volume [m3], centre ``[3]`` [m], and second moments ``[3, 3]`` about the centre [m5].

    ``moments`` is the integral of ``r r^T``; the inertia of a solid of density d is ``d (trace(moments) I - moments)``.
    """

    volume: float
    center: Floats
    moments: Floats

    def inertia(self, mass: float) -> Floats:
        """Return the inertia ``[3, 3]`` [kg m2] about the centre for a total ``mass`` [kg].

        >>> Box((1.0, 1.0, 1.0)).solid().inertia(6.0).tolist()
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
        """
        return np.asarray((np.eye(3) * np.trace(self.moments) - self.moments) * (mass / self.volume))


def together(parts: Sequence[tuple[Solid, Floats]]) -> Solid | None:
    """Return solids in frames ``[4, 4]`` as one solid, or None without volume; overlaps count twice."""
    volume = sum(solid.volume for solid, _ in parts)
    if volume <= 0.0:
        return None
    centers = [transform_points(matrix, solid.center[None])[0] for solid, matrix in parts]
    center = sum((s.volume * c for (s, _), c in zip(parts, centers, strict=True)), np.zeros(3)) / volume
    moments = np.zeros((3, 3))
    for (solid, matrix), place in zip(parts, centers, strict=True):
        rotation, shift = matrix[:3, :3], place - center
        moments += rotation @ solid.moments @ rotation.T + solid.volume * np.outer(shift, shift)
    return Solid(volume, center, moments)


@dataclass(frozen=True)
class Box:
    """A box of ``size`` x, y, z [m] around its origin."""

    size: tuple[float, float, float]

    def solid(self) -> Solid:
        """Return volume, centre and moments."""
        x, y, z = self.size
        volume = x * y * z
        return Solid(volume, np.zeros(3), np.diag([x * x, y * y, z * z]) * (volume / 12.0))

    def points(self) -> Floats:
        """Return points ``[N, 3]`` whose convex hull contains the shape."""
        signs = np.array([[a, b, c] for a in (-1, 1) for b in (-1, 1) for c in (-1, 1)])
        return np.asarray(signs * np.array(self.size) / 2.0)


@dataclass(frozen=True)
class Cylinder:
    """A cylinder along z around its origin; lengths in m."""

    radius: float
    length: float

    def solid(self) -> Solid:
        """Return volume, centre and moments."""
        volume = math.pi * self.radius**2 * self.length
        side = volume * self.radius**2 / 4.0
        return Solid(volume, np.zeros(3), np.diag([side, side, volume * self.length**2 / 12.0]))

    def points(self) -> Floats:
        """Return points ``[N, 3]`` on the two rims."""
        rim = self.radius * np.stack([np.cos(ROUND), np.sin(ROUND)], axis=1)
        ends = [np.column_stack([rim, np.full(len(rim), z)]) for z in (-self.length / 2.0, self.length / 2.0)]
        return np.concatenate(ends)


@dataclass(frozen=True)
class Sphere:
    """A sphere around its origin; radius in m."""

    radius: float

    def solid(self) -> Solid:
        """Return volume, centre and moments."""
        volume = 4.0 / 3.0 * math.pi * self.radius**3
        return Solid(volume, np.zeros(3), np.eye(3) * (volume * self.radius**2 / 5.0))

    def points(self) -> Floats:
        """Return points ``[N, 3]`` whose convex hull approximates the sphere."""
        return self.radius * UNIT_BALL


@dataclass(frozen=True)
class Capsule:
    """A cylinder along z with hemispheres at its ends; ``length`` [m] excludes the hemispheres."""

    radius: float
    length: float

    def solid(self) -> Solid:
        """Return volume, centre and moments."""
        tube, ball = Cylinder(self.radius, self.length).solid(), Sphere(self.radius).solid()
        # the centre of a hemisphere is 3/8 r from its flat side; both are offset by half the length
        reach = self.length / 2.0
        along = ball.moments[2, 2] + ball.volume * (reach * reach + 2.0 * reach * 3.0 / 8.0 * self.radius)
        side = tube.moments[0, 0] + ball.moments[0, 0]
        return Solid(tube.volume + ball.volume, np.zeros(3), np.diag([side, side, tube.moments[2, 2] + along]))

    def points(self) -> Floats:
        """Return points ``[N, 3]`` on the two hemispheres."""
        ball = self.radius * UNIT_BALL
        return np.concatenate([ball + (0.0, 0.0, z) for z in (-self.length / 2.0, self.length / 2.0)])


class ConvexPiece(NamedTuple):
    """A closed convex body: vertices ``[N, 3]`` [m] and triangles ``[M, 3]``, counter-clockwise from outside."""

    vertices: Floats
    faces: NDArray[np.int64]

    def solid(self) -> Solid:
        """Return volume, centre and moments, from the tetrahedra between the triangles and the centre."""
        middle = self.vertices.mean(axis=0)
        a, b, c = (self.vertices[self.faces[:, k]] - middle for k in range(3))
        volumes = np.einsum("ni,ni->n", a, np.cross(b, c)) / 6.0
        volume = float(volumes.sum())
        total = a + b + c
        first = np.einsum("n,ni->i", volumes, total) / 4.0
        rows = np.einsum("n,ni,nj->ij", volumes, total, total)
        rows += sum(np.einsum("n,ni,nj->ij", volumes, v, v) for v in (a, b, c))
        center = first / volume if volume > 0.0 else np.zeros(3)
        return Solid(max(volume, 0.0), middle + center, rows / 20.0 - volume * np.outer(center, center))


class Texture(NamedTuple):
    """An image on triangles of a mesh.

    Fields:
        first, last: the first triangle, and the one after the last.
        image: a PNG file.
        color: factor (red, green, blue, alpha) of the image.
    """

    first: int
    last: int
    image: bytes
    color: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)


@dataclass(frozen=True, eq=False)
class Mesh:
    """A mesh from a file, scaled to metres.

    Fields:
        source: file name in the URDF.
        vertices: vertices ``[N, 3]`` [m].
        faces: triangles ``[M, 3]`` (int).
        pieces: convex bodies for contacts; empty for a visual mesh.
        colors: colours ``[M, 4]`` of the triangles from the file, 0 to 255, or None.
        uv: texture coordinates ``[N, 2]`` of the vertices, or None without textures.
        textures: images on some of the triangles.
    """

    source: str
    vertices: Floats
    faces: NDArray[np.int64]
    pieces: tuple[ConvexPiece, ...] = ()
    colors: NDArray[np.uint8] | None = None
    uv: Floats | None = None
    textures: tuple[Texture, ...] = ()

    def solid(self) -> Solid:
        """Return volume, centre and moments of its convex pieces, or of its bounding box without pieces."""
        result = together([(piece.solid(), np.eye(4)) for piece in self.pieces])
        if result is not None:
            return result
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        x, y, z = np.maximum(high - low, 1e-6)
        box = Box((float(x), float(y), float(z))).solid()
        return Solid(box.volume, (low + high) / 2.0, box.moments)

    def points(self) -> Floats:
        """Return the vertices ``[N, 3]`` of the convex pieces, or of the mesh without pieces."""
        return np.concatenate([piece.vertices for piece in self.pieces]) if self.pieces else self.vertices


Shape = Box | Cylinder | Sphere | Capsule | Mesh


def _unit_ball() -> Floats:
    rings = np.linspace(-math.pi / 2.0, math.pi / 2.0, 17)
    rows = [np.stack([np.cos(t) * np.cos(ROUND), np.cos(t) * np.sin(ROUND), np.full(64, np.sin(t))], 1) for t in rings]
    return np.concatenate(rows)


UNIT_BALL = _unit_ball()
"""Points ``[17 * 64, 3]`` on a sphere of radius 1; shapes are asked for their points at every step."""

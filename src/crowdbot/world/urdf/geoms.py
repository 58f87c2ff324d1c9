"""Shapes of a robot as MJCF geoms, and its meshes as files in memory."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Element
from crowdbot.typing import Floats

from .model import Link, LinkShape, RobotModel
from .shapes import Box, Capsule, Cylinder, Mesh, Shape, Sphere, Texture
from .transforms import across, quaternion, transform_points

GREY = (0.7, 0.7, 0.72, 1.0)
SMOOTH = 1e-3
"""Friction coefficients below this are treated as 0."""
MOST_FACES = 150_000
"""MuJoCo supports at most 200 000 triangles per STL file."""
MOST_CORNERS = 64
"""Maximum number of vertices of a convex body in contacts; more are slower and not more accurate on a floor."""
MOST_COLORS = 32
"""The colours of a mesh with more are rounded."""
MOST_TESTED = 64
"""Number of triangles that are tested first, since most meshes have an area there."""
SMALLEST_AREA = 1e-12
ROUND = 0.25
"""Largest difference of the reach of a mesh from the radius of its wheel, as a share of it."""
NARROW = 0.02
"""A mesh that is flatter than this share of the radius is no tyre."""
NOTHING = 1e-30
"""Smaller numbers are written as 0: MuJoCo rejects denormal numbers."""


def row(values: Iterable[float]) -> str:
    """Return numbers in MJCF format.

    >>> row((1.0, -0.5, 1e-9, 1e-320))
    '1 -0.5 1e-09 0'
    """
    exact = (float(value) for value in values)
    return " ".join(repr(0.0 if abs(value) < NOTHING else value).removesuffix(".0") for value in exact)


class Geoms:
    """Creates the geoms of links and collects their meshes.

    Args:
        model: the robot.
        prefix: prefix of all names.
        contact: contype and conaffinity of colliders.
    """

    def __init__(self, model: RobotModel, prefix: str, contact: tuple[int, int]) -> None:
        self.model, self.prefix, self.contact = model, prefix, contact
        self.meshes: list[Element] = []
        self.files: dict[str, bytes] = {}
        self._parts: dict[int, list[tuple[Mesh, tuple[float, float, float, float]]]] = {}
        self._known: dict[tuple[int, bool], list[str]] = {}
        self._materials: dict[tuple[bytes, tuple[float, float, float, float]], str] = {}

    def of(self, link: Link, matrix: Floats, axle: Floats | None = None, radius: float = 0.0) -> list[Element]:
        """Return the geoms of a link.

        A cylinder that turns about its own axis, or has no friction, is a wheel and becomes an ellipsoid, which touches
        the floor in one point below its centre. The two contact points of a cylinder alternate, and a turning robot
        slips.

        Args:
            link: the link.
            matrix: frame ``[4, 4]`` of the link in the body.
            axle: rotation axis ``[3]`` of the body through its origin, or None.
            radius: radius [m] if the body is a wheel: a mesh around the axle becomes an ellipsoid, too. 0: no wheel.
        """
        gliding = link.friction is not None and link.friction < SMOOTH
        geoms = []
        for number, part in enumerate(link.collisions):
            values = {"group": "3", "contype": str(self.contact[0]), "conaffinity": str(self.contact[1])}
            values |= {"rgba": "0.3 0.6 0.9 0.4", **_friction_attributes(link.friction)}
            name = f"{self.prefix}{link.name}/{number}"
            tire = _tire_of(part, matrix, axle, radius) if radius and axle is not None else None
            if tire is not None:
                geoms.append(Element("geom", {"name": name, **tire, **values}))
                continue
            geoms += self._parse_shape(part, matrix, name, values, gliding or _rolls(part, matrix, axle))
        for number, part in enumerate(item for visual in link.visuals for item in self._painted(visual)):
            values = {"group": "2", "contype": "0", "conaffinity": "0", "rgba": row(part.color or GREY)}
            geoms += self._parse_shape(part, matrix, f"{self.prefix}{link.name}/seen/{number}", values)
        return geoms

    def _painted(self, part: LinkShape) -> list[LinkShape]:
        """Return a visual as one shape for each colour and texture of its mesh.

        A colour in the robot file comes first.
        """
        mesh = part.shape
        if part.color is not None or not isinstance(mesh, Mesh) or mesh.colors is None:
            return [part]
        if id(mesh) not in self._parts:
            rows = []
            plain = np.ones(len(mesh.faces), dtype=bool)
            for texture in mesh.textures:
                plain[texture.first : texture.last] = False
                whole = texture._replace(first=0, last=texture.last - texture.first)
                faces = mesh.faces[texture.first : texture.last]
                one = dataclasses.replace(mesh, faces=faces, colors=None, pieces=(), textures=(whole,))
                rows.append((one, texture.color))
            colors, which = distinct_colors(mesh.colors[plain])
            for k, color in enumerate(colors):
                one = Mesh(mesh.source, mesh.vertices, mesh.faces[plain][which == k])
                rows.append((one, tuple((color / 255.0).tolist())))
            self._parts[id(mesh)] = rows
        return [LinkShape(item, part.origin, part.name, color) for item, color in self._parts[id(mesh)]]

    def _parse_shape(
        self, part: LinkShape, matrix: Floats, name: str, values: dict[str, str], wheel: bool = False
    ) -> list[Element]:
        place = matrix @ part.origin
        placed = {"pos": row(place[:3, 3]), "quat": row(quaternion(place[:3, :3]))}
        if not isinstance(part.shape, Mesh):
            return [Element("geom", {"name": name, **_sized(part.shape, wheel), **placed, **values})]
        files = self._mesh(part.shape, collision=values["group"] == "3")
        if part.shape.textures and part.shape.colors is None and values["group"] != "3":
            del values["rgba"]
            values["material"] = self._material(part.shape.textures[0])
        names = [name if k == 0 else f"{name}.{k}" for k in range(len(files))]
        return [
            Element("geom", {"name": name, "type": "mesh", "mesh": file, **placed, **values})
            for name, file in zip(names, files, strict=True)
        ]

    def _mesh(self, mesh: Mesh, collision: bool) -> list[str]:
        key = (id(mesh), collision)
        if key in self._known:
            return self._known[key]
        shown = mesh
        if collision:
            bodies = [(piece.vertices, piece.faces) for piece in mesh.pieces]
        else:
            shown = drawable(mesh)
            bodies = [(shown.vertices, shown.faces[k : k + MOST_FACES]) for k in range(0, len(shown.faces), MOST_FACES)]
        names = []
        for vertices, faces in bodies:
            name = f"{self.prefix}mesh{len(self.files)}"
            drawn = shown.uv is not None and mesh.colors is None and not collision
            file = _file_name(name, "obj" if drawn else "stl")
            self.files[file] = _obj(vertices, faces, shown.uv) if drawn else _stl(vertices, faces)
            values = {"name": name, "file": file, "inertia": "convex" if collision else "shell"}
            if collision:
                values["maxhullvert"] = str(MOST_CORNERS)
            self.meshes.append(Element("mesh", values))
            names.append(name)
        self._known[key] = names
        return names

    def _material(self, texture: Texture) -> str:
        """Return the name of the material of a texture, with its assets."""
        key = (texture.image, texture.color)
        if key not in self._materials:
            name = f"{self.prefix}texture{len(self.files)}"
            file = _file_name(name, "png")
            self.files[file] = texture.image
            self.meshes.append(Element("texture", {"name": name, "type": "2d", "file": file}))
            self.meshes.append(Element("material", {"name": name, "texture": name, "rgba": row(texture.color)}))
            self._materials[key] = name
        return self._materials[key]


def _file_name(name: str, ending: str) -> str:
    """Return a file name for MuJoCo, which leaves out what stands before a slash: the prefix of the robot must stay."""
    return f"{name.replace('/', '-')}.{ending}"


def _rolls(part: LinkShape, matrix: Floats, axle: Floats | None) -> bool:
    """Return whether a shape is a cylinder around the axle."""
    if axle is None or not isinstance(part.shape, Cylinder):
        return False
    place = matrix @ part.origin
    aside = place[:3, 3] - (place[:3, 3] @ axle) * axle
    return bool(abs(place[:3, 2] @ axle) > 0.999 and np.linalg.norm(aside) < 0.01 * part.shape.radius)


def _tire_of(part: LinkShape, matrix: Floats, axle: Floats, radius: float) -> dict[str, str] | None:
    """Return the ellipsoid of a wheel whose collider is a mesh that is round about the axle, otherwise None."""
    if not isinstance(part.shape, Mesh):
        return None
    points = transform_points(matrix @ part.origin, part.shape.points())
    along = points @ axle
    away = float(np.linalg.norm(points - along[:, None] * axle, axis=1).max())
    low, high = float(along.min()), float(along.max())
    if abs(away - radius) > ROUND * radius or high - low < NARROW * radius:
        return None
    place = {"pos": row(0.5 * (low + high) * axle), "quat": row(quaternion(across(axle)))}
    return {"type": "ellipsoid", "size": row((radius, radius, 0.5 * (high - low))), **place}


def _sized(shape: Shape, wheel: bool) -> dict[str, str]:
    if isinstance(shape, Box):
        return {"type": "box", "size": row(side / 2.0 for side in shape.size)}
    if isinstance(shape, Sphere):
        return {"type": "sphere", "size": row((shape.radius,))}
    assert isinstance(shape, Cylinder | Capsule)
    if wheel and isinstance(shape, Cylinder):
        return {"type": "ellipsoid", "size": row((shape.radius, shape.radius, shape.length / 2.0))}
    kind = "cylinder" if isinstance(shape, Cylinder) else "capsule"
    return {"type": kind, "size": row((shape.radius, shape.length / 2.0))}


def _friction_attributes(friction: float | None) -> dict[str, str]:
    """Return the friction of a geom.

    MuJoCo uses the larger friction of two surfaces. A frictionless castor on a rough floor therefore needs a higher
    priority.
    """
    if friction is None:
        return {}
    if friction < SMOOTH:
        return {"condim": "1", "priority": "1"}
    return {"friction": row((friction, 0.005, 0.0001)), "priority": "1"}


def distinct_colors(colors: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], NDArray[np.int64]]:
    """Return at most 32 colours ``[K, 4]`` and the number ``[M]`` of each row; many colours are rounded.

    >>> distinct_colors(np.array([[9, 0, 0, 255], [0, 0, 0, 255], [9, 0, 0, 255]], dtype=np.uint8))[1].tolist()
    [1, 0, 1]
    """
    bits = 0
    while True:
        rounded = np.minimum((colors >> bits << bits) + ((1 << bits) >> 1), 255).astype(np.uint8)
        found, which = np.unique(rounded, axis=0, return_inverse=True)
        if len(found) <= MOST_COLORS:
            return found, np.asarray(which, dtype=np.int64).ravel()
        bits += 1


def drawable(mesh: Mesh) -> Mesh:
    """Return a mesh that MuJoCo accepts: triangles with an area, and at least four points.

    A mesh of one triangle gets a point 0.1 mm below it; a mesh without area has no triangles.
    """
    corners = mesh.vertices[mesh.faces[:MOST_TESTED]].astype(np.float32).astype(np.float64)
    if len(np.unique(corners.reshape(-1, 3), axis=0)) >= 4 and _area(corners) > SMALLEST_AREA:
        return mesh
    whole = mesh.vertices[mesh.faces].astype(np.float32).astype(np.float64)
    if _area(whole) <= SMALLEST_AREA:
        return dataclasses.replace(mesh, faces=mesh.faces[:0])
    if len(np.unique(whole.reshape(-1, 3), axis=0)) >= 4:
        return mesh
    largest = int(np.argmax(np.linalg.norm(np.cross(whole[:, 1] - whole[:, 0], whole[:, 2] - whole[:, 0]), axis=1)))
    a, b, c = whole[largest]
    normal = np.cross(b - a, c - a)
    below = (a + b + c) / 3.0 - 1e-4 * normal / np.linalg.norm(normal)
    first, second, third = mesh.faces[largest]
    last = len(mesh.vertices)
    more = [(second, first, last), (third, second, last), (first, third, last)]
    uv = None if mesh.uv is None else np.vstack([mesh.uv, mesh.uv[first]])
    faces = np.vstack([mesh.faces[largest : largest + 1], more])
    return dataclasses.replace(mesh, vertices=np.vstack([mesh.vertices, below]), faces=faces, uv=uv)


def _area(corners: Floats) -> float:
    """Return twice the area [m2] of triangles ``[M, 3, 3]``."""
    return float(np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum())


def _obj(vertices: Floats, faces: NDArray[np.int64], uv: Floats | None) -> bytes:
    """Return an OBJ file with texture coordinates; only vertices of the triangles are written."""
    assert uv is not None
    used, corners = np.unique(faces, return_inverse=True)
    rows = [f"v {x:.8g} {y:.8g} {z:.8g}" for x, y, z in vertices[used].tolist()]
    rows += [f"vt {u:.7g} {v:.7g}" for u, v in uv[used].tolist()]
    rows += [f"f {a}/{a} {b}/{b} {c}/{c}" for a, b, c in (corners.reshape(-1, 3) + 1).tolist()]
    return "\n".join([*rows, ""]).encode()


def _stl(vertices: Floats, faces: NDArray[np.int64]) -> bytes:
    """Return a binary STL file."""
    corners = vertices[faces].astype("<f4")
    rows = np.zeros(len(faces), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])
    rows["corners"] = corners
    return b"".join([b"crowdbot".ljust(80), len(faces).to_bytes(4, "little"), rows.tobytes()])

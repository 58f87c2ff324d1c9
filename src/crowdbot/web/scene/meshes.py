"""Meshes and textures of bodies and robots as files for the browser."""

from __future__ import annotations

import functools
import io
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from crowdbot.humans import LEVELS, LONG, SHORT, drape, shapes
from crowdbot.typing import Floats
from crowdbot.web.desk import Resource
from crowdbot.web.state_frame import StateFrame
from crowdbot.world import Robot, link_surface

UNIT = 1e-4
"""Length of one unit of the vertices of bodies [m]."""
MOST_IMAGES = 64
"""Largest number of images of a robot; the triangles of others have their mean colour."""
MOST_BYTES = 12_000_000
"""Largest size of all images of a robot [B]; larger ones are halved until they fit."""


def scene_resource(simulation: Any, path: str, query: dict[str, str]) -> Resource:
    """Return a mesh of a scene as the bytes of a :class:`StateFrame`.

    Args:
        simulation: the simulation, for the meshes of its robots; None for those of bodies.
        path: ``bodies/LEVEL.bin`` with a level of detail from 0 (finest) to 2, or ``robots/NAME.bin``.
        query: not used.

    Raises:
        KeyError: there is no such mesh.

    >>> from crowdbot.simulation import Simulation
    >>> from crowdbot.trials import load_trial
    >>> simulation = Simulation(load_trial("frontal"), posed=True)
    >>> sorted(StateFrame.decode(scene_resource(simulation, "robots/robot.bin", {}).data).arrays)
    ['color', 'faces', 'first', 'vertices']
    """
    folder, _, name = path.partition("/")
    word = name.removesuffix(".bin")
    if folder == "bodies" and word in [str(level) for level in range(LEVELS)]:
        return Resource(body_mesh(int(word)).encode())
    if folder == "robots":
        for control in simulation.robots:
            if control.robot.name == word:
                return Resource(robot_mesh(control.robot.body).encode())
    raise KeyError(path)


@functools.cache
def body_mesh(level: int) -> StateFrame:
    """Return the bodies of the asset at a level of detail, from 0 (finest) to 2.

    A vertex of the asset that belongs to faces of several regions is there once for each, so that colours have sharp
    edges. Arrays: ``rest`` [bodies * V, 3] in 0.1 mm, ``heads`` [bodies * 28, 3] starts of the bones [m], ``parents``
    [28], and for each vertex ``source`` (row in ``rest`` of the first body), ``normal`` [3] of the mean body,
    ``bones`` [4], ``weights`` [4] in 1/65535, ``region`` and ``part``; ``faces`` [F, 3]. For clothes, ``long`` and
    ``short`` [3] in 0.1 mm, by which these cuts move the vertex on a body of the stature ``stature`` [1] [m], and
    ``group`` of each vertex: 0 shirt, 1 sleeves, 2 trousers.
    """
    every = shapes()
    mesh, cloth = every.levels[level], drape(level)
    corner = np.stack([mesh.faces.ravel(), np.repeat(mesh.face_region, 3), np.repeat(mesh.face_part, 3)], axis=1)
    vertex, faces = np.unique(corner, axis=0, return_inverse=True)
    source = vertex[:, 0]
    normal = _vertex_normals(mesh.rest[-1], mesh.faces)
    return StateFrame(
        "body", 0.0,
        {
            "rest": np.round(mesh.rest.reshape(-1, 3) / UNIT).astype(np.int16),
            "heads": every.head.reshape(-1, 3).astype(np.float32),
            "parents": every.parents.astype(np.int16),
            "source": source.astype(np.uint16),
            "normal": normal[source].astype(np.float32),
            "bones": mesh.bones[source].astype(np.uint8),
            "weights": np.round(65535.0 * mesh.weights[source]).astype(np.uint16),
            "region": vertex[:, 1].astype(np.uint8),
            "part": vertex[:, 2].astype(np.uint8),
            "faces": faces.reshape(-1, 3).astype(np.uint16),
            "long": np.round(cloth.shift[LONG][source] / UNIT).astype(np.int16),
            "short": np.round(cloth.shift[SHORT][source] / UNIT).astype(np.int16),
            "group": cloth.group[source].astype(np.uint8),
            "stature": np.array([cloth.height], dtype=np.float32),
        },
    )  # fmt: skip


def shown_links(robot: Robot) -> list[str]:
    """Return the links of a robot that have shapes, in the order of its mesh and of the poses in a frame."""
    links = robot.model.links.values()
    seen = [link.name for link in links if link.visuals]
    return seen or [link.name for link in links if link.collisions]


def robot_mesh(robot: Robot) -> StateFrame:
    """Return the triangles of a robot.

    Arrays: ``vertices`` [N, 3] [m] in the frame of their link, ``faces`` [M, 3], ``color`` [M, 4] and ``first`` [L]
    number of faces before each link of :func:`shown_links`. With textures also ``uv`` [N, 2]; ``textured`` [T, 3] first
    face, the one after the last, and number of the image; and PNG files ``image0``, ``image1``, ...
    """
    vertices, faces, colors, first = [np.zeros((0, 3))], [np.zeros((0, 3), np.int64)], [np.zeros((0, 4), np.uint8)], []
    points = triangles = 0
    coordinates, textures = [np.zeros((0, 2))], list[TexturedFaces]()
    for name in shown_links(robot):
        surface = link_surface(robot.model.links[name])
        assert surface is not None
        first.append(triangles)
        vertices.append(surface.vertices)
        faces.append(surface.faces + points)
        colors.append(surface.colors)
        coordinates.append(surface.uv)
        textures += [
            texture._replace(first=texture.first + triangles, last=texture.last + triangles)
            for texture in surface.textures
        ]
        points, triangles = points + len(surface.vertices), triangles + len(surface.faces)
    return StateFrame(
        "robot", 0.0,
        {
            "vertices": np.concatenate(vertices).astype(np.float32),
            "faces": np.concatenate(faces).astype(np.uint32),
            "color": np.concatenate(colors),
            "first": np.array(first, dtype=np.uint32),
            **texture_arrays(textures, np.concatenate(coordinates)),
        },
    )  # fmt: skip


def _vertex_normals(points: Floats, faces: NDArray[np.int64]) -> Floats:
    """Return unit normals ``[V, 3]``, weighted by the area of the faces."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    flat = np.cross(b - a, c - a)
    found = np.zeros_like(points)
    for k in range(3):
        np.add.at(found, faces[:, k], flat)
    size = np.linalg.norm(found, axis=1, keepdims=True)
    return np.where(size > 1e-12, found / np.maximum(size, 1e-12), (0.0, 0.0, 1.0))


class TexturedFaces(Protocol):
    """An image on the triangles ``first`` to ``last - 1`` of a mesh; the image is a PNG file."""

    @property
    def first(self) -> int:
        """First triangle."""

    @property
    def last(self) -> int:
        """Triangle after the last one."""

    @property
    def image(self) -> bytes:
        """PNG file."""


def texture_arrays(textures: Sequence[TexturedFaces], uv: NDArray[np.float64]) -> dict[str, NDArray[Any]]:
    """Return the arrays ``uv``, ``textured`` and ``imageK`` of a robot, nothing without textures.

    The readers of meshes have decoded every image and written it again, so that a browser never sees a file from
    outside. An image that is on several meshes is sent once.

    Args:
        textures: images with numbers of triangles of the robot.
        uv: texture coordinates ``[N, 2]`` of its vertices.
    """
    numbers: dict[bytes, int] = {}
    for texture in textures:
        if texture.image not in numbers and len(numbers) < MOST_IMAGES:
            numbers[texture.image] = len(numbers)
    rows = [(texture.first, texture.last, numbers[texture.image]) for texture in textures if texture.image in numbers]
    if not rows:
        return {}
    share = MOST_BYTES // len(numbers)
    images = {f"image{k}": np.frombuffer(_fitted(data, share), dtype=np.uint8) for data, k in numbers.items()}
    return {"uv": uv.astype(np.float32), "textured": np.array(rows, dtype=np.uint32), **images}


def _fitted(data: bytes, most: int) -> bytes:
    """Return a PNG file that is at most this large, with half of the pixels along each side as often as needed."""
    from PIL import Image

    if len(data) <= most:
        return data
    with Image.open(io.BytesIO(data), formats=["PNG"]) as image:
        whole = image.convert("RGB")
    while len(data) > most and max(whole.size) > 1:
        whole.thumbnail((whole.width // 2 or 1, whole.height // 2 or 1))
        stream = io.BytesIO()
        whole.save(stream, "PNG")
        data = stream.getvalue()
    return data

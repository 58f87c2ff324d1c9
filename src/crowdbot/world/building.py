"""Building: the triangles of a building in glTF by material, and its doors."""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import GltfFile, InputError, read_gltf
from crowdbot.humans import material_picture
from crowdbot.typing import Bytes, Floats

MOST_TRIANGLES, MOST_MATERIALS = 300_000, 200
SIDE = 512
"""Side [pixels] of the texture of a material."""
LIFT = 0.003
"""Height [m] of the floor of a building above that of the stage, which it hides."""
FLAT, STEP, DEEPEST = 0.95, 0.01, 1.5
"""The floor is the height with the largest area that looks up, in steps of 1 cm up to 1.5 m above the lowest point."""
CEILING = 1.9
"""Height [m] above which triangles are those of ceilings, roofs and lintels."""
DOOR = re.compile(r"(?i)door(?![ _.-]?(frame|way|mat|bell|step|handle|knob))")
"""Names of nodes that are doors."""
NARROWEST, WIDEST, LOWEST = 0.3, 5.0, 1.2
"""Smallest and largest width and smallest height [m] of a door."""


class BuildingPart(NamedTuple):
    """Triangles of one material.

    Fields: ``corner [T, 3, 3]`` [m] with z up; ``uv [T, 3, 2]`` from the top left; ``color`` red, green, blue, 0 to 1;
    ``picture [512, 512, 3]``, None without a texture; ``kind``: ``floor``, ``ceiling`` or ``wall`` (all others);
    ``closed``: whether the back is never seen.
    """

    corner: Floats
    uv: Floats
    color: tuple[float, float, float]
    picture: Bytes | None
    kind: str
    closed: bool


class BuildingDoor(NamedTuple):
    """A door: its name, both ends ``x, y`` [m], and its height [m]."""

    name: str
    start: tuple[float, float]
    end: tuple[float, float]
    height: float


@dataclass(frozen=True, eq=False)
class Building:
    """A building whose floor has the height 0.

    Fields:
        name: name of its file.
        parts: triangles without doors.
        doors: doors, from nodes whose name contains ``door``.
    """

    name: str
    parts: tuple[BuildingPart, ...]
    doors: tuple[BuildingDoor, ...]

    @property
    def corners(self) -> Floats:
        """All triangles without doors ``[T, 3, 3]`` [m]."""
        return np.concatenate([np.zeros((0, 3, 3)), *(part.corner for part in self.parts)])


class _Piece(NamedTuple):
    """Triangles of a primitive in the world, with the number of their material, and the door that they belong to."""

    corner: Floats
    uv: Floats
    material: int
    door: str


def read_building(path: Path) -> Building:
    """Read a building in glTF (``.glb``): metres, y up; x stays, and -z becomes y.

    Raises:
        InputError: the file is missing, damaged or too large, or has no triangles.
    """
    there = path.stat() if path.is_file() else None
    return _read(path, there.st_mtime_ns if there else 0, there.st_size if there else 0)


@functools.lru_cache(maxsize=4)
def _read(path: Path, changed: int, size: int) -> Building:
    file = read_gltf(path)
    pieces = _pieces(file)
    whole = np.concatenate([np.zeros((0, 3, 3)), *(piece.corner for piece in pieces)])
    if not len(whole):
        raise InputError(f"{file.name} has no triangles")
    if not np.all(np.isfinite(whole)) or np.abs(whole).max() > 1e4:
        raise InputError(f"{file.name} has points that are not finite or farther than 10 km from the origin")
    shift = np.array([0.0, 0.0, _floor_height(whole) - LIFT])
    pieces = [piece._replace(corner=piece.corner - shift) for piece in pieces]
    doors, left = _doors(pieces)
    parts = [
        part
        for number in sorted({piece.material for piece in left})
        for part in _parts(file, number, [piece for piece in left if piece.material == number])
    ]
    return Building(file.name, tuple(parts), doors)


def _pieces(file: GltfFile) -> list[_Piece]:
    """Return the triangles of all nodes."""
    nodes, frames = file.rows("nodes"), file.frames()
    parent = {child: k for k, node in enumerate(nodes) for child in node.get("children", ())}
    found, count = list[_Piece](), 0
    for k, node in enumerate(nodes):
        if "mesh" not in node:
            continue
        door, at = "", k
        while True:
            name = str(nodes[at].get("name", ""))
            door = name if DOOR.search(name) else door
            if at not in parent:
                break
            at = parent[at]
        for primitive in _primitives(file, node):
            piece = _piece(file, primitive, frames[k], door)
            count += len(piece.corner)
            if count > MOST_TRIANGLES:
                raise InputError(f"{file.name} has more than {MOST_TRIANGLES} triangles; simplify the building")
            found.append(piece)
    if len({piece.material for piece in found}) > MOST_MATERIALS:
        raise InputError(f"{file.name} has more than {MOST_MATERIALS} materials; join them")
    return found


def _primitives(file: GltfFile, node: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    rows = file.row("meshes", node["mesh"]).get("primitives", [])
    for row in rows:
        if not isinstance(row.get("attributes"), dict) or row.get("mode", 4) > 4:
            raise InputError(f"{file.name}: a primitive is no list of triangles; save it with triangles")
    return [row for row in rows if row.get("mode", 4) == 4 and "POSITION" in row["attributes"]]


def _piece(file: GltfFile, primitive: Mapping[str, Any], frame: Floats, door: str) -> _Piece:
    names = primitive["attributes"]
    points = file.array(names["POSITION"]).astype(np.float64)
    if points.shape[1] != 3:
        raise InputError(f"{file.name}: points have {points.shape[1]} coordinates; expected 3")
    numbers = file.array(primitive["indices"]).ravel() if "indices" in primitive else np.arange(len(points))
    index = numbers[: len(numbers) - len(numbers) % 3].astype(np.int64).reshape(-1, 3)
    if index.size and not 0 <= index.min() <= index.max() < len(points):
        raise InputError(f"{file.name}: a triangle names point {index.max()} of {len(points)}")
    placed = points @ frame[:3, :3].T + frame[:3, 3]
    placed = placed @ np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
    uv = np.zeros((len(points), 2))
    if "TEXCOORD_0" in names:
        given = file.array(names["TEXCOORD_0"]).astype(np.float64)
        if given.shape == uv.shape:
            uv = np.clip(np.nan_to_num(given), -1e3, 1e3)
    index = index[:, ::-1] if np.linalg.det(frame[:3, :3]) < 0.0 else index
    kind = primitive.get("material")
    return _Piece(placed[index], uv[index], kind if isinstance(kind, int) else -1, door)


def _floor_height(corner: Floats) -> float:
    """Return the height [m] of the floor."""
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    area = 0.5 * np.linalg.norm(normal, axis=1)
    height, low = corner[..., 2].mean(axis=1), float(corner[..., 2].min())
    level = (normal[:, 2] > FLAT * 2.0 * np.maximum(area, 1e-12)) & (height < low + DEEPEST)
    if not level.any():
        return low
    step = np.round((height[level] - low) / STEP).astype(np.int64)
    best = int(np.argmax(np.bincount(step, area[level])))
    return float(np.average(height[level][step == best], weights=area[level][step == best]))


def _doors(pieces: list[_Piece]) -> tuple[tuple[BuildingDoor, ...], list[_Piece]]:
    """Return the doors, and the triangles that belong to none."""
    import shapely

    building_doors: list[BuildingDoor] = []
    left = [piece for piece in pieces if not piece.door]
    for name in sorted({piece.door for piece in pieces if piece.door}):
        own = [piece for piece in pieces if piece.door == name]
        points = np.concatenate([piece.corner.reshape(-1, 3) for piece in own])
        around: Any = shapely.minimum_rotated_rectangle(shapely.multipoints(points[:, :2]))
        ring = shapely.get_coordinates(around)
        if len(ring) == 5:
            sides = np.linalg.norm(np.diff(ring[:3], axis=0), axis=1)
            first = 0 if sides[0] < sides[1] else 1
            ends = 0.5 * (ring[[first, first + 2]] + ring[[first + 1, (first + 3) % 4]])
        else:
            ends = ring[:2]
        wide = float(np.linalg.norm(ends[1] - ends[0])) if len(ends) == 2 else 0.0
        tall = float(points[:, 2].max())
        if not NARROWEST <= wide <= WIDEST or tall < LOWEST or points[:, 2].min() > LOWEST:
            left += own
            continue
        (ax, ay), (bx, by) = np.round(ends, 3).tolist()
        building_doors.append(BuildingDoor(name.strip()[:80] or "door", (ax, ay), (bx, by), round(tall, 2)))
    return tuple(building_doors), left


def _parts(file: GltfFile, number: int, pieces: list[_Piece]) -> list[BuildingPart]:
    """Return the triangles of a material by kind."""
    material = file.row("materials", number) if number >= 0 else {}
    tile = material_picture(file, material, SIDE)
    detail = material.get("pbrMetallicRoughness")
    textured = isinstance(detail, dict) and isinstance(detail.get("baseColorTexture"), dict)
    red, green, blue = (tile[..., :3].reshape(-1, 3).mean(axis=0) / 255.0).tolist()
    corner, uv = (np.concatenate([getattr(piece, name) for piece in pieces]) for name in ("corner", "uv"))
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    level = np.abs(normal[:, 2]) > 0.7 * np.maximum(np.linalg.norm(normal, axis=1), 1e-12)
    low = corner[..., 2].min(axis=1)
    kinds = np.select([low > CEILING, level & (np.abs(low) < 0.1)], ["ceiling", "floor"], "wall")
    picture = np.ascontiguousarray(tile[..., :3]) if textured else None
    closed = material.get("doubleSided") is not True
    return [
        BuildingPart(corner[kinds == kind], uv[kinds == kind], (red, green, blue), picture, kind, closed)
        for kind in ("floor", "wall", "ceiling")
        if (kinds == kind).any()
    ]

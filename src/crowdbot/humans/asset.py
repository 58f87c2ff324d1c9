"""The file of bodies that ships: rest shapes, skeleton, skin weights and regions, read once."""

from __future__ import annotations

import functools
import importlib.resources
import json
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["LEVELS", "OFFSET_UNIT", "SOLID_PARTS", "Level", "Shapes", "outward", "shapes"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
LEVELS = 3
"""Levels of detail: 0 is the finest."""
HEM, CUT = 0.29, -1
"""Skirts of the file are long and follow the thighs only, so that the shanks of walkers would come through: triangles
below this share of stature (about the knee) are cut off, and their part is the second number."""
OFFSET_UNIT = 2.5e-4
"""Length of one unit of the stored offsets [m]."""
SOLID_PARTS = (0, 1, 2)
"""Parts of the mesh that are skin or cloth: no hair, no skirt."""
UNIT = 1e-4
"""Length of one unit of the stored vertices [m]."""


@dataclass(frozen=True)
class Level:
    """One level of detail, shared by all bodies but for the rest shape.

    Fields: ``rest [P, V, 3]`` [m], ``faces [F, 3]``, ``bones [V, 4]`` and ``weights [V, 4]`` (sum 1), the part and the
    region of every vertex and face as indices into the names of :class:`Shapes`.
    """

    rest: Floats
    faces: Ints
    bones: Ints
    weights: Floats
    vertex_part: Ints
    vertex_region: Ints
    face_part: Ints
    face_region: Ints


@dataclass(frozen=True)
class Shapes:
    """All bodies of the file: ``people`` says who they are; ``head`` and ``tail`` are the bones at rest [m]."""

    people: tuple[dict[str, Any], ...]
    bones: tuple[str, ...]
    parents: Ints
    parts: tuple[str, ...]
    regions: tuple[str, ...]
    head: Floats
    tail: Floats
    levels: tuple[Level, ...]

    def bone(self, name: str) -> int:
        """Return the index of a bone."""
        return self.bones.index(name)


@functools.cache
def shapes(thick: bool = True) -> Shapes:
    """Return the bodies of the file, and as the last one the mannequin: the mean of the adults.

    ``thick`` moves the vertices of the coarse levels outward, so that limbs are as thick as those of the finest.
    """
    stored = _stored("humans_cc0.npz")
    offsets = _stored("offsets.npz") if thick else {}
    people = tuple(json.loads(str(stored["people"])))
    adult = np.array([person["years"] >= 18 for person in people])
    return Shapes(
        people=people,
        bones=tuple(str(b) for b in stored["bones"]),
        parents=stored["parents"].astype(np.int64),
        parts=tuple(str(p) for p in stored["part_names"]),
        regions=tuple(str(r) for r in stored["regions"]),
        head=_with_mean(stored["joint_head"].astype(np.float64), adult),
        tail=_with_mean(stored["joint_tail"].astype(np.float64), adult),
        levels=tuple(_level(stored, k, adult, offsets) for k in range(LEVELS)),
    )


def outward(rest: Floats, faces: Ints) -> Floats:
    """Return the unit normals ``[P, V, 3]`` of the vertices of bodies, 0 where no face of these has the vertex."""
    normal = np.zeros_like(rest)
    a, b, c = (rest[:, faces[:, k]] for k in range(3))
    of_face = np.cross(b - a, c - a)
    for k in range(3):
        np.add.at(normal.swapaxes(0, 1), faces[:, k], of_face.swapaxes(0, 1))
    return np.asarray(normal / np.maximum(np.linalg.norm(normal, axis=-1, keepdims=True), 1e-12))


def _stored(name: str) -> dict[str, NDArray[Any]]:
    place = importlib.resources.files("crowdbot").joinpath("assets", "humans", name)
    with importlib.resources.as_file(place) as path, np.load(path, allow_pickle=False) as file:
        return {key: file[key] for key in file.files}


def _level(
    stored: dict[str, NDArray[Any]], k: int, adult: NDArray[np.bool_], offsets: dict[str, NDArray[Any]]
) -> Level:
    rest = _with_mean(stored[f"lod{k}_verts"] * UNIT, adult)
    if f"lod{k}" in offsets:
        solid = np.isin(np.repeat(np.arange(6), stored[f"lod{k}_parts"][:, 1]), SOLID_PARTS)
        normal = outward(rest, stored[f"lod{k}_faces"][solid].astype(np.int64))
        rest = rest + (offsets[f"lod{k}"] * OFFSET_UNIT)[:, None] * normal
    rest[..., 2] = np.maximum(rest[..., 2], 0.0)  # the soles of the file lie up to 6 mm under the floor
    counts = stored[f"lod{k}_parts"].astype(np.int64)
    weights = stored[f"lod{k}_weights"].astype(np.float64)
    faces = stored[f"lod{k}_faces"].astype(np.int64)
    part = np.repeat(np.arange(len(counts)), counts[:, 1])
    skirt = list(stored["part_names"]).index("skirt")
    hem = HEM * rest[..., 2].max(axis=1)
    part[(part == skirt) & (rest[-1, faces, 2].max(axis=1) < hem[-1])] = CUT
    below = np.repeat(np.arange(len(counts)), counts[:, 0]) == skirt
    rest[:, below, 2] = np.maximum(rest[:, below, 2], hem[:, None])
    return Level(
        rest=rest,
        faces=faces,
        bones=stored[f"lod{k}_bones"].astype(np.int64),
        weights=weights / weights.sum(axis=1, keepdims=True),
        vertex_part=np.repeat(np.arange(len(counts)), counts[:, 0]),
        vertex_region=stored[f"lod{k}_region"].astype(np.int64),
        face_part=part,
        face_region=stored[f"lod{k}_face_region"].astype(np.int64),
    )


def _with_mean(values: Floats, adult: NDArray[np.bool_]) -> Floats:
    return np.concatenate([values, values[adult].mean(axis=0, keepdims=True)])

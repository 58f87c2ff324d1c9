"""Import of rigged characters of other programs as bodies."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError, read_gltf
from crowdbot.humans.asset import shapes
from crowdbot.humans.person import person

from .character import read_character
from .picture import character_picture
from .rest_pose import rest_pose
from .rigged_body import RiggedBody
from .simplify import detail_levels


class ImportedBody(NamedTuple):
    """A body, the bones that its skeleton lacks, and sentences about what is left out."""

    body: RiggedBody
    missing: tuple[str, ...]
    remarks: tuple[str, ...]


def import_body(path: str | Path, name: str, height: float | None = None, mass: float | None = None) -> ImportedBody:
    """Turn a rigged character in glTF into a body.

    The skeleton is that of Rocketbox (``Bip01``), Mixamo (``mixamorig``) or one with similar names; the character
    stands in a T or A pose. Bones that it lacks have the place of the mean adult.

    Args:
        path: a ``.glb`` or ``.gltf`` file.
        name: name of the body, such as ``ann.body``.
        height: stature [m] (default: that in the file).
        mass: mass [kg] (default: that of the mean adult times the square of the ratio of statures, the same body mass
            index).

    Raises:
        InputError: the file is missing, damaged, too large or without a known skeleton, or a value is not allowed.
    """
    file = read_gltf(Path(path))
    character = read_character(file)
    looks = character_picture(file, character)
    pose = rest_pose(character, height)
    faces = character.faces[looks.drawn]
    levels = detail_levels(pose.vertices, character.weights, faces, looks.uv[looks.drawn], looks.closed[looks.drawn])
    mean = person("mannequin")
    weight = mean.mass * (pose.height / mean.height) ** 2 if mass is None else mass
    if not np.all([len(level.faces) for level in levels]):
        raise InputError(f"{file.name} has no triangles of more than 0.1 mm")
    body = RiggedBody(name, pose.height, weight, pose.head, pose.tail, levels, looks.picture)
    missing = tuple(bone for bone in shapes().bones if bone not in character.joints)
    return ImportedBody(body, missing, character.remarks)

"""Picture of a character: base colours and textures of all its materials in one image."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import GltfFile, InputError
from crowdbot.typing import Floats

from .character import Character
from .rigged_body import PICTURE

MOST_PIXELS = 70_000_000
MOST_MATERIALS = 64
FORMATS = ("PNG", "JPEG", "WEBP")
GREY = (0.72, 0.70, 0.67, 1.0)
"""Colour of triangles without a material."""
CUT = 0.5
"""Smallest opacity of a triangle that is drawn, of materials with transparent parts."""


class CharacterPicture(NamedTuple):
    """The picture ``[1024, 1024, 3]``, coordinates ``uv [F, 3, 2]``, triangles with a back that shows, and drawn ones.

    Fields ``closed`` and ``drawn`` are ``[F]``.
    """

    picture: NDArray[np.uint8]
    uv: Floats
    closed: NDArray[np.bool_]
    drawn: NDArray[np.bool_]


def character_picture(file: GltfFile, character: Character) -> CharacterPicture:
    """Return the picture of a character; each material has a square of it.

    Textures repeat outside of 0 to 1 by whole triangles only. Triangles of transparent materials are drawn where more
    than half is opaque.

    Raises:
        InputError: an image cannot be read or is too large, or there are too many materials.
    """
    used = np.unique(character.material)
    if len(used) > MOST_MATERIALS:
        raise InputError(f"{file.name} has {len(used)} materials, at most {MOST_MATERIALS} are allowed; join them")
    grid = 1 << math.ceil(math.log2(max(1, math.ceil(math.sqrt(len(used))))))
    side = PICTURE // grid
    picture = np.zeros((PICTURE, PICTURE, 3), dtype=np.uint8)
    uv = character.uv - np.floor(character.uv.min(axis=1, keepdims=True) + 1e-6)
    uv = np.clip(uv, 0.5 / side, 1.0 - 0.5 / side)
    closed, drawn = np.ones(len(uv), dtype=np.bool_), np.ones(len(uv), dtype=np.bool_)
    for k, number in enumerate(used.tolist()):
        row, column = divmod(k, grid)
        material = file.row("materials", number) if number >= 0 else {}
        tile = material_picture(file, material, side)
        picture[row * side : (row + 1) * side, column * side : (column + 1) * side] = tile[..., :3]
        own = np.flatnonzero(character.material == number)
        closed[own] = material.get("doubleSided") is not True
        if material.get("alphaMode", "OPAQUE") != "OPAQUE":
            drawn[own] = _opacity(tile, uv[own]) >= CUT
            closed[own] = False
        uv[own] = (uv[own] + (column, row)) / grid
    if not drawn.any():
        raise InputError(f"{file.name}: all its triangles are transparent")
    return CharacterPicture(picture, uv, closed, drawn)


def _opacity(tile: NDArray[np.uint8], uv: Floats) -> Floats:
    """Return the mean opacity of triangles, from their middle and points between it and the corners."""
    side = len(tile)
    middle = uv.mean(axis=1, keepdims=True)
    points = np.concatenate([middle, 0.5 * (middle + uv)], axis=1)
    x, y = (np.minimum((points[..., k] * side).astype(np.int64), side - 1) for k in (0, 1))
    return np.asarray(tile[y, x, 3].mean(axis=1) / 255.0)


def material_picture(file: GltfFile, material: Mapping[str, Any], side: int) -> NDArray[np.uint8]:
    """Return the base colour of a material of a glTF file ``[side, side, 4]``: red, green, blue, opacity.

    Raises:
        InputError: its image cannot be read or is too large.
    """
    from PIL import Image

    detail = material.get("pbrMetallicRoughness", {})
    detail = detail if isinstance(detail, dict) else {}
    factor = _factor(file, detail) if material else np.array(GREY)
    texture = detail.get("baseColorTexture")
    if not isinstance(texture, dict):
        return np.tile(np.round(255.0 * factor).astype(np.uint8), (side, side, 1))
    row = file.row("textures", texture.get("index"))
    extensions = row.get("extensions")
    webp = extensions.get("EXT_texture_webp", {}) if isinstance(extensions, dict) else {}
    number = row.get("source", webp.get("source") if isinstance(webp, dict) else None)
    data = file.image(number)
    try:
        with Image.open(io.BytesIO(data), formats=FORMATS) as image:
            if image.size[0] * image.size[1] > MOST_PIXELS:
                raise InputError(f"image {number} has {image.size[0]} x {image.size[1]} pixels, at most 70 million")
            image.draft("RGB", (2 * side, 2 * side))
            whole = image.convert("RGBA").resize((side, side), Image.Resampling.BOX)
    except InputError as error:
        raise InputError(f"{file.name}: {error}") from None
    except Exception as error:  # a broken image causes many kinds of exceptions inside Pillow
        raise InputError(f"{file.name}: image {number} cannot be read: {type(error).__name__}") from None
    return np.round(np.asarray(whole, dtype=np.float64) * factor).astype(np.uint8)


def _factor(file: GltfFile, detail: Mapping[str, Any]) -> Floats:
    """Return the base colour factor ``[4]``, red, green and blue as in images."""
    try:
        found = np.array(detail.get("baseColorFactor", (1.0, 1.0, 1.0, 1.0)), dtype=np.float64)
    except (TypeError, ValueError):
        found = np.zeros(0)
    if found.shape != (4,) or not np.all((found >= 0.0) & (found <= 1.0)):
        raise InputError(f"{file.name}: baseColorFactor must be four numbers from 0 to 1")
    return np.append(found[:3] ** (1.0 / 2.2), found[3])

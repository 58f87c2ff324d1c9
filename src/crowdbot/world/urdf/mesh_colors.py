"""Colours and textures of mesh files, read from the materials that trimesh has loaded."""

from __future__ import annotations

import io
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

from .mesh_files import MOST_BYTES, MeshFiles
from .shapes import Texture

MOST_PIXELS = 40_000_000
MOST_SIDE = 2048
"""Largest side of a texture in pixels; larger images are reduced."""
FORMATS = ("PNG", "JPEG", "BMP", "TGA", "WEBP", "GIF", "TIFF")
GREY = (178, 178, 184, 255)
INVISIBLE = 13
"""Below this alpha, 5 %, a material is drawn opaque: exporters of DAE files write the alpha in several ways."""
PLAIN = (102, 102, 102, 255)
"""Colour of a material that trimesh adds to a mesh with texture coordinates."""


class PartColors(NamedTuple):
    """Look of a part: colours ``[M, 4]`` of triangles or one colour ``[4]``, texture coordinates ``[N, 2]``, and the
    texture as a PNG file; None for what is missing.
    """

    color: NDArray[np.uint8] | None = None
    uv: NDArray[np.float64] | None = None
    image: bytes | None = None


def take_colors(part: Any, kind: str, files: MeshFiles | None) -> PartColors:
    """Return the look of a trimesh and remove it there, so that images are neither copied nor joined.

    Args:
        part: the trimesh.
        kind: format of the file.
        files: collects remarks; without it, there are no textures.
    """
    import trimesh

    visual, part.visual = part.visual, trimesh.visual.ColorVisuals()
    material = getattr(visual, "material", None)
    if material is None:
        several = getattr(visual, "kind", None) in ("face", "vertex")
        return PartColors(np.asarray(visual.face_colors, dtype=np.uint8)) if several else PartColors()
    color = np.asarray(getattr(material, "main_color", ()))
    color = color.astype(np.uint8) if color.shape == (4,) else np.array(GREY, dtype=np.uint8)
    color = np.append(color[:3], np.uint8(255)) if color[3] < INVISIBLE else color
    image = getattr(material, "baseColorTexture", None) or getattr(material, "image", None)
    if image is None:
        added = kind in ("obj", "ply") and tuple(color) == PLAIN
        return PartColors() if added else PartColors(color)
    if files is None:
        return PartColors(color)
    made = _png(image, files)
    if made is None:
        return PartColors(color)
    data, mean = made
    uv = getattr(visual, "uv", None)
    if uv is None or np.shape(uv) != (len(part.vertices), 2) or not np.all(np.isfinite(uv)):
        files.remarks.append(f"a texture of the mesh {files.path.name} has no coordinates; its mean colour is used")
        return PartColors(mean)
    factor = color if kind == "glb" else np.array([255, 255, 255, 255], dtype=np.uint8)
    return PartColors(factor, np.clip(np.asarray(uv, dtype=np.float64), -1e3, 1e3), data)


def _png(image: Any, files: MeshFiles) -> tuple[bytes, NDArray[np.uint8]] | None:
    """Return an image as a PNG file and its mean colour ``[4]``, or None with a remark."""
    width, height = image.size
    if image.format not in FORMATS or width * height > MOST_PIXELS:
        reason = f"has {width} x {height} pixels, at most {MOST_PIXELS} are allowed"
        reason = reason if image.format in FORMATS else f"has the format {str(image.format)[:20]}"
        files.remarks.append(f"a texture of the mesh {files.path.name} {reason}; its colour is used")
        return None
    try:
        image.draft("RGB", (MOST_SIDE, MOST_SIDE))
        whole = image.convert("RGB")
        whole.thumbnail((MOST_SIDE, MOST_SIDE))
        stream = io.BytesIO()
        whole.save(stream, "PNG", compress_level=1)
        mean = np.asarray(whole.resize((1, 1), 4), dtype=np.uint8).ravel()
    except Exception as error:  # a broken image causes many kinds of exceptions inside Pillow
        reason = f"{type(error).__name__}: {str(error)[:80]}"
        files.remarks.append(f"a texture of the mesh {files.path.name} cannot be read ({reason}); its colour is used")
        return None
    return stream.getvalue(), np.append(mean[:3], np.uint8(255)).astype(np.uint8)


def mean_color(path: Path) -> tuple[float, float, float, float]:
    """Return the mean colour (red, green, blue, alpha) of an image file.

    Raises:
        InputError: the file is not an image, or is too large; the end of a sentence.
    """
    from PIL import Image

    if path.stat().st_size > MOST_BYTES:
        raise InputError(f"is larger than {MOST_BYTES} bytes, the maximum")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            image = Image.open(io.BytesIO(path.read_bytes()), formats=FORMATS)
            if image.size[0] * image.size[1] > MOST_PIXELS:
                raise InputError(f"has {image.size[0]} x {image.size[1]} pixels, at most {MOST_PIXELS} are allowed")
            red, green, blue = np.asarray(image.convert("RGB").resize((1, 1), Image.Resampling.BOX))[0, 0] / 255.0
        except InputError:
            raise
        except Exception as error:  # a broken image causes many kinds of exceptions inside Pillow
            raise InputError(f"cannot be read as an image: {type(error).__name__}") from None
    return float(red), float(green), float(blue), 1.0


def join_colors(
    parts: list[tuple[Any, PartColors]],
) -> tuple[NDArray[np.uint8] | None, NDArray[np.float64] | None, tuple[Texture, ...]]:
    """Return colours ``[M, 4]`` of all triangles, texture coordinates ``[N, 2]``, and textures with their triangles.

    Args:
        parts: trimeshes with their look, in the order in which they are joined.
    """
    if not any(look.color is not None for _, look in parts):
        return None, None, ()
    colors, coordinates, textures, first = [], [], [], 0
    for part, look in parts:
        count = len(part.faces)
        color = np.array(GREY, dtype=np.uint8) if look.color is None else look.color
        colors.append(np.broadcast_to(color, (count, 4)))
        coordinates.append(np.zeros((len(part.vertices), 2)) if look.uv is None else look.uv)
        if look.image is not None:
            red, green, blue, alpha = (float(value) / 255.0 for value in color)
            textures.append(Texture(first, first + count, look.image, (red, green, blue, alpha)))
        first += count
    return np.concatenate(colors), np.concatenate(coordinates) if textures else None, tuple(textures)

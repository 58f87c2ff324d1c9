"""Textures of robot meshes as arrays of a state frame, within limits."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = ["TexturedFaces", "texture_arrays"]

MOST_IMAGES = 64
"""Largest number of images of a robot; the triangles of others have their mean colour."""
MOST_BYTES = 12_000_000
"""Largest size of all images of a robot [B]; larger ones are halved until they fit."""


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
    for one in textures:
        if one.image not in numbers and len(numbers) < MOST_IMAGES:
            numbers[one.image] = len(numbers)
    rows = [(one.first, one.last, numbers[one.image]) for one in textures if one.image in numbers]
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

"""BackgroundPicture: a picture behind the scene, seen from above."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

MOST_PIXELS = 40_000_000
"""Largest picture that is read."""
LONGEST = 1600
"""Longest side of the picture that the page gets [px]."""
KINDS = ("PNG", "JPEG", "WEBP", "BMP", "TIFF", "GIF")
WIDEST = 2000.0
"""Largest extent of a picture on the ground [m]."""


class BackgroundPicture:
    """A picture of the ground, drawn from above: its pixels are warped to the coordinates of the tracks.

    Args:
        path: picture.
        homography: ``[3, 3]`` from (column, row, 1) of the picture to the coordinates of the tracks; None if the tracks
            are in pixels of the picture.

    Attributes:
        bounds: left, bottom, right and top in the coordinates of the tracks.
        data: PNG.

    Raises:
        InputError: the file is not a picture, is too large, or the homography puts it nowhere.
    """

    def __init__(self, path: Path, homography: NDArray[np.float64] | None) -> None:
        from PIL import Image, UnidentifiedImageError

        matrix = np.eye(3) if homography is None else homography
        try:
            with Image.open(path, formats=KINDS) as picture:
                if picture.width * picture.height > MOST_PIXELS:
                    raise InputError(f"{path.name} has {picture.width} x {picture.height} pixels, more than 40 million")
                pixels = picture.convert("RGB")
        except (UnidentifiedImageError, OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
            if isinstance(error, InputError):
                raise
            raise InputError(f"{path.name} is not a picture ({', '.join(KINDS)})") from None
        self.bounds = _ground_bounds(matrix, pixels.width, pixels.height, path.name)
        left, bottom, right, top = self.bounds
        scale = LONGEST / max(right - left, top - bottom)
        size = max(1, round((right - left) * scale)), max(1, round((top - bottom) * scale))
        ground = np.array([[1.0 / scale, 0.0, left], [0.0, -1.0 / scale, top], [0.0, 0.0, 1.0]])
        back = np.linalg.inv(matrix) @ ground
        back /= back[2, 2]
        warped = pixels.transform(
            size, Image.Transform.PERSPECTIVE, back.ravel()[:8].tolist(), Image.Resampling.BILINEAR
        )
        buffer = io.BytesIO()
        warped.save(buffer, "PNG")
        self.name, self.data = path.name, buffer.getvalue()

    @property
    def facts(self) -> dict[str, Any]:
        """Name and bounds as JSON."""
        return {"name": self.name, "bounds": [*self.bounds]}


def parse_homography(text: str) -> NDArray[np.float64]:
    """Return a homography from nine numbers, or from one: metres per pixel, with y upwards.

    Raises:
        InputError: there are not one or nine numbers, or the matrix cannot be inverted.

    >>> parse_homography("0.02").tolist()
    [[0.02, 0.0, 0.0], [0.0, -0.02, 0.0], [0.0, 0.0, 1.0]]
    """
    try:
        numbers = np.array([float(word) for word in text.replace(",", " ").split()])
    except ValueError:
        raise InputError(f"homography = {text!r:.60}: expected nine numbers, or metres per pixel") from None
    if numbers.shape == (1,):
        matrix = np.diag([numbers[0], -numbers[0], 1.0])
    elif numbers.shape == (9,):
        matrix = numbers.reshape(3, 3)
    else:
        raise InputError(f"a homography has 9 numbers, not {len(numbers)}")
    if not np.all(np.isfinite(matrix)) or abs(np.linalg.det(matrix)) < 1e-12:
        raise InputError("the homography must be finite and invertible")
    return matrix


def _ground_bounds(
    matrix: NDArray[np.float64], width: int, height: int, name: str
) -> tuple[float, float, float, float]:
    corners = np.array([[0, 0, 1], [width, 0, 1], [width, height, 1], [0, height, 1]], dtype=float) @ matrix.T
    if np.any(corners[:, 2] * corners[0, 2] <= 0.0):
        raise InputError(f"{name}: the homography puts the horizon into the picture")
    points = corners[:, :2] / corners[:, 2:]
    low, high = points.min(axis=0), points.max(axis=0)
    limit = WIDEST if not np.array_equal(matrix, np.eye(3)) else 1e5
    if not np.all(high - low > 1e-6) or np.any(high - low > limit):
        raise InputError(f"{name}: the homography makes the picture {high[0] - low[0]:.3g} m wide")
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])

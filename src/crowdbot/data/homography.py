"""Homography files: the 3 x 3 matrix from pixels of a picture to metres on the ground."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError

from .source import Source

LARGEST = 64 * 1024
"""Largest homography file [bytes]."""


def read_homography(path: str | PathLike[str]) -> NDArray[np.float64]:
    """Read the matrix ``[3, 3]`` from (x, y, 1) in pixels to metres, as in the files ``H.txt`` of ETH and UCY.

    Args:
        path: text file with three lines of three numbers; "#" begins a comment.

    Raises:
        DataError: the file is missing, larger than 64 KiB, has another shape, or a matrix without an inverse.

    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder, "H.txt")
    ...     _ = path.write_text("0.02 0 -1\\n0 0.02 2\\n0 0 1\\n")
    ...     read_homography(path).tolist()
    [[0.02, 0.0, -1.0], [0.0, 0.02, 2.0], [0.0, 0.0, 1.0]]
    """
    source = Source.of(Path(path))
    if source.path.stat().st_size > LARGEST:
        raise DataError(f"{path} is larger than {LARGEST} bytes; a homography has three lines of three numbers")
    try:
        matrix, _ = source.table(3)
    except DataError as error:
        raise DataError(f"the homography {error}; it must have three lines of three numbers") from None
    if matrix.shape != (3, 3) or not np.all(np.isfinite(matrix)) or abs(np.linalg.det(matrix)) < 1e-300:
        raise DataError(f"{path} is not a homography: three lines of three finite numbers, a matrix with an inverse")
    return matrix

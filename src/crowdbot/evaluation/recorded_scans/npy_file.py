"""One row of numbers in a file of NumPy's NPY format."""

from __future__ import annotations

import io
import math
import tokenize
from pathlib import Path

import numpy as np
from numpy.lib import format as npy

from crowdbot.core import DataError
from crowdbot.typing import Floats

LARGEST = 131_072
"""Largest size of a file [bytes]."""
HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
"""Readers of the header by version of the format."""
WRONG = (ValueError, TypeError, SyntaxError, RecursionError, MemoryError, OverflowError, tokenize.TokenError)
"""What the readers of the header raise on damaged files."""


def read_npy_row(path: Path) -> Floats:
    """Return the numbers ``[N]`` of a file; its array has at most one axis that is longer than 1.

    Only the header is parsed, so that neither pickled objects nor the memory that a header asks for are created.

    Raises:
        DataError: the file is missing, too large or damaged.
    """
    try:
        if not path.is_file() or path.stat().st_size > LARGEST:
            raise DataError(f"{path} must be a file of at most {LARGEST // 1024} KiB")
        data = path.read_bytes()
    except OSError as error:
        raise DataError(f"{path} cannot be read: {error}") from None
    stream = io.BytesIO(data)
    try:
        shape, _, kind = HEADERS[npy.read_magic(stream)](stream)
    except (*WRONG, KeyError):
        raise DataError(f"{path} is not an NPY file of version 1.0 or 2.0") from None
    rest = data[stream.tell() :]
    if kind.kind not in "fiu":
        raise DataError(f"{path} has values of type {str(kind)[:40]}, it must have numbers")
    if max(shape, default=1) != math.prod(shape) or math.prod(shape) * kind.itemsize != len(rest):
        raise DataError(f"{path} has {len(rest)} bytes of shape {str(shape)[:60]}, it must have one row of {kind}")
    return np.frombuffer(rest, kind).astype(np.float64)

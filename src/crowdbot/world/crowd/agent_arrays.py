"""Arrays of agents in the form that kernels accept."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["BOOL", "FLOAT", "dense"]

FLOAT = np.dtype(np.float64)
BOOL = np.dtype(np.bool_)


def dense(value: NDArray[Any], shape: tuple[int, ...], kind: np.dtype[Any]) -> Any:
    """Return an array as C-contiguous, aligned and writeable array; a copy only if necessary.

    >>> dense(np.zeros(2), (3, 2), FLOAT).shape
    (3, 2)
    """
    if value.dtype is kind and value.shape == shape and value.flags.carray:
        return value
    return np.require(np.broadcast_to(np.asarray(value, dtype=kind), shape), requirements=["C", "A", "W"])

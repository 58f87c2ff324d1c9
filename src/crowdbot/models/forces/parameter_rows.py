"""Shared functions of force models: parameters as rows for kernels, and limited vectors."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel, per_agent

__all__ = ["limit_length", "parameter_rows"]

Floats = NDArray[np.float64]


def parameter_rows(model: Any, names: Sequence[str], shape: tuple[int, int]) -> Floats:
    """Return the parameters ``names`` of a model as ``[E * A, N]``, or ``[1, N]`` if they are equal for all agents.

    Raises:
        InputError: a parameter does not broadcast to ``shape`` [E, A].

    >>> from types import SimpleNamespace
    >>> parameter_rows(SimpleNamespace(a=1.0, b=np.array([2.0, 3.0])), ["a", "b"], (1, 2)).tolist()
    [[1.0, 2.0], [1.0, 3.0]]
    """
    values = [getattr(model, name) for name in names]
    if all(type(value) is float or np.ndim(value) == 0 for value in values):
        return np.array([values], dtype=np.float64)
    columns = [per_agent(value, shape, name).reshape(-1) for value, name in zip(values, names, strict=True)]
    return np.ascontiguousarray(np.stack(columns, axis=1))


@kernel
def limit_length(x: float, y: float, longest: float) -> tuple[float, float]:
    """Return the vector x, y limited to the length ``longest``."""
    length = math.sqrt(x * x + y * y)
    if length <= longest:
        return x, y
    return x * (longest / length), y * (longest / length)

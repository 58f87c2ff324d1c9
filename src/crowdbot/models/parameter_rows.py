"""Shared functions of models: parameters for kernels, and limited vectors."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from crowdbot.core import kernel, per_agent
from crowdbot.typing import Floats


def parameter_rows(model: Any, names: Sequence[str], shape: tuple[int, int]) -> Floats:
    """Return the parameters ``names`` of a model as ``[E * A, N]``, or ``[1, N]`` if they are equal for all agents.

    Raises:
        InputError: a parameter does not broadcast to ``shape`` [E, A].

    >>> from types import SimpleNamespace
    >>> parameter_rows(SimpleNamespace(a=1.0, b=np.array([2.0, 3.0])), ["a", "b"], (1, 2)).tolist()
    [[1.0, 2.0], [1.0, 3.0]]
    """
    values = [getattr(model, name) for name in names]
    for value in values:
        if type(value) is not float and np.ndim(value) > 0:
            break
    else:
        return np.array([values], dtype=np.float64)
    table = np.empty((shape[0] * shape[1], len(names)))
    for k, (value, name) in enumerate(zip(values, names, strict=True)):
        table[:, k] = per_agent(value, shape, name).reshape(-1)
    return table


def parameter_columns(model: Any, shape: tuple[int, int], *names: str) -> tuple[Floats, ...]:
    """Return each of the parameters ``names`` of a model by row, ``[E * A]``.

    Raises:
        InputError: a parameter does not broadcast to ``shape`` [E, A].

    >>> from types import SimpleNamespace
    >>> [column.tolist() for column in parameter_columns(SimpleNamespace(a=1.0, b=2.0), (1, 2), "a", "b")]
    [[1.0, 1.0], [2.0, 2.0]]
    """
    return tuple(per_agent(getattr(model, name), shape, name).reshape(-1) for name in names)


@kernel
def limit_length(x: float, y: float, longest: float) -> tuple[float, float]:
    """Return the vector x, y limited to the length ``longest``."""
    length = math.sqrt(x * x + y * y)
    if length <= longest:
        return x, y
    return x * (longest / length), y * (longest / length)

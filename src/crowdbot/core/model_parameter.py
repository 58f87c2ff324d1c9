"""Parameters of models: one table for docs, command line, XML and calibration.

A model is a frozen dataclass with fields defined by :func:`parameter`. A value is a number for all agents, or an array
that broadcasts to ``[E, A]``.
"""

from __future__ import annotations

import dataclasses
import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .bounds import Bounds
from .errors import InputError

FLOAT, BOOL = np.dtype(np.float64), np.dtype(np.bool_)

PerAgent = float | NDArray[np.float64]
"""A number for all agents, or an array that broadcasts to ``[E, A]``."""


@dataclass(frozen=True)
class Parameter:
    """One row of a parameter table: ``low`` and ``high`` limit calibration, ``min`` and ``max`` all values."""

    name: str
    unit: str
    default: float
    low: float
    high: float
    source: str
    min: float = 0.0
    max: float | None = None

    def bounds(self, largest: float | None = None) -> Bounds:
        """Return the allowed range; ``largest`` is the upper limit if ``max`` is None."""
        highest = largest if self.max is None else self.max
        return Bounds("" if self.unit == "1" else self.unit, min=self.min, max=highest)


def parameter(
    default: float,
    *,
    unit: str,
    low: float,
    high: float,
    source: str,
    min: float = 0.0,
    max: float | None = None,
) -> Any:
    """Make the dataclass field of one parameter.

    Args:
        default: default value.
        unit: SI unit, ``1`` for dimensionless parameters.
        low, high: limits for calibration.
        source: source of the default.
        min: minimum value.
        max: maximum value (default: that of the model).
    """
    row = Parameter("", unit, default, low, high, source, min, max)
    return dataclasses.field(default=default, metadata={"parameter": row})


def parameters(model: Any) -> tuple[Parameter, ...]:
    """Return the parameter table of a model or model class, in the order of its fields."""
    return _table(model if isinstance(model, type) else type(model))


@functools.lru_cache(maxsize=256)
def _table(kind: Any) -> tuple[Parameter, ...]:
    return tuple(
        dataclasses.replace(field.metadata["parameter"], name=field.name)
        for field in dataclasses.fields(kind)
        if "parameter" in field.metadata
    )


def check_parameters(model: Any, largest: float | None = None) -> None:
    """Raise :class:`InputError` if a parameter is outside its range.

    Args:
        model: an instance with parameters.
        largest: upper limit of parameters without ``max``; None for no limit.
    """
    for row in parameters(model):
        value, bounds = getattr(model, row.name), row.bounds(largest)
        if not bounds.holds(value):
            raise InputError(
                f"{type(model).__name__}: {row.name} = {bounds.worst(value)} [{row.unit}] is not allowed,"
                f" it must be {bounds.describe()}"
            )


def per_agent(value: PerAgent, shape: tuple[int, int], name: str = "parameter") -> NDArray[np.float64]:
    """Return ``value`` as a contiguous float64 array of ``shape`` ``[E, A]``.

    >>> per_agent(0.5, (1, 3)).tolist()
    [[0.5, 0.5, 0.5]]
    """
    try:
        return dense(value, shape, FLOAT)
    except ValueError:
        got = np.shape(value)
        raise InputError(f"{name} has shape {got}, which does not broadcast to [E, A] = {list(shape)}") from None


def dense(value: Any, shape: tuple[int, ...], kind: np.dtype[Any]) -> NDArray[Any]:
    """Return a value as an array that kernels accept: C-contiguous, aligned and writeable; a copy only if necessary.

    Args:
        value: a number or an array.
        shape: shape of the result, to which the value is broadcast.
        kind: data type of the result.

    Raises:
        ValueError: the value does not broadcast to the shape.

    >>> dense(2.0, (1, 3), np.dtype(np.int32)).tolist()
    [[2, 2, 2]]
    """
    if type(value) is np.ndarray:
        if value.dtype is kind and value.shape == shape and value.flags.carray:
            return value
    elif type(value) is float or type(value) is bool or type(value) is int:
        array = np.empty(shape, dtype=kind)
        array.fill(value)
        return array
    # writeable: numba has a separate type for read-only arrays
    return np.require(np.broadcast_to(np.asarray(value, dtype=kind), shape), requirements=["C", "A", "W"])

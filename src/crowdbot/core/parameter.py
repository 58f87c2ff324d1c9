"""Parameters of models: one table serves docs, command line, XML and calibration.

A model is a frozen dataclass whose fields are made by :func:`parameter`. A value is a number for all agents, or an
array that broadcasts to ``[E, A]``.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import InputError

__all__ = ["Parameter", "PerAgent", "check_parameters", "parameter", "parameters", "per_agent"]

PerAgent = float | NDArray[np.float64]
"""A number for everyone, or an array that broadcasts to ``[E, A]``."""


@dataclass(frozen=True)
class Parameter:
    """One row of a parameter table: ``low`` and ``high`` are the calibration box, ``minimum`` what is allowed."""

    name: str
    unit: str
    default: float
    low: float
    high: float
    source: str
    minimum: float = 0.0


def parameter(default: float, *, unit: str, low: float, high: float, source: str, minimum: float = 0.0) -> Any:
    """Make the dataclass field of one parameter.

    Args:
        default: value when none is given.
        unit: SI unit, ``1`` when it has none.
        low, high: calibration box.
        source: where the default comes from.
        minimum: smallest allowed value.
    """
    row = Parameter("", unit, default, low, high, source, minimum)
    return dataclasses.field(default=default, metadata={"parameter": row})


def parameters(model: Any) -> tuple[Parameter, ...]:
    """Return the parameter table of a model or model class, in the order of its fields."""
    return tuple(
        dataclasses.replace(field.metadata["parameter"], name=field.name)
        for field in dataclasses.fields(model)
        if "parameter" in field.metadata
    )


def check_parameters(model: Any) -> None:
    """Raise :class:`InputError` unless every parameter is finite and not below its minimum."""
    for row in parameters(model):
        value = np.asarray(getattr(model, row.name), dtype=float)
        if not np.all(np.isfinite(value)) or np.any(value < row.minimum):
            worst = value.flat[int(np.argmin(np.where(np.isfinite(value), value, -np.inf)))]
            raise InputError(
                f"{type(model).__name__}: {row.name} = {worst} [{row.unit}] is not allowed,"
                f" it must be finite and at least {row.minimum}"
            )


def per_agent(value: PerAgent, shape: tuple[int, int], name: str = "parameter") -> NDArray[np.float64]:
    """Return ``value`` as a contiguous float64 array of ``shape`` ``[E, A]``.

    >>> per_agent(0.5, (1, 3)).tolist()
    [[0.5, 0.5, 0.5]]
    """
    try:
        return np.ascontiguousarray(np.broadcast_to(np.asarray(value, dtype=np.float64), shape))
    except ValueError:
        got = np.shape(value)
        raise InputError(f"{name} has shape {got}, which does not broadcast to [E, A] = {list(shape)}") from None

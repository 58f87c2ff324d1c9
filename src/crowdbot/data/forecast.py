"""Forecast: where people are expected to be, as weighted samples."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Forecast"]


@dataclass(frozen=True)
class Forecast:
    """Predicted positions of the people of W windows.

    Fields:
        position: ``[W, K, T, A, 2]`` [m]: windows, samples, future steps 1..T, people in the order of the past.
        weight: ``[W, K]``, each row sums to 1.
        valid: ``[W, A]`` bool: people that were predicted (present at the last observed step).
        dt: time step [s].
        predictor: name of what made it.
    """

    position: NDArray[np.float64]
    weight: NDArray[np.float64]
    valid: NDArray[np.bool_]
    dt: float
    predictor: str

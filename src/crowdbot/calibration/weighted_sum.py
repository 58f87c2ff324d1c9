"""Weighted sum of costs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

from .cost import Cost
from .resimulation import ResimulatedTracks


@dataclass(frozen=True)
class WeightedSum(Cost):
    """Weighted sum of several costs; people count if they count in all of them.

    Fields:
        parts: the costs.
        weights: one weight per cost, at least 0 and not all 0.

    Raises:
        InputError: there is no cost, or the weights do not fit.

    >>> from crowdbot.calibration import Absolute, InterPedestrian
    >>> WeightedSum((Absolute(), InterPedestrian()), (1.0, 0.5)).weights
    (1.0, 0.5)
    """

    parts: tuple[Cost, ...]
    weights: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.parts) == 0 or len(self.parts) != len(self.weights):
            raise InputError(
                f"weighted-sum: {len(self.parts)} costs and {len(self.weights)} weights; each cost needs one weight"
            )
        if not all(0.0 <= weight < math.inf for weight in self.weights) or sum(self.weights) == 0.0:
            raise InputError(f"weighted-sum: weights {self.weights} must be finite, at least 0 and not all 0")

    def measure(self, tracks: ResimulatedTracks) -> NDArray[np.float64]:
        """Return the weighted sum for every candidate and person, see :meth:`Cost.measure`."""
        return reduce(
            np.add,
            (weight * part.measure(tracks) for part, weight in zip(self.parts, self.weights, strict=True)),
        )

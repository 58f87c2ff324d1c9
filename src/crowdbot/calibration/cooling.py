"""Cooling: temperature schedules over the budget."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

from crowdbot.core import InputError


@dataclass(frozen=True)
class Cooling(ABC):
    """Temperature as a function of the spent share of the budget."""

    @abstractmethod
    def at(self, progress: float) -> float:
        """Return the temperature at the spent share ``progress`` of the budget, 0 to 1."""


@dataclass(frozen=True)
class Geometric(Cooling):
    """Geometric decrease from ``start`` to ``end``.

    Source: Kirkpatrick, Gelatt & Vecchi (1983), doi 10.1126/science.220.4598.671.

    Raises:
        InputError: a temperature is not finite and above 0, or the end is above the start.

    >>> [round(Geometric(1.0, 0.01).at(progress), 3) for progress in (0.0, 0.5, 1.0)]
    [1.0, 0.1, 0.01]
    """

    start: float = 0.1
    end: float = 1e-4

    def __post_init__(self) -> None:
        if not 0.0 < self.end <= self.start < math.inf:
            raise InputError(
                f"geometric cooling: from {self.start} to {self.end} must fall and stay above 0, and both be finite"
            )

    def at(self, progress: float) -> float:
        """Return the temperature, see :meth:`Cooling.at`."""
        return float(self.start * (self.end / self.start) ** progress)

"""Costs: how far a simulated crowd is from the recorded one."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Paper
from crowdbot.data.windows import Windows

__all__ = ["AbsoluteDifference", "Cost", "Simulate"]

Floats = NDArray[np.float64]

Simulate = Callable[[Windows, int], Floats]
"""Called with windows and a row, runs P candidates from that row on: ``[P, W, rows after it, A, 2]`` [m]."""


@dataclass(frozen=True)
class Cost(ABC):
    """A dissimilarity between what was recorded and what candidates make of it, person by person."""

    @abstractmethod
    def measure(self, past: Windows, simulate: Simulate) -> Floats:
        """Return the cost ``[P, W, A]`` of every candidate and person; NaN for people that do not count.

        Args:
            past: observed rows.
            simulate: runs the candidates, on these windows or on windows cut out of them.
        """


@dataclass(frozen=True)
class AbsoluteDifference(Cost):
    """Mean distance [m] between simulated and recorded positions, over all rows, started once at the first one.

    People count who are seen at the first row and at another one; robots do not.

    Source: Wolinski et al. (2014), doi 10.1111/cgf.12328.
    """

    paper: ClassVar[Paper] = Paper(
        "Wolinski, Guy, Olivier, Lin, Manocha, Pettré",
        2014,
        "Parameter estimation and comparative evaluation of crowd simulations",
        "Computer Graphics Forum",
        "10.1111/cgf.12328",
    )

    def measure(self, past: Windows, simulate: Simulate) -> Floats:
        """Return the mean distance of every candidate and person, see :meth:`Cost.measure`."""
        away = simulate(past, 0) - past.position[:, 1:]
        rows = past.present[:, 1:] & (past.present[:, 0] & ~past.robot)[:, None]
        distance = np.where(rows, np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2), 0.0)
        count = rows.sum(axis=1)
        return np.where(count > 0, distance.sum(axis=2) / np.maximum(count, 1), np.nan)

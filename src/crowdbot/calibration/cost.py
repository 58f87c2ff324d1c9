"""Cost: contract of the dissimilarity between a simulated and a recorded crowd."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Paper
from crowdbot.typing import Floats

from .resimulation import ResimulatedTracks

METRICS = Paper(
    "Wolinski, Guy, Olivier, Lin, Manocha, Pettré",
    2014,
    "Parameter estimation and comparative evaluation of crowd simulations",
    "Computer Graphics Forum",
    "10.1111/cgf.12328",
)
"""Source of the three costs of the literature."""


@dataclass(frozen=True)
class Cost(ABC):
    """Dissimilarity between recorded and simulated tracks, for each person [m]."""

    paper: ClassVar[Paper] = METRICS

    @abstractmethod
    def measure(self, tracks: ResimulatedTracks) -> Floats:
        """Return the cost ``[P, W, A]`` [m] of every candidate and person; NaN for people that do not count.

        The people who count depend on the recording only, not on the candidate. Robots never count.
        """


def mean_over_rows(distance: Floats, counted: NDArray[np.bool_]) -> Floats:
    """Return the mean over the counted rows ``[P, W, A]`` of ``distance [P, W, T, A]``; NaN where no row counts."""
    count = counted.sum(axis=1)
    total = np.where(counted, distance, 0.0).sum(axis=2)
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)

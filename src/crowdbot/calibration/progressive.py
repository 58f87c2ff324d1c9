"""Progressive difference: how far people are from where they were seen one row after the simulation began."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .cost import Cost, mean_over_rows
from .resimulation import ResimulatedTracks

__all__ = ["Progressive"]


@dataclass(frozen=True)
class Progressive(Cost):
    """Mean distance [m] one row ahead, when the simulation begins anew at every observed row.

    Rows from the second on begin a simulation: there the velocity is known from the rows before. People count who are
    seen at a row that begins one and at the row after it, so at least three rows are needed.

    Source: Wolinski et al. (2014), doi 10.1111/cgf.12328.
    """

    def measure(self, tracks: ResimulatedTracks) -> NDArray[np.float64]:
        """Return the mean distance of every candidate and person, see :meth:`Cost.measure`."""
        past = tracks.past
        away = tracks.stepwise - past.position[:, 2:]
        counted = past.present[:, 2:] & past.present[:, 1:-1] & ~past.robot[:, None]
        return mean_over_rows(np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2), counted)

"""Absolute: distance between simulated and recorded positions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .cost import Cost, mean_over_rows
from .resimulation import ResimulatedTracks


@dataclass(frozen=True)
class Absolute(Cost):
    """Mean distance [m] between simulated and recorded positions, simulated from the first row over all rows.

    People count if they are observed at the first row and at another row.

    Source: Wolinski et al. (2014), doi 10.1111/cgf.12328.
    """

    def measure(self, tracks: ResimulatedTracks) -> NDArray[np.float64]:
        """Return the mean distance of every candidate and person, see :meth:`Cost.measure`."""
        past = tracks.past
        away = tracks.once - past.position[:, 1:]
        counted = past.present[:, 1:] & (past.present[:, 0] & ~past.robot)[:, None]
        return mean_over_rows(np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2), counted)

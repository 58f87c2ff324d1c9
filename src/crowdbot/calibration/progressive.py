"""Progressive: distance between simulated and recorded positions one row ahead."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .cost import Cost, mean_over_rows
from .resimulation import ResimulatedTracks


@dataclass(frozen=True)
class Progressive(Cost):
    """Mean distance [m] between simulated and recorded positions one row ahead of every observed row.

    A simulation of one row starts at each row from the second on, where the velocity is known from the previous row.
    People count if they are observed at such a row and at the next one, so at least three rows are needed.

    Source: Wolinski et al. (2014), doi 10.1111/cgf.12328.
    """

    def measure(self, tracks: ResimulatedTracks) -> NDArray[np.float64]:
        """Return the mean distance of every candidate and person, see :meth:`Cost.measure`."""
        past = tracks.past
        away = tracks.stepwise - past.position[:, 2:]
        counted = past.present[:, 2:] & past.present[:, 1:-1] & ~past.robot[:, None]
        return mean_over_rows(np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2), counted)

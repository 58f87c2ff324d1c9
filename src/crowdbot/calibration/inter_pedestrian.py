"""InterPedestrian: difference between simulated and recorded distances of pairs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crowdbot.core import kernel, prange
from crowdbot.typing import Bools, Floats

from .cost import Cost
from .resimulation import ResimulatedTracks


@kernel(parallel=True)
def _differ(simulated: Floats, recorded: Floats, counted: Bools, total: Floats) -> None:
    """Sum the differences between simulated and recorded distances of each person to all others, over all rows."""
    P, W, T, A = simulated.shape[:4]
    for pw in prange(P * W):
        p, w = pw // W, pw % W
        for t in range(T):
            for a in range(A):
                if not counted[w, t, a]:
                    continue
                for b in range(a):
                    if not counted[w, t, b]:
                        continue
                    dx = simulated[p, w, t, a, 0] - simulated[p, w, t, b, 0]
                    dy = simulated[p, w, t, a, 1] - simulated[p, w, t, b, 1]
                    ex = recorded[w, t, a, 0] - recorded[w, t, b, 0]
                    ey = recorded[w, t, a, 1] - recorded[w, t, b, 1]
                    gap = abs(np.sqrt(dx * dx + dy * dy) - np.sqrt(ex * ex + ey * ey))
                    total[p, w, a] += gap
                    total[p, w, b] += gap


@dataclass(frozen=True)
class InterPedestrian(Cost):
    """Mean difference [m] between simulated and recorded distances of each person to all others, over all rows.

    The simulation starts at the first row. A pair counts at the rows where both are observed, if both are present at
    the first row. People without a pair do not count.

    Source: Wolinski et al. (2014), doi 10.1111/cgf.12328.
    """

    def measure(self, tracks: ResimulatedTracks) -> Floats:
        """Return the mean difference of every candidate and person, see :meth:`Cost.measure`."""
        past, simulated = tracks.past, np.ascontiguousarray(tracks.once)
        counted = past.present[:, 1:] & (past.present[:, 0] & ~past.robot)[:, None]
        others = np.where(counted, counted.sum(axis=2, keepdims=True) - 1, 0).sum(axis=1)
        total = np.zeros((*simulated.shape[:2], simulated.shape[3]))
        _differ(simulated, np.ascontiguousarray(past.position[:, 1:]), counted, total)
        return np.where(others > 0, total / np.maximum(others, 1), np.nan)

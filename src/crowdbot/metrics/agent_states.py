"""AgentStates: states of the agents present at one time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["AgentStates"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class AgentStates:
    """States of the N agents, people and robots, present at one time.

    Fields:
        time: simulated time [s].
        ids: identity of each agent ``[N]``, increasing.
        position, velocity: ``[N, 2]`` [m], [m/s].
        heading, radius: ``[N]`` [rad], [m].

    >>> here = AgentStates(0.0, np.array([4]), np.ones((1, 2)), np.zeros((1, 2)), np.zeros(1), np.array([0.3]))
    >>> here.at(np.array([4, 7]))[2].tolist()
    [True, False]
    """

    time: float
    ids: NDArray[np.int64]
    position: Floats
    velocity: Floats
    heading: Floats
    radius: Floats

    def at(self, ids: NDArray[np.int64]) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """Return position and velocity ``[M, 2]`` of the given agents, 0 if absent, and which are present ``[M]``."""
        place = np.clip(np.searchsorted(self.ids, ids), 0, len(self.ids) - 1)
        here = self.ids[place] == ids
        return (
            np.where(here[:, None], self.position[place], 0.0),
            np.where(here[:, None], self.velocity[place], 0.0),
            here,
        )

"""Tracks: the people whom a tracker follows at one instant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import storable
from crowdbot.typing import Floats


@storable
@dataclass(frozen=True)
class Tracks:
    """People followed by a tracker at one instant, in the world frame.

    Fields:
        time: time [s].
        ids: ``[N]`` identities, from 0 in the order of their first detection; none is used twice.
        position, velocity: ``[N, 2]`` [m], [m/s].
        covariance: ``[N, 4, 4]`` of x, y, vx, vy.
        existence: ``[N]`` probability that there is a person.
        detected: ``[N]`` whether the person was detected at this instant, otherwise the motion is continued.

    >>> Tracks.none(0.5).position.shape
    (0, 2)
    """

    time: float
    ids: NDArray[np.int64]
    position: Floats
    velocity: Floats
    covariance: Floats
    existence: Floats
    detected: NDArray[np.bool_]

    @classmethod
    def none(cls, time: float) -> Tracks:
        """Return nobody."""
        empty = np.zeros((0, 2))
        nobody = np.zeros(0, dtype=np.int64)
        return cls(time, nobody, empty, empty, np.zeros((0, 4, 4)), np.zeros(0), np.zeros(0, dtype=np.bool_))

    def __len__(self) -> int:
        """Return the number of people."""
        return len(self.ids)

    def at(self, time: float) -> Floats:
        """Return positions ``[N, 2]`` [m] at another time [s], with constant velocities."""
        return np.asarray(self.position + (time - self.time) * self.velocity)

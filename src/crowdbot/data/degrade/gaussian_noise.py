"""Gaussian noise: independent errors of every measured position."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.core import parameter

from .degradation import Degradation, DegradedTracks


@dataclass(frozen=True)
class GaussianNoise(Degradation):
    """Adds an independent normal error to every coordinate of every row.

    Fields:
        sd: standard deviation of a coordinate [m]; the level.

    >>> from crowdbot.data.trajectories import Trajectories
    >>> tracks = Trajectories([7, 7], [0, 10], [0.0, 0.5], [2.0, 2.0], row_rate=2.5)
    >>> GaussianNoise(0.0).apply(tracks).tracks is tracks, str(GaussianNoise(0.1))
    (True, 'gaussian-noise(sd=0.1 m)')
    """

    sd: float = parameter(
        0.05, unit="m", low=0.0, high=0.3,
        source="what Kalman.fit finds in four drone recordings of the TrajNet cut (0.054 m)",
    )  # fmt: skip

    level: ClassVar[str] = "sd"
    levels: ClassVar[tuple[float, ...]] = (0.0, 0.02, 0.05, 0.1, 0.2)

    def degrade(self, seen: DegradedTracks, rng: np.random.Generator) -> DegradedTracks:
        return seen.displace(self.sd * rng.standard_normal((len(seen.tracks), 2)))

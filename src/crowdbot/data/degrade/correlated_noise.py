"""Correlated noise: drifting errors, as of trackers that smooth or follow one edge of a body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.core import Paper, parameter

from .degradation import Degradation, DegradedTracks
from .row_ranks import iterate_ranks


@dataclass(frozen=True)
class CorrelatedNoise(Degradation):
    """Adds an independent first-order Gauss-Markov error to every coordinate of a track.

    Errors at times t and s of one track have the correlation exp(-|t - s| / time), also across gaps. ``time=0`` is
    white noise.

    Fields:
        sd: standard deviation of a coordinate [m]; the level.
        time: correlation time [s].

    Paper: Uhlenbeck & Ornstein (1930), doi 10.1103/PhysRev.36.823.
    """

    sd: float = parameter(0.1, unit="m", low=0.0, high=0.3, source="ours")
    time: float = parameter(1.0, unit="s", low=0.0, high=5.0, source="ours: about two steps of walking")

    level: ClassVar[str] = "sd"
    levels: ClassVar[tuple[float, ...]] = (0.0, 0.02, 0.05, 0.1, 0.2)
    paper: ClassVar[Paper] = Paper(
        "Uhlenbeck, Ornstein", 1930, "On the theory of the Brownian motion", "Physical Review",
        "10.1103/PhysRev.36.823",
    )  # fmt: skip

    def degrade(self, seen: DegradedTracks, rng: np.random.Generator) -> DegradedTracks:
        tracks = seen.tracks
        error, time = rng.standard_normal((len(tracks), 2)), tracks.time
        for rows, before in iterate_ranks(tracks.id, tracks.frame):
            if len(before) == 0:
                continue
            passed = time[rows] - time[before]
            keep = np.exp(-passed / self.time)[:, None] if self.time > 0.0 else np.zeros((len(rows), 1))
            error[rows] = keep * error[before] + np.sqrt(1.0 - keep * keep) * error[rows]
        return seen.displace(self.sd * error)

"""False tracks: tracks of people who do not exist."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import parameter

from .degradation import Degradation, DegradedTracks

Ghost = tuple[float, float, NDArray[np.float64], NDArray[np.float64]]


@dataclass(frozen=True)
class FalseTracks(Degradation):
    """Adds tracks of people who do not exist; they appear at a constant rate, move straight and disappear.

    False tracks appear uniformly in the bounding box of the people, as a Poisson process in time, with exponential
    lifetimes and normal velocity components. Their ids are above all others.

    Fields:
        rate: false tracks per second in the whole area [1/s]; the level.
        life: mean lifetime [s].
        speed: root mean square speed [m/s].
    """

    rate: float = parameter(0.2, unit="1/s", low=0.0, high=5.0, source="ours: one in five seconds")
    life: float = parameter(4.0, unit="s", low=0.5, high=20.0, source="ours: ten rows of 0.4 s")
    speed: float = parameter(0.5, unit="m/s", low=0.0, high=2.0, source="ours: slower than people")

    level: ClassVar[str] = "rate"
    levels: ClassVar[tuple[float, ...]] = (0.0, 0.2, 0.5, 1.0, 2.0)

    def degrade(self, seen: DegradedTracks, rng: np.random.Generator) -> DegradedTracks:
        tracks = seen.tracks
        frames, first = np.unique(tracks.frame, return_index=True)
        times = tracks.time[first]
        place = tracks.position[~seen.robot] if np.any(~seen.robot) else tracks.position
        low, high = place.min(axis=0), place.max(axis=0)
        highest = int(tracks.id.max())
        id: list[NDArray[np.int64]] = []
        frame: list[NDArray[np.int64]] = []
        position: list[NDArray[np.float64]] = []
        for birth, life, begin, velocity in self._ghosts(float(times[-1]) + tracks.dt, rng):
            rows = slice(*np.searchsorted(times, (birth, birth + life)).tolist())
            if rows.start < rows.stop:
                id.append(np.full(rows.stop - rows.start, highest + 1 + len(id), dtype=np.int64))
                frame.append(frames[rows])
                position.append(low + begin * (high - low) + velocity * (times[rows] - birth)[:, None])
        if not id:
            return seen
        return seen.add_false_rows(np.concatenate(id), np.concatenate(frame), np.concatenate(position))

    def _ghosts(self, seconds: float, rng: np.random.Generator) -> list[Ghost]:
        """Return birth [s], life [s], place in the area (0 to 1) and velocity [m/s] of every false track."""
        ghosts: list[Ghost] = []
        birth = 0.0
        while True:
            birth += float(rng.exponential()) / self.rate
            life = self.life * float(rng.exponential())
            begin, velocity = rng.random(2), self.speed / math.sqrt(2.0) * rng.standard_normal(2)
            if birth >= seconds:
                return ghosts
            ghosts.append((birth, life, begin, velocity))

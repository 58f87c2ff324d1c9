"""Missing frames: rows without a measurement, single or in bursts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Paper, did_you_mean, parameter

from .degradation import Degradation, DegradedTracks
from .row_ranks import iterate_ranks

OF = ("person", "frame")


@dataclass(frozen=True)
class MissingFrames(Degradation):
    """Removes a share of the rows, single or in bursts (Gilbert model, a Markov chain with two states).

    After a missing row, the next row is missing with probability 1 - (1 - probability) / burst, so the mean gap has
    burst / (1 - probability) rows. With ``burst=1``, rows are removed independently.

    Fields:
        probability: probability of a missing row [1]; the level.
        burst: length of gaps relative to independently missing rows [1], at least 1.
        of: ``person``: each track has separate gaps; ``frame``: all people are missing at the same frames.

    Paper: Gilbert (1960), doi 10.1002/j.1538-7305.1960.tb03959.x.
    """

    probability: float = parameter(0.1, unit="1", low=0.0, high=0.8, source="ours")
    burst: float = parameter(1.0, unit="1", low=1.0, high=10.0, min=1.0, source="ours: independent drops")
    of: str = "person"

    level: ClassVar[str] = "probability"
    levels: ClassVar[tuple[float, ...]] = (0.0, 0.1, 0.2, 0.4, 0.6)
    metric: ClassVar[bool] = False
    paper: ClassVar[Paper] = Paper(
        "Gilbert", 1960, "Capacity of a burst-noise channel", "Bell System Technical Journal",
        "10.1002/j.1538-7305.1960.tb03959.x",
    )  # fmt: skip

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.of not in OF:
            raise InputError(
                f"{self.name}: of {self.of!r} is unknown{did_you_mean(self.of, OF)}; known are {', '.join(OF)}"
            )

    def degrade(self, seen: DegradedTracks, rng: np.random.Generator) -> DegradedTracks:
        tracks = seen.tracks
        if self.of == "frame":
            frames, place = np.unique(tracks.frame, return_inverse=True)
            missing = self._missing(np.zeros_like(frames), frames, rng)[place]
        else:
            missing = self._missing(tracks.id, tracks.frame, rng)
        return seen.keep_rows(~missing)

    def _missing(self, id: NDArray[np.int64], frame: NDArray[np.int64], rng: np.random.Generator) -> NDArray[np.bool_]:
        """Return the mask of missing rows; rows missing at a low level are also missing at all higher levels."""
        drawn = rng.random(len(id))
        missing = np.zeros(len(id), dtype=np.bool_)
        seen_again = (1.0 - self.probability) / self.burst
        for rows, before in iterate_ranks(id, frame):
            chance = np.full(len(rows), self.probability)
            if len(before):
                chance = np.where(missing[before], 1.0 - seen_again, self.probability / self.burst)
            missing[rows] = drawn[rows] < chance
        return missing

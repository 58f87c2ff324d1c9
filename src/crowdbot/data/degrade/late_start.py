"""Late start: new tracks are confirmed after some rows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.core import InputError, parameter

from .degradation import Degradation, DegradedTracks
from .row_ranks import row_rank


@dataclass(frozen=True)
class LateStart(Degradation):
    """Removes the first rows of each track, as a tracker that confirms new tracks late.

    Shorter tracks are removed. Gaps do not restart a track. Deterministic.

    Fields:
        rows: rows of a track before confirmation; the level.
    """

    rows: int = parameter(3, unit="rows", low=0, high=10, source="ours: the usual three hits of multi-object trackers")

    level: ClassVar[str] = "rows"
    levels: ClassVar[tuple[float, ...]] = (0, 3, 6, 8, 10)
    metric: ClassVar[bool] = False

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.rows != int(self.rows):
            raise InputError(f"{self.name}: rows = {self.rows} must be a whole number")
        object.__setattr__(self, "rows", int(self.rows))

    def degrade(self, seen: DegradedTracks, rng: np.random.Generator) -> DegradedTracks:
        return seen.keep_rows(row_rank(seen.tracks.id, seen.tracks.frame) >= self.rows)

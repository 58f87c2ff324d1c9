"""Heavy tails: outliers among correct positions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.core import Paper, parameter

from .degradation import Degradation, DegradedTracks


@dataclass(frozen=True)
class HeavyTails(Degradation):
    """Displaces a share of the rows by a bivariate Student-t error (outliers).

    The distance r of an outlier exceeds any R with probability (1 + R^2 / (freedom scale^2))^(-freedom / 2).
    ``probability=1`` adds Student-t noise to every row.

    Fields:
        probability: probability of an outlier per row [1]; the level.
        scale: scale of the error [m].
        freedom: degrees of freedom [1]; smaller values give heavier tails.

    Paper: Lange, Little, Taylor (1989), doi 10.1080/01621459.1989.10478852.
    """

    probability: float = parameter(0.05, unit="1", low=0.0, high=0.3, source="ours")
    scale: float = parameter(0.3, unit="m", low=0.05, high=1.0, source="ours: a body away, somebody else was measured")
    freedom: float = parameter(
        3.0, unit="1", low=1.0, high=10.0, min=0.5, source="ours: the fewest with a finite variance"
    )

    level: ClassVar[str] = "probability"
    levels: ClassVar[tuple[float, ...]] = (0.0, 0.02, 0.05, 0.1, 0.2)
    paper: ClassVar[Paper] = Paper(
        "Lange, Little, Taylor", 1989, "Robust statistical modeling using the t distribution",
        "Journal of the American Statistical Association", "10.1080/01621459.1989.10478852",
    )  # fmt: skip

    def degrade(self, seen: DegradedTracks, rng: np.random.Generator) -> DegradedTracks:
        rows = len(seen.tracks)
        outlier = rng.random(rows) < self.probability
        normal = rng.standard_normal((rows, 2))
        spread = self.scale / np.sqrt(rng.chisquare(self.freedom, rows) / self.freedom)
        return seen.displace(np.where(outlier, spread, 0.0)[:, None] * normal)

"""PlainSampling: random runs, the baseline of all searches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.evaluation import proportion_interval

from .runner import MOST_SEEDS, SampleRunner
from .sampling import Sampling, SamplingResult


@dataclass(frozen=True)
class PlainSampling(Sampling):
    """Plain Monte Carlo: points from the distributions of the factors; the interval is that of Wilson.

    >>> PlainSampling().name
    'plain'
    """

    name: ClassVar[str] = "plain"
    batch: int = 1024

    def search(self, runner: SampleRunner, rng: np.random.Generator) -> SamplingResult:
        """Spend the budget on random points."""
        while runner.remaining:
            count = min(self.batch, runner.remaining)
            runner.run(rng.standard_normal((count, runner.dimensions)), rng.integers(0, MOST_SEEDS, count))
        valid = [sample for sample in runner.samples if sample.valid]
        estimate = proportion_interval(sum(sample.fails for sample in valid), len(valid), method="wilson")
        return SamplingResult(estimate, np.ones(len(runner.samples)))

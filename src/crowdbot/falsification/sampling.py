"""Sampling: contract of the searches for failures."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.evaluation import Estimate

from .runner import SampleRunner


class SamplingResult(NamedTuple):
    """What a search says about the failure probability.

    Fields:
        estimate: the probability of a failure, or None for a search that only finds failures.
        weights: ``[N]`` weight of each sample as a draw from the distributions of the factors; 0 for samples that do
            not count.
        levels: thresholds of the robustness that the search has passed.
    """

    estimate: Estimate | None
    weights: NDArray[np.float64]
    levels: tuple[float, ...] = ()


@dataclass(frozen=True)
class Sampling(ABC):
    """Contract of a search: spends the runs of a runner, and estimates the failure probability.

    The requests of a search depend on the random generator and on the samples only, so an interrupted search continues
    with the same points.
    """

    name: ClassVar[str]

    @abstractmethod
    def search(self, runner: SampleRunner, rng: np.random.Generator) -> SamplingResult:
        """Spend the budget of the runner."""

"""CrossEntropy: adaptive importance sampling."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats

from .estimate import mixture_estimate
from .proposal import Proposal, fit_proposal, mixture_weights
from .runner import MOST_SEEDS, SampleRunner
from .sampling import Sampling, SamplingResult

WIDE, NARROW = 1.5, 1.2
"""Factor of the standard deviations of a proposal that still moves, and of one that is fitted to failures."""
CLIP = 10.0
"""Largest weight of a point to which a proposal is fitted, as a multiple of the median."""


@dataclass(frozen=True)
class CrossEntropy(Sampling):
    """Adaptive importance sampling with the multilevel cross-entropy method.

    Generations of runs move a :class:`Proposal` towards the failures: it is fitted to the runs whose robustness is
    below a quantile, or to the failures as soon as there are enough, with the weights of all generations so far. Then
    the proposal is fixed, and the rest of the budget is drawn from it. The estimate pools all generations: each run
    counts with the density of the factors over the mixture of all proposals (balance heuristic), so failures that are
    found while exploring count, too. Later proposals depend on earlier runs, so the estimate is consistent, not
    unbiased; a bad proposal makes its interval wide.

    Fields:
        explore: largest share of the budget for finding the proposal.
        generation: share of the budget of one generation.
        quantile: share of runs in a generation to which the proposal moves.
        defensive: share of the plain distribution in the proposal; weights are at most its inverse.
        enough: number of failures after which the proposal is fitted to failures only.

    Source: Rubinstein & Kroese 2004, The cross-entropy method, doi:10.1007/978-1-4757-4321-0; mixtures: Kurtz & Song
    2013, doi:10.1016/j.strusafe.2013.01.006; defensive mixtures: Hesterberg 1995, doi:10.1080/00401706.1995.10484303;
    pooling: Veach & Guibas 1995, doi:10.1145/218380.218498; Cornuet et al. 2012,
    doi:10.1111/j.1467-9469.2011.00756.x.

    >>> CrossEntropy(explore=0.5).explore
    0.5
    """

    name: ClassVar[str] = "cross-entropy"
    explore: float = 0.5
    generation: float = 0.1
    quantile: float = 0.1
    defensive: float = 0.1
    enough: int = 50

    def __post_init__(self) -> None:
        for name in ("explore", "generation", "quantile", "defensive"):
            if not 0.0 < getattr(self, name) < 1.0:
                raise InputError(f"cross-entropy: {name} = {getattr(self, name)} must be above 0 and below 1")
        if self.enough < 1:
            raise InputError(f"cross-entropy: enough = {self.enough} failures must be at least 1")

    def search(self, runner: SampleRunner, rng: np.random.Generator) -> SamplingResult:
        """Find a proposal, spend the rest with it, and estimate from all runs."""
        used = [Proposal.standard(runner.dimensions)]
        counts: list[int] = []
        levels: list[float] = []
        size = max(1, round(self.generation * runner.budget))
        while len(runner.samples) + size <= self.explore * runner.budget:
            self._draw(runner, rng, used[-1], size)
            counts.append(size)
            points, robustness = _arrays(runner)
            fails = int(np.sum(robustness <= 0.0))
            level = self._level(robustness[-size:], fails)
            levels.append(level)
            elite = robustness <= level
            if not (elite.any() and math.isfinite(level)):
                used.append(Proposal.standard(runner.dimensions))
                continue
            weights = mixture_weights(used, counts, points[elite])
            weights = np.minimum(weights, CLIP * float(np.median(weights)))
            widen = WIDE if level > 0.0 else NARROW
            used.append(fit_proposal(points[elite], weights, rng, self.defensive, widen))
            if fails >= self.enough and len(levels) > 2 and levels[-2] == 0.0 and levels[-3] == 0.0:
                break
        counts.append(runner.remaining)
        self._draw(runner, rng, used[-1], runner.remaining)
        return self._estimate(runner, used, counts, levels)

    def _level(self, new: Floats, fails: int) -> float:
        """Return the next threshold of the robustness: 0 with enough failures, or a quantile of the last runs."""
        level = 0.0 if fails >= self.enough else max(0.0, float(np.quantile(new, self.quantile)))
        return level if math.isfinite(level) else float(np.min(new))

    @staticmethod
    def _estimate(runner: SampleRunner, used: list[Proposal], counts: list[int], levels: list[float]) -> SamplingResult:
        """Return the probability from all runs, without the share of impossible ones."""
        points, robustness = _arrays(runner)
        weights = mixture_weights(used, counts, points)
        valid = np.array([sample.valid for sample in runner.samples])
        groups = np.repeat(np.arange(len(counts)), counts)
        largest = len(points) / sum(count * one.defensive for one, count in zip(used, counts, strict=True))
        estimate = mixture_estimate(robustness <= 0.0, weights, groups, largest)
        mass = float(np.sum(weights[valid])) / float(np.sum(weights))
        if not valid.all() and mass > 0.0:
            estimate = estimate._replace(
                **{name: min(1.0, getattr(estimate, name) / mass) for name in ("value", "low", "high")}
            )
        return SamplingResult(estimate, weights, tuple(levels))

    @staticmethod
    def _draw(runner: SampleRunner, rng: np.random.Generator, proposal: Proposal, count: int) -> None:
        runner.run(proposal.draw(rng, count), rng.integers(0, MOST_SEEDS, count))


def _arrays(runner: SampleRunner) -> tuple[Floats, Floats]:
    """Return the points ``[N, D]`` and the robustness ``[N]`` of all samples."""
    points = np.array([sample.point for sample in runner.samples], dtype=np.float64)
    robustness = np.array([sample.robustness for sample in runner.samples])
    return points.reshape(len(robustness), runner.dimensions), robustness

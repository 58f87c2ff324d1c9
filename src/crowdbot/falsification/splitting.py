"""Splitting: adaptive multilevel splitting over factors and seeds."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.evaluation import Estimate
from crowdbot.typing import Floats

from .estimate import replicate_estimate
from .runner import MOST_SEEDS, SampleRunner
from .sampling import Sampling, SamplingResult


@dataclass
class _Chain:
    """One replicate: its particles and the estimate so far."""

    points: Floats
    seeds: NDArray[np.int64]
    robustness: Floats
    share: float = 1.0
    level: float = math.inf
    step: float = 0.6
    done: bool = False


@dataclass(frozen=True)
class Splitting(Sampling):
    """Adaptive multilevel splitting (subset simulation) over factors and seeds.

    Particles are drawn from the distributions. At each level, those with the smallest robustness are copied, and each
    copy moves by Markov steps that keep the distribution below the level: the factors move by a preconditioned
    Crank-Nicolson step, and half of the steps draw another seed. Failures that depend on the seed alone are as rare as
    in plain runs, since seeds have no order. The probability is the product of the shares at the levels. Replicates are
    independent; the interval is Student's over their estimates. A replicate that reaches no failure within the budget
    counts as 0, and the interval then starts at 0.

    Fields:
        replicates: number of independent replicates.
        particles: particles of a replicate.
        quantile: share of particles that survive a level.
        moves: Markov steps of each particle at a level.

    Source: Au & Beck 2001, doi:10.1016/S0266-8920(01)00019-4; Papaioannou et al. 2015,
    doi:10.1016/j.probengmech.2015.06.006.

    >>> Splitting(replicates=4).quantile
    0.25
    """

    name: ClassVar[str] = "splitting"
    replicates: int = 8
    particles: int = 64
    quantile: float = 0.25
    moves: int = 3

    def __post_init__(self) -> None:
        for name, least in (("replicates", 2), ("particles", 8), ("moves", 1)):
            if getattr(self, name) < least:
                raise InputError(f"splitting: {name} = {getattr(self, name)} must be at least {least}")
        if not 0.0 < self.quantile < 1.0:
            raise InputError(f"splitting: quantile = {self.quantile} must be above 0 and below 1")

    def search(self, runner: SampleRunner, rng: np.random.Generator) -> SamplingResult:
        """Move all replicates from level to level."""
        size = self.replicates * self.particles
        if runner.budget < 2 * size:
            raise InputError(f"splitting needs at least {2 * size} runs, not {runner.budget}")
        points, seeds = rng.standard_normal((size, runner.dimensions)), rng.integers(0, MOST_SEEDS, size)
        values = _robustness(runner, points, seeds)
        parts = np.split(np.arange(size), self.replicates)
        chains = [_Chain(points[part], seeds[part], values[part]) for part in parts]
        levels: list[float] = []
        while True:
            for chain in chains:
                self._next_level(chain, rng)
            left = [chain for chain in chains if not chain.done]
            if not left or runner.remaining < len(left) * self.particles * self.moves:
                break
            levels.append(float(np.median([chain.level for chain in left])))
            for _ in range(self.moves):
                self._move(runner, left, rng)
        shares = np.array([chain.share if chain.done else 0.0 for chain in chains])
        estimate = replicate_estimate(shares, len(runner.samples))
        if not all(chain.done for chain in chains):
            best = max((chain.share for chain in chains if not chain.done), default=0.0)
            estimate = Estimate(estimate.value, 0.0, max(estimate.high, best), estimate.runs)
        return SamplingResult(estimate, self._weights(runner, chains), tuple(levels))

    def _next_level(self, chain: _Chain, rng: np.random.Generator) -> None:
        """Set the next level of a replicate and copy the particles below it; done if enough of them fail."""
        if chain.done:
            return
        fails = chain.robustness <= 0.0
        level = float(np.sort(chain.robustness)[max(0, math.ceil(self.quantile * self.particles) - 1)])
        if level <= 0.0:
            chain.share *= float(fails.mean())
            chain.done = True
            return
        below = np.flatnonzero(chain.robustness <= level)
        if not math.isfinite(level):
            below = np.flatnonzero(np.isfinite(chain.robustness))
            below = below if len(below) else np.arange(self.particles)
        chain.share *= len(below) / self.particles
        chain.level = level
        copies = below[rng.integers(0, len(below), self.particles)]
        chain.points, chain.seeds = chain.points[copies], chain.seeds[copies]
        chain.robustness = chain.robustness[copies]

    def _move(self, runner: SampleRunner, chains: list[_Chain], rng: np.random.Generator) -> None:
        """Make one Markov step of all particles of some replicates."""
        points, seeds = [], []
        for chain in chains:
            noise = rng.standard_normal(chain.points.shape)
            points.append(math.sqrt(1.0 - chain.step**2) * chain.points + chain.step * noise)
            fresh = rng.random(self.particles) < 0.5
            seeds.append(np.where(fresh, rng.integers(0, MOST_SEEDS, self.particles), chain.seeds))
        values = _robustness(runner, np.concatenate(points), np.concatenate(seeds))
        for k, chain in enumerate(chains):
            new = values[k * self.particles : (k + 1) * self.particles]
            taken = new <= chain.level
            chain.points = np.where(taken[:, None], points[k], chain.points)
            chain.seeds = np.where(taken, seeds[k], chain.seeds)
            chain.robustness = np.where(taken, new, chain.robustness)
            rate = float(taken.mean())
            chain.step = float(np.clip(chain.step * math.exp(rate - 0.4), 0.05, 1.0))

    def _weights(self, runner: SampleRunner, chains: list[_Chain]) -> Floats:
        """Return equal weights for the failures among the last particles, 0 for the others."""
        found = {
            (tuple(point), int(seed))
            for chain in chains
            for point, seed, value in zip(chain.points.tolist(), chain.seeds, chain.robustness, strict=True)
            if value <= 0.0
        }
        return np.array([float((sample.point, sample.seed) in found) for sample in runner.samples])


def _robustness(runner: SampleRunner, points: Floats, seeds: NDArray[np.int64]) -> Floats:
    return np.array([sample.robustness for sample in runner.run(points, seeds)])

"""Searches for failures: plain sampling, importance sampling, splitting, and the searches of calibration."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import special

from crowdbot.calibration import Search
from crowdbot.core import InputError
from crowdbot.evaluation import Estimate, proportion_interval
from crowdbot.typing import Floats

from .estimate import mixture_estimate, replicate_estimate
from .sample import MOST_SEEDS, SampleRunner


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


@dataclass(frozen=True)
class PlainSampling(Sampling):
    """Plain Monte Carlo: points from the distributions of the factors; the interval is that of Wilson.

    >>> PlainSampling().name
    'plain'
    """

    name: ClassVar[str] = "plain"
    batch: int = 1024

    def search(self, runner: SampleRunner, rng: np.random.Generator) -> SamplingResult:
        while runner.remaining:
            count = min(self.batch, runner.remaining)
            runner.run(rng.standard_normal((count, runner.dimensions)), rng.integers(0, MOST_SEEDS, count))
        valid = [sample for sample in runner.samples if sample.valid]
        estimate = proportion_interval(sum(sample.fails for sample in valid), len(valid), method="wilson")
        return SamplingResult(estimate, np.ones(len(runner.samples)))


STEPS = 40
"""Steps of the expectation-maximisation."""
FLOOR = 0.3
"""Least standard deviation of a component."""
PER_COMPONENT = 3
"""Effective points for each number of a component at least."""
MOST_COMPONENTS = 6


@dataclass(frozen=True)
class Proposal:
    """A mixture of normal densities with diagonal covariances and the standard normal density.

    The share of the standard normal density bounds all weights by its inverse: a failure far from the others cannot
    have an arbitrarily large weight (defensive importance sampling).

    Fields:
        shares: ``[K]`` shares of the components, 1 in total.
        means, deviations: ``[K, D]`` means and standard deviations.
        defensive: share of the standard normal density, 0 to 1.

    >>> plain = Proposal.standard(2)
    >>> plain.log_ratio(np.array([[3.0, 1.0]])).tolist()
    [0.0]
    """

    shares: Floats
    means: Floats
    deviations: Floats
    defensive: float

    @classmethod
    def standard(cls, dimensions: int) -> Proposal:
        """Return the standard normal density."""
        return cls(np.ones(1), np.zeros((1, dimensions)), np.ones((1, dimensions)), 1.0)

    def draw(self, rng: np.random.Generator, count: int) -> Floats:
        """Return ``[count, D]`` points."""
        normal = rng.standard_normal((count, self.means.shape[1]))
        plain = rng.random(count) < self.defensive
        which = rng.choice(len(self.shares), size=count, p=self.shares)
        return np.where(plain[:, None], normal, self.means[which] + self.deviations[which] * normal)

    def log_ratio(self, points: Floats) -> Floats:
        """Return ``[N]`` the logarithm of this density over the standard normal density at points ``[N, D]``."""
        if self.defensive >= 1.0:
            return np.zeros(len(points))
        mixture = math.log1p(-self.defensive) + special.logsumexp(self.log_components(points), axis=1)
        if self.defensive <= 0.0:
            return np.asarray(mixture)
        return np.asarray(np.logaddexp(math.log(self.defensive), mixture))

    def log_components(self, points: Floats) -> Floats:
        """Return ``[N, K]`` the logarithm of each share times its density over the standard normal density."""
        scaled = (points[:, None, :] - self.means) / self.deviations
        log = 0.5 * (points[:, None, :] ** 2 - scaled**2) - np.log(self.deviations)
        return np.asarray(np.log(self.shares) + log.sum(axis=2))


def mixture_weights(proposals: Sequence[Proposal], counts: Sequence[int], points: Floats) -> Floats:
    """Return ``[N]`` the standard normal density over the mixture of proposals, by their numbers of runs.

    This is the balance heuristic of Veach & Guibas 1995, doi:10.1145/218380.218498.

    >>> mixture_weights([Proposal.standard(1)], [10], np.zeros((2, 1))).tolist()
    [1.0, 1.0]
    """
    there = [(proposal, count) for proposal, count in zip(proposals, counts, strict=False) if count]
    shares = np.array([count for _, count in there]) / sum(count for _, count in there)
    logs = np.array([item.log_ratio(points) for item, _ in there])
    return np.asarray(np.exp(-special.logsumexp(logs, axis=0, b=shares[:, None])))


def fit_proposal(
    points: Floats, weights: Floats, rng: np.random.Generator, defensive: float, widen: float = 1.0
) -> Proposal:
    """Return a proposal fitted to weighted points by expectation-maximisation.

    The number of components is that with the largest weighted likelihood less the Bayesian information criterion.

    Args:
        points: ``[N, D]``.
        weights: ``[N]``, at least one above 0.
        rng: random generator of the first means.
        defensive: share of the standard normal density.
        widen: factor of the standard deviations.

    >>> rng = np.random.default_rng(0)
    >>> two = np.concatenate([rng.normal(-3, 0.5, (200, 1)), rng.normal(3, 0.5, (200, 1))])
    >>> sorted(fit_proposal(two, np.ones(400), rng, 0.1).means[:, 0].round(1).tolist())
    [-3.0, 3.0]
    """
    share = weights / weights.sum()
    effective = 1.0 / float(np.sum(share**2))
    dimensions = points.shape[1]
    most = int(min(MOST_COMPONENTS, max(1.0, effective / (PER_COMPONENT * max(1, dimensions)))))
    best, score = Proposal.standard(dimensions), -math.inf
    for count in range(1, most + 1):
        found = _maximize(points, share, count, rng)
        likelihood = effective * float(share @ found.log_ratio(points))
        penalty = 0.5 * (count * (2 * dimensions + 1) - 1) * math.log(max(2.0, effective))
        if likelihood - penalty > score:
            best, score = found, likelihood - penalty
    return Proposal(best.shares, best.means, widen * best.deviations, defensive)


def _maximize(points: Floats, share: Floats, count: int, rng: np.random.Generator) -> Proposal:
    means = _spread_means(points, share, count, rng)
    center = share @ points
    deviation = np.sqrt(share @ (points - center) ** 2)
    proposal = Proposal(np.full(count, 1.0 / count), means, np.maximum(np.tile(deviation, (count, 1)), FLOOR), 0.0)
    for _ in range(STEPS if count > 1 else 1):
        log = proposal.log_components(points)
        belongs = np.exp(log - special.logsumexp(log, axis=1, keepdims=True)) * share[:, None]
        total = np.maximum(belongs.sum(axis=0), 1e-12)
        means = (belongs.T @ points) / total[:, None]
        spread = np.stack([belongs[:, k] @ (points - means[k]) ** 2 / total[k] for k in range(count)])
        proposal = Proposal(total / total.sum(), means, np.maximum(np.sqrt(spread), FLOOR), 0.0)
    return proposal


def _spread_means(points: Floats, share: Floats, count: int, rng: np.random.Generator) -> Floats:
    """Return first means: points drawn far from each other (k-means++)."""
    chosen = [points[int(rng.choice(len(points), p=share))]]
    while len(chosen) < count:
        away = np.min([np.sum((points - item) ** 2, axis=1) for item in chosen], axis=0) * share
        if away.sum() <= 0.0:
            chosen.append(points[int(rng.choice(len(points), p=share))])
        else:
            chosen.append(points[int(rng.choice(len(points), p=away / away.sum()))])
    return np.array(chosen)


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
        largest = len(points) / sum(count * item.defensive for item, count in zip(used, counts, strict=True))
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


AIMS = ("worst", "likely")
EDGE = 1e-6
"""Distance of the box from 0 and 1, in shares of the distributions."""
FAR = 1e6
"""Cost of an impossible variant."""


@dataclass(frozen=True)
class DirectedSearch(Sampling):
    """A search of calibration over the shares of the distributions and the seed; it estimates no probability.

    The cost of ``worst`` is the robustness. That of ``likely`` is the robustness without a failure, and for a failure
    minus 1 over 1 plus the squared distance from the most likely point, so that the most likely failure is the best.

    Fields:
        method: the search.
        title: its name.
        aim: ``worst`` or ``likely``.

    >>> from crowdbot.calibration import CMAES
    >>> DirectedSearch(CMAES(), "cma-es", "likely").aim
    'likely'
    """

    method: Search
    title: str
    aim: str = "worst"

    name: ClassVar[str] = "directed"

    def __post_init__(self) -> None:
        if self.aim not in AIMS:
            raise InputError(f"aim {self.aim!r} must be {' or '.join(AIMS)}")

    def search(self, runner: SampleRunner, rng: np.random.Generator) -> SamplingResult:
        # minimise the cost in the unit box of all factors and the seed
        sides = runner.dimensions + 1
        start = np.full((1, 1, 1, sides), 0.5)
        low, high = np.full(sides, EDGE), np.full(sides, 1.0 - EDGE)

        def cost(candidates: Floats, which: NDArray[np.int64]) -> Floats:
            shares = candidates[:, 0, 0, :]
            seeds = np.minimum((shares[:, -1] * MOST_SEEDS).astype(np.int64), MOST_SEEDS - 1)
            samples = runner.run(special.ndtri(shares[:, :-1]), seeds)
            values = np.array([self._cost(sample.robustness, sample.log_density) for sample in samples])
            return values[:, None, None]

        self.method.minimize(cost, low, high, [rng], runner.budget, start)
        return SamplingResult(None, np.zeros(len(runner.samples)))

    def _cost(self, robustness: float, log_density: float) -> float:
        if not np.isfinite(robustness):
            return FAR
        if self.aim == "worst" or robustness > 0.0:
            return robustness
        return -1.0 / (1.0 - 2.0 * log_density)


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

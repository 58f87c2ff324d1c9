"""Proposal: the density from which importance sampling draws its points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import special

from crowdbot.typing import Floats

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
        mixture = math.log1p(-self.defensive) + special.logsumexp(self._components(points), axis=1)
        if self.defensive <= 0.0:
            return np.asarray(mixture)
        return np.asarray(np.logaddexp(math.log(self.defensive), mixture))

    def _components(self, points: Floats) -> Floats:
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
    there = [(one, count) for one, count in zip(proposals, counts, strict=False) if count]
    shares = np.array([count for _, count in there]) / sum(count for _, count in there)
    logs = np.array([one.log_ratio(points) for one, _ in there])
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
    found = Proposal(np.full(count, 1.0 / count), means, np.maximum(np.tile(deviation, (count, 1)), FLOOR), 0.0)
    for _ in range(STEPS if count > 1 else 1):
        log = found._components(points)
        belongs = np.exp(log - special.logsumexp(log, axis=1, keepdims=True)) * share[:, None]
        total = np.maximum(belongs.sum(axis=0), 1e-12)
        means = (belongs.T @ points) / total[:, None]
        spread = np.stack([belongs[:, k] @ (points - means[k]) ** 2 / total[k] for k in range(count)])
        found = Proposal(total / total.sum(), means, np.maximum(np.sqrt(spread), FLOOR), 0.0)
    return found


def _spread_means(points: Floats, share: Floats, count: int, rng: np.random.Generator) -> Floats:
    """Return first means: points drawn far from each other (k-means++)."""
    chosen = [points[int(rng.choice(len(points), p=share))]]
    while len(chosen) < count:
        away = np.min([np.sum((points - one) ** 2, axis=1) for one in chosen], axis=0) * share
        if away.sum() <= 0.0:
            chosen.append(points[int(rng.choice(len(points), p=share))])
        else:
            chosen.append(points[int(rng.choice(len(points), p=away / away.sum()))])
    return np.array(chosen)

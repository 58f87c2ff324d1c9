"""CMAES: covariance matrix adaptation for each person, with the library ``cmaes``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from crowdbot.core import InputError, Paper
from crowdbot.typing import Floats

from .search import Search
from .search_state import SearchState, own_best


@dataclass(frozen=True)
class CMAES(Search):
    """Covariance matrix adaptation (CMA-ES) with one optimiser per person, driven by the cost of that person.

    The p-th solutions of all optimisers form one candidate crowd. Each generation also evaluates the crowd of the means
    of all optimisers. The result is the best crowd evaluated as a whole. Each optimiser starts at the best start of its
    person and restarts at a random place in the box when it has converged. The library processes one person at a time,
    which makes this the slowest search.

    Fields:
        population: number of solutions of an optimiser in a generation.
        width: initial standard deviation, relative to the parameter ranges.

    Source: Hansen (2016), doi 10.48550/arXiv.1604.00772, as in the library cmaes (Nomura & Shibata 2024, doi
    10.48550/arXiv.2402.01373).

    >>> low, high = np.array([-1.0, -1.0]), np.array([2.0, 2.0])
    >>> everyone = lambda candidates, which: (candidates**2).sum(axis=-1)
    >>> found = CMAES().minimize(everyone, low, high, [np.random.default_rng(0)], 500, np.ones((1, 1, 3, 2)))
    >>> found.best.shape, found.evaluations.tolist(), bool(found.cost[0] < 0.01)
    ((1, 3, 2), [500], True)
    """

    population: int = 16
    width: float = 0.3

    paper: ClassVar[Paper] = Paper(
        "Hansen", 2016, "The CMA evolution strategy: a tutorial", "arXiv", "10.48550/arXiv.1604.00772"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.population < 2:
            raise InputError(f"cmaes: population = {self.population} solutions must be at least 2")
        if not 0.0 < self.width <= 1.0:
            raise InputError(f"cmaes: width = {self.width} sides of the box must be above 0 and at most 1")

    def search(self, state: SearchState, population: Floats, cost: Floats) -> None:
        """Ask all optimisers, evaluate, tell them, see :meth:`Search.search`."""
        side = np.where(state.span > 0.0, state.span, 1.0)
        best, _ = own_best(population, cost)
        begin = np.clip((best[0] - state.low) / side, 0.0, 1.0)
        optimisers = {
            (problem, person): self._optimiser(begin[row, person], state.rngs[problem])
            for row, problem in enumerate(state.live.tolist())
            for person in np.flatnonzero(state.counts[row]).tolist()
        }
        while state.remaining:
            rows = {problem: row for row, problem in enumerate(state.live.tolist())}
            place = np.zeros((self.population + 1, len(rows), *state.best.shape[1:]))
            ours = [(key, (slice(1, None), rows[key[0]], key[1])) for key in optimisers if key[0] in rows]
            for key, where in ours:
                optimiser = optimisers[key]
                place[0][where[1:]] = np.clip(optimiser.mean, 0.0, 1.0)
                place[where] = [optimiser.ask() for _ in range(self.population)]
            measured = state.evaluate(state.scale_to_box(place))
            if not state.remaining:
                break
            for key, where in ours:
                optimisers[key].tell(list(zip(place[where], measured[where].tolist(), strict=True)))
                if optimisers[key].should_stop():
                    rng = state.rngs[key[0]]
                    optimisers[key] = self._optimiser(rng.random(len(side)), rng)
            state.prune()

    def _optimiser(self, mean: Floats, rng: np.random.Generator) -> Any:
        """Return an optimiser in the unit box that starts at ``mean``."""
        from cmaes import CMA

        bounds = np.repeat([[0.0, 1.0]], len(mean), axis=0)
        seed = int(rng.integers(2**32))
        return CMA(mean=mean, sigma=self.width, bounds=bounds, seed=seed, population_size=self.population)

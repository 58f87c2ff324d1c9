"""RandomSearch: uniformly random candidates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats

from .search import Search
from .search_state import SearchState, own_best


@dataclass(frozen=True)
class RandomSearch(Search):
    """Uniformly random parameters for all people, the baseline of the other searches.

    The last evaluation of the budget is the crowd of the best parameters of all people.

    Fields:
        batch: number of candidates evaluated at once.

    >>> low, high = np.array([-1.0, -1.0]), np.array([2.0, 2.0])
    >>> everyone = lambda candidates, which: (candidates**2).sum(axis=-1)
    >>> found = RandomSearch().minimize(everyone, low, high, [np.random.default_rng(0)], 500, np.ones((1, 1, 3, 2)))
    >>> found.best.shape, found.evaluations.tolist(), bool(found.cost[0] < 0.05)
    ((1, 3, 2), [500], True)
    """

    batch: int = 100

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.batch < 1:
            raise InputError(f"random-search: batch = {self.batch} candidates must be at least 1")

    def search(self, state: SearchState, population: Floats, cost: Floats) -> None:
        """Draw and evaluate until one evaluation is left, see :meth:`Search.search`."""
        best, least = own_best(population, cost)
        while state.remaining > 1:
            drawn = state.sample_uniform(min(self.batch, state.remaining - 1))
            cost = state.evaluate(drawn)
            best, least = own_best(np.concatenate([best, drawn]), np.concatenate([least, cost]))
            best, least = state.prune(best, least)
        if state.remaining:
            state.evaluate(best)
            state.prune()

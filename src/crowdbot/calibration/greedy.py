"""Greedy: one parameter of one person at a time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.core import InputError, Paper
from crowdbot.typing import Floats, Ints

from .search import Search
from .search_state import SearchState

NARROWEST = 1e-3
"""Minimum standard deviation of new values, relative to the parameter range; the maximum is 1."""


@dataclass(frozen=True)
class Greedy(Search):
    """Changes one parameter of one person at a time, and keeps changes that lower the cost of the whole crowd.

    The search starts at the best start and visits all parameters of all people who count, in a random order that is
    then repeated. Each visit evaluates ``trials`` new values as one batch. Half of them are uniform between the bounds;
    the others are normal around the current value, with standard deviations that are log-uniform between 1/1000 and 1
    of the range of the parameter. The best one replaces the current value if it lowers the mean cost of the people. The
    search cannot leave a minimum where no single change lowers the cost. A crowd of 30 people with 7 parameters needs
    210 visits to try each parameter once.

    Fields:
        trials: number of new values per visit.

    Source: Wolinski et al. (2014), doi 10.1111/cgf.12328 (the distribution of new values is new here).

    >>> low, high = np.array([-1.0, -1.0]), np.array([2.0, 2.0])
    >>> everyone = lambda candidates, which: (candidates**2).sum(axis=-1)
    >>> found = Greedy().minimize(everyone, low, high, [np.random.default_rng(0)], 500, np.ones((1, 1, 3, 2)))
    >>> found.best.shape, found.evaluations.tolist(), bool(found.cost[0] < 0.01)
    ((1, 3, 2), [500], True)
    """

    trials: int = 8

    paper: ClassVar[Paper] = Paper(
        "Wolinski, Guy, Olivier, Lin, Manocha, Pettré",
        2014,
        "Parameter estimation and comparative evaluation of crowd simulations",
        "Computer Graphics Forum",
        "10.1111/cgf.12328",
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.trials < 1:
            raise InputError(f"greedy: trials = {self.trials} new values must be at least 1")

    def search(self, state: SearchState, population: Floats, cost: Floats) -> None:
        """Visit the parameters one by one, see :meth:`Search.search`."""
        order = self._order(state)
        visit = 0
        while state.remaining:
            present = state.incumbent()
            _, L, _, D = present.shape
            length = state.counts.sum(axis=1) * D
            gene = np.take_along_axis(order[0], (visit % length)[:, None], axis=1)[:, 0].astype(np.int64)
            person, parameter = gene // D, gene % D
            crowds = np.repeat(present, self.trials, axis=0)
            value = present[0, np.arange(L), person, parameter]
            crowds[:, np.arange(L), person, parameter] = self._values(state, value, parameter)
            state.evaluate(crowds)
            (order,) = state.prune(order)
            visit += 1

    def _order(self, state: SearchState) -> Floats:
        """Return the order of visits, ``[1, L, N * D]`` numbers ``person * D + parameter``."""
        _, N, D = state.best.shape
        chance = state.draw(lambda rng: rng.random((1, N * D)))
        chance = np.where(np.repeat(state.counts, D, axis=1), chance, np.inf)
        return np.argsort(chance, axis=2, kind="stable").astype(np.float64)

    def _values(self, state: SearchState, present: Floats, parameter: Ints) -> Floats:
        """Return new values ``[trials, L]`` for a parameter of each problem."""
        low, high, side = state.low[parameter], state.high[parameter], state.span[parameter]
        chance = state.draw(lambda rng: rng.random(self.trials))
        away = state.draw(lambda rng: rng.standard_normal(self.trials))
        near = present + np.exp(np.log(NARROWEST) * chance) * side * away
        sample_uniform = (np.arange(self.trials) % 2 == 0)[:, None]
        values: Floats = np.clip(np.where(sample_uniform, low + side * chance, near), low, high)
        return values

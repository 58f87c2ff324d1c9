"""Genetic: a genetic algorithm with selection, crossover and mutation for each person."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.core import InputError, Paper

from .search import Search
from .search_state import Floats, SearchState

__all__ = ["Genetic"]

PRESSURE = 3.0
"""Parents are ranks ``M u^PRESSURE`` of a sorted pool of M, u uniform in 0 to 1: the best of about so many drawn."""
OVERSHOOT = 0.5
"""How far, in distances between the parents, a blend may lie beyond either of them (BLX-0.5)."""
NEAR = 0.1
"""Half of the first pool lies around the starts, with this standard deviation [sides of the box]."""
MUTATION = 0.3
"""Standard deviation of a mutation at the beginning [sides of the box]; it falls to ``FINEST`` at the end."""
FINEST = 1e-3


@dataclass(frozen=True)
class Genetic(Search):
    """A genetic algorithm in which a candidate is a crowd and everyone in it has his own pool of genes.

    What someone costs depends mostly on his own parameters. So each person has his own pool, sorted by what he alone
    cost when he had these genes; a child crowd takes two parents for every person, blends their genes or swaps them one
    by one, and mutates about one. Costs also depend on the others, whose genes differ from crowd to crowd: a cheap one
    may have been luck. Three rules keep the search honest. Costs are forgotten after ``memory`` generations. One child
    of every generation is everyone's own best, unchanged and together, which evaluates them anew. And towards the end
    most people in a child keep the genes that they have in the best crowd, so that the others are measured there.
    The result is the best crowd that was evaluated as a whole.

    Fields:
        population: crowds in a pool and children of a generation.
        memory: after how many generations a cost is forgotten.
        bred: the share of people with new genes in a child at the end; at the beginning it is 1.

    Source: the idea of a pool is Wolinski et al. (2014), doi 10.1111/cgf.12328; blends are those of Eshelman & Schaffer
    (1993), doi 10.1016/B978-0-08-094832-4.50018-0. Pools by person and the three rules are ours.

    >>> low, high = np.array([-1.0, -1.0]), np.array([2.0, 2.0])
    >>> everyone = lambda candidates, which: (candidates**2).sum(axis=-1)
    >>> found = Genetic().minimize(everyone, low, high, [np.random.default_rng(0)], 500, np.ones((1, 1, 20, 2)))
    >>> found.best.shape, found.evaluations.tolist(), bool(found.cost[0] < 0.01)
    ((1, 20, 2), [500], True)
    """

    population: int = 50
    memory: int = 3
    bred: float = 0.4

    paper: ClassVar[Paper] = Paper(
        "Wolinski, Guy, Olivier, Lin, Manocha, Pettré",
        2014,
        "Parameter estimation and comparative evaluation of crowd simulations",
        "Computer Graphics Forum",
        "10.1111/cgf.12328",
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.population < 2 or self.memory < 1:
            raise InputError(
                f"genetic: population = {self.population} crowds must be at least 2"
                f" and memory = {self.memory} generations at least 1"
            )
        if not 0.0 < self.bred <= 1.0:
            raise InputError(f"genetic: bred = {self.bred} of the people must be above 0 and at most 1")

    def search(self, state: SearchState, population: Floats, cost: Floats) -> None:
        """Breed generation after generation, see :meth:`Search.search`."""
        first = self._first(state, population)
        population, cost = np.concatenate([population, first]), np.concatenate([cost, state.evaluate(first)])
        population = np.clip(population, state.low, state.high)
        population, cost, age = self._fittest(population, cost, np.zeros_like(cost))
        population, cost, age = state.prune(population, cost, age)
        while state.remaining:
            children = self._children(state, population)
            children[0] = population[0]
            measured = state.evaluate(children)
            population, cost = np.concatenate([children, population]), np.concatenate([measured, cost])
            age = np.concatenate([np.zeros_like(measured), age + 1.0])
            population, cost, age = self._fittest(population, cost, age)
            population, cost, age = state.prune(population, cost, age)

    def _first(self, state: SearchState, start: Floats) -> Floats:
        """Return a first pool: half around the starts, half anywhere."""
        first = state.sample_uniform(min(self.population, state.remaining))
        near = len(first) // 2
        shape = (near, *first.shape[2:])
        away = state.draw(lambda rng: rng.standard_normal(shape))
        first[:near] = state.fold(start[np.arange(near) % len(start)] + NEAR * state.span * away)
        return first

    def _fittest(self, population: Floats, cost: Floats, age: Floats) -> tuple[Floats, Floats, Floats]:
        """Return everyone's best genes, the best first, but those whose costs are too old."""
        cost = np.where(age < self.memory, cost, np.inf)
        row = np.argsort(cost, axis=0, kind="stable")[: self.population]
        genes = np.take_along_axis(population, row[..., None], axis=0)
        return genes, np.take_along_axis(cost, row, axis=0), np.take_along_axis(age, row, axis=0)

    def _children(self, state: SearchState, population: Floats) -> Floats:
        # The last evaluation is one child, everyone's own best; so the one before leaves it.
        count = max(1, min(self.population, state.remaining - 1))
        M, _, N, D = population.shape
        chance = state.draw(lambda rng: rng.random((count, N, 4)))
        rank = (M * chance[..., 0:2] ** PRESSURE).astype(np.int64)
        mother = np.take_along_axis(population, rank[..., 0, None], axis=0)
        father = np.take_along_axis(population, rank[..., 1, None], axis=0)
        place = state.draw(lambda rng: rng.random((count, N, D)))
        blend = (1.0 + 2.0 * OVERSHOOT) * place - OVERSHOOT
        share = np.where(chance[..., 2, None] < 0.5, blend, np.rint(place))
        children = mother + share * (father - mother)
        mutated = state.draw(lambda rng: rng.random((count, N, D))) * D < 1.0
        width = MUTATION * (1.0 - state.progress) ** 2 + FINEST
        change = state.draw(lambda rng: rng.standard_normal((count, N, D)))
        children = state.fold(children + np.where(mutated, width * state.span * change, 0.0))
        bred = chance[..., 3] < 1.0 + (self.bred - 1.0) * state.progress
        return np.where(bred[..., None], children, state.incumbent())

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
"""Selection pressure: parents have rank ``M u^PRESSURE`` in a sorted pool of M, with u uniform in 0 to 1."""
OVERSHOOT = 0.5
"""Extension of the blend beyond both parents, relative to their distance (BLX-0.5)."""
NEAR = 0.1
"""Standard deviation of the half of the initial pool around the starts, relative to the parameter ranges."""
MUTATION = 0.3
"""Initial standard deviation of a mutation, relative to the parameter ranges; it decreases to ``FINEST``."""
FINEST = 1e-3


@dataclass(frozen=True)
class Genetic(Search):
    """Genetic algorithm; a candidate is a crowd, and each person has a separate pool of parameters.

    The cost of a person depends mostly on the parameters of this person. Each person therefore has a separate pool,
    sorted by the cost of the person. A child crowd selects two parents per person, blends or exchanges their
    parameters, and mutates about one of them. Costs also depend on the other people, whose parameters differ between
    crowds, so a low cost may be due to chance. Three rules reduce this effect. Costs expire after ``memory``
    generations. One child of each generation is the crowd of the best parameters of all people, which evaluates them
    again. Towards the end, most people in a child have their parameters of the best crowd, so the new parameters of the
    others are evaluated in this crowd. The result is the best crowd evaluated as a whole.

    Fields:
        population: size of the pools, and number of children in a generation.
        memory: number of generations after which a cost expires.
        bred: final share of people with new parameters in a child; the initial share is 1.

    Source: pool, Wolinski et al. (2014), doi 10.1111/cgf.12328; blend, Eshelman & Schaffer (1993), doi
    10.1016/B978-0-08-094832-4.50018-0. The pools by person and the three rules are new here.

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
        """Run the generations, see :meth:`Search.search`."""
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
        """Return an initial pool: half around the starts, half uniform."""
        first = state.sample_uniform(min(self.population, state.remaining))
        near = len(first) // 2
        shape = (near, *first.shape[2:])
        away = state.draw(lambda rng: rng.standard_normal(shape))
        first[:near] = state.fold(start[np.arange(near) % len(start)] + NEAR * state.span * away)
        return first

    def _fittest(self, population: Floats, cost: Floats, age: Floats) -> tuple[Floats, Floats, Floats]:
        """Return the best parameters of each person, best first, without those with expired costs."""
        cost = np.where(age < self.memory, cost, np.inf)
        row = np.argsort(cost, axis=0, kind="stable")[: self.population]
        genes = np.take_along_axis(population, row[..., None], axis=0)
        return genes, np.take_along_axis(cost, row, axis=0), np.take_along_axis(age, row, axis=0)

    def _children(self, state: SearchState, population: Floats) -> Floats:
        # Leaves one evaluation for the last child, the crowd of the best parameters of all people.
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

"""Genetic: a genetic algorithm with selection, crossover and mutation for each person."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Paper, kernel
from crowdbot.typing import Floats

from .search import Search
from .search_state import SearchState


@kernel
def keep_fittest(
    children: Floats, pool: Floats, child_cost: Floats, cost: Floats, age: Floats, memory: float,
    genes: Floats, kept_cost: Floats, kept_age: Floats,
) -> None:  # fmt: skip
    """Write the parameters of each person with the lowest costs, best first; costs expire at the age ``memory``.

    Args:
        children, child_cost: ``[P, L, N, D]`` and ``[P, L, N]``, new parameters and their costs; preferred at equal
            costs.
        pool, cost, age: ``[M, L, N, D]`` and ``[M, L, N]``, earlier parameters, sorted by cost; the age is a number of
            generations.
        genes, kept_cost, kept_age: ``[K, L, N, D]`` and ``[K, L, N]``, output arrays.
    """
    P, (M, L, N, D) = len(children), pool.shape
    value, order = np.empty(P + M), np.empty(P + M, dtype=np.int64)
    for w in range(L):
        for n in range(N):
            for k in range(P + M):
                x = child_cost[k, w, n] if k < P else cost[k - P, w, n]
                if k >= P and not age[k - P, w, n] + 1.0 < memory:
                    x = math.inf
                at = k  # stable insertion: the pool is in order already
                while at > 0 and x < value[at - 1]:
                    value[at], order[at] = value[at - 1], order[at - 1]
                    at -= 1
                value[at], order[at] = x, k
            for i in range(len(genes)):
                k = order[i]
                kept_cost[i, w, n], kept_age[i, w, n] = value[i], 0.0 if k < P else age[k - P, w, n] + 1.0
                for d in range(D):
                    genes[i, w, n, d] = children[k, w, n, d] if k < P else pool[k - P, w, n, d]


@kernel
def breed(
    pool: Floats, rank: NDArray[np.int64], chance: Floats, place: Floats, mutation: Floats, change: Floats,
    incumbent: Floats, low: Floats, high: Floats, overshoot: float, width: float, bred: float, children: Floats,
) -> None:  # fmt: skip
    """Write children ``[P, L, N, D]``: two parents of each person are blended or exchanged, and mutated.

    Args:
        pool: ``[M, L, N, D]``, parameters of each person, best first.
        rank: ``[P, L, N, 2]``, places of the parents in the pool.
        chance: ``[P, L, N, 4]``, numbers from 0 to 1: the third chooses between blend and exchange, the fourth between
            a child and the incumbent.
        place, mutation: ``[P, L, N, D]``, numbers from 0 to 1: place between the parents, and whether to mutate.
        change: ``[P, L, N, D]``, normally distributed changes.
        incumbent: ``[1, L, N, D]``, parameters of people without a child.
        low, high: ``[D]``, bounds, at which children are reflected.
        overshoot: extension of the blend beyond the parents, relative to their distance.
        width: standard deviation of a mutation, relative to the bounds.
        bred: probability of a child.
        children: output array.
    """
    P, L, N, D = children.shape
    for k in range(P):
        for w in range(L):
            for n in range(N):
                taken, blends = chance[k, w, n, 3] < bred, chance[k, w, n, 2] < 0.5
                mother, father = rank[k, w, n, 0], rank[k, w, n, 1]
                for d in range(D):
                    if not taken:
                        children[k, w, n, d] = incumbent[0, w, n, d]
                        continue
                    share = place[k, w, n, d]
                    share = (1.0 + 2.0 * overshoot) * share - overshoot if blends else np.rint(share)
                    first = pool[mother, w, n, d]
                    value = first + share * (pool[father, w, n, d] - first)
                    if mutation[k, w, n, d] * D < 1.0:
                        value += width * (high[d] - low[d]) * change[k, w, n, d]
                    side = min(max(value, low[d]), high[d])
                    children[k, w, n, d] = min(max(2.0 * side - value, low[d]), high[d])


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
        population, cost, age = self._fittest(population, cost, *(part[:0] for part in (population, cost, cost)))
        population, cost, age = state.prune(population, cost, age)
        while state.remaining:
            children = self._children(state, population)
            children[0] = population[0]
            population, cost, age = self._fittest(children, state.evaluate(children), population, cost, age)
            population, cost, age = state.prune(population, cost, age)

    def _first(self, state: SearchState, start: Floats) -> Floats:
        """Return an initial pool: half around the starts, half uniform."""
        first = state.sample_uniform(min(self.population, state.remaining))
        near = len(first) // 2
        shape = (near, *first.shape[2:])
        away = state.draw(lambda rng: rng.standard_normal(shape))
        first[:near] = state.fold(start[np.arange(near) % len(start)] + NEAR * state.span * away)
        return first

    def _fittest(
        self, children: Floats, measured: Floats, population: Floats, cost: Floats, age: Floats
    ) -> tuple[Floats, Floats, Floats]:
        """Return the best parameters of each person, best first, their costs and ages, without expired costs."""
        count = min(self.population, len(children) + len(population))
        shape = (count, *cost.shape[1:])
        found = np.empty((*shape, population.shape[-1])), np.empty(shape), np.empty(shape)
        values: list[Any] = [np.ascontiguousarray(part) for part in (children, population, measured, cost, age)]
        values += [float(self.memory), *found]
        keep_fittest(*values)
        return found

    def _children(self, state: SearchState, population: Floats) -> Floats:
        # Leaves one evaluation for the last child, the crowd of the best parameters of all people.
        count = max(1, min(self.population, state.remaining - 1))
        M, _, N, D = population.shape
        chance = state.draw(lambda rng: rng.random((count, N, 4)))
        rank = (M * chance[..., 0:2] ** PRESSURE).astype(np.int64)
        place = state.draw(lambda rng: rng.random((count, N, D)))
        mutation = state.draw(lambda rng: rng.random((count, N, D)))
        width = MUTATION * (1.0 - state.progress) ** 2 + FINEST
        change = state.draw(lambda rng: rng.standard_normal((count, N, D)))
        bred = 1.0 + (self.bred - 1.0) * state.progress
        children = np.empty_like(place)
        breed(
            np.ascontiguousarray(population), rank, chance, place, mutation, change, state.incumbent(), state.low,
            state.high, OVERSHOOT, width, bred, children,
        )  # fmt: skip
        return children

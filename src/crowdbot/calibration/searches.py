"""Searches: annealing, CMA-ES, genetic, greedy and random."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Paper, kernel
from crowdbot.typing import Floats, Ints

from .search import Search, SearchState, own_best


@dataclass(frozen=True)
class Cooling(ABC):
    """Temperature as a function of the spent share of the budget."""

    @abstractmethod
    def at(self, progress: float) -> float:
        """Return the temperature at the spent share ``progress`` of the budget, 0 to 1."""


@dataclass(frozen=True)
class Geometric(Cooling):
    """Geometric decrease from ``start`` to ``end``.

    Source: Kirkpatrick, Gelatt & Vecchi (1983), doi 10.1126/science.220.4598.671.

    Raises:
        InputError: a temperature is not finite and above 0, or the end is above the start.

    >>> [round(Geometric(1.0, 0.01).at(progress), 3) for progress in (0.0, 0.5, 1.0)]
    [1.0, 0.1, 0.01]
    """

    start: float = 0.1
    end: float = 1e-4

    def __post_init__(self) -> None:
        if not 0.0 < self.end <= self.start < math.inf:
            raise InputError(
                f"geometric cooling: from {self.start} to {self.end} must fall and stay above 0, and both be finite"
            )

    def at(self, progress: float) -> float:
        return float(self.start * (self.end / self.start) ** progress)


COOLING = Geometric(0.1, 1e-4)
REACH = Geometric(0.5, 0.003)
ANYWHERE = 0.2
"""Share of new values that are drawn uniformly between the bounds."""


@dataclass(frozen=True)
class Annealing(Search):
    """Simulated annealing with several chains; changes are accepted or rejected for each person separately.

    In each step, every chain proposes a new value of one parameter for most people: usually near the current value, at
    distances that shrink over time, sometimes anywhere between the bounds. The value is accepted if the cost of the
    person decreases, and otherwise with probability ``exp(-increase / T)``. The decision uses the cost of the person
    and not of the crowd, since a crowd would rarely accept 30 simultaneous changes. T is the temperature of ``cooling``
    times the interquartile range of the costs of the person with the initial random parameters, so ``cooling`` has no
    unit. Each step also evaluates the crowd of the best parameters of all people. Every ``exchange`` steps, the worse
    half of the chains of each person continues from the better half. The result is the best crowd evaluated as a whole.

    Fields:
        cooling: temperature, relative to the interquartile range of the costs.
        reach: standard deviation of a change, relative to the range of the parameter.
        chains: number of chains.
        exchange: number of steps after which the worse half is replaced; 0: never.
        moved: final share of people with a new value in a step; the initial share is 1.

    Source: Kirkpatrick, Gelatt & Vecchi (1983), doi 10.1126/science.220.4598.671; acceptance by person and the exchange
    are new here.

    >>> low, high = np.array([-1.0, -1.0]), np.array([2.0, 2.0])
    >>> everyone = lambda candidates, which: (candidates**2).sum(axis=-1)
    >>> found = Annealing().minimize(everyone, low, high, [np.random.default_rng(0)], 1000, np.ones((1, 1, 20, 2)))
    >>> found.best.shape, found.evaluations.tolist(), bool(found.cost[0] < 0.01)
    ((1, 20, 2), [1000], True)
    """

    cooling: Cooling = COOLING
    reach: Cooling = REACH
    chains: int = 12
    exchange: int = 4
    moved: float = 0.4

    paper: ClassVar[Paper] = Paper(
        "Kirkpatrick, Gelatt, Vecchi", 1983, "Optimization by simulated annealing", "Science",
        "10.1126/science.220.4598.671",
    )  # fmt: skip

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.chains < 1 or self.exchange < 0:
            raise InputError(
                f"annealing: chains = {self.chains} must be at least 1 and exchange = {self.exchange} steps at least 0"
            )
        if not 0.0 < self.moved <= 1.0:
            raise InputError(f"annealing: moved = {self.moved} of the people must be above 0 and at most 1")

    def search(self, state: SearchState, population: Floats, cost: Floats) -> None:
        first = state.sample_uniform(min(self.chains, state.remaining))
        population, cost = np.concatenate([population, first]), np.concatenate([cost, state.evaluate(first)])
        population = np.clip(population, state.low, state.high)
        here, energy = _cheapest(population, cost, len(cost), self.chains)
        here, energy, best, spread = state.prune(here, energy, here[:1], _spread(cost))
        step = 0
        while state.remaining > 1:
            there, moved = self._propose(state, here)
            crowds = np.concatenate([best, there])[: state.remaining - 1]
            measured = state.evaluate(crowds)
            best, _ = own_best(crowds, measured)
            if len(crowds) > self.chains:
                step += 1
                limit = self.cooling.at(state.progress) * spread * _draw_tolerance(state, self.chains)
                accepted = (measured[1:] <= energy + limit) | ~moved
                here = np.where(accepted[..., None], there, here)
                energy = np.where(accepted, measured[1:], energy)
                if self.exchange and step % self.exchange == 0:
                    here, energy = _cheapest(here, energy, (self.chains + 1) // 2, self.chains)
            here, energy, best, spread = state.prune(here, energy, best, spread)
        if state.remaining:
            state.evaluate(best)
            state.prune()

    def _propose(self, state: SearchState, here: Floats) -> tuple[Floats, NDArray[np.bool_]]:
        """Return the proposed parameters, and the mask ``[chains, L, N]`` of people whose parameters change."""
        C, _, N, D = here.shape
        chance = state.draw(lambda rng: rng.random((C, N, 4)))
        away = state.draw(lambda rng: rng.standard_normal((C, N, 1)))
        moved = chance[..., 0] < 1.0 + (self.moved - 1.0) * state.progress
        which = (chance[..., 1] * D).astype(np.int64)[..., None] == np.arange(D)
        near = state.fold(here + self.reach.at(state.progress) * state.span * away)
        sample_uniform = state.scale_to_box(chance[..., 2, None])
        there = np.where(chance[..., 3, None] < ANYWHERE, sample_uniform, near)
        return np.where(which & moved[..., None], there, here), moved


def _cheapest(population: Floats, cost: Floats, count: int, chains: int) -> tuple[Floats, Floats]:
    """Return the ``count`` best parameters of each person and their costs, repeated for ``chains`` chains."""
    row = np.argsort(cost, axis=0, kind="stable")[np.arange(chains) % count]
    return np.take_along_axis(population, row[..., None], axis=0), np.take_along_axis(cost, row, axis=0)


def _spread(cost: Floats) -> Floats:
    """Return the interquartile range of the costs of each person ``[1, L, N]``, computed without sums over L."""
    ordered = np.sort(cost, axis=0)
    low, high = ordered[len(cost) // 4], ordered[(3 * len(cost)) // 4]
    finite = np.isfinite(high)
    return np.where(finite, high, 0.0)[None] - np.where(finite, low, 0.0)[None]


def _draw_tolerance(state: SearchState, chains: int) -> Floats:
    """Draw the accepted increase of the cost of each person, in temperatures: exponentially distributed, mean 1."""
    people = state.best.shape[1]
    return state.draw(lambda rng: rng.standard_exponential((chains, people)))


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
        fittest = np.empty((*shape, population.shape[-1])), np.empty(shape), np.empty(shape)
        values: list[Any] = [np.ascontiguousarray(part) for part in (children, population, measured, cost, age)]
        values += [float(self.memory), *fittest]
        keep_fittest(*values)
        return fittest

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
        best, least = own_best(population, cost)
        while state.remaining > 1:
            drawn = state.sample_uniform(min(self.batch, state.remaining - 1))
            cost = state.evaluate(drawn)
            best, least = own_best(np.concatenate([best, drawn]), np.concatenate([least, cost]))
            best, least = state.prune(best, least)
        if state.remaining:
            state.evaluate(best)
            state.prune()

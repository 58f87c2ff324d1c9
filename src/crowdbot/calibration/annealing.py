"""Annealing: simulated annealing with acceptance for each person."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Paper
from crowdbot.typing import Floats

from .cooling import Cooling, Geometric
from .search import Search
from .search_state import SearchState, own_best

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
        """Run all chains, see :meth:`Search.search`."""
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

"""The parts of searches, each observed through the candidates that it evaluates: memory, blending, folding, jumps."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.calibration import Annealing, Genetic, Geometric, RandomSearch, Search
from crowdbot.calibration.search import SearchState
from crowdbot.calibration.searches import breed, keep_fittest
from crowdbot.core import stream

Function = Callable[[np.ndarray, np.ndarray], np.ndarray]


class Evaluations:
    """A cost function of one problem that records every batch ``[P, N, D]`` of candidates."""

    def __init__(self, cost: Callable[[np.ndarray, int], np.ndarray]) -> None:
        self.cost = cost
        self.batches: list[np.ndarray] = []

    def __call__(self, candidates: np.ndarray, which: np.ndarray) -> np.ndarray:
        batch = candidates[:, 0].copy()
        self.batches.append(batch)
        return self.cost(batch, len(self.batches) - 1)[:, None]


def run(search: Search, cost: Callable[[np.ndarray, int], np.ndarray], start: np.ndarray, budget: int, low: float = 0.0,
        high: float = 1.0, seed: int = 1) -> list[np.ndarray]:  # fmt: skip
    """Return the batches that a search evaluates from starts ``[S, N, D]`` in the box ``low`` to ``high``."""
    function, D = Evaluations(cost), start.shape[-1]
    rng = stream(seed, "mechanics")
    search = dataclasses.replace(search, tolerance=-math.inf)
    search.minimize(function, np.full(D, low), np.full(D, high), [rng], budget, start[:, None])
    return function.batches


def state(low: list[float], high: list[float], budget: int = 100, people: int = 2) -> SearchState:
    """Return the state of a search of one problem in a box."""
    ends = np.array(low), np.array(high)
    start = np.zeros((1, people, len(low)))
    return SearchState(lambda x, which: x.sum(axis=-1), *ends, [stream(0, "state")], budget, start, -math.inf, 0)


@pytest.mark.parametrize("memory", [1, 2, 3, 5])
def test_a_lucky_cost_is_remembered_for_memory_generations(memory: int) -> None:
    """Genes that cost little once, by luck, lead the pool for ``memory`` generations and not one longer."""
    lucky: list[np.ndarray] = []

    def cost(batch: np.ndarray, number: int) -> np.ndarray:
        own = 1.0 + np.sum((batch - 0.7) ** 2, axis=-1)
        if number == 1:  # the first random pool
            lucky.append(batch[3, 0])
            own[3, 0] = 0.0
        return own

    batches = run(Genetic(population=8, memory=memory), cost, np.full((1, 3, 2), 0.1), 1 + 8 * (memory + 4))
    leads = [bool(np.array_equal(batch[0, 0], lucky[0])) for batch in batches[2:]]
    assert leads == [True] * memory + [False] * (len(leads) - memory)


def test_the_first_child_of_a_generation_is_everyone_s_own_best() -> None:
    def cost(batch: np.ndarray, number: int) -> np.ndarray:
        return np.asarray(np.sum((batch - 0.7) ** 2, axis=-1))

    batches = run(Genetic(population=6, memory=1000), cost, np.full((1, 4, 2), 0.1), 1 + 6 * 6)
    for number in range(2, len(batches)):
        before = np.concatenate(batches[:number])
        own = cost(before, 0)
        best = before[np.argmin(own, axis=0), np.arange(4)]
        np.testing.assert_array_equal(batches[number][0], best)


def two_parents(people: int, D: int, generations: int) -> np.ndarray:
    """Return the children ``[P, N, D]`` of the only two crowds with a finite cost, at 0 and at 1 of the box -2 to 3."""
    start = np.stack([np.zeros((people, D)), np.ones((people, D))])

    def cost(batch: np.ndarray, number: int) -> np.ndarray:
        return batch[..., 0] if number == 0 else np.full(batch.shape[:2], np.inf)

    search = Genetic(population=2, memory=10_000, bred=1.0)
    batches = run(search, cost, start, 4 + 2 * generations, low=-2.0, high=3.0)
    return np.concatenate([batch[1:] for batch in batches[2:-1]])


def test_children_blend_their_parents_or_swap_genes() -> None:
    """Half of the people with two different parents get blends, from 0.5 below to 0.5 above (BLX-0.5), half swaps."""
    children = two_parents(people=400, D=20, generations=12)
    whole = (children == 0.0) | (children == 1.0)
    zeros, ones = np.sum(children == 0.0, axis=-1), np.sum(children == 1.0, axis=-1)
    blended = np.sum(whole, axis=-1) < 10
    swapped = (zeros >= 3) & (ones >= 3)
    first, second = 0.5 ** (1 / 3), 1.0 - 0.5 ** (1 / 3)  # ranks 2 u^3 of two crowds
    assert np.mean(blended) == pytest.approx(first * second, abs=0.02)
    assert np.mean(swapped) == pytest.approx(first * second, abs=0.02)
    assert np.mean(children[swapped] == 1.0) == pytest.approx(0.475, abs=0.02)  # one gene in twenty is mutated
    values = children[blended]
    values = values[(values > -0.5) & (values < 1.5)]
    np.testing.assert_allclose(
        np.quantile(values, [0.05, 0.25, 0.5, 0.75, 0.95]), [-0.4, 0.0, 0.5, 1.0, 1.4], atol=0.03
    )
    assert np.mean((children[blended] < -0.5) | (children[blended] > 1.5)) < 0.06


def test_one_gene_of_a_child_is_mutated_on_average_ever_less_far() -> None:
    children = two_parents(people=800, D=20, generations=40)
    zeros = np.sum(children == 0.0, axis=-1)
    pure = zeros >= 15  # both parents at 0
    mutated = (children != 0.0) & pure[..., None]
    assert np.mean(mutated[pure]) == pytest.approx(1 / 20, abs=0.004)
    sizes = [np.median(np.abs(children[k][mutated[k]])) / 0.6745 / 5.0 for k in range(len(children))]
    progress = (np.arange(len(sizes)) * 2 + 4) / 84
    np.testing.assert_allclose(sizes, 0.3 * (1.0 - progress) ** 2 + 1e-3, rtol=0.25, atol=2e-4)


def test_parents_are_drawn_by_the_cube_of_their_rank() -> None:
    children = two_parents(people=2000, D=1, generations=3)
    share = 0.5 ** (1 / 3)
    assert not np.any((children == 0.0) | (children == 1.0))  # a person's only gene is always mutated
    zeros = two_parents(people=2000, D=40, generations=3)
    assert np.mean(np.sum(zeros == 0.0, axis=-1) > 30) == pytest.approx(share**2, abs=0.03)


@pytest.mark.parametrize("bred", [0.25, 1.0])
def test_towards_the_end_people_keep_the_genes_of_the_best_crowd(bred: float) -> None:
    def cost(batch: np.ndarray, number: int) -> np.ndarray:
        return np.where(np.all(batch == 0.5, axis=-1), 0.0, 1.0)

    batches = run(Genetic(population=10, bred=bred), cost, np.full((1, 500, 1), 0.5), 1 + 10 * 30)
    kept = np.array([np.mean(batch[1:] == 0.5) for batch in batches[2:-1]])
    progress = (1 + 10 * np.arange(1, len(kept) + 1)) / 301
    np.testing.assert_allclose(kept, (1.0 - bred) * progress, atol=0.03)


@given(value=st.floats(-30.0, 30.0), low=st.floats(-5.0, 5.0), side=st.floats(0.0, 10.0), shift=st.floats(-0.99, 0.99))
@settings(max_examples=200)
def test_folding_mirrors_at_the_sides_and_never_leaves_the_box(
    value: float, low: float, side: float, shift: float
) -> None:
    high = low + side
    box = state([low], [high])
    fold = float(box.fold(np.array([value]))[0])
    assert low <= fold <= high
    if low <= value <= high:
        assert fold == pytest.approx(value)
    beyond = abs(shift) * side
    assert float(box.fold(np.array([low - beyond]))[0]) == pytest.approx(low + beyond, abs=1e-9)
    assert float(box.fold(np.array([high + beyond]))[0]) == pytest.approx(high - beyond, abs=1e-9)


def test_the_pool_of_a_person_is_a_stable_sort_of_costs_that_have_not_expired():
    rng = np.random.default_rng(5)
    children, pool = rng.random((5, 2, 3, 2)), rng.random((7, 2, 3, 2))
    child_cost, cost = rng.integers(0, 4, (5, 2, 3)) * 1.0, np.sort(rng.integers(0, 4, (7, 2, 3)) * 1.0, axis=0)
    age = rng.integers(0, 4, (7, 2, 3)) * 1.0
    genes, kept, ages = np.empty((6, 2, 3, 2)), np.empty((6, 2, 3)), np.empty((6, 2, 3))
    keep_fittest(children, pool, child_cost, cost, age, 3.0, genes, kept, ages)
    every_age = np.concatenate([np.zeros_like(child_cost), age + 1.0])
    every = np.where(every_age < 3.0, np.concatenate([child_cost, cost]), np.inf)
    row = np.argsort(every, axis=0, kind="stable")[:6]
    assert np.array_equal(kept, np.take_along_axis(every, row, axis=0))
    assert np.array_equal(ages, np.take_along_axis(every_age, row, axis=0))
    assert np.array_equal(genes, np.take_along_axis(np.concatenate([children, pool]), row[..., None], axis=0))


def test_children_have_the_bits_of_their_definition():
    rng = np.random.default_rng(6)
    pool, low, high = rng.uniform(1.0, 3.0, (4, 2, 3, 5)), np.linspace(1.0, 1.4, 5), np.linspace(2.6, 3.0, 5)
    rank, chance = rng.integers(0, 4, (9, 2, 3, 2)), rng.random((9, 2, 3, 4))
    place, mutation, change = rng.random((9, 2, 3, 5)), rng.random((9, 2, 3, 5)), rng.standard_normal((9, 2, 3, 5))
    incumbent, children = rng.uniform(1.0, 3.0, (1, 2, 3, 5)), np.empty((9, 2, 3, 5))
    breed(pool, rank, chance, place, mutation, change, incumbent, low, high, 0.5, 0.2, 0.6, children)
    mother = np.take_along_axis(pool, rank[..., 0, None], axis=0)
    father = np.take_along_axis(pool, rank[..., 1, None], axis=0)
    share = np.where(chance[..., 2, None] < 0.5, 2.0 * place - 0.5, np.rint(place))
    value = mother + share * (father - mother) + np.where(mutation * 5 < 1.0, 0.2 * (high - low) * change, 0.0)
    folded = np.clip(2.0 * np.clip(value, low, high) - value, low, high)
    expected = np.where(chance[..., 3, None] < 0.6, folded, incumbent)
    assert children.tobytes() == expected.tobytes()


@pytest.mark.parametrize("search", [Genetic(), Annealing()], ids=["genetic", "annealing"])
def test_values_beyond_the_box_are_folded_into_it_not_piled_up_at_its_side(search: Search) -> None:
    edge = 1e-9

    def cost(batch: np.ndarray, number: int) -> np.ndarray:
        return np.asarray(np.sum(batch, axis=-1))

    asked = np.concatenate(run(search, cost, np.full((1, 50, 2), edge), 600)[1:])
    assert np.mean((asked == 0.0) | (asked == 1.0)) < 0.005
    assert np.mean((asked > edge) & (asked < 0.2)) > 0.3


@settings(max_examples=80)
@given(
    gains=st.lists(st.integers(0, 119), max_size=6), batch=st.integers(1, 17), patience=st.integers(0, 40),
    budget=st.integers(1, 120),
)  # fmt: skip
def test_patience_counts_evaluations_since_the_last_gain(
    gains: list[int], batch: int, patience: int, budget: int
) -> None:
    """The cost of an evaluation falls at given numbers of it and never elsewhere."""
    costs = [float(-sum(gain <= number for gain in gains)) for number in range(200)]
    asked = 0

    def cost(values: np.ndarray, number: int) -> np.ndarray:
        nonlocal asked
        asked += len(values)
        return np.array([costs[asked - len(values) + k] for k in range(len(values))])[:, None]

    search = RandomSearch(tolerance=-math.inf, patience=patience, batch=batch)
    found = search.minimize(
        Evaluations(cost), np.zeros(1), np.ones(1), [stream(0, "x")], budget, np.full((1, 1, 1, 1), 0.5)
    )
    sizes, spent, best, gained = [1], 0, math.inf, 0
    while spent < budget:
        size = 1 if spent == 0 else max(1, min(batch, budget - spent - 1))
        for number in range(spent, spent + size):
            if costs[number] < best:
                best, gained = costs[number], number + 1
        spent += size
        sizes.append(size)
        if patience and spent - gained >= patience:
            break
    assert found.evaluations.tolist() == [spent]
    assert found.cost[0] == best


def annealed(search: Annealing, people: int, D: int, budget: int) -> np.ndarray:
    """Return where chains go when everything is accepted: ``[steps, chains, N, D]``."""
    batches = run(search, lambda batch, number: np.ones(batch.shape[:2]), np.full((1, people, D), 0.5), budget)
    return np.stack([batch[1:] for batch in batches[2:] if len(batch) == search.chains + 1])


def test_one_value_in_five_jumps_anywhere_and_the_others_stay_near() -> None:
    search = Annealing(reach=Geometric(1e-6, 1e-6), chains=5, exchange=0, moved=1.0)
    path = annealed(search, people=80, D=3, budget=400)
    moves = path[1:] - path[:-1]
    assert np.all(np.count_nonzero(moves, axis=-1) == 1)
    far = np.abs(moves) > 1e-4
    assert np.mean(np.any(far, axis=-1)) == pytest.approx(0.2, abs=0.01)
    landed = path[1:][far]
    np.testing.assert_allclose(np.quantile(landed, [0.0, 0.25, 0.5, 0.75, 1.0]), [0, 0.25, 0.5, 0.75, 1], atol=0.03)
    np.testing.assert_allclose(np.mean(moves != 0.0, axis=(0, 1, 2)), 1 / 3, atol=0.02)


def test_changes_follow_the_reach_and_ever_fewer_people_move() -> None:
    search = Annealing(reach=Geometric(0.02, 0.0002), chains=5, exchange=0, moved=0.25)
    budget = 700
    path = annealed(search, people=200, D=1, budget=budget)
    moves = (path[1:] - path[:-1])[..., 0]
    progress = (1 + 5 + 6 * np.arange(1, len(moves) + 1)) / budget
    np.testing.assert_allclose(np.mean(moves != 0.0, axis=(1, 2)), 1.0 - 0.75 * progress, atol=0.06)
    near = [np.median(np.abs(step[step != 0.0])) for step in moves]
    # the median of |normal| among 4 of 5 values, the rest are jumps: its quantile 0.625 is 0.887
    np.testing.assert_allclose(near, 0.887 * 0.02 * 0.01**progress, rtol=0.25)


def fixed_chains(exchange: int, temperature: float, later: float, people: int) -> list[np.ndarray]:
    """Return the batches of four chains that begin at costs 0, 0, 0 and 1, a spread of 1; all later costs are equal."""

    def cost(batch: np.ndarray, number: int) -> np.ndarray:
        first = [[0.0], [0.0, 0.0, 1.0, 1.0]]
        return (
            np.repeat(np.array(first[number])[:, None], people, axis=1)
            if number < 2
            else np.full(batch.shape[:2], later)
        )

    search = Annealing(
        cooling=Geometric(temperature, temperature), reach=Geometric(1e-9, 1e-9), chains=4, exchange=exchange, moved=1.0
    )
    return run(search, cost, np.full((1, people, 1), 0.5), 1 + 4 + 5 * 8)


@pytest.mark.parametrize("temperature", [0.3, 1.0, 3.0])
def test_a_dearer_value_is_accepted_with_the_probability_of_metropolis(temperature: float) -> None:
    """A cost that grows by one spread is accepted with the probability ``exp(-1 / T)``."""
    batches = fixed_chains(exchange=0, temperature=temperature, later=1.0, people=4000)
    here = np.stack([batches[0][0], *batches[1][:2]])
    tried, after = batches[2][1:4], batches[3][1:4]
    jumped = np.abs(tried - here) > 1e-3
    accepted, rejected = jumped & (np.abs(after - tried) < 1e-6), jumped & (np.abs(after - here) < 1e-6)
    share = accepted.sum() / (accepted.sum() + rejected.sum())
    assert share == pytest.approx(math.exp(-1.0 / temperature), abs=0.05)


@pytest.mark.parametrize("exchange", [0, 1, 3])
def test_the_worse_half_of_the_chains_continues_from_the_better_half(exchange: int) -> None:
    batches = fixed_chains(exchange, temperature=1e-6, later=1e9, people=300)
    begin = np.stack([batches[0][0], batches[1][0], batches[1][1], batches[1][2]])
    for step, batch in enumerate(batches[2:8]):
        same = np.mean(np.abs(batch[1:] - begin) < 1e-6, axis=(1, 2)) > 0.7
        copies = np.mean(np.abs(batch[1:] - begin[[0, 1, 0, 1]]) < 1e-6, axis=(1, 2)) > 0.7
        replaced = bool(exchange) and step >= exchange
        assert (same.tolist(), copies.tolist()) == (
            ([True, True, False, False], [True] * 4) if replaced else ([True] * 4, [True, True, False, False])
        )

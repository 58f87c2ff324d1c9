"""Searches keep their budget and the best crowd, the same ones every time, alone or among others."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot import calibration
from crowdbot.calibration import CMAES, Annealing, Genetic, Geometric, Greedy, RandomSearch, Search
from crowdbot.core import InputError, UnknownName, builtin_classes, find_class, stream

KINDS = builtin_classes(calibration, Search)
every = pytest.mark.parametrize("name", KINDS)
LOW, HIGH = np.array([-2.0, 0.1, 1.0]), np.array([2.0, 1.0, 5.1])
TARGET = np.array([0.5, 0.25, 2.0])


def bowl(x: np.ndarray, which: np.ndarray) -> np.ndarray:
    """Everyone costs the square of his distance to a point, and a little of that of who is before him."""
    own = np.sum((x - TARGET + 0.1 * which[:, None, None]) ** 2, axis=-1)
    return own + 0.1 * np.roll(own, 1, axis=-1)


def begin(W: int, N: int, S: int = 1) -> np.ndarray:
    return np.stack([stream(5, "begin", w).uniform(LOW, HIGH, (S, N, 3)) for w in range(W)], axis=1)


def rngs(W: int, seed: int = 1) -> list[np.random.Generator]:
    return [stream(seed, "search", w) for w in range(W)]


class Watched:
    """A function that remembers what it was asked, problem by problem."""

    def __init__(self, function: Callable[[np.ndarray, np.ndarray], np.ndarray], W: int) -> None:
        self.function = function
        self.asked: list[list[np.ndarray]] = [[] for _ in range(W)]

    def __call__(self, x: np.ndarray, which: np.ndarray) -> np.ndarray:
        assert x.ndim == 4
        assert x.shape[1] == len(which)
        for place, w in enumerate(which):
            self.asked[w] += [crowd.copy() for crowd in x[:, place]]
        return self.function(x, which)


def test_searches_are_found_by_their_names() -> None:
    assert set(KINDS) == {"annealing", "cmaes", "genetic", "greedy", "random-search"}
    assert find_class("cma-es", calibration, Search) is find_class("CMAES", calibration, Search) is CMAES
    with pytest.raises(UnknownName, match="did you mean"):
        find_class("genetics", calibration, Search)


@every
@settings(max_examples=6)
@given(
    W=st.integers(1, 3), N=st.integers(1, 4), S=st.integers(1, 3), budget=st.integers(1, 150), seed=st.integers(0, 99)
)
def test_every_search_keeps_its_books(name: str, W: int, N: int, S: int, budget: int, seed: int) -> None:
    start = begin(W, N, S)
    watched = Watched(bowl, W)
    found = KINDS[name]().minimize(watched, LOW, HIGH, rngs(W, seed), budget, start)
    for w in range(W):
        asked = np.array(watched.asked[w])
        total = bowl(asked[:, None], np.array([w]))[:, 0].sum(axis=1) / N
        assert len(asked) == found.evaluations[w] <= budget
        assert np.all((asked >= LOW) & (asked <= HIGH))
        np.testing.assert_array_equal(asked[:S], start[:budget, w])
        np.testing.assert_allclose(found.history[w, : len(asked)], np.minimum.accumulate(total), rtol=1e-12)
        assert np.all(np.diff(found.history[w]) <= 0.0)
        assert found.history.shape == (W, budget)
        assert found.cost[w] == found.history[w, -1] <= total[: min(S, budget)].min()
        assert found.cost[w] == bowl(found.best[w][None, None], np.array([w])).sum() / N


@every
def test_the_whole_budget_is_spent_and_lowers_the_cost(name: str) -> None:
    found = KINDS[name]().minimize(bowl, LOW, HIGH, rngs(3), 601, begin(3, 5))
    assert found.evaluations.tolist() == [601] * 3
    assert np.all(found.cost < {"random-search": 0.2, "greedy": 0.1}.get(name, 0.02))


@every
def test_a_problem_alone_is_bitwise_the_problem_among_others(name: str) -> None:
    search = dataclasses.replace(KINDS[name](), tolerance=0.03)
    for N in (1, 3):
        start = begin(4, N, 2)
        together = search.minimize(bowl, LOW, HIGH, rngs(4), 400, start)
        for w in range(4):

            def only(x: np.ndarray, which: np.ndarray, w: int = w) -> np.ndarray:
                return bowl(x, which + w)

            alone = search.minimize(only, LOW, HIGH, rngs(4)[w : w + 1], 400, start[:, w : w + 1])
            for field in ("best", "cost", "evaluations", "history"):
                assert getattr(alone, field)[0].tobytes() == getattr(together, field)[w].tobytes(), field


@every
def test_the_same_streams_find_the_same_and_others_do_not(name: str) -> None:
    one, same, other = (KINDS[name]().minimize(bowl, LOW, HIGH, rngs(2, s), 200, begin(2, 2)) for s in (1, 1, 2))
    assert np.array_equal(one.best, same.best)
    assert np.array_equal(one.history, same.history)
    assert not np.array_equal(one.best, other.best)


@every
def test_a_good_start_is_never_lost_and_may_lie_outside(name: str) -> None:
    start = np.stack([np.full((1, 2, 3), 9.0), np.tile(TARGET, (1, 2, 1)) + 1e-4])
    watched = Watched(bowl, 1)
    found = KINDS[name]().minimize(watched, LOW, HIGH, rngs(1), 60, start)
    assert found.cost[0] <= bowl(start[1:], np.array([0])).mean()
    asked = np.array(watched.asked[0])
    np.testing.assert_array_equal(asked[:2], start[:, 0])
    assert np.all((asked[2:] >= LOW) & (asked[2:] <= HIGH))
    only = KINDS[name]().minimize(bowl, LOW, HIGH, rngs(1), 1, start)
    assert (only.evaluations[0], only.best[0].tolist()) == (1, np.full((2, 3), 9.0).tolist())


@every
def test_a_start_outside_that_is_best_stays_the_best(name: str) -> None:
    outside = np.array([3.0, 0.5, 2.0])
    found = KINDS[name]().minimize(
        lambda x, which: np.sum((x - outside) ** 2, axis=-1),
        LOW,
        HIGH,
        rngs(1),
        50,
        np.tile(outside, (1, 1, 2, 1)) + 0.1,
    )
    assert np.array_equal(found.best[0], np.tile(outside + 0.1, (2, 1)))


@every
def test_who_does_not_count_keeps_the_first_start(name: str) -> None:
    nobody = np.array([[True, False, False], [True, True, True], [False, False, False]])

    def some(x: np.ndarray, which: np.ndarray) -> np.ndarray:
        return np.where(nobody[which], np.nan, np.sum((x - TARGET) ** 2, axis=-1))

    start, watched = begin(3, 3), Watched(some, 3)
    found = KINDS[name]().minimize(watched, LOW, HIGH, rngs(3), 200, start)
    assert np.array_equal(found.best[0, 0], start[0, 0, 0])
    assert np.array_equal(found.best[1], start[0, 1])
    assert np.isnan(found.cost).tolist() == [False, True, False]
    assert np.all(np.isnan(found.history[1]))
    assert found.evaluations.tolist() == [200, 1, 200] == [len(asked) for asked in watched.asked]
    assert np.all(np.array(watched.asked[0])[:, 0] == start[0, 0, 0])
    own = np.sum((found.best[0, 1:] - TARGET) ** 2, axis=-1)
    assert found.cost[0] == pytest.approx(own.mean())
    assert own.mean() < 0.5


@every
@pytest.mark.parametrize("bad", [np.inf, np.nan])
def test_candidates_without_a_finite_cost_are_worst(name: str, bad: float) -> None:
    start = np.tile([1.0, 0.5, 2.0], (1, 1, 2, 1))

    def torn(x: np.ndarray, which: np.ndarray) -> np.ndarray:
        return np.where(x[..., 0] > 0.2, bowl(x, which), bad)

    found = KINDS[name]().minimize(torn, LOW, HIGH, rngs(1), 200, start)
    assert found.cost[0] < bowl(start, np.array([0])).mean()
    assert np.all(found.best[..., 0] > 0.2)
    never = KINDS[name]().minimize(lambda x, which: np.full(x.shape[:3], np.inf), LOW, HIGH, rngs(1), 60, start)
    assert never.cost[0] == np.inf
    assert np.array_equal(never.best[0], start[0, 0])


@every
def test_a_problem_stops_by_tolerance_and_leaves_the_batch(name: str) -> None:
    start = begin(3, 2)
    start[0, 1] = TARGET - 0.1
    watched = Watched(bowl, 3)
    found = dataclasses.replace(KINDS[name](), tolerance=0.5).minimize(watched, LOW, HIGH, rngs(3), 900, start)
    assert found.evaluations[1] == 1
    assert np.all(found.cost <= 0.5)
    assert np.all(found.evaluations < 900)
    for w, count in enumerate(found.evaluations):
        assert len(watched.asked[w]) == count
        assert np.all(found.history[w, count:] == found.cost[w])
    to_the_end = dataclasses.replace(KINDS[name](), tolerance=-math.inf)
    assert to_the_end.minimize(bowl, LOW, HIGH, rngs(3), 100, start).evaluations.tolist() == [100] * 3


@every
def test_a_problem_stops_when_patience_ends(name: str) -> None:
    flat = dataclasses.replace(KINDS[name](), patience=30)
    found = flat.minimize(lambda x, which: np.ones(x.shape[:3]), LOW, HIGH, rngs(2), 2000, begin(2, 2))
    assert np.all((found.evaluations >= 31) & (found.evaluations < 250))
    assert found.history.tolist() == np.ones((2, 2000)).tolist()


@every
def test_a_side_without_length_and_one_parameter_are_searched(name: str) -> None:
    high = np.array([2.0, 0.1, 5.0])
    found = KINDS[name]().minimize(bowl, LOW, high, rngs(1), 200, begin(1, 2))
    assert np.all(found.best[..., 1] == 0.1)
    one = KINDS[name]().minimize(
        lambda x, which: (x[..., 0] - 0.3) ** 2, np.zeros(1), np.ones(1), rngs(1), 200, np.ones((1, 1, 2, 1))
    )
    assert one.cost[0] < 1e-3


@every
def test_no_problem_is_no_trouble(name: str) -> None:
    found = KINDS[name]().minimize(bowl, LOW, HIGH, [], 10, np.zeros((1, 0, 4, 3)))
    assert found.best.shape == (0, 4, 3)
    assert found.history.shape == (0, 10)


@every
def test_an_impossible_search_is_refused(name: str) -> None:
    search, start = KINDS[name](), begin(1, 2)
    for low, high, budget, first, message in (
        (LOW, HIGH, 0, start, "budget = 0 evaluations must be at least 1"),
        (HIGH, LOW, 5, start, "the box is empty"),
        (LOW[:2], HIGH, 5, start, "two lists of finite numbers of equal length"),
        (LOW, HIGH * np.nan, 5, start, "two lists of finite numbers of equal length"),
        (LOW[:0], HIGH[:0], 5, start[..., :0], "the box has no dimensions"),
        (LOW, HIGH, 5, start[0], "must be \\[S, W, N, D\\]"),
        (LOW, HIGH, 5, start[:0], "at least one start"),
        (LOW, HIGH, 5, start * np.nan, "start must be finite"),
    ):
        with pytest.raises(InputError, match=message):
            search.minimize(bowl, low, high, rngs(1), budget, first)
    with pytest.raises(InputError, match="W = 2 streams"):
        search.minimize(bowl, LOW, HIGH, rngs(2), 5, start)
    with pytest.raises(InputError, match="the costs of 1 candidates have shape"):
        search.minimize(lambda x, which: x[..., 0].T, LOW, HIGH, rngs(1), 5, start)
    with pytest.raises(InputError, match="patience = -1 evaluations must be at least 0"):
        KINDS[name](patience=-1)
    with pytest.raises(InputError, match="tolerance = nan"):
        KINDS[name](tolerance=math.nan)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: RandomSearch(batch=0), "batch = 0 candidates must be at least 1"),
        (lambda: Greedy(trials=0), "trials = 0 new values must be at least 1"),
        (lambda: Annealing(chains=0), "chains = 0 must be at least 1"),
        (lambda: Annealing(moved=0.0), "moved = 0.0 of the people must be above 0"),
        (lambda: Genetic(population=1), "population = 1 crowds must be at least 2"),
        (lambda: Genetic(bred=1.5), "bred = 1.5 of the people must be above 0 and at most 1"),
        (lambda: CMAES(population=1), "population = 1 solutions must be at least 2"),
        (lambda: CMAES(width=0.0), "width = 0.0 sides of the box must be above 0"),
        (lambda: Geometric(0.1, 0.2), "from 0.1 to 0.2 must fall"),
        (lambda: Geometric(1.0, 0.0), "must fall and stay above 0"),
    ],
)
def test_wrong_settings_are_refused(make: Callable[[], object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()


def test_greedy_changes_one_parameter_of_one_person_at_a_time_and_visits_all() -> None:
    watched = Watched(bowl, 1)
    search = Greedy(trials=4)
    search.minimize(watched, LOW, HIGH, rngs(1), 1 + 4 * 3 * 5, begin(1, 5))
    asked = np.array(watched.asked[0])
    total = bowl(asked[:, None], np.array([0]))[:, 0].mean(axis=1)
    visited = set()
    for first in range(1, len(asked), 4):
        present = asked[int(np.argmin(total[:first]))]
        places = {tuple(place) for crowd in asked[first : first + 4] for place in np.argwhere(crowd != present)}
        assert len(places) == 1
        visited |= places
    assert len(visited) == 15


def test_random_search_covers_the_box() -> None:
    watched = Watched(bowl, 1)
    RandomSearch().minimize(watched, LOW, HIGH, rngs(1), 4000, begin(1, 1))
    place = (np.array(watched.asked[0])[1:-1, 0] - LOW) / (HIGH - LOW)
    np.testing.assert_allclose(place.mean(axis=0), 0.5, atol=0.02)
    np.testing.assert_allclose(place.std(axis=0), np.sqrt(1 / 12), atol=0.01)


def test_a_hot_chain_accepts_more_than_a_cold_one() -> None:
    start = np.tile(TARGET, (1, 1, 20, 1))

    def strayed(temperature: float) -> float:
        watched = Watched(lambda x, which: 1.0 + bowl(x, which), 1)
        cooling = Geometric(temperature, temperature)
        Annealing(cooling=cooling, exchange=0, moved=1.0).minimize(watched, LOW, HIGH, rngs(1), 800, start)
        return float(np.median(np.abs(np.array(watched.asked[0])[400:] - TARGET)))

    assert strayed(1.0) > 2.0 * strayed(1e-6)

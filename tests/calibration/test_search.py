"""Searches find small values, within their budget, the same ones every time."""

from __future__ import annotations

import numpy as np
import pytest

from crowdbot import calibration
from crowdbot.calibration import RandomSearch, Search
from crowdbot.core import InputError, stream
from crowdbot.core.plug import built_in

KINDS = built_in(calibration, Search)
every = pytest.mark.parametrize("name", KINDS)
LOW, HIGH = np.array([-2.0, 0.0, 1.0]), np.array([2.0, 1.0, 5.0])


def bowl(x: np.ndarray) -> np.ndarray:
    return np.sum((x - [0.5, 0.25, 2.0]) ** 2, axis=1)


@every
def test_the_budget_is_kept_and_the_history_falls(name: str) -> None:
    asked: list[np.ndarray] = []

    def counted(x: np.ndarray) -> np.ndarray:
        asked.append(x.copy())
        return bowl(x)

    found = KINDS[name]().minimize(counted, LOW, HIGH, stream(1), 300)
    tried = np.concatenate(asked)
    assert len(tried) == found.evaluations == len(found.history) <= 300
    assert np.all((tried >= LOW) & (tried <= HIGH))
    assert np.all(np.diff(found.history) <= 0.0)
    assert found.cost == found.history[-1] == bowl(tried).min() == bowl(found.best[None])[0]
    assert found.cost < 0.1


@every
def test_the_same_stream_finds_the_same_and_another_does_not(name: str) -> None:
    one, same, other = (KINDS[name]().minimize(bowl, LOW, HIGH, stream(seed), 50) for seed in (1, 1, 2))
    assert np.array_equal(one.best, same.best)
    assert not np.array_equal(one.best, other.best)


@every
def test_a_good_start_is_never_lost(name: str) -> None:
    start = np.array([[9.0, 9.0, 9.0], [0.5, 0.25, 2.0]])
    found = KINDS[name]().minimize(bowl, LOW, HIGH, stream(1), 20, start)
    assert found.cost == 0.0
    assert found.evaluations == 20
    only = KINDS[name]().minimize(bowl, LOW, HIGH, stream(1), 1, start)
    assert (only.evaluations, only.best.tolist()) == (1, [9.0, 9.0, 9.0])


@every
def test_candidates_without_a_finite_cost_are_passed_over(name: str) -> None:
    found = KINDS[name]().minimize(lambda x: np.where(x[:, 0] > 0, bowl(x), np.nan), LOW, HIGH, stream(1), 100)
    assert np.isfinite(found.cost)
    with pytest.raises(InputError, match="none of 5 candidates has a finite cost"):
        KINDS[name]().minimize(lambda x: np.full(len(x), np.inf), LOW, HIGH, stream(1), 5)


def test_random_search_covers_the_box() -> None:
    seen: list[np.ndarray] = []
    RandomSearch().minimize(lambda x: seen.append(x) or bowl(x), LOW, HIGH, stream(3), 4000)  # type: ignore[func-returns-value]
    place = (seen[0] - LOW) / (HIGH - LOW)
    assert len(seen) == 1
    np.testing.assert_allclose(place.mean(axis=0), 0.5, atol=0.02)
    np.testing.assert_allclose(place.std(axis=0), np.sqrt(1 / 12), atol=0.01)


@every
def test_an_impossible_search_is_refused(name: str) -> None:
    search = KINDS[name]()
    with pytest.raises(InputError, match="budget = 0 evaluations must be at least 1"):
        search.minimize(bowl, LOW, HIGH, stream(1), 0)
    with pytest.raises(InputError, match="the box is empty"):
        search.minimize(bowl, HIGH, LOW, stream(1), 5)
    with pytest.raises(InputError, match="two lists of as many finite numbers"):
        search.minimize(bowl, LOW[:2], HIGH, stream(1), 5)

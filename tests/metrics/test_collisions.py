"""Predicted collisions against a slow, obvious twin."""

import dataclasses
import math

import numpy as np
import pytest
from guesses import case, moved, scene, shuffled, weighted
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError
from crowdbot.data import Forecast, Windows
from crowdbot.metrics import collision_mask, collision_share, collisions, neighbor_mask

BOTH = pytest.mark.parametrize("neighbors", ["predicted", "true"])


def slow_collided(forecast: Forecast, future: Windows, limit: float, neighbors: str) -> np.ndarray:
    W, K, T, A, _ = forecast.position.shape
    slow = np.zeros((W, K, A), dtype=bool)
    for w, k, t, a, b in np.ndindex(W, K, T, A, A):
        if a == b or forecast.weight[w, k] == 0.0 or not future.scored[w, a]:
            continue
        if not (future.present[w, t, a] and future.present[w, t, b]):
            continue
        own = forecast.position[w, k, t, a]
        if neighbors == "true":
            slow[w, k, a] |= math.dist(own, future.position[w, t, b]) < limit
        elif future.scored[w, b]:
            slow[w, k, a] |= math.dist(own, forecast.position[w, k, t, b]) < limit
    return slow


@BOTH
@pytest.mark.parametrize("seed", range(4))
def test_collided_equals_its_slow_twin(seed: int, neighbors: str, monkeypatch: pytest.MonkeyPatch) -> None:
    forecast, future = case(seed)
    forecast = weighted(forecast, seed)
    slow = slow_collided(forecast, future, 0.4, neighbors)
    assert np.array_equal(collision_mask(forecast, future, 0.4, neighbors), slow)
    assert 0 < slow.sum() < slow.size
    monkeypatch.setattr(collisions, "PAIRS_AT_ONCE", 1)  # one sample at a time
    assert np.array_equal(collision_mask(forecast, future, 0.4, neighbors), slow)


@BOTH
@pytest.mark.parametrize("seed", range(4))
def test_who_has_company_equals_its_slow_twin(seed: int, neighbors: str) -> None:
    _, future = case(seed)
    found = neighbor_mask(future, neighbors)
    for w, a in np.ndindex(found.shape):
        others = [b for b in range(found.shape[1]) if b != a]
        if neighbors == "predicted":
            company = any(future.scored[w, b] for b in others)
        else:
            company = any(np.any(future.present[w, :, a] & future.present[w, :, b]) for b in others)
        assert found[w, a] == (future.scored[w, a] and company)


def test_the_share_counts_people_who_have_company_and_weighs_samples() -> None:
    position = [[[[0.0, 0.0], [0.1, 0.0], [9.0, 0.0]]], [[[0.0, 0.0], [0.3, 0.0], [9.0, 0.0]]]]
    forecast, future = scene(position[0], position, [0.75, 0.25])
    assert collision_share(forecast, future) == pytest.approx(2 / 3 * 0.75)
    alone = dataclasses.replace(future, scored=np.array([[True, False, False]]))
    assert math.isnan(collision_share(forecast, alone))


def test_true_neighbors_are_where_they_walked_scored_or_not_and_robots_too() -> None:
    truth = [[[0.0, 0.0], [5.0, 0.0], [1.0, 0.0]]]
    guess = [[[1.1, 0.0], [1.25, 0.0], [0.0, 0.0]]]  # two meet as predicted; the first also where the third truly is
    forecast, future = scene(truth, [guess])
    assert collision_mask(forecast, future).tolist() == [[[True, True, False]]]
    assert collision_mask(forecast, future, neighbors="true").tolist() == [[[True, False, True]]]
    robot = dataclasses.replace(future, robot=np.array([[False, False, True]]), scored=np.array([[True, True, False]]))
    assert collision_mask(forecast, robot, neighbors="true").tolist() == [[[True, False, False]]]
    assert collision_share(forecast, robot, neighbors="true") == 0.5
    gone = dataclasses.replace(robot, present=np.array([[[True, True, False]]]))
    assert collision_share(forecast, gone, neighbors="true") == 0.0


def test_the_truth_against_itself_is_the_same_with_both_kinds_of_neighbors() -> None:
    _, future = case(2)
    everyone = dataclasses.replace(future, scored=future.present.any(axis=1))
    exact = Forecast.of(future.position[:, None], np.ones(future.id.shape, dtype=bool), 0.4, "truth")
    one = collision_mask(exact, everyone, 0.8)
    assert np.array_equal(one, collision_mask(exact, everyone, 0.8, "true"))
    assert one.any()


@BOTH
@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), angle=st.floats(-4, 4), shift=st.floats(-100, 100))
def test_turning_shifting_and_reordering_changes_no_share(
    neighbors: str, seed: int, angle: float, shift: float
) -> None:
    forecast, future = case(seed)
    forecast = weighted(forecast, seed)
    share = collision_share(forecast, future, 0.4, neighbors)
    other = collision_share(*moved(forecast, future, angle, shift), 0.4, neighbors)
    mixed, there, _ = shuffled(forecast, future, seed)
    assert other == pytest.approx(share, abs=1e-12, nan_ok=True)
    assert collision_share(mixed, there, 0.4, neighbors) == pytest.approx(share, abs=1e-12, nan_ok=True)


def test_an_unknown_kind_of_neighbors_is_refused() -> None:
    with pytest.raises(InputError, match="collisions: neighbors 'ture', did you mean 'true'. must be predicted or"):
        collision_mask(*case(0), neighbors="ture")

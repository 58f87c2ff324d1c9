"""Collisions between rows, as TrajNet++ counts them."""

import math

import numpy as np
import pytest
from guesses import case

from crowdbot.core import InputError
from crowdbot.data import Forecast, Windows
from crowdbot.metrics import collision_mask


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("neighbors", ["predicted", "true"])
def test_points_between_rows_equal_a_slow_twin(seed: int, neighbors: str) -> None:
    forecast, future = case(seed)
    W, K, T, A, _ = forecast.position.shape
    slow = np.zeros((W, K, A), dtype=bool)
    for w, k, t, a, b in np.ndindex(W, K, T, A, A):
        there = future.present[w]
        if a == b or not future.scored[w, a] or not (there[t, a] and there[t, b]):
            continue
        if neighbors == "predicted" and not future.scored[w, b]:
            continue
        others = forecast.position[w, k] if neighbors == "predicted" else future.position[w]
        points = [(forecast.position[w, k, t, a], others[t, b])]
        if t + 1 < T and there[t + 1, a] and there[t + 1, b]:
            own = (forecast.position[w, k, t, a] + forecast.position[w, k, t + 1, a]) / 2
            points.append((own, (others[t, b] + others[t + 1, b]) / 2))
        slow[w, k, a] |= any(math.dist(item, other) < 0.4 for item, other in points)
    assert np.array_equal(collision_mask(forecast, future, 0.4, neighbors, parts=2), slow)
    assert slow.sum() >= collision_mask(forecast, future, 0.4, neighbors).sum()


def exchange() -> tuple[Forecast, Windows]:
    """Two people exchange their places within a step; only the first is scored."""
    place = np.array([[[[0.0, 0.0], [1.0, 0.0]], [[1.0, 0.0], [0.0, 0.0]]]])
    here = np.ones((1, 2, 2), dtype=bool)
    scored = np.array([[True, False]])
    future = Windows(place, here, scored, ~here[:, 0], np.array([[1, 2]]), np.array([[1, 2]]), 0.4, "trajnet++", "made")
    return Forecast.of(place[:, None], here[:, 0], 0.4, "mine"), future


def test_people_who_exchange_places_collide_between_rows() -> None:
    forecast, future = exchange()
    assert not collision_mask(forecast, future, neighbors="true").any()
    assert collision_mask(forecast, future, neighbors="true", parts=2).tolist() == [[[True, False]]]


def test_predicted_neighbors_need_not_be_scored() -> None:
    forecast, future = exchange()
    assert not collision_mask(forecast, future, parts=2).any()
    assert collision_mask(forecast, future, parts=2, everyone=True).tolist() == [[[True, False]]]


def test_parts_are_at_least_one() -> None:
    with pytest.raises(InputError, match="parts = 0 must be at least 1"):
        collision_mask(*exchange(), parts=0)

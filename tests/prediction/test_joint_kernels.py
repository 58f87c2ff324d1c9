"""Kernels of joint futures against slow and obvious twins: wall crossings, separation of paths, assignment."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from crowdbot.core import stream
from crowdbot.data import Windows
from crowdbot.prediction.joint_futures import (
    coordinate_draws,
    coordinate_modes,
    separate_people,
    stop_at_walls,
)
from crowdbot.prediction.joint_kernels import assign_futures, first_crossing, separate_paths

Maker = Callable[..., Windows]
LIMIT = 0.4
seeds = st.integers(0, 10_000)
PEOPLE = np.ones(2, dtype=np.int64)


def rooms(path: np.ndarray) -> np.ndarray:
    """Return half of the limit for everyone."""
    return np.full(len(path), 0.5 * LIMIT)


def cuts(p: np.ndarray, q: np.ndarray, a: np.ndarray, b: np.ndarray) -> bool:
    """Return whether the segments pq and ab cross, by solving for the point of intersection."""
    matrix = np.stack([q - p, a - b], axis=1)
    if abs(np.linalg.det(matrix)) < 1e-12:
        return False
    s, t = np.linalg.solve(matrix, a - p)
    return bool(0.0 < s < 1.0 and 0.0 < t < 1.0)


@settings(max_examples=25, deadline=None)
@given(seed=seeds)
def test_the_first_crossing_of_a_wall_equals_its_slow_twin(seed: int) -> None:
    rng = stream(seed, "walls")
    start, one, other = rng.normal(0.0, 2.0, (3, 2)), rng.normal(0.0, 2.0, (4, 2)), rng.normal(0.0, 2.0, (4, 2))
    path = np.cumsum(rng.normal(0.0, 0.7, (3, 2, 5, 2)), axis=2)
    expected = np.full((3, 2), 5)
    for n in range(3):
        for k in range(2):
            places = np.concatenate([start[n : n + 1], start[n] + path[n, k]])
            hits = [t for t in range(5) if any(cuts(*places[t : t + 2], a, b) for a, b in zip(one, other, strict=True))]
            expected[n, k] = min(hits, default=5)
    assert first_crossing(start, path, one, other).tolist() == expected.tolist()


@settings(max_examples=25, deadline=None)
@given(seed=seeds, first=st.booleans(), second=st.booleans())
def test_two_people_are_moved_apart_along_their_closest_line(seed: int, first: bool, second: bool) -> None:
    rng = stream(seed, "pairs")
    path = np.cumsum(rng.normal(0.0, 0.3, (2, 6, 2)), axis=1)
    fixed = np.array([first, second])
    rows = path[0] - path[1]
    fine = np.linspace(0.0, 5.0, 5001)
    away = np.stack([np.interp(fine, np.arange(6), rows[:, axis]) for axis in (0, 1)], axis=1)
    distance = np.linalg.norm(away, axis=1)
    at = int(np.argmin(distance))
    when = fine[at]
    moved = separate_paths(path, np.where(fixed, 0, 1), rooms(path), 1)
    expected = path.copy()
    if distance[at] < LIMIT and not fixed.all():
        missing = (1.02 * LIMIT - distance[at]) * away[at] / distance[at]
        grown = np.minimum(1.0, np.arange(1.0, 7.0) / (when + 1.0))[:, None] * missing
        share = 1.0 if fixed.any() else 0.5
        expected[0] += 0.0 if first else share * grown
        expected[1] -= 0.0 if second else share * grown
    assume(abs(distance[at] - LIMIT) > 1e-4)
    assume(distance[at] > 0.02)
    np.testing.assert_allclose(moved, expected, atol=0.02)


@settings(max_examples=15, deadline=None)
@given(seed=seeds)
def test_separation_does_not_depend_on_the_order_of_people(seed: int) -> None:
    rng = stream(seed, "many")
    path = rng.normal(0.0, 0.5, (4, 1, 2)) + np.cumsum(rng.normal(0.0, 0.1, (4, 5, 2)), axis=1)
    fixed, order = rng.random(4) < 0.3, rng.permutation(4)
    moved = separate_paths(path, np.where(fixed, 0, 1), rooms(path), 3)
    np.testing.assert_allclose(
        separate_paths(path[order], np.where(fixed, 0, 1)[order], rooms(path[order]), 3), moved[order], atol=1e-9
    )
    np.testing.assert_array_equal(moved[fixed], path[fixed])


def test_people_at_one_place_are_moved_across_their_way() -> None:
    step = np.arange(1.0, 5.0)[:, None]
    same = np.stack([step * [0.5, 0.0]] * 2)
    moved = separate_paths(same, PEOPLE, rooms(same), 1)
    assert np.all(moved[..., 0] == same[..., 0])
    np.testing.assert_allclose(np.abs(moved[:, :, 1]), 0.51 * LIMIT)
    assert np.all(moved[0, :, 1] == -moved[1, :, 1])
    far = np.stack([step * [0.5, 0.0], step * [0.5, 0.0] + [0.0, LIMIT]])
    np.testing.assert_array_equal(separate_paths(far, PEOPLE, rooms(far), 12), far)


def collisions(path: np.ndarray, choice: np.ndarray) -> int:
    taken = np.take_along_axis(path, choice[:, :, None, None], axis=1)
    away = np.linalg.norm(taken[:, None] - taken[None], axis=-1).min(axis=-1)
    return int((away < LIMIT).sum() - choice.size) // 2


def sides(*people: list[float]) -> np.ndarray:
    """Return futures ``[A, K, 3, 2]`` of people who walk along x, each at these places y."""
    place = np.zeros((len(people), len(people[0]), 3, 2))
    place[..., 0] = np.arange(3.0)
    place[..., 1] = np.array(people)[:, :, None]
    return place


@pytest.mark.parametrize("order", [0.0, 0.3, 1.0])
def test_futures_are_exchanged_if_that_saves_collisions(order: float) -> None:
    both_meet = sides([0.0, 5.0], [0.1, 5.1])
    assert assign_futures(both_meet, rooms(both_meet), order, 8).tolist() == [[1, 0], [0, 1]]
    assert assign_futures(both_meet, rooms(both_meet), order, 0).tolist() == [[0, 1], [0, 1]]
    nobody_meets = sides([0.0, 5.0], [0.5, 5.5])
    assert assign_futures(nobody_meets, rooms(nobody_meets), order, 8).tolist() == [[0, 1], [0, 1]]


def test_futures_are_exchanged_only_if_they_cost_less_than_a_collision() -> None:
    # of three futures the outer ones meet; the cheapest exchanges are those with the neighbor in probability
    path = sides([0.0, 20.0, 5.0], [0.1, 10.0, 15.0])
    assert assign_futures(path, rooms(path), 0.3, 8).tolist() == [[1, 0, 2], [0, 1, 2]]
    assert assign_futures(path, rooms(path), 6.0, 8).tolist() == [[0, 1, 2], [0, 1, 2]]  # two moves by 1/3: 12 / 9 > 1
    assert assign_futures(path, rooms(path), 4.0, 8).tolist() == [[1, 0, 2], [0, 1, 2]]  # 8 / 9 < 1


@settings(max_examples=20, deadline=None)
@given(seed=seeds)
def test_no_single_exchange_saves_another_collision(seed: int) -> None:
    rng = stream(seed, "local")
    path = rng.normal(0.0, 1.0, (4, 1, 1, 2)) + np.cumsum(rng.normal(0.0, 0.3, (4, 4, 6, 2)), axis=2)
    choice = assign_futures(path, rooms(path), 0.0, 50)
    least = collisions(path, choice)
    for a in range(4):
        for k in range(4):
            for j in range(k):
                other = choice.copy()
                other[a, [k, j]] = choice[a, [j, k]]
                assert collisions(path, other) >= least


def two_beside(windows: Maker, **more: object) -> Windows:
    back = 0.4 * np.arange(-3, 1)[:, None]
    return windows(np.stack([back * [1.0, 0.0], back * [1.0, 0.0] + [0.0, 0.1]], axis=1)[None], **more)


def test_modes_are_weighted_by_the_mean_probability_of_people(windows: Maker) -> None:
    past = two_beside(windows, robot=[[False, False]])
    place = np.swapaxes(sides([0.0, 5.0], [0.1, 5.1]), 0, 2).swapaxes(0, 1)[None]
    share = np.array([[[0.8, 0.2], [0.6, 0.4]]])
    found, weight, order = coordinate_modes(past, place, share, LIMIT)
    assert found[0, :, 0, :, 1].tolist() == [[0.0, 5.1], [5.0, 0.1]]
    np.testing.assert_allclose(weight, [[0.6, 0.4]])
    assert order.tolist() == [[[0, 1], [1, 0]]]
    np.testing.assert_array_equal(coordinate_modes(past, place, share, 0.0)[0], place)
    robot = two_beside(windows, robot=[[False, True]])
    np.testing.assert_allclose(coordinate_modes(robot, place, share, LIMIT)[1], [[0.8, 0.2]])


def test_draws_stay_in_their_block(windows: Maker) -> None:
    past = two_beside(windows)
    place = np.swapaxes(sides([0.0, 5.0, 0.0, 9.0], [0.1, 5.1, 0.1, 9.1]), 0, 2).swapaxes(0, 1)[None]
    found = coordinate_draws(past, place, LIMIT, 2)
    assert found[0, :, 0, :, 1].tolist() == [[5.0, 0.1], [0.0, 5.1], [9.0, 0.1], [0.0, 9.1]]
    np.testing.assert_array_equal(coordinate_draws(past, place, LIMIT, 1), place)


def test_people_are_separated_unless_that_leads_through_a_wall(windows: Maker) -> None:
    step = 0.4 * np.arange(1.0, 4.0)[:, None]
    place = np.stack([step * [1.0, 0.0], step * [1.0, 0.0] + [0.0, 0.1]], axis=1)[None, None]
    free = separate_people(two_beside(windows), place, LIMIT)
    np.testing.assert_allclose(free[0, 0, :, 1, 1] - free[0, 0, :, 0, 1], [1.02 * LIMIT] * 3)
    wall = np.array([[-9.0, 0.15], [9.0, 0.15], [9.0, 0.16], [-9.0, 0.16]])
    walled = separate_people(two_beside(windows, walls=(wall,)), place, LIMIT)
    np.testing.assert_array_equal(walled[0, 0, :, 1], place[0, 0, :, 1])
    np.testing.assert_array_equal(walled[0, 0, :, 0], free[0, 0, :, 0])
    np.testing.assert_array_equal(separate_people(two_beside(windows), place, 0.0), place)


def test_displacements_end_in_front_of_a_wall(windows: Maker) -> None:
    wall = np.array([[1.0, -1.0], [1.0, 1.0]])
    past = windows(np.zeros((1, 2, 1, 2)), walls=(wall,))
    path = np.array([[[[0.6, 0.0], [1.2, 0.0], [1.8, 0.0]], [[1.5, 0.0], [2.0, 0.0], [3.0, 0.0]],
                      [[0.0, 1.0], [0.0, 2.0], [0.0, 3.0]]]])  # fmt: skip
    where = np.array([0]), np.array([0])
    found, stopped = stop_at_walls(past, path, *where)
    assert found[0, :, :, 0].tolist() == [[0.6, 0.6, 0.6], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
    assert found[0, 2, :, 1].tolist() == [1.0, 2.0, 3.0]
    assert stopped.tolist() == [[True, True, False]]
    same, nobody = stop_at_walls(windows(np.zeros((1, 2, 1, 2))), path, *where)
    np.testing.assert_array_equal(same, path)
    assert not nobody.any()

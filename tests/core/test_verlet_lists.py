"""Neighbour lists over several steps: the results of a new search, from fewer searches."""

from __future__ import annotations

import numpy as np
import pytest

from crowdbot.core.neighbors import SMALL, nearest, search, verlet_lists


@pytest.fixture(autouse=True)
def no_lists():
    """Begin and end without kept candidates."""
    verlet_lists._kept.__dict__.clear()
    yield
    verlet_lists._kept.__dict__.clear()


@pytest.fixture
def searches(monkeypatch):
    """Return a list to which every search in a grid adds the number of its rows."""
    result: list[int] = []
    whole = search.search_in_grid

    def counted(seekers, seen, *arguments):
        result.append(len(seen))
        return whole(seekers, seen, *arguments)

    monkeypatch.setattr(search, "search_in_grid", counted)
    return result


def crowd(seed, E, A, density=0.7):
    rng = np.random.default_rng(seed)
    return rng, rng.uniform(0.0, (A / density) ** 0.5, (E, A, 2)), rng.normal(0.0, 1.0, (E, A, 2))


def check(place, reach, most, seen=True, asking=True):
    found, fresh = (nearest(place, reach, most, seen, asking, method=how) for how in ("auto", "grid"))
    assert np.array_equal(found.agent, fresh.agent)
    assert np.array_equal(found.number, fresh.number)
    assert np.array_equal(np.sort(found.order), np.arange(place.shape[0] * place.shape[1]))


@pytest.mark.parametrize(("E", "A"), [(1, 200), (1, SMALL + 150), (3, 260)])
@pytest.mark.parametrize(("reach", "most"), [(3.0, 50), (5.0, 10), (2.0, 1), (50.0, 500), (np.inf, 8)])
def test_slow_crowds_have_the_neighbours_of_a_new_search(E, A, reach, most):
    _, place, velocity = crowd(A, E, A)
    for _ in range(25):
        place = place + 0.01 * velocity
        check(place, reach, most)


def test_a_slow_crowd_is_searched_seldom(searches):
    _, place, velocity = crowd(0, 1, 300)
    velocity *= 1.3 / np.linalg.norm(velocity, axis=-1, keepdims=True)
    for step in range(40):
        nearest(place + 0.01 * step * velocity, 3.0, 50)
    assert len(searches) <= 6


def test_a_fast_crowd_is_searched_once_a_step(searches):
    _, place, velocity = crowd(1, 1, 300)
    for step in range(10):
        nearest(place + 0.1 * step * velocity, 3.0, 50)
    assert len(searches) == 10


@pytest.mark.parametrize(("reach", "most"), [(5.0, 10), (2.0, 1), (50.0, 150), (np.inf, 8)])
def test_fast_crowds_have_the_neighbours_of_a_new_search(reach, most):
    rng, place, velocity = crowd(5, 2, 200)
    for step in range(12):
        place = place + 0.2 * velocity
        seen = rng.random((2, 200)) < (0.9 if step % 4 == 1 else 1.0)
        place[rng.random((2, 200)) < 0.02] = 3.0  # several at the same place
        check(place, reach, rng.integers(0, 12, (2, 200)) if step % 5 == 4 else most, seen)


def test_jumps_changes_of_visibility_and_of_reach_are_noticed():
    rng, place, velocity = crowd(2, 1, 400)
    seen, reach = np.ones((1, 400), dtype=bool), np.full((1, 400), 3.0)
    for step in range(60):
        place = place + 0.01 * velocity
        if step % 7 == 3:
            place[0, rng.integers(400)] = place[0, rng.integers(400)] + 1e-3  # one jumps beside another
        if step % 11 == 5:
            seen = seen.copy()
            seen[0, rng.integers(400)] ^= True
        if step % 13 == 6:
            reach = reach.copy()
            reach[0, rng.integers(400)] = rng.uniform(0.0, 3.0)
        asking = rng.random((1, 400)) < 0.9
        check(place, reach, rng.integers(0, 12, 400) if step % 17 == 9 else 10, seen, asking)


def test_equal_distances_are_sorted_by_index():
    place = np.stack(np.meshgrid(np.arange(14.0), np.arange(14.0)), axis=-1).reshape(1, -1, 2)
    for step in range(12):
        check(place + 0.01 * step, 2.5, 7)


def test_absent_agents_do_not_matter():
    _, place, velocity = crowd(3, 1, 300)
    here = np.arange(300)[None] % 5 > 0
    for step in range(12):
        now = np.where(here[..., None], place + 0.01 * step * velocity, np.nan)
        check(now, 3.0, 20, here, here)


def test_models_of_one_crowd_keep_their_own_candidates(searches):
    _, place, velocity = crowd(4, 1, 250)
    velocity *= 1.3 / np.linalg.norm(velocity, axis=-1, keepdims=True)
    for step in range(12):
        now = place + 0.01 * step * velocity
        nearest(now, 3.0, 50)
        nearest(now, 4.0, 16)
    assert len(searches) <= 6
    assert len(verlet_lists._kept.slots) == 2


def test_few_crowds_are_kept():
    for A in range(200, 220):
        nearest(crowd(A, 1, A)[1], 3.0, 10)
    assert len(verlet_lists._kept.slots) == verlet_lists.SLOTS

"""Neighbour search: the grid, brute force and a plain NumPy twin give the same neighbours in the same order."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import SMALL, InputError, Neighbors
from crowdbot.core.model_parameter import dense
from crowdbot.core.neighbors import CROWD, FEW, SPARE, Seekers, nearest, nearest_of_rows
from crowdbot.core.neighbors.search import fill_copies, find_period
from samples import sample


def twin(position, reach, most, seen, asking):
    """Return lists of neighbours: sort everybody by distance, then by index."""
    E, A = position.shape[:2]
    answer = []
    for e in range(E):
        for a in range(A):
            dx, dy = position[e, :, 0] - position[e, a, 0], position[e, :, 1] - position[e, a, 1]
            d2 = dx * dx + dy * dy
            order = sorted((float(d2[j]), j) for j in range(A) if j != a and seen[e, j] and d2[j] < reach[e, a] ** 2)
            wanted = most[e, a] if asking[e, a] else 0
            answer.append([j for _, j in order[:wanted]])
    return answer


def lists(found: Neighbors):
    flat = zip(
        found.agent.reshape(found.number.size, -1 if found.agent.size else 0), found.number.reshape(-1), strict=True
    )
    return [row[:count].tolist() for row, count in flat]


def check_against_twin(position, reach, most, seen=True, asking=True):
    """Check both ways of searching against the twin."""
    shape = position.shape[:2]
    reach, most = np.broadcast_to(reach, shape), np.broadcast_to(most, shape)
    seen, asking = np.broadcast_to(seen, shape), np.broadcast_to(asking, shape)
    expected = twin(position, reach, most, seen, asking)
    for method in ("brute", "grid", "auto"):
        found = nearest(position, reach, most, seen, asking, method=method)
        assert lists(found) == expected, method
        assert sorted(found.order.tolist()) == list(range(shape[0] * shape[1]))
        for row, count in zip(
            found.agent.reshape(found.number.size, -1 if found.agent.size else 0), found.number.reshape(-1), strict=True
        ):
            assert np.all(row[count:] == -1)


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32),
    E=st.integers(1, 3),
    A=st.integers(1, 60),
    width=st.sampled_from([0.0, 0.5, 8.0, 60.0, 5000.0]),
    height=st.sampled_from([0.0, 4.0, 60.0]),
    far=st.sampled_from([0.0, -3e5, 7e11]),
)
def test_both_ways_agree_with_sorting(seed, E, A, width, height, far):
    rng = np.random.default_rng(seed)
    position = rng.uniform(0.0, 1.0, (E, A, 2)) * [width, height] + far
    if A > 3:
        position[:, 1] = position[:, 0]  # somebody in the same place
        position[:, 2] = position[:, 0] + [1e6, -1e6]  # and somebody far away from all others
    reach = rng.uniform(0.0, 0.5 * (width + height) + 1.0, (E, A))
    most = rng.integers(0, 12, (E, A))
    check_against_twin(position, reach, most, rng.random((E, A)) < 0.8, rng.random((E, A)) < 0.8)


def test_a_grid_with_an_even_number_of_rows():
    rng = np.random.default_rng(0)
    for A in range(20, 70, 5):  # the row above the last is the first again, which also lies below
        check_against_twin(rng.uniform(0.0, 1.0, (6, A, 2)) * [8.0, 4.0], 4.0, 11)


def test_equal_distances_are_sorted_by_index():
    side = np.arange(12.0)
    lattice = np.stack(np.meshgrid(side, side), axis=-1).reshape(1, -1, 2)
    shuffled = lattice[:, np.random.default_rng(3).permutation(144)]
    for most in (3, 5, 9, 143):
        check_against_twin(shuffled, 2.5, most)
    check_against_twin(np.concatenate([shuffled] * 2, axis=1), 1.5, 7)  # everybody twice


@pytest.mark.parametrize("most", sample([2, 1, 9], 1))
def test_far_more_candidates_than_are_wanted(most):
    side = np.arange(15.0)
    lattice = np.stack(np.meshgrid(side, side), axis=-1).reshape(1, -1, 2)  # many at equal distances
    crammed = np.concatenate([0.01 * lattice, lattice * 50.0 + 9.0, 1e-3 * lattice, np.zeros((1, 60, 2))], axis=1)
    shuffled = crammed[:, np.random.default_rng(5).permutation(crammed.shape[1])]
    check_against_twin(shuffled, 1e4, most)


def test_the_reach_is_open():
    row = np.array([[[0.0, 0.0], [3.0, 4.0], [-3.0, -3.9]]])
    found = nearest(row, 5.0, 9)
    assert lists(found)[0] == [2]
    check_against_twin(row, 5.0, 9)


@pytest.mark.parametrize("reach", [0.0, -2.0, np.inf, 1e200, 1e-200])
def test_strange_reaches(reach):
    position = np.random.default_rng(0).uniform(0.0, 9.0, (1, 40, 2))
    for method in ("brute", "grid"):
        found = nearest(position, reach, 39, method=method)
        assert np.all(found.number == (39 if reach > 1.0 else 0))


@pytest.mark.parametrize("size", [1e-300, 1e-12, 1e17, 1e150])
def test_strange_sizes(size):
    position = np.random.default_rng(0).uniform(-size, size, (2, 70, 2))
    check_against_twin(position, 0.3 * size, 5)
    check_against_twin(position, 5.0, 5)


def test_whoever_is_not_finite_is_nowhere():
    position = np.random.default_rng(0).uniform(0.0, 9.0, (1, 50, 2))
    position[0, 7], position[0, 8, 1] = np.nan, np.inf
    for method in ("brute", "grid"):
        found = nearest(position, 100.0, 49, method=method)
        assert found.number[0, 7] == found.number[0, 8] == 0
        assert not np.any(np.isin(found.agent, [7, 8]))


def test_alone_or_in_a_batch():
    position = np.random.default_rng(1).uniform(0.0, 30.0, (9, CROWD + 8, 2))
    together = nearest(position, 4.0, 8)
    assert CROWD + 8 <= SMALL < position.shape[0] * position.shape[1]  # alone by one thread, together by all
    for e in range(9):
        alone = nearest(position[e : e + 1], 4.0, 8)
        assert np.array_equal(alone.agent[0], together.agent[e])
        assert np.array_equal(alone.number[0], together.number[e])


def test_nobody_and_one():
    for shape in ((1, 0, 2), (0, 3, 2), (2, 1, 2)):
        for method in ("brute", "grid"):
            found = nearest(np.zeros(shape), 5.0, 4, method=method)
            assert found.number.shape == shape[:2]
            assert found.number.sum() == 0


def test_read_only_arrays_are_fine_and_stay_as_they_are():
    position = np.random.default_rng(1).uniform(0.0, 5.0, (1, 20, 2))
    position.setflags(write=False)
    before = position.copy()
    assert nearest(position, 2.0, 4).number.max() <= 4
    assert np.array_equal(position, before)


def test_unknown_method():
    with pytest.raises(InputError, match=r"'gird', did you mean 'grid'\?; choose auto, brute, grid"):
        nearest(np.zeros((1, 2, 2)), 5.0, 4, method="gird")


@pytest.mark.parametrize("A", [FEW, FEW + 1, FEW + 2, SPARE + 3, SPARE + 40])
@pytest.mark.parametrize("most", [1, 2, 5, 60])
def test_brute_force_of_every_size_agrees_with_sorting(A, most):
    rng = np.random.default_rng(A)
    position = np.round(rng.uniform(0.0, 4.0, (2, A, 2)))  # many equal distances
    check_against_twin(position, 3.0, most, seen=rng.random((2, A)) < 0.8)


def test_numbers_and_arrays_mean_the_same():
    position = np.random.default_rng(0).uniform(0.0, 4.0, (3, 9, 2))
    whole = nearest(position, 2.0, 3)
    spread = nearest(position, np.full((3, 9), 2.0), np.full(9, 3.0), np.ones((3, 1), bool), np.ones((3, 9), bool))
    for item, other in zip(whole, spread, strict=True):
        np.testing.assert_array_equal(item, other)


def test_dense_arrays_are_copied_only_if_necessary():
    kind = np.dtype(np.float64)
    plain = np.arange(6.0).reshape(2, 3)
    assert dense(plain, (2, 3), kind) is plain
    fixed = plain.copy()
    fixed.flags.writeable = False
    for value in (fixed, plain.T.copy().T, plain.astype(np.float32), plain.tolist()):
        found = dense(value, (2, 3), kind)
        assert found.flags.carray
        assert found.dtype == kind
        np.testing.assert_array_equal(found, plain)
    np.testing.assert_array_equal(dense([1.0, 2.0, 3.0], (2, 3), kind), [[1.0, 2.0, 3.0]] * 2)
    np.testing.assert_array_equal(dense(2.5, (2, 3), np.dtype(np.int32)), np.full((2, 3), 2))
    with pytest.raises(ValueError, match="broadcast"):
        dense(np.zeros(4), (2, 3), kind)


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**32), copies=st.integers(1, 5), E=st.integers(1, 4), A=st.integers(1, 40), lost=st.booleans()
)
def test_copies_of_environments_have_the_same_neighbours_as_alone(seed, copies, E, A, lost) -> None:
    random = np.random.default_rng(seed)
    place = np.round(random.uniform(-4.0, 4.0, (E, A, 2)), 1)  # many equal distances
    if lost:
        place[random.random((E, A)) < 0.2] = np.nan
    seen = np.tile(random.random((E, A)) < 0.8, (copies, 1))
    asking = random.random((copies * E, A)) < 0.8
    reach = random.choice([0.0, 0.5, 3.0, 20.0], (copies * E, A))
    most = random.integers(0, 12, (copies * E, A)).astype(np.int32)
    every = np.tile(place, (copies, 1, 1))
    period = find_period(every, seen)
    assert copies * E % period == 0
    assert period <= E
    agent = np.empty((copies * E * A, min(11, A)), dtype=np.int32)
    number = np.empty(copies * E * A, dtype=np.int32)
    flat = every.reshape(-1, 2), reach.reshape(-1), most.reshape(-1), asking.reshape(-1), seen.reshape(-1)
    fill_copies(*flat, A, period, agent, number)
    expected = twin(every, reach, most, seen, asking)
    assert [row[:count].tolist() for row, count in zip(agent, number, strict=True)] == [
        row[: agent.shape[1]] for row in expected
    ]


def test_a_batch_of_copies_takes_the_same_neighbours_as_one_of_others() -> None:
    random = np.random.default_rng(5)
    place = random.uniform(0.0, 6.0, (6, 30, 2))
    many = np.tile(place, (20, 1, 1))
    reach = random.uniform(1.0, 6.0, (120, 30))
    assert find_period(many, np.ones((120, 30), dtype=np.bool_)) == 6
    found = nearest(many, reach, 10)
    moved = many.copy()
    moved[-1] += 1.0  # no copy
    assert find_period(moved, np.ones((120, 30), dtype=np.bool_)) == 120
    other = nearest(moved, reach, 10)
    assert np.array_equal(found.agent[:-1], other.agent[:-1])
    assert np.array_equal(found.number[:-1], other.number[:-1])
    alone = nearest(place, reach[:6], 10)
    assert np.array_equal(found.agent[:6], alone.agent)


@pytest.mark.parametrize("copies", [1, 20])
def test_copies_may_share_their_neighbours(copies) -> None:
    random = np.random.default_rng(6)
    place = np.tile(np.round(random.uniform(0.0, 6.0, (6, 30, 2)), 1), (copies, 1, 1))
    seen, asking = np.tile(random.random((6, 30)) < 0.9, (copies, 1)), random.random((6 * copies, 30)) < 0.9
    reach, most = random.uniform(0.0, 6.0, (6 * copies, 30)), random.integers(0, 12, (6 * copies, 30)).astype(np.int32)
    expected = nearest(place, reach, most, seen, asking)
    rows = Seekers(place.reshape(-1, 2), reach.reshape(-1), most.reshape(-1), asking.reshape(-1))
    found = nearest_of_rows(rows, seen.reshape(-1), (6 * copies, 30), 11, shared=True)
    assert found.agent.shape[0] == 6
    assert np.array_equal(found.number, expected.number)
    assert np.array_equal(np.sort(found.order), np.arange(6 * copies * 30))
    for e, a in np.ndindex(found.number.shape):
        count = found.number[e, a]
        assert found.agent[e % 6, a, :count].tolist() == expected.agent[e, a, :count].tolist()

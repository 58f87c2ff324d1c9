"""Order of lanes: against a slow twin, chance and known crowds."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, stream
from crowdbot.data import Trajectories
from crowdbot.measurement import compute_lane_order, lane_order


def test_order_is_one_for_lanes_and_nothing_by_chance():
    rng = stream(1, "lanes")
    y = rng.uniform(0.0, 4.0, 400)
    assert lane_order(y, np.where(y < 2.0, 1.0, -1.0)) > 0.8
    assert lane_order(y, np.ones(400)) == 1.0
    assert abs(lane_order(y, rng.permutation(np.repeat([1.0, -1.0], 200)))) < 0.05
    assert np.isnan(lane_order(np.arange(5.0), np.ones(5)))


def test_what_chance_would_give_is_the_mean_over_shuffles():
    rng = stream(2, "lanes")
    y, side = rng.uniform(0.0, 3.0, 30), np.where(np.arange(30) < 12, 1.0, -1.0)
    reduced = [lane_order(y, rng.permutation(side)) for _ in range(3000)]
    assert abs(np.mean(reduced)) < 0.01


@settings(deadline=None, max_examples=20)
@given(st.integers(3, 40), st.integers(0, 10**6))
def test_order_is_that_of_the_slow_twin(count, seed):
    rng = stream(seed, "twin")
    y, side = rng.uniform(0.0, 2.0, count), rng.choice([-1.0, 1.0], count)
    phi, chance = [], []
    q = (side.sum() ** 2 - count) / (count * (count - 1))
    for i in range(count):
        band = [side[j] for j in range(count) if j != i and abs(y[j] - y[i]) < 0.3]
        if band:
            phi.append((sum(band) / len(band)) ** 2)
            chance.append((1.0 + (len(band) - 1) * q) / len(band))
    got = lane_order(y, side)
    if not phi:
        assert np.isnan(got)
    elif np.mean(chance) >= 1.0:
        assert got == 1.0
    else:
        assert got == pytest.approx((np.mean(phi) - np.mean(chance)) / (1.0 - np.mean(chance)))


def two_way(y, side):
    """Return people who walk three seconds along x at 1 m/s."""
    frame = np.repeat(np.arange(31), len(y))
    id = np.tile(np.arange(len(y)), 31)
    return Trajectories(id, frame, np.asarray(side)[id] * frame / 10.0, np.asarray(y)[id], row_rate=10.0)


def test_order_over_time_takes_the_way_of_each_person():
    side = np.repeat([1.0, -1.0], 6)
    lanes = compute_lane_order(two_way(np.where(side > 0.0, 0.0, 2.0), side))
    assert lanes.time.tolist() == [0.0, 1.0, 2.0, 3.0]
    assert lanes.order.tolist() == [1.0] * 4
    assert set(lanes.positive) == {6}
    assert len(compute_lane_order(two_way(np.where(side > 0.0, 0.0, 2.0), side), least=7)) == 0


def test_wrong_lanes_are_refused():
    tracks = two_way([0.0, 1.0], [1.0, -1.0])
    with pytest.raises(InputError, match="needs an axis x or y"):
        compute_lane_order(tracks, axis="z")

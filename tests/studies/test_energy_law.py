"""Energy of interactions of recorded people and of models in their place."""

from __future__ import annotations

import numpy as np
import pytest

from crowdbot.core import DataError
from crowdbot.data import Trajectories
from crowdbot.measurement import fit_interaction_energy
from crowdbot.models import ORCA, People
from measure_energy import EnergyCounts, count_energy, find_companions, fit_energy, read_streets, walk_again


def street(people=12, rows=20):
    """Return people who walk along x in both directions, side by side and one after the other."""
    start = np.arange(people) % 4
    side = np.where(np.arange(people) % 2, -1.0, 1.0)
    frame = (start[:, None] + np.arange(rows)).ravel()
    x = (side[:, None] * (0.5 * np.arange(rows) - 4.0)).ravel()
    y = np.repeat(0.9 * np.arange(people), rows)
    return Trajectories(np.repeat(np.arange(people), rows), frame, x, y, row_rate=2.5)


def test_models_walk_in_the_place_of_recorded_people():
    real = street()
    again = walk_again(real, ORCA())
    assert set(again.ids) == set(real.ids)
    for id in real.ids:
        mine, theirs = again.track(int(id)), real.track(int(id))
        assert mine.frame[0] == theirs.frame[0] - real.frame.min()
        assert mine.position[0] == pytest.approx(theirs.position[0])
        assert np.hypot(*(mine.position[-1] - theirs.position[-1])) < 1.0
        assert abs(len(mine.frame) - len(theirs.frame)) <= 3
    assert np.array_equal(walk_again(real, People()).position, walk_again(real, People()).position)


def test_companions_are_those_who_stay_near_each_other():
    rows = np.arange(12)
    frame, id = np.tile(rows, 3), np.repeat([4, 7, 9], 12)
    y = np.repeat([0.0, 0.8, 5.0], 12)
    tracks = Trajectories(id, frame, np.tile(0.5 * rows, 3), y, row_rate=2.5)
    assert find_companions(tracks) == {(4, 7)}
    counts = count_energy(tracks, 0.2, frozenset({(4, 7)}))
    assert counts.found.shape == counts.free.shape == (10, 80)


def test_the_exponent_of_made_counts_comes_back():
    tau = 0.1 * (np.arange(80) + 0.5)
    free = np.full((10, 80), 400.0)
    found = np.random.default_rng(2).poisson(free * np.exp(-0.3 / tau**2))
    fit = fit_energy((EnergyCounts(found.astype(float), free),))
    assert fit.exponent_low <= 2.0 <= fit.exponent_high
    assert fit.exponent == pytest.approx(2.0, abs=0.3)
    assert fit.energy[9] == pytest.approx(0.3 / tau[9] ** 2, abs=0.1)
    assert fit.low[9] < fit.energy[9] < fit.high[9]


def test_a_given_constant_and_range_are_kept():
    tau = np.arange(0.25, 3.0, 0.1)
    g, count = np.exp(-0.8 / tau**1.5), np.full(len(tau), 100)
    n, k, c = fit_interaction_energy(tau, g, count, offset=0.0)
    assert (round(n, 2), round(k, 2), c) == (1.5, 0.8, 0.0)
    bent = np.where(tau < 1.0, 0.5, g)
    assert fit_interaction_energy(tau, bent, count, (1.0, 3.0), 0.0)[0] == pytest.approx(1.5)
    assert fit_interaction_energy(tau, bent, count, offset=0.0)[0] < 1.0


def test_a_folder_without_streets_is_told(tmp_path):
    with pytest.raises(DataError, match="contains none of the recordings, such as eth_biwi"):
        read_streets(tmp_path)

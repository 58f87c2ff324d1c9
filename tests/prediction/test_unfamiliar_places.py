"""Places, trackers and people that the training did not see: bounded features and the out-of-distribution score."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.data import Windows
from crowdbot.prediction import AnchorNet, Anchors, ConstantVelocity, Kalman
from crowdbot.prediction.anchor_net.agent_frame import REACH, agent_features, agent_histories, heading_vectors, rotate
from crowdbot.prediction.anchor_net.anchors import resample_paths, scatter_to_slots
from crowdbot.prediction.anchor_net.filtered_line import filter_tracks, filtered_lines
from crowdbot.prediction.anchor_net.predictor import _bends
from crowdbot.prediction.anchor_net.predictor import out_of_distribution as score_of
from crowdbot.prediction.pretrained_weights import load_pretrained
from training_crowds import CROWD_LAYOUTS, CROWD_MODELS, simulated_crowds

Maker = Callable[..., Windows]
NET = AnchorNet("open")


def walkers(windows: Maker, *people: tuple[float, float, float, float], sway: float = 0.04) -> Windows:
    """People who walk from x, y [m] with velocities [m/s] for 8 rows, and sway [m] as measured people do."""
    time = 0.4 * np.arange(-7.0, 1.0)
    side = sway * np.array([1.0, -1.0, 0.5, 1.0, -1.0, 0.5, 0.0, 0.0])
    track = [[[x + vx * t, y + vy * t + s] for x, y, vx, vy in people] for t, s in zip(time, side, strict=True)]
    return windows([track])


def test_bounded_features_are_bounded_and_change_little_nearby(windows: Maker) -> None:
    wide = walkers(windows, (0.0, 0.0, 40.0, 0.0), (900.0, 50.0, -30.0, 9.0), (0.5, -700.0, 0.0, 60.0))
    people, _, _ = agent_histories(wide)
    own, company = agent_features(people, heading_vectors(people.past), REACH)
    assert np.abs(own).max() <= 10.0
    assert np.abs(company).max() <= 2.0
    close = walkers(windows, (0.0, 0.0, 0.8, 0.0), (1.0, 1.0, 0.8, 0.0))
    people, _, _ = agent_histories(close)
    heading = heading_vectors(people.past)
    for bounded, plain in zip(agent_features(people, heading, REACH), agent_features(people, heading), strict=True):
        np.testing.assert_allclose(bounded, plain, atol=0.1)


def test_a_neighbor_far_away_changes_nothing(windows: Maker) -> None:
    alone = walkers(windows, (0.0, 0.0, 1.3, 0.0))
    for x in (8.5, 30.0, 2000.0):
        both = walkers(windows, (0.0, 0.0, 1.3, 0.0), (x, 1.0, -1.0, 0.3))
        for samples in (1, 20):
            one = dataclasses.replace(NET, contact=0.0)
            beside, without = (one.predict(past, 12, samples).position[0, :, :, 0] for past in (both, alone))
            # the futures of both people combine by weight, so only their order may differ
            assert sorted(beside.reshape(samples, -1).tolist()) == sorted(without.reshape(samples, -1).tolist())


def test_walkers_in_a_wide_place_do_not_stop(windows: Maker) -> None:
    rng = np.random.default_rng(0)
    crowd = [(0.0, 0.0, 1.4, 0.0)] + [(*rng.uniform(-40.0, 40.0, 2), *rng.normal(0.0, 1.0, 2)) for _ in range(12)]
    crowd = [item for item in crowd if np.hypot(item[0], item[1]) > 10.0 or item[2] == 1.4]
    end = NET.predict(walkers(windows, *crowd), 12).position[0, 0, -1, 0, 0]
    assert 0.8 * 4.8 * 1.4 < end < 1.2 * 4.8 * 1.4


def test_the_score_is_low_for_walkers_and_high_for_what_is_no_walker(windows: Maker) -> None:
    past = walkers(windows, (0.0, 0.0, 1.2, 0.0), (200.0, 0.0, 15.0, 0.0))
    score = NET.predict(past, 12).out_of_distribution
    assert score is not None
    assert score[0, 0] < 0.1
    assert score[0, 1] > 0.9
    assert AnchorNet("eth").predict(past, 12).out_of_distribution.tolist() == [[0.0, 0.0]]  # type: ignore[union-attr]


def test_a_foreign_person_gets_the_filtered_line_and_the_anchors(windows: Maker) -> None:
    past = walkers(windows, (0.0, 0.0, 200.0, 0.0))
    one, many = NET.predict(past, 12), NET.modes(past)
    numbers = NET._numbers(past)
    people, _, _ = agent_histories(past)
    line = (
        filtered_lines(people.past, people.seen, people.noise, np.array([[1.0, 0.0]]), numbers["basis"])[0]
        @ numbers["basis"]
    )
    base = ConstantVelocity().predict(past, 12).position[0, 0, :, 0]
    np.testing.assert_allclose(one.position[0, 0, :, 0], base + line.reshape(12, 2), atol=0.02)
    shapes = (numbers["centres"] @ numbers["basis"]).reshape(1, -1, 12, 2)
    fixed = resample_paths(shapes, np.array([[80.0, 0.0]]), 12, 0.4)
    np.testing.assert_allclose(np.sort(many.path[0, :, -1, 0]), np.sort(fixed[0, :, -1, 0]), atol=1e-3)
    assert many.probability[0].sum() == pytest.approx(1.0)
    assert scatter_to_slots(past, fixed, np.array([0]), np.array([0])).shape == (1, 20, 12, 1, 2)
    assert Anchors("open").predict(past, 12, 20).samples == 20


def test_the_note_names_the_share_of_foreign_people(windows: Maker) -> None:
    past = walkers(windows, (0.0, 0.0, 1.2, 0.0), (200.0, 0.0, 15.0, 0.0))
    assert NET.note(past).startswith("50% of the people of made are unlike the training data")
    assert NET.note(walkers(windows, (0.0, 0.0, 1.2, 0.0))) == ""
    assert "; 50% of the people" in AnchorNet().note(past)


def test_the_score_grows_smoothly_with_the_speed(windows: Maker) -> None:
    speeds = np.linspace(0.5, 8.0, 200)
    people, window, _ = agent_histories(walkers(windows, *((0.0, 30.0 * k, v, 0.0) for k, v in enumerate(speeds))))
    score = score_of(load_pretrained("anchor-net", "open"), people, window)
    assert np.all(score[speeds < 3.9] == 0.0)
    assert np.all(score[speeds > 6.1] == 1.0)
    assert np.all(np.diff(score) >= 0.0)
    assert np.diff(score).max() < 0.05


def test_people_who_walk_like_machines_walk_on(windows: Maker) -> None:
    crowd = [(2.0 * k, 3.0 * (k % 3), 1.0 + 0.05 * k, 0.0) for k in range(6)]
    even = walkers(windows, *crowd, sway=0.0)
    forecast = NET.predict(even, 12)
    assert forecast.out_of_distribution is not None
    assert forecast.out_of_distribution.tolist() == [[1.0] * 6]
    free = dataclasses.replace(NET, contact=0.0)
    np.testing.assert_allclose(
        free.predict(even, 12).position, ConstantVelocity().predict(even, 12).position, atol=0.002
    )
    swaying = NET.predict(walkers(windows, *crowd), 12).out_of_distribution
    assert swaying is not None
    assert swaying.max() < 0.1


def test_simulated_crowds_are_the_same_for_a_seed() -> None:
    one, other = simulated_crowds(1, seed=4), simulated_crowds(1, seed=4)
    assert len(one) == len(CROWD_MODELS) * len(CROWD_LAYOUTS)
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(a.position, b.position)
        assert a.dt == pytest.approx(0.4)
        assert len(a.windows()[0]) > 0


def test_the_reach_of_a_training_is_above_0() -> None:
    from crowdbot.prediction.anchor_net.training import PRESETS, AnchorTraining

    assert PRESETS["general"].reach == REACH
    assert PRESETS["shipped"].reach == np.inf
    with pytest.raises(InputError, match="reach = 0.0 m must be above 0"):
        AnchorTraining(reach=0.0)


def straight_walkers(windows: Maker, noise: float) -> tuple[Windows, np.ndarray]:
    """Return 200 people who walk straight, far apart, with noise [m], and their true future ``[12, 200, 2]``."""
    rng = np.random.default_rng(7)
    speed, angle = rng.uniform(0.6, 1.8, 200), rng.uniform(-np.pi, np.pi, 200)
    velocity = speed[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    begin = 40.0 * np.stack(np.divmod(np.arange(200.0), 20.0), axis=1)
    row = np.arange(-7.0, 13.0)[:, None, None]
    true = begin + 0.4 * row * velocity
    return windows([true[:8] + noise * rng.standard_normal((8, 200, 2))]), true[8:]


@pytest.mark.parametrize("noise", [0.02, 0.05, 0.1])
def test_one_answer_is_not_worse_than_kalman_for_straight_noisy_walkers(windows: Maker, noise: float) -> None:
    past, truth = straight_walkers(windows, noise)
    one, filtered = (
        np.linalg.norm(predictor.predict(past, 12).position[0, 0] - truth, axis=2).mean()
        for predictor in (NET, Kalman())
    )
    assert one < 1.03 * filtered


def test_one_filter_of_the_grid_is_the_kalman_predictor(windows: Maker) -> None:
    past, _ = straight_walkers(windows, 0.05)
    people, _, _ = agent_histories(past)
    seen = people.seen.copy()
    seen[::3, 2:5] = False
    seen[::5, :6] = False
    kalman = Kalman(0.3, 0.04, 0.9)
    place, velocity, _ = filter_tracks(people.past, seen, people.noise, 0.4, np.array([0.3]), np.array([0.04]), 0.9)
    track = np.where(seen[..., None], people.past, 0.0).swapaxes(0, 1)
    motion, _, _ = kalman._run_filter(track, seen.T, 0.4)
    np.testing.assert_allclose(place, motion[0], atol=1e-12)
    np.testing.assert_allclose(velocity, motion[1], atol=1e-12)


def test_filters_fitted_to_each_track_are_better_than_one_filter_for_all(windows: Maker) -> None:
    row = np.arange(1.0, 13.0)[:, None, None]
    for noise in (0.05, 0.1):
        past, truth = straight_walkers(windows, noise)
        people, _, _ = agent_histories(past)
        basis = np.eye(24)
        heading = heading_vectors(people.past)
        found = filtered_lines(people.past, people.seen, people.noise, heading, basis)[0].reshape(-1, 12, 2)
        step = people.past[:, -1] - people.past[:, -2]
        line = past.position[0, -1] + row * step + rotate(found, heading, back=True).swapaxes(0, 1)
        fixed = Kalman().predict(past, 12).position[0, 0]
        errors = [np.linalg.norm(path - truth, axis=2).mean() for path in (line, fixed)]
        assert errors[0] < 0.8 * errors[1]


def test_the_share_of_the_filtered_line_grows_with_straightness_and_noise(windows: Maker) -> None:
    past, _ = straight_walkers(windows, 0.05)
    plain = dict(load_pretrained("anchor-net", "open"))
    assert 0.0 < plain["line_share"] < 1.0
    single = {share: _bends(plain | {"line_share": np.array(share)}, past).single for share in (0.0, 0.5, 1.0)}
    np.testing.assert_allclose(single[0.5], 0.5 * single[0.0] + 0.5 * single[1.0], atol=1e-9)
    people, _, _ = agent_histories(past)
    heading = heading_vectors(people.past)
    line, straight = filtered_lines(people.past, people.seen, people.noise, heading, plain["basis"])
    assert straight.mean() > 0.5
    np.testing.assert_allclose(single[1.0], single[0.0] + straight[:, None] * (line - single[0.0]), atol=1e-9)
    bend = 0.12 * np.arange(-7.0, 1.0)[:, None] ** 2 * np.array([0.0, 1.0])
    assert filtered_lines(people.past + bend, people.seen, people.noise, heading, plain["basis"])[1].max() < 0.01
    smooth, _, _ = agent_histories(straight_walkers(windows, 0.001)[0])
    assert filtered_lines(smooth.past, smooth.seen, smooth.noise, heading, plain["basis"])[1].max() < 0.01
    del plain["line_share"]
    np.testing.assert_allclose(_bends(plain, past).single, single[0.0], atol=1e-9)

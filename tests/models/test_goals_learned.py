"""Destinations learned from recordings of a place."""

from __future__ import annotations

import dataclasses
import time

import numpy as np
import pytest
from goal_places import crowd, street, windows
from scipy.optimize import minimize

from crowdbot.core import InputError
from crowdbot.data import Trajectories, fill_gaps, load, observed_velocity, steady_velocity
from crowdbot.models import CurrentDirection
from crowdbot.models.goals import EnvironmentLayout, LearnedDestinations
from crowdbot.models.goals.exits import clusters, track_ends
from crowdbot.models.goals.learned_destinations import BINS, TurnSamples, accumulate, median_turn
from crowdbot.models.goals.learned_velocity import LearnedVelocity, mean_velocity


def eastwards(x, y, speed=1.3):
    far = x - speed * 0.4 * np.arange(7.0, -1.0, -1.0)
    return windows(np.stack([far, np.full(8, float(y))], axis=1)[None, :, None])


def test_people_at_the_junction_are_known_to_turn():
    goal = LearnedDestinations.learn(street())
    assert len(goal.exits) == 2
    turning, passing = eastwards(-0.5, 1.5), eastwards(-0.5, -1.5)
    away = goal.resolve(turning)[0, 0] - turning.position[0, -1, 0]
    assert np.degrees(np.arctan2(away[1], away[0])) > 20.0
    straight = goal.resolve(passing)[0, 0] - passing.position[0, -1, 0]
    assert abs(np.degrees(np.arctan2(straight[1], straight[0]))) < 5.0
    north = int(np.argmax(goal.exits[:, 1]))
    assert goal.choices(turning).weight[0, 0, 1 + north] > 0.5
    assert goal.choices(passing).weight[0, 0, 0] > 0.5
    middle = goal.choices(eastwards(-0.5, 0.0)).weight[0, 0]
    assert middle[0] > 0.15
    assert middle[1 + north] > 0.15


def test_of_many_recorded_rows_every_kth_is_kept(monkeypatch):
    every = LearnedDestinations.learn(street()).samples
    count = len(every.turn)
    monkeypatch.setattr("crowdbot.models.goals.learned_destinations.MOST_VOTERS", count // 3 + 1)
    some = LearnedDestinations.learn(street()).samples
    for name in every._fields:
        np.testing.assert_array_equal(getattr(some, name), getattr(every, name)[::3])


def test_where_nobody_has_been_people_go_straight_on():
    goal = LearnedDestinations.learn(street())
    past = eastwards(50.0, 50.0)
    assert goal.resolve(past)[0, 0] == pytest.approx([50.0 + 26.0, 50.0], abs=0.5)
    assert goal.choices(past).weight[0, 0].tolist() == [1.0, 0.0, 0.0]


def test_it_predicts_better_than_the_current_direction():
    goal = LearnedDestinations.learn(street(), lookahead=3.2)
    past, future = street(seed=7).windows(8, 8)

    def error(towards):
        place = past.position[:, -1] + 3.2 * (towards - past.position[:, -1]) / 20.0
        return np.hypot(*np.moveaxis(place - future.position[:, -1], -1, 0))[future.scored].mean()

    assert error(goal.resolve(past)) < 0.75 * error(CurrentDirection().resolve(past))


@pytest.mark.parametrize("name", ["crowds_zara03", "students001"])
def test_on_real_streets_it_is_as_good_as_the_best_constant_velocity(recordings, name):
    early, late = load(recordings / f"eth_ucy_splits/all_data/{name}.txt").split(0.5)
    goal = LearnedDestinations.learn(early)
    past, future = late.windows(8, 12)
    time = past.dt * np.arange(1, 13)[:, None, None]

    def error(velocity):
        place = past.position[:, -1, None] + velocity[:, None] * time
        return np.sqrt(np.sum((place - future.position) ** 2, axis=-1)).mean(axis=1)[future.scored]

    best = min(error(observed_velocity(past, k)).mean() for k in (1, 2, 3, 7))
    one = error((goal.resolve(past) - past.position[:, -1]) / goal.horizon).mean()
    ways = goal.choices(past).likeliest(3).position - past.position[:, -1, :, None]
    assert one < best
    assert np.min([error(ways[:, :, k] / goal.horizon) for k in range(3)], axis=0).mean() < 0.93 * one


@pytest.mark.live
def test_thirty_people_take_less_than_five_milliseconds():
    goal = LearnedDestinations.learn(street(people=200))
    past = crowd(W=1, A=30, holes=0.0)
    goal.choices(past)
    took = []
    for _ in range(20):
        begin = time.perf_counter()
        goal.choices(past)
        took.append(time.perf_counter() - begin)
    assert min(took) < 0.005


def test_votes_are_those_of_a_plain_loop():
    rng = np.random.default_rng(3)
    angle = rng.uniform(-3.0, 3.0, 40)
    samples = TurnSamples(
        rng.normal(0.0, 2.0, (40, 2)),
        np.stack([np.cos(angle), np.sin(angle)], axis=1),
        rng.uniform(-2.0, 2.0, 40),
        rng.uniform(0.5, 1.5, 40),
        rng.random(40),
        rng.integers(0, 3, 40),
    )
    place, heading = rng.normal(0.0, 1.0, (3, 2)), samples.heading[:3]
    histogram, slow = np.zeros((3, 4, BINS)), np.zeros((3, 4, BINS))
    accumulate(place, heading, samples, 2, 1.5, 0.8, histogram)
    nodes = np.linspace(-np.pi / 2, np.pi / 2, BINS)
    for p in range(3):
        for v in range(40):
            apart = np.sum((samples.place[v] - place[p]) ** 2) / 1.5**2
            weight = max(0.0, 1.0 - (apart + np.sum((samples.heading[v] - heading[p]) ** 2) / 0.8**2) / 8.0) ** 4
            hat = np.maximum(
                0.0, 1.0 - np.abs(np.clip(samples.turn[v], nodes[0], nodes[-1]) - nodes) / (nodes[1] - nodes[0])
            )
            slow[p, 0] += weight * samples.worth[v] * samples.straight[v] * hat
            slow[p, 1 + samples.exit[v]] += weight * samples.worth[v] * (1.0 - samples.straight[v]) * hat
    assert histogram == pytest.approx(slow, abs=1e-12)
    assert slow.sum() > 1.0


def test_the_typical_turn_is_a_median():
    histogram = np.zeros(BINS)
    histogram[[20, 45]] = [1.0, 1.2]
    assert np.degrees(median_turn(histogram)) == pytest.approx(45.0, abs=3.0)
    histogram[20] = 1.4
    assert np.degrees(median_turn(histogram)) == pytest.approx(-30.0, abs=3.0)
    many = np.random.default_rng(2).normal(0.3, 0.2, 5001)
    histogram = np.bincount(np.round((many + np.pi / 2) / (np.pi / (BINS - 1))).astype(int), minlength=BINS)
    assert median_turn(histogram.astype(float)) == pytest.approx(np.median(many), abs=0.01)
    assert median_turn(np.zeros((2, BINS))).tolist() == [0.0, 0.0]


def test_the_learned_velocity_minimises_the_summed_distance():
    past, future = street(seed=5, noise=0.1).windows(5, 4)
    pace = LearnedVelocity.fit([(past, future)])
    steady, after, seen = steady_velocity(past), mean_velocity(past, future), future.scored
    off = np.diff(fill_gaps(past).position, axis=1) / past.dt - steady[:, None]

    def total(weight):
        miss = after - steady - np.sum(off * np.asarray(weight)[:, None, None], axis=1)
        return np.hypot(miss[..., 0], miss[..., 1])[seen].sum()

    best = minimize(total, np.zeros(4), method="Powell").fun
    assert total(pace.weight[3]) < best + 0.05 * (total(np.zeros(4)) - best) + 1e-9
    velocity = pace.velocity(past)
    assert np.hypot(*np.moveaxis(after - velocity, -1, 0))[seen].sum() == pytest.approx(total(pace.weight[3]))


def test_even_walkers_teach_nothing():
    past = windows(np.arange(12.0)[None, :, None, None] * np.ones((3, 1, 2, 2)))
    pair = past, dataclasses.replace(past, scored=np.ones((3, 2), dtype=bool), position=past.position + 12.0)
    assert np.all(LearnedVelocity.fit([pair]).weight == 0.0)


def test_ends_are_grouped_and_those_cut_off_left_out():
    tracks = street()
    id, place, gone = track_ends(tracks)
    assert list(id) == list(range(61))
    assert not gone[60]
    assert gone[:60].all()
    found = clusters(place[gone], 3.0, 2)
    assert len(found) == 2
    assert clusters(np.array([[1.0, 2.0]]), 3.0, 1).tolist() == [[1.0, 2.0]]
    assert clusters(np.array([[1.0, 2.0]]), 3.0, 2).shape == (0, 2)
    many = np.random.default_rng(0).normal(0.0, 0.1, (7000, 2))
    assert clusters(many, 3.0, 2) == pytest.approx(np.zeros((1, 2)), abs=0.05)


def test_two_recordings_teach_more_than_one():
    one, both = LearnedDestinations.learn(street(1)), LearnedDestinations.learn(street(1), street(2))
    assert len(both.samples.turn) > 1.5 * len(one.samples.turn)


def test_what_was_learned_is_the_same_again():
    one, two = LearnedDestinations.learn(street()), LearnedDestinations.learn(street())
    assert one.choices(crowd()).position.tobytes() == two.choices(crowd()).position.tobytes()


def slow_clock():
    tracks = street()
    return Trajectories(tracks.id, tracks.frame, tracks.x, tracks.y, row_rate=1.0, frame_step=10, name="slow")


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (LearnedDestinations.learn, "there is no recording to learn from"),
        (
            lambda: LearnedDestinations.learn(street(), slow_clock()),
            "street has steps of 0.4 s and slow has steps of 1 s",
        ),
        (lambda: LearnedDestinations.learn(dataclasses.replace(street(), units="px")), "street is in pixels"),
        (lambda: LearnedDestinations.learn(street(), lookahead=0.0), "lookahead = 0.0 s must be finite"),
        (lambda: LearnedDestinations.learn(street(), width=-1.0), "width = -1.0 m must be finite"),
        (lambda: LearnedDestinations.learn(street(), reach=0.0), "reach = 0.0"),
        (
            lambda: LearnedDestinations.learn(street()).choices(windows(np.zeros((1, 8, 1, 2)), units="px")),
            "made is in px, the goal was learned in m",
        ),
    ],
)
def test_wrong_use(make, says):
    with pytest.raises(InputError, match=says) as told:
        make()
    assert "\n" not in str(told.value)


def test_windows_of_another_time_step_are_interpolated():
    goal = LearnedDestinations.learn(street())
    time = np.arange(29.0)[:, None, None] * 0.1
    fast = windows((np.array([[0.5, 1.0], [6.0, 0.2]]) + time * np.array([[1.3, 0.0], [-1.1, 0.1]]))[None], dt=0.1)
    slow = windows(fast.position[:, ::4], dt=0.4)
    assert np.allclose(goal.velocity(fast), goal.velocity(slow), atol=1e-9)
    assert np.allclose(goal.resolve(fast), goal.resolve(slow), atol=1e-6)
    for item, other in zip(*(vars(goal.choices(past)).values() for past in (fast, slow)), strict=True):
        assert np.allclose(item, other, atol=1e-6)


def test_people_observed_for_less_than_the_time_step_of_the_goal_have_a_velocity():
    goal = LearnedDestinations.learn(street())
    walk = np.arange(3.0)[:, None, None] * 0.1 * np.array([[1.3, 0.0]])
    assert goal.velocity(windows(walk[None], dt=0.1))[0, 0] == pytest.approx([1.3, 0.0], abs=1e-9)
    alone = windows(walk[None, -1:], dt=0.1)
    assert goal.velocity(alone)[0, 0].tolist() == [0.0, 0.0]


def test_a_goal_says_how_much_time_it_reads():
    goal = LearnedDestinations.learn(street())
    assert goal.history == pytest.approx(7 * 0.4)
    assert EnvironmentLayout([(10.0, 0.0)]).history == 0.0

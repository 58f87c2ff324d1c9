"""Tracks of visible people as arrays, and forecasts from them."""

import copy
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, Walls, stream
from crowdbot.navigation import DriveLimits, Observation, TrackHistory
from crowdbot.prediction import ConstantVelocity, Kalman, SampledConstantVelocity


def walk(rows=5, dt=0.1, length=40):
    """Return tracks of person 7 at (1, 0.5) m/s, and of person 9, who is first seen at the third row."""
    tracks = TrackHistory.empty(length)
    for k in range(rows):
        who = [7, 9] if k >= 2 else [7]
        tracks = tracks.update(k * dt, who, [[k * dt, 0.5 * k * dt], [5.0, -2.0 * k * dt]][: len(who)])
    return tracks


def test_rows_are_bounded_and_the_past_is_kept():
    tracks = walk(5)
    assert tracks.ids.tolist() == [7, 9]
    np.testing.assert_allclose(tracks.times, [0.0, 0.1, 0.2, 0.3, 0.4])
    assert np.isnan(tracks.position[:2, 1]).all()
    np.testing.assert_allclose(tracks.position[:, 0, 0], tracks.times)
    short = walk(5, length=2)
    assert short.position.shape == (2, 2, 2)
    assert walk(5, length=1).times.tolist() == [0.4]


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10_000), st.integers(1, 6), st.integers(1, 12))
def test_it_holds_what_was_seen_in_the_last_rows(seed, length, rows):
    rng = stream(seed, "tracks")
    tracks, log = TrackHistory.empty(length), []
    for k in range(rows):
        ids = rng.permutation(8)[: rng.integers(0, 8)]
        place = rng.normal(0, 1, (len(ids), 2))
        before = copy.deepcopy(tracks)
        after = tracks.update(0.5 * k, ids, place)
        np.testing.assert_array_equal(tracks.position, before.position)
        tracks = after
        log.append(dict(zip(ids.tolist(), place.tolist(), strict=True)))
    last = log[-length:]
    assert tracks.ids.tolist() == sorted(set().union(*last))
    assert len(tracks.times) == len(last)
    for row, seen in zip(tracks.position, last, strict=True):
        for n, who in enumerate(tracks.ids.tolist()):
            np.testing.assert_array_equal(row[n], seen.get(who, [math.nan, math.nan]))


def test_constant_velocity_is_predicted_exactly():
    tracks = walk()
    forecast = tracks.forecast(ConstantVelocity(), 0.5)
    assert forecast.position.shape == (1, 1, 5, 2, 2)
    ahead = 0.4 + 0.1 * np.arange(1, 6)
    np.testing.assert_allclose(forecast.position[0, 0, :, 0], np.stack([ahead, 0.5 * ahead], axis=1))
    np.testing.assert_allclose(forecast.position[0, 0, :, 1, 1], -2.0 * ahead)


def test_people_out_of_sight_are_not_predicted():
    tracks = walk().update(0.5, [9], [[5.0, -1.0]])
    assert tracks.forecast(ConstantVelocity(), 0.2).valid.tolist() == [[False, True]]


def test_a_larger_time_step_takes_fewer_rows():
    past = walk(10).windows(0.4)
    np.testing.assert_allclose(past.position[0, :, 0, 0], [0.1, 0.5, 0.9])
    assert past.present[0, :, 1].tolist() == [False, True, True]
    forecast = walk(10).forecast(ConstantVelocity(), 1.0, dt=0.4)
    assert forecast.steps == 3
    np.testing.assert_allclose(forecast.position[0, 0, :, 0, 0], [1.3, 1.7, 2.1])


def test_samples_repeat_and_depend_on_the_seed():
    tracks = walk()
    one, same, other = (
        tracks.forecast(SampledConstantVelocity(), 0.5, samples=4, seed=seed).position for seed in (1, 1, 2)
    )
    np.testing.assert_array_equal(one, same)
    assert np.any(one != other)


def test_an_observation_forecasts_its_tracks():
    known = {"pose": (0.0, 0.0, 0.0), "goal": (9.0, 0.0), "radius": 0.3, "limits": DriveLimits(1.0, 2.0), "dt": 0.1}
    walls = Walls.of([[(0.0, -3.0), (6.0, -3.0)], [(1.0, 1.0), (2.0, 1.0), (2.0, 2.0)]])
    seen = Observation(**known, tracks=walk(), walls=walls)
    for predictor in (ConstantVelocity(), Kalman()):
        np.testing.assert_array_equal(
            seen.forecast(predictor, 0.3).position, walk().forecast(predictor, 0.3, walls=walls).position
        )
    assert [ring.tolist() for ring in walk().windows(walls=walls).walls] == [
        [[0.0, -3.0], [6.0, -3.0]],
        [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0]],
    ]
    with pytest.raises(InputError, match="observation: forecast needs tracks"):
        Observation(**known).forecast(ConstantVelocity(), 0.3)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0.4, [7], [[0.0, 0.0]]), "time = 0.4 s must be finite and after the newest row at 0.4 s"),
        ((math.nan, [7], [[0.0, 0.0]]), "time = nan s must be finite"),
        ((0.5, [7, 7], [[0.0, 0.0], [1.0, 0.0]]), r"identities \[7, 7\] must be distinct"),
        ((0.5, [7, 8], [[0.0, 0.0]]), "2 identities and 1 positions"),
        ((0.5, [7], [[math.nan, 0.0]]), "the position of 7 is not finite"),
    ],
)
def test_wrong_rows_are_explained(arguments, message):
    with pytest.raises(InputError, match=f"track history: {message}"):
        walk().update(*arguments)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: TrackHistory.empty(0), "length = 0 rows must be at least 1"),
        (lambda: TrackHistory.empty().windows(), "no row yet"),
        (lambda: walk(1).windows(), "a single row does not define the time step"),
        (lambda: walk().windows(-0.1), "dt = -0.1 s must be finite and above 0"),
        (lambda: walk().forecast(ConstantVelocity(), 0.0), "seconds = 0.0 must be finite and above 0"),
        (lambda: walk().forecast("cv", 1.0), "'cv' is not a predictor"),
    ],
)
def test_wrong_questions_are_explained(call, message):
    with pytest.raises(InputError, match=message):
        call()

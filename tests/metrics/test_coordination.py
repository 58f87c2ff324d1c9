"""Leaders and followers of known gain and delay, under noise, latency and lost frames."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError
from crowdbot.metrics import coordination


def pair(frequency=0.125, gain=0.9, delay=0.3, rate=60.0, duration=48.0, noise=0.0, lost=0.0, seed=0, turn=0.0):
    """Return times and positions of a leader and of a follower with irregular samples."""
    rng = np.random.default_rng(seed)
    times = np.arange(0.0, duration, 1.0 / rate)
    other = times + rng.uniform(0.0, 0.3 / rate, len(times))
    angle = 2.0 * math.pi * frequency
    ways = 0.4 * np.sin(angle * times + 1.0), 2.0 + gain * 0.4 * np.sin(angle * (other - delay) + 1.0)
    line = np.array([math.cos(turn), math.sin(turn)])
    tracks = [way[:, None] * line + 7.0 + rng.normal(0.0, noise, (len(way), 2)) for way in ways]
    kept = [rng.random(len(times)) >= lost for _ in range(2)]
    return times[kept[0]], tracks[0][kept[0]], other[kept[1]], tracks[1][kept[1]]


@settings(max_examples=25)
@given(
    frequency=st.sampled_from([0.1, 0.125, 0.2, 0.25]),
    gain=st.floats(0.5, 1.2),
    delay=st.floats(0.0, 1.0),
    rate=st.sampled_from([30.0, 60.0, 90.0]),
    lost=st.sampled_from([0.0, 0.1]),
    seed=st.integers(0, 1000),
    turn=st.floats(0.0, 6.28),
)
def test_gain_and_delay_are_recovered_under_noise_and_lost_frames(frequency, gain, delay, rate, lost, seed, turn):
    found = coordination(*pair(frequency, gain, delay, rate, 48.0, 0.01, lost, seed, turn))
    assert abs(found.lag - delay) < 0.01
    assert abs(found.gain / gain - 1.0) < 0.02
    assert abs(found.phase - 2.0 * math.pi * frequency * delay) < 0.02
    assert abs(found.frequency - frequency) < 0.002
    assert found.correlation > 0.98


def test_the_distance_is_that_at_common_times():
    found = coordination(*pair(gain=1.0, delay=0.0))
    assert found.distance == pytest.approx(2.0, abs=1e-3)
    assert found.distance_sd < 1e-2
    late = coordination(*pair(gain=1.0, delay=2.0))  # a quarter of a period: sd = 0.4
    assert late.distance_sd == pytest.approx(0.4, rel=0.02)


def test_a_turn_a_shift_and_lost_rows_change_nothing():
    times, leader, other, follower = pair(noise=0.005)
    plain = coordination(times, leader, other, follower)
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    moved = coordination(times + 90.0, leader @ turn.T + 3.0, other + 90.0, follower @ turn.T + 3.0)
    np.testing.assert_allclose(moved, plain, rtol=1e-6, atol=1e-6)
    follower[5] = np.nan
    assert coordination(times, leader, other, follower).lag == pytest.approx(plain.lag, abs=1e-3)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda t, a, s, b: (t[:5], a[:5], s, b), "leader: 5 samples are known; at least 8"),
        (lambda t, a, s, b: (t, a[:, :1], s, b), r"they must be \[T\] and \[T, 2\]"),
        (lambda t, a, s, b: (t[::-1], a, s, b), "times must ascend"),
        (lambda t, a, s, b: (t, a, s + 100.0, b), "less than one period"),
        (lambda t, a, s, b: (t, 0.0 * a, s, b), "the leader does not move"),
    ],
)
def test_what_cannot_be_measured_is_refused(change, words):
    with pytest.raises(InputError, match=words):
        coordination(*change(*pair()), frequency=0.125)

"""Limits of speed and acceleration after any model."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, Scene
from crowdbot.models import ORCA
from crowdbot.world import CrowdLimits, PlanarWorld


def steps(seed, A=12, E=2):
    rng = np.random.default_rng(seed)
    before = Scene.of(rng.normal(size=(E, A, 2)), rng.normal(size=(E, A, 2)), external=np.arange(A) == 3)
    return before, before.advance(rng.normal(0.0, 3.0, (E, A, 2)), 0.1)


def by_hand(before, after, dt, speed, acceleration):
    """The slow twin."""
    out = after.velocity.copy()
    for e, a in np.ndindex(*before.shape):
        if before.external[e, a]:
            continue
        change = out[e, a] - before.velocity[e, a]
        if np.hypot(*change) > acceleration * dt:
            out[e, a] = before.velocity[e, a] + change / np.hypot(*change) * acceleration * dt
        if np.hypot(*out[e, a]) > speed:
            out[e, a] *= speed / np.hypot(*out[e, a])
    return out


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 999), st.floats(0.1, 5.0), st.floats(0.1, 50.0))
def test_limits_are_what_the_slow_twin_says(seed, speed, acceleration):
    before, after = steps(seed)
    kept = CrowdLimits(speed, acceleration).apply(before, after, 0.1)
    expected = by_hand(before, after, 0.1, speed, acceleration)
    np.testing.assert_allclose(kept.velocity, expected, atol=1e-12)
    np.testing.assert_allclose(kept.position, before.position + 0.1 * expected, atol=1e-12)


def test_headings_follow_and_those_of_a_model_stay():
    before, after = steps(1)
    after = after.replace(heading=np.where(np.arange(12) == 5, 0.123, after.heading))
    kept = CrowdLimits(max_acceleration=1.0).apply(before, after, 0.1)
    walks = (np.arange(12) != 3) & (np.arange(12) != 5)
    assert np.all(kept.heading[:, 5] == 0.123)
    assert np.array_equal(kept.heading[:, walks], np.arctan2(kept.velocity[..., 1], kept.velocity[..., 0])[:, walks])


def test_who_is_within_the_limits_keeps_every_byte():
    before, after = steps(2)
    assert CrowdLimits(1e3, 1e6).apply(before, after, 0.1).digest() == after.digest()
    assert CrowdLimits().apply(before, after, 0.1).digest() == after.digest()


def test_limits_may_differ_per_agent():
    before, after = steps(3)
    most = np.linspace(0.1, 1.2, 12)
    kept = CrowdLimits(max_speed=most).apply(before, after, 0.1)
    speed = np.hypot(kept.velocity[..., 0], kept.velocity[..., 1])
    others = np.arange(12) != 3
    assert np.all(speed[:, others] <= most[others] * (1.0 + 1e-12))
    with pytest.raises(InputError, match="max_speed has shape"):
        CrowdLimits(max_speed=np.ones(5)).apply(before, after, 0.1)


def test_a_crowd_in_a_world_accelerates_no_faster():
    rng = np.random.default_rng(0)
    scene = Scene.of(rng.uniform(0.0, 6.0, (30, 2)), goal=rng.uniform(0.0, 6.0, (30, 2)))
    world = PlanarWorld(scene, ORCA(), {}, 0.1, limits=CrowdLimits(1.5, 2.0))
    for _ in range(40):
        before = world.scene.velocity
        change = world.step({}).velocity - before
        assert np.hypot(change[..., 0], change[..., 1]).max() <= 0.2 + 1e-12


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"max_speed": 0.0}, "max_speed = 0.0 m/s must be finite and above 0"),
        ({"max_acceleration": np.array([1.0, np.nan])}, "max_acceleration = nan m/s2"),
    ],
)
def test_wrong_limits_are_explained(values, message):
    with pytest.raises(InputError, match=f"CrowdLimits: {message}"):
        CrowdLimits(**values)

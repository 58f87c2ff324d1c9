"""The values with which models begin a step: checks, desired velocities, masks and the output array."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from model_crowds import crowd

from crowdbot.core import InputError, Scene
from crowdbot.models import ORCA, Boids, Mixture, SocialForce, agent_rows
from crowdbot.models.agent_rows import LIMIT, RADIUS, VX, VY, WISH_X, WISH_Y, X, Y, begin_rows
from crowdbot.models.model import begin_step, desired_velocity, movable, rows


def _mask(rng, share=0.7):
    return rng.random((3, 8)) < share


def _scene(seed, preferred=False):
    rng = np.random.default_rng(seed)
    scene = crowd(seed, 8, 3, active=_mask(rng), visible=_mask(rng), external=_mask(rng, 0.3))
    scene = scene.replace(goal=np.where(_mask(rng, 0.2)[..., None], scene.position, scene.goal))
    return scene.replace(preferred_velocity=rng.normal(0.0, 1.0, (3, 8, 2))) if preferred else scene


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.booleans(), st.sampled_from([0.01, 0.1, 3.0]))
def test_a_step_begins_with_the_values_of_the_scene(seed, preferred, dt):
    scene = _scene(seed, preferred)
    start = begin_step(scene, dt)
    active, out = scene.active, scene.active & scene.external
    np.testing.assert_array_equal(start.desired, np.where(active[..., None], scene.desired_velocity(dt), 0.0))
    np.testing.assert_array_equal(start.walking, active & ~scene.external)
    np.testing.assert_array_equal(start.walking, movable(scene))
    np.testing.assert_array_equal(start.seen, active & scene.visible)
    np.testing.assert_array_equal(start.velocity, np.where(out[..., None], scene.velocity, 0.0))
    np.testing.assert_array_equal(start.desired, desired_velocity(scene, dt))


@pytest.mark.parametrize("serial", [agent_rows.SERIAL, 3])
@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), preferred=st.booleans(), limited=st.booleans())
def test_rows_have_the_values_of_the_scene_on_one_thread_and_on_several(serial, seed, preferred, limited):
    scene = _scene(seed, preferred)
    before, agent_rows.SERIAL = agent_rows.SERIAL, serial
    try:
        found = begin_rows(scene, 0.1, 0.7 if limited else None)
    finally:
        agent_rows.SERIAL = before
    start = begin_step(scene, 0.1)
    top = np.full((3, 8), 0.7) if limited else scene.max_speed
    for columns, values in (
        ([X, Y], scene.position), ([VX, VY], scene.velocity), ([WISH_X, WISH_Y], start.desired),
        ([RADIUS], scene.radius[..., None]), ([LIMIT], top[..., None]),
    ):  # fmt: skip
        np.testing.assert_array_equal(found.agents[:, columns], values.reshape(24, -1))
    np.testing.assert_array_equal(found.walking, start.walking.ravel())
    np.testing.assert_array_equal(found.seen, start.seen.ravel())
    np.testing.assert_array_equal(found.external, scene.external.ravel())
    np.testing.assert_array_equal(found.velocity, start.velocity)
    assert np.shares_memory(found.out, found.velocity)


def test_values_of_absent_agents_are_arbitrary():
    scene = _scene(1)
    gone = ~scene.active
    wild = {name: np.array(getattr(scene, name)) for name in ("position", "velocity", "goal", "radius", "max_speed")}
    for value in wild.values():
        value[gone] = np.nan
    first, second = begin_step(scene, 0.1), begin_step(scene.replace(**wild), 0.1)
    for item, other in zip(first, second, strict=True):
        np.testing.assert_array_equal(item, other)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1.1e9, -1.1e9])
@pytest.mark.parametrize("name", ["position", "velocity", "radius", "max_speed", "goal", "preferred_speed"])
def test_the_first_wrong_value_of_an_active_agent_is_named(name, value):
    scene = crowd(2, 8, 3)
    values = getattr(scene, name).copy()
    values[1, 3:] = value
    with pytest.raises(InputError, match=rf"^scene: {name} .* of agent 3 in environment 1 is not finite or larger"):
        begin_step(scene.replace(**{name: values}), 0.1)
    with pytest.raises(InputError, match=rf"^scene: {name} .* of agent 3 in environment 1 is not finite or larger"):
        begin_rows(scene.replace(**{name: values}), 0.1)
    begin_rows(scene.replace(**{name: values}, active=np.arange(8) < np.array([[8], [3], [8]])), 0.1)
    begin_step(scene.replace(**{name: values}, active=np.arange(8) < np.array([[8], [3], [8]])), 0.1)


def test_given_velocities_replace_goal_and_preferred_speed():
    scene = _scene(3, preferred=True)
    far = scene.replace(goal=np.full((3, 8, 2), np.nan), preferred_speed=np.full((3, 8), np.inf))
    np.testing.assert_array_equal(begin_step(far, 0.1).desired, begin_step(scene, 0.1).desired)
    wrong = scene.replace(preferred_velocity=np.full((3, 8, 2), 2e9))
    with pytest.raises(InputError, match="scene: preferred velocity .* is not finite or larger than 1e"):
        begin_step(wrong, 0.1)


@pytest.mark.parametrize("dt", [0.0, -0.1, math.inf, math.nan])
def test_the_time_step_is_positive(dt):
    with pytest.raises(InputError, match="time step .* is not allowed, it must be above 0 and finite"):
        begin_step(_scene(4), dt)


@pytest.mark.parametrize(
    "model",
    [ORCA(), SocialForce(), Boids(), Mixture((ORCA(), Boids()), which=[0, 1] * 4)],
    ids=lambda m: type(m).__name__,
)
def test_the_layout_of_arrays_does_not_change_results(model):
    scene = _scene(5)
    strange = {}
    for name in ("position", "velocity", "goal", "radius", "max_speed", "preferred_speed", "active", "visible"):
        value = np.asfortranarray(getattr(scene, name))
        value.flags.writeable = False
        strange[name] = value
    expected, other = model.step(scene, 0.1), model.step(scene.replace(**strange), 0.1)
    np.testing.assert_array_equal(expected.position, other.position)
    np.testing.assert_array_equal(expected.velocity, other.velocity)
    assert expected.digest() == other.digest()


def test_a_step_changes_no_array_of_the_scene():
    scene = _scene(6)
    before = {name: np.array(value) for name, value in vars(scene).items() if isinstance(value, np.ndarray)}
    later = ORCA().step(scene, 0.1)
    later.position[:] = later.velocity[:] = 7.0
    later.heading[:] = 7.0
    for name, value in before.items():
        np.testing.assert_array_equal(getattr(scene, name), value)


def test_rows_are_views_of_contiguous_arrays():
    values = np.arange(24.0).reshape(2, 3, 4)
    assert np.shares_memory(rows(values), values)
    assert rows(values).shape == (6, 4)
    np.testing.assert_array_equal(rows(values.transpose(1, 0, 2)), values.transpose(1, 0, 2).reshape(6, 4))
    assert rows(np.zeros((2, 3, 0))).shape == (6, 0)
    assert rows(np.zeros((0, 3, 2))).shape == (0, 2)
    assert isinstance(rows(Scene.of(np.zeros((2, 3, 2))).active), np.ndarray)

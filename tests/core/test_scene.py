"""Scene: shapes, defaults, the step, copies and the digest."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, Scene


def _pair(**changes):
    return Scene.of([[0.0, 0.0], [4.0, 0.0]], [[1.0, 0.0], [-1.0, 0.0]], **changes)


def test_plain_and_batched_arrays_mean_the_same():
    plain = _pair(radius=[0.2, 0.3])
    batched = Scene.of([[[0.0, 0.0], [4.0, 0.0]]], [[[1.0, 0.0], [-1.0, 0.0]]], radius=[[0.2, 0.3]])
    assert plain.shape == batched.shape == (1, 2)
    assert plain.digest() == batched.digest()
    np.testing.assert_array_equal(plain.radius, batched.radius)


def test_a_scene_owns_its_arrays():
    place = np.zeros((1, 2, 2))
    scene = Scene.of(place)
    place[:] = 7.0
    assert np.all(scene.position == 0.0)


def test_desired_velocity_points_at_the_goal_and_does_not_overshoot():
    scene = _pair(goal=[[10.0, 0.0], [4.0, 0.05]], preferred_speed=1.3)
    wish = scene.desired_velocity(0.1)[0]
    np.testing.assert_allclose(wish, [[1.3, 0.0], [0.0, 0.5]])


def test_desired_velocity_is_zero_on_the_goal():
    assert np.all(Scene.of([[1.0, 2.0]]).desired_velocity(0.1) == 0.0)


def test_advanced_moves_own_agents_and_lets_external_ones_drift():
    scene = _pair(external=[False, True])
    later = scene.advanced(np.full((1, 2, 2), 2.0), 0.5)
    np.testing.assert_allclose(later.position[0], [[1.0, 1.0], [3.5, 0.0]])
    np.testing.assert_allclose(later.velocity[0, 1], [-1.0, 0.0])
    assert later.time == 0.5


def test_absent_agents_stay_and_do_not_show_in_the_digest():
    scene = _pair(active=[True, False])
    other = scene.replace(position=scene.position + [[[0.0, 0.0], [9.0, 9.0]]])
    assert scene.digest() == other.digest()
    np.testing.assert_array_equal(scene.advanced(scene.velocity, 1.0).position[0, 1], scene.position[0, 1])


def test_standing_agents_keep_their_heading():
    scene = _pair(heading=[2.0, -1.0])
    assert scene.advanced(np.full((1, 2, 2), 1e-3), 0.1).heading.tolist() == [[2.0, -1.0]]


def test_environments_are_taken_in_any_order_and_number():
    one = _pair(preferred_velocity=[[1.0, 0.0], [0.0, 1.0]])
    many = one.environments([0, 0, 0])
    assert many.shape == (3, 2)
    assert many.preferred_velocity.shape == (3, 2, 2)
    moved = many.advanced(many.velocity + np.arange(3.0)[:, None, None], 1.0).replace(memory={"x": np.arange(3.0)})
    chosen = moved.environments([2, 0])
    assert np.array_equal(chosen.position, moved.position[[2, 0]])
    assert chosen.memory["x"].tolist() == [2.0, 0.0]
    assert chosen.walls is moved.walls


def test_without_leaves_the_original_alone():
    scene = _pair()
    assert scene.without(1).active.tolist() == [[True, False]]
    assert scene.active.all()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"position": [[0.0, np.nan]]}, "position of an active agent is not finite"),
        ({"position": [[0.0, 0.0, 0.0]]}, r"shape \[1, 3\], it must be \[A, 2\] or \[E, A, 2\]"),
        ({"position": [[0.0, 0.0]], "radius": -0.1}, "radius -0.1 m is not above 0"),
        ({"position": [[0.0, 0.0]], "preferred_speed": -1.0}, "preferred_speed -1.0 m/s is below 0"),
        ({"position": [[0.0, 0.0]], "radius": [0.1, 0.2]}, "radius has shape"),
        ({"position": [[0.0, 0.0]], "velocity": [[np.inf, 0.0]]}, "velocity of an active agent is not finite"),
    ],
)
def test_wrong_arrays_are_named(arguments, words):
    with pytest.raises(InputError, match=words):
        Scene.of(**arguments)


@settings(deadline=None, max_examples=30)
@given(st.integers(1, 5), st.integers(1, 6), st.integers(0, 99))
def test_digest_is_of_bytes(envs, agents, seed):
    draw = np.random.default_rng(seed)
    scene = Scene.of(draw.normal(size=(envs, agents, 2)), draw.normal(size=(envs, agents, 2)))
    again = Scene.of(scene.position, scene.velocity)
    nudged = scene.replace(position=np.nextafter(scene.position, np.inf))
    assert scene.digest() == again.digest() != nudged.digest()

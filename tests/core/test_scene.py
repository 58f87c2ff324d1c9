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


DIGESTED = {"position": (2,), "velocity": (2,), "heading": ()}
OTHERS = {
    "radius": (),
    "goal": (2,),
    "preferred_speed": (),
    "max_speed": (),
    "visible": (),
    "external": (),
    "group": (),
}


@given(st.sampled_from(sorted(DIGESTED)), st.integers(0, 1), st.integers(0, 2), st.integers(0, 1))
def test_the_digest_depends_on_every_number_of_what_moves(name, e, a, component):
    scene = Scene.of(np.ones((2, 3, 2)), np.ones((2, 3, 2)))
    value = getattr(scene, name).copy()
    place = (e, a, component) if DIGESTED[name] else (e, a)
    value[place] = np.nextafter(value[place], 9.0)
    assert scene.replace(**{name: value}).digest() != scene.digest()
    absent = np.ones((2, 3), dtype=np.bool_)
    absent[e, a] = False
    assert scene.replace(**{name: value}, active=absent).digest() == scene.replace(active=absent).digest()
    assert scene.replace(active=absent).digest() != scene.digest()


@given(st.sampled_from(sorted(OTHERS)))
def test_the_digest_leaves_out_what_does_not_move(name):
    scene = Scene.of(np.ones((1, 2, 2)))
    assert scene.replace(**{name: getattr(scene, name) * 0}).digest() == scene.digest()


def test_the_digest_of_a_known_scene_stays():
    scene = Scene.of([[0.0, 0.5], [4.0, 0.0]], [[1.0, 0.0], [-1.0, 0.25]], active=[True, False])
    assert scene.digest() == "e485c7d1411a74f9eac29ae74cb0c4c8"


@given(st.floats(0.0, 0.2), st.floats(-3.1, 3.1))
def test_agents_turn_only_above_the_turning_speed(speed, angle):
    scene = Scene.of([[0.0, 0.0]], heading=0.7)
    later = scene.advanced(np.array([[[speed * np.cos(angle), speed * np.sin(angle)]]]), 0.1)
    moved = np.hypot(*later.velocity[0, 0])
    if moved > 0.05 + 1e-12:
        np.testing.assert_allclose(later.heading, angle, atol=1e-9)
    elif moved < 0.05 - 1e-12:
        np.testing.assert_array_equal(later.heading, 0.7)


def test_external_and_absent_agents_keep_their_heading():
    scene = _pair(heading=0.3, external=[True, False], active=[True, False])
    np.testing.assert_array_equal(scene.advanced(np.full((1, 2, 2), 2.0), 0.5).heading, 0.3)


def test_defaults_of_a_scene():
    scene = Scene.of([[1.0, 2.0]])
    assert (scene.time, scene.wall_height, scene.height, scene.bodies, dict(scene.memory)) == (0.0, 3.0, None, None, {})
    assert [float(getattr(scene, n)[0, 0]) for n in ("radius", "preferred_speed", "heading")] == [0.25, 1.3, 0.0]
    assert float(scene.max_speed[0, 0]) == pytest.approx(1.69)
    assert [int(getattr(scene, n)[0, 0]) for n in ("active", "visible", "external", "group")] == [1, 1, 0, -1]
    np.testing.assert_array_equal(scene.goal, scene.position)


def test_the_heading_follows_the_velocity_or_else_the_wish():
    wish = [[0.0, 1.0]]
    assert Scene.of([[0.0, 0.0]], [[-1.0, 0.0]], preferred_velocity=wish).heading[0, 0] == pytest.approx(np.pi)
    assert Scene.of([[0.0, 0.0]], preferred_velocity=wish).heading[0, 0] == pytest.approx(np.pi / 2)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"radius": [0.2, 0.0]}, "radius 0.0 m is not above 0"),
        ({"preferred_speed": [0.2, -0.5]}, "preferred_speed -0.5 m/s is below 0"),
        ({"max_speed": [-0.25, 1.0]}, "max_speed -0.25 m/s is below 0"),
        ({"height": [0.0, 1.0]}, "height 0.0 m is not above 0"),
        ({"wall_height": 0.0}, "wall_height 0.0 m is not above 0"),
        ({"heading": [np.nan, 0.0]}, "heading of an active agent is not finite"),
        ({"goal": [[np.inf, 0.0], [0.0, 0.0]]}, "goal of an active agent is not finite"),
    ],
)
def test_wrong_values_of_active_agents_are_refused(changes, message):
    with pytest.raises(InputError, match=message):
        _pair(**changes)
    _pair(preferred_speed=0.0, max_speed=0.0)


def test_an_agent_is_absent_for_its_own_sensors():
    assert Scene.of(np.zeros((2, 3, 2))).without(1).active.tolist() == [[True, False, True]] * 2

"""Scene: shapes, defaults, the step, copies and the digest."""

import copy
import pickle

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
    later = scene.advance(np.full((1, 2, 2), 2.0), 0.5)
    np.testing.assert_allclose(later.position[0], [[1.0, 1.0], [3.5, 0.0]])
    np.testing.assert_allclose(later.velocity[0, 1], [-1.0, 0.0])
    assert later.time == 0.5


def test_absent_agents_stay_and_do_not_show_in_the_digest():
    scene = _pair(active=[True, False])
    other = scene.replace(position=scene.position + [[[0.0, 0.0], [9.0, 9.0]]])
    assert scene.digest() == other.digest()
    np.testing.assert_array_equal(scene.advance(scene.velocity, 1.0).position[0, 1], scene.position[0, 1])


def test_standing_agents_keep_their_heading():
    scene = _pair(heading=[2.0, -1.0])
    assert scene.advance(np.full((1, 2, 2), 1e-3), 0.1).heading.tolist() == [[2.0, -1.0]]


def test_environments_are_taken_in_any_order_and_number():
    one = _pair(preferred_velocity=[[1.0, 0.0], [0.0, 1.0]])
    many = one.environments([0, 0, 0])
    assert many.shape == (3, 2)
    assert many.preferred_velocity.shape == (3, 2, 2)
    moved = many.advance(many.velocity + np.arange(3.0)[:, None, None], 1.0).replace(memory={"x": np.arange(3.0)})
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
    later = scene.advance(np.array([[[speed * np.cos(angle), speed * np.sin(angle)]]]), 0.1)
    moved = np.hypot(*later.velocity[0, 0])
    if moved > 0.05 + 1e-12:
        np.testing.assert_allclose(later.heading, angle, atol=1e-9)
    elif moved < 0.05 - 1e-12:
        np.testing.assert_array_equal(later.heading, 0.7)


def test_external_and_absent_agents_keep_their_heading():
    scene = _pair(heading=0.3, external=[True, False], active=[True, False])
    np.testing.assert_array_equal(scene.advance(np.full((1, 2, 2), 2.0), 0.5).heading, 0.3)


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


def _advance_with_numpy(scene, velocity, dt):
    own = scene.active & ~scene.external
    moved = np.where(own[..., None], velocity, scene.velocity)
    speed = np.sqrt(moved[..., 0] ** 2 + moved[..., 1] ** 2)
    turned = np.where(own & (speed > 0.05), np.arctan2(moved[..., 1], moved[..., 0]), scene.heading)
    return np.where(scene.active[..., None], scene.position + moved * dt, scene.position), moved, turned


@given(st.integers(0, 2**32 - 1), st.integers(1, 4), st.integers(0, 9), st.sampled_from([0.01, 0.05, 1.0]))
def test_the_step_of_the_kernel_has_the_bits_of_numpy(seed, envs, agents, dt):
    rng = np.random.default_rng(seed)
    shape = (envs, agents, 2)
    scene = Scene.of(
        rng.normal(0.0, 9.0, shape),
        rng.normal(0.0, 0.1, shape),
        heading=rng.uniform(-4.0, 4.0, shape[:2]),
        active=rng.random(shape[:2]) < 0.7,
        external=rng.random(shape[:2]) < 0.3,
    )
    wild = np.where(scene.active[..., None], scene.position, np.nan)
    velocity = rng.normal(0.0, 0.06, shape)
    for item in (scene, scene.replace(position=wild)):
        for chosen in (velocity, velocity[..., ::-1], velocity[:1, :1], np.float64(0.25)):
            later = item.advance(chosen, dt)
            for found, expected in zip(
                (later.position, later.velocity, later.heading), _advance_with_numpy(item, chosen, dt), strict=True
            ):
                assert found.tobytes() == np.ascontiguousarray(expected).tobytes()


def test_a_step_shares_the_arrays_that_it_does_not_change():
    scene = _pair()
    later = scene.advance(scene.velocity, 0.5)
    for name in ("radius", "goal", "preferred_speed", "max_speed", "active", "visible", "external", "group", "walls"):
        assert getattr(later, name) is getattr(scene, name)
    assert (scene.time, later.time) == (0.0, 0.5)


def test_arrays_of_a_step_are_dense_whatever_the_scene_was_made_of():
    rng = np.random.default_rng(3)
    scene = Scene.of(rng.normal(size=(2, 5, 2)), rng.normal(size=(2, 5, 2)), goal=rng.normal(size=(2, 5, 2)))
    later = scene.advance(scene.velocity, 0.1)
    for item in (scene, later, later.replace(radius=np.asfortranarray(np.full((2, 5), 0.3))), later.environment(1)):
        arrays = item.step_arrays()
        shapes = [(*item.shape, 2)] * 2 + [item.shape] * 2 + [(*item.shape, 2)] + [item.shape] * 4
        assert [array.shape for array in arrays] == shapes
        assert all(array.flags.carray for array in arrays)
        names = ("position", "velocity", "radius", "max_speed", "goal", "preferred_speed", "active", "visible")
        for name, array in zip((*names, "external"), arrays, strict=True):
            assert np.array_equal(array, getattr(item, name))
    wish = later.replace(preferred_velocity=np.ones((2, 5, 2)))
    assert np.array_equal(wish.step_arrays()[4], np.ones((2, 5, 2)))


@pytest.mark.parametrize("external", [False, True])
def test_next_positions_are_those_of_the_advanced_scene(external):
    rng = np.random.default_rng(4)
    scene = Scene.of(
        rng.normal(size=(3, 6, 2)), rng.normal(size=(3, 6, 2)), active=rng.random((3, 6)) < 0.7,
        external=(rng.random((3, 6)) < 0.4) & external,
    )  # fmt: skip
    chosen = rng.normal(size=(3, 6, 2))
    assert scene.next_positions(chosen, 0.3).tobytes() == scene.advance(chosen, 0.3).position.tobytes()


def test_a_copy_replaces_fields_that_exist():
    scene = _pair()
    other = scene.replace(time=2.0, wall_height=1.0)
    assert (other.time, other.wall_height, scene.time, scene.wall_height) == (2.0, 1.0, 0.0, 3.0)
    assert type(other) is Scene
    assert other.position is scene.position
    with pytest.raises(TypeError, match="Scene has no field 'speed'"):
        scene.replace(speed=1.0)


def test_copies_and_pickles_of_a_scene_are_equal():
    scene = _pair(walls=[[(0, 1), (9, 1)]], time=[3.0])
    scene.walls.segments()
    for other in (copy.deepcopy(scene), pickle.loads(pickle.dumps(scene)), copy.copy(scene)):
        assert other.digest() == scene.digest()
        np.testing.assert_array_equal(other.walls.segments(), scene.walls.segments())
        assert other.time.tolist() == [3.0]


def test_environments_may_be_at_different_times():
    scene = Scene.of(np.zeros((3, 2, 2)), time=[0.0, 1.0, 2.5])
    later = scene.advance(scene.velocity, 0.5)
    assert later.time.tolist() == [0.5, 1.5, 3.0]
    assert scene.time.tolist() == [0.0, 1.0, 2.5]
    assert later.environments([2, 0, 2]).time.tolist() == [3.0, 0.5, 3.0]
    assert scene.replace(time=1.0).environments([2, 0]).time == 1.0
    assert later.without(0).time is later.time


@pytest.mark.parametrize("time", [2, 2.0, np.float64(2.0), np.array(2.0)])
def test_one_time_for_all_environments_is_a_float(time):
    scene = Scene.of(np.zeros((3, 2, 2)), time=time)
    assert type(scene.time) is float
    assert type(scene.advance(scene.velocity, 0.5).time) is float
    assert scene.advance(scene.velocity, 0.5).time == 2.5


def test_a_scene_owns_its_times():
    times = np.zeros(3)
    scene = Scene.of(np.zeros((3, 2, 2)), time=times)
    times[:] = 7.0
    assert scene.time.tolist() == [0.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("time", "message"),
    [
        ([0.0, 1.0], r"scene: time has shape \[2\], it must be a number or \[E\] = \[3\]"),
        (np.zeros((3, 1)), r"scene: time has shape \[3, 1\]"),
        ([0.0, np.nan, 1.0], "scene: time nan s is not finite"),
        (np.inf, "scene: time inf s is not finite"),
    ],
)
def test_wrong_times_are_refused(time, message):
    with pytest.raises(InputError, match=message):
        Scene.of(np.zeros((3, 2, 2)), time=time)


@pytest.mark.parametrize("name", ["position", "velocity", "heading", "radius", "goal", "preferred_speed", "max_speed"])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_value_that_is_not_finite_is_found_anywhere(name, value):
    scene = Scene.of(np.zeros((2, 3, 2)))
    wrong = getattr(scene, name).copy()
    wrong[1, 2, ...] = value
    changed = scene.replace(**{name: wrong})
    with pytest.raises(InputError, match=f"^scene: {name} of an active agent is not finite; mark absent agents"):
        changed.check()
    changed.without(2).check()
    assert not changed.without(2).active[1, 2]


@pytest.mark.parametrize("name", ["radius", "active", "visible", "external", "group", "preferred_speed", "heading"])
def test_values_of_the_wrong_number_of_agents_are_refused(name):
    for wrong in (np.ones(3), np.ones((1, 1, 2)), np.ones((2, 2))):
        with pytest.raises(ValueError, match="broadcast|does not fit"):
            _pair(**{name: wrong})


def test_the_arrays_of_a_scene_are_dense_and_its_own():
    values = np.full((2, 3), 0.5).T.copy().T
    scene = Scene.of(np.zeros((2, 3, 2))[:, ::-1], np.zeros((1, 3, 2)), radius=values, heading=values, active=[True])
    for value in vars(scene).values():
        if isinstance(value, np.ndarray):
            assert value.flags.carray
            assert not np.shares_memory(value, values)
    assert scene.radius.tolist() == values.tolist()


def test_one_environment_is_the_same_as_a_selection_of_one():
    scene = Scene.of(np.arange(12.0).reshape(3, 2, 2), time=[0.5, 1.0, 2.0])
    scene = scene.replace(memory={"state": np.arange(6.0).reshape(3, 2)})
    one, selection = scene.environment(2), scene.environments([2])
    assert one.digest() == selection.digest()
    assert (one.time, one.memory["state"].tolist()) == (2.0, selection.memory["state"].tolist())
    assert np.shares_memory(one.position, scene.position)


@pytest.mark.parametrize("order", ["C", "F"])
def test_kernels_get_contiguous_arrays_after_a_replacement(order):
    scene = Scene.of(np.arange(12.0).reshape(2, 3, 2), np.ones((2, 3, 2)), radius=0.2)
    later = scene.advance(scene.velocity, 0.5)
    later.check()
    place = np.array(later.position + 1.0, order=order)
    changed = later.replace(position=place, time=4.0)
    np.testing.assert_array_equal(changed.step_arrays()[0], place)
    assert all(value.flags.c_contiguous for value in changed.step_arrays())
    np.testing.assert_array_equal(changed.advance(changed.velocity, 0.5).position, place + 0.5)

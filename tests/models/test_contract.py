"""What holds for every model in the room's ``__all__``."""

from __future__ import annotations

import dataclasses
import inspect

import numba
import numpy as np
import pytest
from model_crowds import PILLAR, ROOM, crowd, renumbered

import crowdbot.models as room
from crowdbot.core import (
    SMALL,
    InputError,
    Paper,
    Scene,
    builtin_classes,
    find_class,
    from_attributes,
    kebab_case,
    parameters,
    stream,
)
from crowdbot.core.neighbors import CROWD
from samples import sample

MODELS = [kind for kind in builtin_classes(room, room.CrowdModel).values() if kind is not room.Mixture]
"""All but the mixture: it is made of others, has no parameters of its own, and is held to this in test_mixture."""
every_model = pytest.mark.parametrize("kind", MODELS, ids=lambda kind: kebab_case(kind.__name__))
most_models = pytest.mark.parametrize(
    "kind",
    sample(MODELS, [kind for kind in MODELS if kind not in (room.Tangent, room.VBM, room.VOG)]),
    ids=lambda kind: kebab_case(kind.__name__),
)
"""All but three that take long for a large crowd; a sweep asks those too."""


def velocity(model, scene, dt=0.1):
    return model.velocity(scene, dt)  # without a stream there is no chance in it


def test_the_room_lists_models_and_goals():
    assert {"orca", "social-force"} <= set(builtin_classes(room, room.CrowdModel))
    assert {"current-direction", "ground-truth"} <= set(builtin_classes(room, room.Goal))
    assert sorted(room.__all__) == sorted(set(room.__all__))


@every_model
def test_parameters_are_a_table(kind):
    assert isinstance(kind.paper, Paper)
    assert kind.__doc__
    table = parameters(kind)
    assert table
    text = inspect.getdoc(kind)
    for row in table:
        assert row.unit, row.name
        assert row.source, row.name
        assert row.min <= row.low < row.high, row.name
        assert row.low <= row.default <= row.high, row.name
        assert f"{row.name}:" in text, f"{kind.__name__} does not explain {row.name}"


@every_model
def test_parameters_come_from_text(kind):
    for row in parameters(kind):
        model = from_attributes(kind, {row.name.replace("_", "-"): repr(row.default)})
        assert getattr(model, row.name) == row.default
    assert find_class(kebab_case(kind.__name__), room, room.CrowdModel) is kind


@every_model
def test_a_bad_parameter_is_named(kind):
    for row in parameters(kind):
        for value in (np.nan, np.inf, row.min - 1.0, 1e300, np.array([row.default, np.nan])):
            with pytest.raises(InputError, match=row.name):
                kind(**{row.name: value})
        with pytest.raises(InputError, match=row.name):
            velocity(kind(**{row.name: np.full(7, row.default)}), crowd(0, A=3))


@every_model
def test_models_are_frozen(kind):
    model = kind()
    with pytest.raises(dataclasses.FrozenInstanceError):
        setattr(model, parameters(kind)[0].name, 1.0)


@every_model
def test_every_parameter_may_differ_per_agent(kind):
    scene = crowd(1, A=8, E=2)
    expected = velocity(kind(), scene)
    for row in parameters(kind):
        one = velocity(kind(**{row.name: np.full((2, 8), row.default)}), scene)
        assert np.array_equal(one, expected), row.name


@every_model
def test_a_step_is_a_velocity_that_is_followed(kind):
    scene = crowd(2, E=2)
    before = {field.name: np.copy(getattr(scene, field.name)) for field in dataclasses.fields(scene)}
    chosen = kind().velocity(scene, 0.1, stream(1, "test"))
    after = kind().step(scene, 0.1, stream(1, "test"))
    assert chosen.shape == (2, 30, 2)
    assert np.allclose(after.position, scene.position + 0.1 * chosen, atol=1e-12)
    assert np.array_equal(after.velocity, chosen)
    assert after.time == pytest.approx(0.1)
    for name, value in before.items():
        if isinstance(getattr(scene, name), np.ndarray):
            assert np.array_equal(getattr(scene, name), value), f"{name} was changed"


@most_models
def test_alone_in_a_batch_or_twice_the_bytes_are_the_same(kind):
    for A in (30, CROWD + 20):
        scene = crowd(3, A=A)
        alone = velocity(kind(), scene)
        assert np.array_equal(velocity(kind(), scene), alone)
        for copy in velocity(kind(), scene.environments([0] * (SMALL // A + 1))):  # by several threads
            assert np.array_equal(copy, alone[0])


@every_model
def test_the_number_of_threads_does_not_matter(kind):
    scene = crowd(4, A=SMALL // 2 + 50, E=2)
    most = numba.get_num_threads()
    results = []
    for count in (1, min(2, numba.config.NUMBA_NUM_THREADS)):
        numba.set_num_threads(count)
        results.append(velocity(kind(), scene))
    numba.set_num_threads(most)
    assert np.array_equal(*results)


@every_model
@pytest.mark.parametrize("A", [30, CROWD + 20])
def test_renumbering_renumbers(kind, A):
    scene = crowd(5, A=A)
    order = np.random.default_rng(0).permutation(A)
    assert np.array_equal(velocity(kind(), renumbered(scene, order)), velocity(kind(), scene)[:, order])


@every_model
def test_absent_agents_do_not_matter(kind):
    scene = crowd(6, A=40)
    here = np.random.default_rng(1).random(40) < 0.6
    garbage = np.where(here[:, None], scene.position, np.nan)
    holes = Scene.of(
        garbage,
        np.where(here[:, None], scene.velocity, 1e200),
        goal=scene.goal,
        radius=np.where(here, scene.radius, -1.0),
        preferred_speed=scene.preferred_speed,
        max_speed=np.where(here, scene.max_speed, np.nan),
        active=here,
        walls=scene.walls,
    )
    chosen = velocity(kind(), holes)
    assert np.array_equal(chosen[:, here], velocity(kind(), renumbered(scene, np.flatnonzero(here))))
    assert np.all(chosen[:, ~here] == 0.0)


@every_model
def test_the_invisible_are_not_seen_but_see(kind):
    scene = crowd(7, A=12, width=4.0, walls=())
    ghost = np.arange(12) == 5
    dt = 0.01  # so short that no model moves people within a step, where the ghost would meet others elsewhere
    chosen = velocity(kind(), scene.replace(visible=np.broadcast_to(~ghost, (1, 12))), dt)
    assert np.array_equal(chosen[:, ~ghost], velocity(kind(), renumbered(scene, np.flatnonzero(~ghost)), dt))
    assert np.array_equal(chosen[:, ghost], velocity(kind(), scene, dt)[:, ghost])


@every_model
def test_external_agents_are_left_alone(kind):
    scene = crowd(8, A=12, width=4.0)
    robot = np.broadcast_to(np.arange(12) == 3, (1, 12))
    chosen = velocity(kind(), scene.replace(external=robot))
    assert np.array_equal(chosen[robot], scene.velocity[robot])
    assert not np.array_equal(chosen[~robot], scene.velocity[~robot])


@every_model
def test_nobody_and_no_environment(kind):
    for shape in ((1, 0, 2), (0, 3, 2), (2, 1, 2)):
        assert velocity(kind(), Scene.of(np.zeros(shape), walls=[ROOM])).shape == shape


@every_model
@pytest.mark.parametrize("dt", [0.0, -0.1, np.nan, np.inf])
def test_a_bad_time_step(kind, dt):
    with pytest.raises(InputError, match="time step"):
        velocity(kind(), crowd(0, A=3), dt)


@every_model
@pytest.mark.parametrize(
    "name", ["position", "velocity", "radius", "max_speed", "goal", "preferred_speed", "preferred_velocity"]
)
@pytest.mark.parametrize("value", [np.nan, np.inf, 1e200])
def test_a_bad_scene(kind, name, value):
    scene = crowd(0, A=3)
    if name == "preferred_velocity":
        scene = scene.replace(preferred_velocity=scene.velocity.copy())
    wrong = getattr(scene, name).copy()
    wrong[0, 1] = value
    with pytest.raises(InputError, match="agent 1 in environment 0 is not finite or larger"):
        velocity(kind(), scene.replace(**{name: wrong}))


def same_place():
    return crowd(0, A=2, walls=()).replace(position=np.zeros((1, 2, 2)), velocity=np.zeros((1, 2, 2)))


def heap():
    scene = crowd(1, A=20)
    return scene.replace(position=np.zeros((1, 20, 2)) + [3.0, 3.0], velocity=np.zeros((1, 20, 2)))


def dense():
    return crowd(2, A=220, width=5.0, radius=0.3)  # 8.8 people/m^2


def fast():
    scene = crowd(3, A=20, width=3.0)
    return scene.replace(velocity=scene.velocity * 1e8)


def goals_in_walls():
    return crowd(4, A=20, goal=np.broadcast_to([0.8, 0.8], (1, 20, 2)))


def in_walls():
    scene = crowd(5, A=20, goal=np.broadcast_to([9.0, 9.0], (1, 20, 2)))
    corners = np.array([*PILLAR, *ROOM, (0.8, 0.8), (1.0, 0.25), (6.0, 0.0), (20.0, 0.0)])
    place = scene.position.copy()
    place[0, : len(corners)] = corners
    return scene.replace(position=place)


def giants():
    return crowd(6, A=20, radius=1e6)


def standing():
    return crowd(7, A=20, width=3.0, max_speed=0.0, preferred_speed=0.0)


def far_away():
    return crowd(8, A=30, walls=()).replace(position=9e8 - np.random.default_rng(0).uniform(0.0, 9.0, (1, 30, 2)))


def thin_walls():
    slivers = [[(0.0, 0.0), (1e-13, 0.0)], [(0.0, 0.0), (1e6, 1e-9), (1e6, 0.0)], [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)]]
    return crowd(9, A=30, width=2.0, walls=slivers)


HOSTILE = [same_place, heap, dense, fast, goals_in_walls, in_walls, giants, standing, far_away, thin_walls]


@every_model
@pytest.mark.parametrize("make", HOSTILE, ids=lambda make: make.__name__)
@pytest.mark.parametrize("dt", [1e-6, 0.1, 10.0])
def test_an_impossible_crowd_takes_a_bounded_step(kind, make, dt):
    scene = make()
    for _ in range(3):
        chosen = velocity(kind(), scene, dt)
        assert np.all(np.isfinite(chosen))
        assert np.all(np.linalg.norm(chosen, axis=-1) <= scene.max_speed * (1.0 + 1e-9) + 1e-12)
        scene = scene.advance(chosen, dt)

"""EscapePanic: against the CrowdBot simulator, a plain twin, and by what bodies must do."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from extremes import assert_bounded, extreme, heaped
from hypothesis import given, settings
from hypothesis import strategies as st
from model_crowds import PILLAR, ROOM, SCREEN, crowd, moved

from crowdbot.core import InputError, Scene
from crowdbot.models import EscapePanic
from crowdbot.models.forces.escape_panic import MEMORY, VARIANTS

every_variant = pytest.mark.parametrize("variant", VARIANTS)


@pytest.mark.parametrize("name", ["crossing", "corridor"])
def test_one_step_agrees_with_the_crowdbot_simulator(reference, capsys, name):
    steps = np.load(reference / "crowdbot" / f"{name}_Helbing2000.npz")
    about = json.loads((reference / "crowdbot" / f"{name}_Helbing2000.json").read_text(encoding="utf-8"))
    scene = Scene.of(
        steps["x"], steps["v"], preferred_velocity=steps["pref"], radius=steps["radius"], walls=about["obstacles"]
    )
    after = EscapePanic(variant="crowdbot").step(scene, about["dt"])
    error = np.linalg.norm(after.velocity - steps["v_next"], axis=-1)
    with capsys.disabled():
        print(
            f"\n{name}_Helbing2000: {np.mean(error < 1e-4):.2%} of {error.size} within 1e-4,"
            f" median {np.median(error):.0e}, worst {error.max():.0e}"
        )
    assert np.mean(error < 1e-4) >= 0.999
    assert np.mean(np.abs(after.position - steps["x_next"]) < 1e-4) >= 0.999


def twin(scene, dt):
    """Return the next velocities of one short step by the text of the paper, friction at the old velocities."""
    x, v, r = scene.position[0], scene.velocity[0], scene.radius[0]
    out = v.copy()
    for i in range(len(x)):
        force = 80.0 * (scene.desired_velocity(dt)[0, i] - v[i]) / 0.5
        for j in range(len(x)):
            d = np.linalg.norm(x[i] - x[j])
            if i == j or d >= 3.0:
                continue
            n = (x[i] - x[j]) / d
            t = np.array([-n[1], n[0]])
            over = r[i] + r[j] - d
            force += (2000.0 * math.exp(over / 0.08) + 1.2e5 * max(over, 0.0)) * n
            force += 2.4e5 * max(over, 0.0) * ((v[j] - v[i]) @ t) * t
        after = v[i] + force / 80.0 * dt
        out[i] = after * min(1.0, scene.max_speed[0, i] / max(np.linalg.norm(after), 1e-12))
    return out


@pytest.mark.parametrize("seed", range(4))
def test_a_short_step_follows_the_text(seed):
    scene = crowd(seed, A=20, width=2.2, walls=(), max_speed=500.0)
    dt = 1e-7  # friction at the end of the step is then the same as at its begin
    got = EscapePanic().velocity(scene, dt)[0]
    assert (got - scene.velocity[0]) / dt == pytest.approx((twin(scene, dt) - scene.velocity[0]) / dt, rel=2e-3, abs=1)
    apart = np.linalg.norm(scene.position[0, :, None] - scene.position[0], axis=-1) + 9.0 * np.eye(20)
    assert apart.min() < 0.3  # some are in contact


def test_the_parts_of_a_long_step_are_short_steps():
    scene = crowd(1, A=30, width=5.0)
    scene = scene.replace(preferred_velocity=scene.desired_velocity(0.1))  # which way to go is found once a step
    fine, coarse = EscapePanic(longest_step=0.01), EscapePanic(longest_step=0.02)
    one = fine.step(scene, 0.1)
    many, last = scene, scene
    for _ in range(10):
        last = many = fine.step(many, 0.01)
    assert np.allclose(one.position, many.position, atol=1e-12)
    assert np.allclose(one.velocity + one.memory[MEMORY], last.velocity, atol=1e-12)
    assert np.allclose(one.velocity, (many.position - scene.position) / 0.1)
    assert not np.allclose(coarse.step(scene, 0.1).position, one.position, atol=1e-12)


def test_a_scene_without_memory_begins_anew():
    scene = crowd(2, A=10, width=3.0)
    after = EscapePanic().step(scene, 0.1)
    again = EscapePanic().velocity(after, 0.1)
    assert not np.allclose(again, EscapePanic().velocity(after.replace(memory={}), 0.1))
    with pytest.raises(InputError, match=r"memory 'escape-panic' has shape \[1, 3, 2\]"):
        EscapePanic().velocity(scene.replace(memory={MEMORY: np.zeros((1, 3, 2))}), 0.1)


@every_variant
def test_a_lone_walker_reaches_the_preferred_speed(variant):
    scene = Scene.of([[0.0, 0.0]], goal=[[100.0, 0.0]], preferred_speed=1.2)
    for step in range(1, 201):
        scene = EscapePanic(variant=variant).step(scene, 0.01)
        assert scene.velocity[0, 0, 0] == pytest.approx(1.2 * (1.0 - 0.98**step))
    assert scene.velocity[0, 0].tolist() == pytest.approx([1.2, 0.0], rel=0.02)


def pushed(walls, place, velocity=(0.0, 0.0), variant="textbook"):
    scene = Scene.of([place], [velocity], preferred_velocity=[velocity], walls=walls, max_speed=1e6)
    return (EscapePanic(variant=variant).velocity(scene, 1e-6)[0, 0] - velocity) / 1e-6


def test_a_joint_of_two_walls_pushes_once():
    whole, pieces = [[(-2.0, 0.0), (2.0, 0.0)]], [[(-2.0, 0.0), (0.0, 0.0)], [(0.0, 0.0), (2.0, 0.0)]]
    for x in (-0.1, 0.0, 1e-9, 0.1):
        one = pushed(whole, (x, 0.3))
        assert one == pytest.approx([0.0, 25.0 * math.exp(-0.05 / 0.08)])
        assert pushed(pieces, (x, 0.3)) == pytest.approx(one)
    assert pushed(pieces, (0.0, 0.3), variant="crowdbot")[1] == pytest.approx(2.0 * one[1])


def test_a_wall_presses_and_rubs():
    x, y = pushed([[(-2.0, 0.0), (2.0, 0.0)]], (0.0, 0.24), (1.0, 0.0))
    assert y == pytest.approx(25.0 * math.exp(0.01 / 0.08) + 1500.0 * 0.01)
    assert x == pytest.approx(-3000.0 * 0.01, rel=1e-4)


def test_friction_between_two_cannot_overshoot():
    place, velocity = [[0.0, 0.0], [0.3, 0.0]], [[0.0, 1.0], [0.0, -1.0]]
    scene = Scene.of(place, velocity, preferred_velocity=velocity, max_speed=1e6)
    for dt in (1e-4, 1e-2, 1.0):
        sideways = EscapePanic(longest_step=1.0).velocity(scene, dt)[0, :, 1]
        assert -1.0 <= sideways[0] <= 1.0
        assert sideways[0] == pytest.approx(-sideways[1])


def leaving(model, dt, speed):
    """Let 60 people leave a room by a door of 1.2 m; return how many did, and the deepest overlaps."""
    rng = np.random.default_rng(0)
    walls = [[(0, 0), (9, 0)], [(9, 0), (9, 3.9)], [(9, 5.1), (9, 9)], [(9, 9), (0, 9)], [(0, 9), (0, 0)]]
    grid = np.stack(np.meshgrid(np.arange(3.0, 8.5, 0.6), np.arange(1.0, 8.5, 0.6)), axis=-1).reshape(-1, 2)
    place = grid[rng.permutation(len(grid))[:60]]
    scene = Scene.of(place, goal=np.tile([9.2, 4.5], (60, 1)), preferred_speed=speed, walls=walls, radius=0.25)
    deepest = through = 0.0
    for _ in range(round(12.0 / dt)):
        scene = model.step(scene, dt)
        x, y = scene.position[0].T
        scene = scene.replace(goal=np.where((x > 9.0)[:, None], [30.0, 4.5], scene.goal))
        apart = np.linalg.norm(scene.position[0, :, None] - scene.position[0], axis=-1) + 9.0 * np.eye(60)
        deepest = max(deepest, 0.5 - apart.min())
        behind = (x < 9.0) & (np.abs(y - 4.5) > 0.9)
        through = max(through, (0.25 - np.minimum.reduce([x, y, 9.0 - x, 9.0 - y])[behind]).max(initial=0.0))
        assert np.all((x > 0.0) & (y > 0.0) & (y < 9.0))
    return np.sum(scene.position[0, :, 0] > 9.0), deepest, through


@pytest.mark.parametrize("speed", [1.3, 3.0])
def test_people_leave_a_room_with_steps_of_a_tenth_of_a_second(speed):
    out, overlap, through = leaving(EscapePanic(), 0.1, speed)
    assert 8 <= out < 60
    assert overlap < 0.1
    assert through < 0.1


def test_two_in_one_place_come_apart():
    scene = Scene.of(np.zeros((2, 2)), goal=[[9.0, 0.0], [9.0, 0.0]])
    for _ in range(10):
        scene = EscapePanic().step(scene, 0.1)
    assert np.linalg.norm(scene.position[0, 0] - scene.position[0, 1]) >= 0.5


def test_a_robot_goes_on_while_people_make_room():
    scene = Scene.of(
        [[0.0, 0.0], [0.9, 0.02]], [[1.0, 0.0], [0.0, 0.0]], goal=[[0.0, 0.0], [0.9, 0.02]], external=[True, False]
    )
    for _ in range(12):
        scene = EscapePanic().step(scene, 0.1)
        assert np.linalg.norm(scene.position[0, 0] - scene.position[0, 1]) > 0.45
    assert scene.position[0, 0].tolist() == pytest.approx([1.2, 0.0])


@every_variant
@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000), turn=st.floats(-3.0, 3.0), x=st.integers(-64, 64), mirror=st.booleans())
def test_turning_shifting_and_mirroring_the_scene(variant, seed, turn, x, mirror):
    walls, model = [ROOM, PILLAR, SCREEN], EscapePanic(variant=variant)
    scene = crowd(seed, A=8, walls=walls)
    there = moved(scene, walls, turn, (x, -0.5 * x), mirror)
    expected = moved(scene.replace(velocity=model.velocity(scene, 0.01)), walls, turn, (x, -0.5 * x), mirror).velocity
    assert np.allclose(model.velocity(there, 0.01), expected, atol=1e-8)


@every_variant
@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32), dt=st.sampled_from([1e-6, 0.1, 10.0]))
def test_extreme_parameters_in_a_heap_stay_bounded(variant, seed, dt):
    rng = np.random.default_rng(seed)
    assert_bounded(extreme(EscapePanic, rng, variant=variant), heaped(rng), dt, 2.5 if variant == "crowdbot" else None)


def test_a_huge_time_step_ends():
    scene = crowd(3, A=5, width=3.0)
    assert_bounded(EscapePanic(), scene, 1e6)


@pytest.mark.parametrize("step", [0.0, -1.0, math.nan, math.inf])
def test_a_bad_longest_step_is_named(step):
    with pytest.raises(InputError, match="longest_step"):
        EscapePanic(longest_step=step)


def test_an_unknown_variant_is_named():
    with pytest.raises(InputError, match="variant 'textbok' is unknown, did you mean 'textbook'"):
        EscapePanic(variant="textbok")

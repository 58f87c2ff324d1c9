"""Boids: against the CrowdBot simulator, a plain twin, and by what it must do."""

from __future__ import annotations

import json

import numpy as np
import pytest
from extremes import assert_bounded, extreme, heaped
from hypothesis import given, settings
from hypothesis import strategies as st
from model_crowds import PILLAR, ROOM, SCREEN, crowd, moved

from crowdbot.core import InputError, Scene
from crowdbot.models import Boids
from crowdbot.models.forces.boids import VARIANTS

every_variant = pytest.mark.parametrize("variant", VARIANTS)


@pytest.mark.parametrize("name", ["crossing", "corridor"])
def test_one_step_agrees_with_the_crowdbot_simulator(reference, capsys, name):
    steps = np.load(reference / "crowdbot" / f"{name}_Boids.npz")
    about = json.loads((reference / "crowdbot" / f"{name}_Boids.json").read_text(encoding="utf-8"))
    scene = Scene.of(
        steps["x"], steps["v"], preferred_velocity=steps["pref"], radius=steps["radius"], walls=about["obstacles"]
    )
    error = np.linalg.norm(Boids(variant="crowdbot").velocity(scene, about["dt"]) - steps["v_next"], axis=-1)
    with capsys.disabled():
        print(
            f"\n{name}_Boids: {np.mean(error < 1e-4):.2%} of {error.size} within 1e-4,"
            f" median {np.median(error):.0e}, worst {error.max():.0e}"
        )
    assert np.mean(error < 1e-4) >= 0.999


def away(y, w, ahead, reach):
    """Return the push of one neighbour or wall point at -y that moves by w relative to it."""
    times = np.linspace(0.0, ahead, 200_001)
    places = y + np.outer(times, w)
    best = places[np.argmin(np.linalg.norm(places, axis=1))]
    distance = np.linalg.norm(best)
    return max(0.0, 1.0 - distance / reach) * best / distance


@pytest.mark.parametrize("seed", range(3))
def test_the_kernel_follows_the_text(seed):
    scene = crowd(seed, A=8, width=3.0, walls=())
    model = Boids(alignment=0.3, cohesion=0.2, flock_distance=2.0)
    x, v, r = scene.position[0], scene.velocity[0], scene.radius[0]
    got = model.velocity(scene, 0.1)[0]
    for i in range(8):
        others = np.delete(np.arange(8), i)
        total = 3.5 * (scene.desired_velocity(0.1)[0, i] - v[i])
        total += 12.0 * sum(away(x[i] - x[j], v[i] - v[j], 1.5, r[i] + r[j] + 0.5) for j in others)
        mates = [j for j in others if np.linalg.norm(x[i] - x[j]) < 2.0]
        if mates:
            total += 0.3 * (v[mates].mean(axis=0) - v[i]) + 0.2 * (x[mates].mean(axis=0) - x[i])
        total *= min(1.0, 5.0 / np.linalg.norm(total))
        after = v[i] + 0.1 * total
        after *= min(1.0, scene.max_speed[0, i] / np.linalg.norm(after))
        assert got[i] == pytest.approx(after, abs=1e-4)


@every_variant
def test_a_lone_walker_reaches_the_preferred_speed(variant):
    scene = Scene.of([[0.0, 0.0]], goal=[[100.0, 0.0]], preferred_speed=1.3)
    for _ in range(round(3.0 / 3.5 / 0.01)):
        scene = Boids(variant=variant).step(scene, 0.01)
    assert 0.95 * 1.3 <= scene.velocity[0, 0, 0] <= 1.3


def meeting(model):
    """Return the smallest distance of two who meet, 0.1 m off head-on."""
    scene = Scene.of([[-5.0, 0.0], [5.0, 0.1]], [[1.3, 0], [-1.3, 0]], goal=[[9.0, 0.0], [-9.0, 0.1]], radius=0.25)
    gaps = []
    for _ in range(250):
        scene = model.step(scene, 0.05)
        gaps.append(np.linalg.norm(scene.position[0, 0] - scene.position[0, 1]))
    assert np.linalg.norm(scene.position - scene.goal, axis=-1).max() < 0.1
    return min(gaps)


def test_two_who_meet_pass_with_a_gap_because_they_look_ahead():
    assert meeting(Boids()) >= 0.5
    assert meeting(Boids(look_ahead=1.0)) >= 0.5
    assert abs(meeting(Boids(look_ahead=0.0)) - meeting(Boids(look_ahead=1.0))) > 0.05


@pytest.mark.parametrize("dt", [0.05, 0.1])
def test_twenty_on_a_circle_change_places(dt):
    angle = np.arange(20) * 0.1 * np.pi
    start = 5.0 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    start += np.random.default_rng(0).uniform(-0.05, 0.05, start.shape)
    scene = Scene.of(start, goal=-start, radius=0.25)
    gaps = []
    for _ in range(round(20.0 / dt)):
        scene = Boids().step(scene, dt)
        apart = np.linalg.norm(scene.position[0, :, None] - scene.position[0], axis=-1) + 9.0 * np.eye(20)
        gaps.append(apart.min())
    assert np.linalg.norm(scene.position - scene.goal, axis=-1).max() < 0.05
    assert gaps[-1] > 0.5
    assert min(gaps) > 0.45


def test_nobody_walks_through_a_wall():
    wall = [[(-9.0, 0.0), (0.0, 0.0)], [(0.0, 0.0), (9.0, 0.0)]]
    place = [[-0.02, 3.0], [3.3, -2.0], [-4.0, 0.3]]
    scene = Scene.of(place, goal=[[0.0, -9.0], [3.3, 9.0], [-4.0, -9.0]], preferred_speed=1.6, walls=wall)
    for _ in range(300):
        scene = Boids().step(scene, 0.05)
        assert np.all(np.sign(scene.position[0, :, 1]) == [1, -1, 1])
    assert np.all(np.abs(scene.position[0, :, 1]) > 0.25)
    assert np.abs(scene.velocity).max() < 0.01


def test_exactly_head_on_they_brake():
    scene = Scene.of([[0.0, 0.0], [2.0, 0.0]], [[1.0, 0.0], [-1.0, 0.0]], preferred_velocity=[[1.0, 0.0], [-1.0, 0.0]])
    assert Boids().velocity(scene, 0.1)[0] == pytest.approx(np.array([[0.5, 0.0], [-0.5, 0.0]]))


def test_a_flock_aligns_and_gathers():
    scene = Scene.of([[0.0, 0.0], [2.0, 0.0]], [[0.0, 0.0], [0.0, 1.0]], preferred_velocity=[[0.0, 0.0], [0.0, 1.0]])
    plain = Boids(separation=0.0).velocity(scene, 0.1)
    assert np.array_equal(plain, scene.velocity)
    flock = Boids(separation=0.0, alignment=0.5, cohesion=0.25).velocity(scene, 0.1)
    assert flock[0] == pytest.approx(np.array([[0.05, 0.05], [-0.05, 0.95]]))


def test_the_simulator_takes_the_body_that_is_nearest():
    place = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.1]]
    scene = Scene.of(place, radius=[0.3, 0.1, 0.4], preferred_velocity=np.zeros((3, 2)))
    x, y = Boids(variant="crowdbot").velocity(scene, 0.1)[0, 0]
    assert x == 0.0
    assert y == pytest.approx(-0.1 * 65.0 * (1.0 - 1.1 / 1.62) ** 2 * 1.1)


@every_variant
@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000), turn=st.floats(-3.0, 3.0), x=st.integers(-64, 64), mirror=st.booleans())
def test_turning_shifting_and_mirroring_the_scene(variant, seed, turn, x, mirror):
    walls, model = [ROOM, PILLAR, SCREEN], Boids(variant=variant)
    scene = crowd(seed, A=8, walls=walls)
    there = moved(scene, walls, turn, (x, -0.5 * x), mirror)
    expected = moved(scene.replace(velocity=model.velocity(scene, 0.1)), walls, turn, (x, -0.5 * x), mirror).velocity
    assert np.allclose(model.velocity(there, 0.1), expected, atol=1e-8)


@every_variant
@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32), dt=st.sampled_from([1e-6, 0.1, 10.0]))
def test_extreme_parameters_in_a_heap_stay_bounded(variant, seed, dt):
    rng = np.random.default_rng(seed)
    assert_bounded(extreme(Boids, rng, variant=variant), heaped(rng), dt, 2.5 if variant == "crowdbot" else None)


def test_an_unknown_variant_is_named():
    with pytest.raises(InputError, match="variant 'predictiv' is unknown, did you mean 'predictive'"):
        Boids(variant="predictiv")
    with pytest.raises(InputError, match=r"Boids: max_speed = -1.0 \[m/s\] is not allowed"):
        Boids(max_speed=-1.0)

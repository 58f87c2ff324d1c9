"""SocialForce: against the gradient of its potential, a NumPy twin, the steps of UMANS, and by what it must do."""

from __future__ import annotations

import math

import numpy as np
import pytest
from engine_steps import umans
from hypothesis import given, settings
from hypothesis import strategies as st
from model_crowds import PILLAR, ROOM, SCREEN, crowd, moved

from crowdbot.core import InputError, Scene
from crowdbot.models import SocialForce


def potential(x, stride, strength=2.1, distance=0.3):
    """Return V(b) of Helbing and Molnar 1995, equations 3 and 4."""
    reach = np.linalg.norm(x) + np.linalg.norm(x - stride)
    return strength * np.exp(-0.5 * np.sqrt(reach**2 - stride @ stride) / distance)


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32))
def test_the_push_is_the_gradient_of_the_potential(seed):
    rng = np.random.default_rng(seed)
    place, other, velocity = rng.normal(0.0, 1.0, (3, 2))
    model = SocialForce(behind=1.0, max_acceleration=1e6)
    scene = Scene.of([place, other], [[0, 0], velocity], preferred_velocity=np.zeros((2, 2)), max_speed=1e6)
    push = model.velocity(scene, 0.01)[0, 0] / 0.01
    h = 1e-6
    slope = [
        (potential(place - other + step, 2.0 * velocity) - potential(place - other - step, 2.0 * velocity)) / (2.0 * h)
        for step in np.eye(2) * h
    ]
    assert push == pytest.approx(-np.array(slope), rel=1e-5, abs=1e-7)


def twin(scene, dt, umans=False):
    """Return the next velocities by the text of the papers, one pair after the other."""
    wish, x, v = scene.desired_velocity(dt)[0], scene.position[0], scene.velocity[0]
    chosen = v.copy()
    for i in range(len(x)):
        look = v[i] if umans or not wish[i].any() else wish[i]
        force, contact = (wish[i] - v[i]) / 0.5, np.zeros(2)

        def seen(n, look=look):
            known = np.linalg.norm(look) * np.linalg.norm(n) > 0.0
            angle = math.acos(np.clip(-n @ look / np.linalg.norm(look) / np.linalg.norm(n), -1, 1)) if known else 0.0
            return 1.0 if angle <= math.radians(100) else 0.5

        for j in range(len(x)):
            n = x[i] - x[j]
            d = np.linalg.norm(n)
            if i == j or d >= 5.0:
                continue
            stride = 2.0 * v[j]
            long = np.linalg.norm(stride)
            if umans:
                overlap = scene.radius[0, i] + scene.radius[0, j] - d
                if overlap > 0.0:
                    contact += 62.5 * overlap * n / d
                    continue
                aim = wish[j] / np.linalg.norm(wish[j]) if wish[j].any() else wish[j]
                long = np.linalg.norm(v[j])  # even of who has arrived: then it has no direction
                stride = long * aim
            far = np.linalg.norm(n - stride)
            b = 0.5 * math.sqrt((d + far) ** 2 - long**2)
            size = 2.1 / 0.3 * math.exp(-b / 0.3) * (d + far) / (4.0 * b)
            if umans:
                force += seen(n) * size * n * (1.0 + (d - n @ stride / d) / far)
            else:
                force += seen(n) * size * (n / d + (n - stride) / far)
        for ax, ay, bx, by in scene.walls.segments():
            a, edge = np.array([ax, ay]), np.array([bx - ax, by - ay])
            n = x[i] - a - np.clip((x[i] - a) @ edge / (edge @ edge), 0.0, 1.0) * edge
            d = np.linalg.norm(n)
            if d < 5.0:
                force += seen(n) * 10.0 / 0.2 * math.exp(-d / 0.2) * n / d
        if umans and not wish[i].any():
            force = -v[i] / dt
        force *= min(1.0, 5.0 / max(np.linalg.norm(force), 1e-12))
        after = v[i] + force * dt
        after *= min(1.0, scene.max_speed[0, i] / max(np.linalg.norm(after), 1e-12))
        chosen[i] = after + contact * dt
    return chosen


@pytest.mark.parametrize("variant", ["gradient", "umans2018"])
@pytest.mark.parametrize("seed", range(4))
def test_the_kernel_follows_the_text(variant, seed):
    scene = crowd(seed, A=25, width=9.0)
    wish = scene.desired_velocity(0.1)
    wish[0, 3] = 0.0
    scene = scene.replace(preferred_velocity=wish)
    expected = twin(scene, 0.1, variant == "umans2018")
    assert SocialForce(variant=variant).velocity(scene, 0.1)[0] == pytest.approx(expected, abs=1e-9)


def test_one_step_agrees_with_umans(reference, capsys):
    scene, after = umans(reference, "SocialForces")
    error = np.abs(SocialForce(variant="umans2018").velocity(scene, 0.1) - after).max(axis=-1)
    with capsys.disabled():
        print(
            f"\ncrossing_SocialForces: {np.mean(error < 1e-3):.2%} of {error.size} within 1e-3,"
            f" {np.mean(error < 1e-4):.2%} within 1e-4, median {np.median(error):.0e}, worst {error.max():.0e}"
        )
    assert np.median(error) <= 1e-6
    assert np.mean(error < 1e-4) >= 0.998
    assert error.max() < 1e-3


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000), turn=st.floats(-3.0, 3.0), x=st.integers(-64, 64), mirror=st.booleans())
@pytest.mark.parametrize("variant", ["gradient", "umans2018"])
def test_turning_shifting_and_mirroring_the_scene(variant, seed, turn, x, mirror):
    walls, model = [ROOM, PILLAR, SCREEN], SocialForce(variant=variant)
    scene = crowd(seed, A=8, walls=walls)
    there = moved(scene, walls, turn, (x, -0.5 * x), mirror)
    expected = moved(scene.replace(velocity=model.velocity(scene, 0.1)), walls, turn, (x, -0.5 * x), mirror).velocity
    assert np.allclose(model.velocity(there, 0.1), expected, atol=1e-8)


@pytest.mark.parametrize("variant", ["gradient", "umans2018"])
def test_a_lone_walker_reaches_the_preferred_speed(variant):
    scene = Scene.of([[0.0, 0.0]], goal=[[100.0, 0.0]], preferred_speed=1.2)
    model = SocialForce(variant=variant)
    for step in range(1, 61):
        scene = model.step(scene, 0.05)
        assert scene.velocity[0, 0, 0] == pytest.approx(1.2 * (1.0 - 0.9**step))  # v' = (s - v) / tau, tau = 0.5 s
    assert scene.velocity[0, 0].tolist() == pytest.approx([1.2, 0.0], rel=0.01)


def test_two_who_meet_pass_with_a_gap():
    scene = Scene.of(
        [[-5.0, 0.0], [5.0, 0.1]], [[1.3, 0.0], [-1.3, 0.0]], goal=[[50.0, 0.0], [-50.0, 0.1]], preferred_speed=1.3
    )
    closest = np.inf
    for _ in range(200):
        scene = SocialForce().step(scene, 0.05)
        closest = min(closest, float(np.hypot(*(scene.position[0, 0] - scene.position[0, 1]))))
    assert closest > 0.5
    assert scene.position[0, 0, 0] > 4.0
    assert scene.position[0, 1, 0] < -4.0


def test_a_wall_stops_who_walks_at_it():
    walls = [[(4.0, -9.0), (4.0, 9.0)]]
    scene = Scene.of([[0.0, 0.0]], preferred_velocity=[[1.3, 0.0]], walls=walls)
    for _ in range(600):
        scene = SocialForce().step(scene, 0.02)
    # at rest the pull s / tau equals the push U / R exp(-d / R)
    assert 4.0 - scene.position[0, 0, 0] == pytest.approx(0.2 * math.log(10.0 / 0.2 / (1.3 / 0.5)), abs=1e-3)


def test_what_is_behind_pushes_half():
    def push(at):
        scene = Scene.of([[0.0, 0.0], at], preferred_velocity=[[1.0, 0.0], [0.0, 0.0]], velocity=[[1, 0], [0, 0]])
        return SocialForce().velocity(scene, 0.01)[0, 0, 0] - 1.0

    assert push([-0.8, 0.0]) == pytest.approx(-0.5 * push([0.8, 0.0]))


def test_acceleration_is_capped():
    scene = Scene.of([[0.0, 0.0], [0.05, 0.0]], preferred_velocity=np.zeros((2, 2)))
    for most in (0.5, 3.0):
        assert np.abs(SocialForce(max_acceleration=most).velocity(scene, 0.1))[0, :, 0] == pytest.approx(0.1 * most)


def test_the_parameters_do_something():
    scene = crowd(0, A=20, width=5.0)
    usual = SocialForce().velocity(scene, 0.1)
    for name, value in {
        "strength": 1.0,
        "distance": 0.5,
        "look_ahead": 1.0,
        "wall_strength": 5.0,
        "wall_distance": 0.3,
        "relaxation_time": 0.7,
        "view_angle": 1.0,
        "behind": 0.0,
        "neighbor_distance": 1.0,
        "max_neighbors": 2,
        "max_acceleration": 2.0,
        "max_speed": 0.4,
        "variant": "umans2018",
    }.items():
        assert not np.array_equal(SocialForce(**{name: value}).velocity(scene, 0.1), usual), name


def test_an_unknown_variant():
    with pytest.raises(InputError, match="variant 'gradiant' is unknown, did you mean 'gradient'"):
        SocialForce(variant="gradiant")
    with pytest.raises(InputError, match="SocialForce: max_speed"):
        SocialForce(max_speed=-1.0)

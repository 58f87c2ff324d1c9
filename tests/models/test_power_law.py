"""PowerLaw: against UMANS, against the slope of its energy, a plain twin, and by what it must do."""

from __future__ import annotations

import math

import numpy as np
import pytest
from engine_steps import umans
from extremes import assert_bounded, extreme, heaped
from hypothesis import given, settings
from hypothesis import strategies as st
from model_crowds import PILLAR, ROOM, SCREEN, crowd, moved

from crowdbot.core import InputError, Scene
from crowdbot.core.geometry import time_to_contact, time_to_segment
from crowdbot.models import PowerLaw

FREE = {"max_acceleration": 1e9, "max_speed": 1e9}


def force(model, place, velocity, radius=0.25, walls=()):
    """Return the acceleration of the first agent by all others and walls [m/s^2]."""
    velocity = np.asarray(velocity, dtype=float)
    scene = Scene.of(place, velocity, preferred_velocity=velocity, radius=radius, walls=walls)
    return model.velocity(scene, 1.0)[0, 0] - velocity[0]


def energy(time, model):
    return model.strength * time**-model.exponent * math.exp(-time / model.time_horizon) if time < math.inf else 0.0


def slope(function, at, h=2e-4):
    """Return the gradient of a function of a point, by differences of fourth order."""
    steps = np.eye(2) * h
    values = [8 * (function(at + s) - function(at - s)) - function(at + 2 * s) + function(at - 2 * s) for s in steps]
    return np.array(values) / (12 * h)


def smooth(time, at):
    """Return whether a collision is sure nearby, and neither grazing nor too near or far."""
    around = [time(at + step) for step in 0.03 * np.array([[0, 0], [1, 0], [-1, 0], [0, 1], [0, -1]])]
    return min(around) > 0.05 and max(around) < min(2.9, 1.05 * min(around))


def test_one_step_agrees_with_umans(reference, capsys):
    scene, after = umans(reference, "PowerLaw")
    place = scene.position
    model = PowerLaw(relaxation_time=0.5, neighbor_distance=5.0, max_acceleration=5.0)
    error = np.linalg.norm(model.velocity(scene, 0.1) - after, axis=-1)
    apart = np.linalg.norm(place[:, :, None] - place[:, None], axis=-1) + 9.0 * np.eye(place.shape[1])
    free = apart.min(axis=-1) >= 0.5
    walking = np.linalg.norm(scene.goal - place, axis=-1) > 0.25  # the library stops at once who has the goal below
    with capsys.disabled():
        for name, some in (("all", error), ("free, not arrived", error[free & walking])):
            print(
                f"\ncrossing_PowerLaw, {name}: {np.mean(some < 1e-3):.2%} of {some.size} within 1e-3,"
                f" {np.mean(some < 1e-4):.2%} within 1e-4, median {np.median(some):.0e}, worst {some.max():.0e}"
            )
    assert np.median(error) <= 1e-5
    assert np.mean(error < 1e-3) >= 0.99
    assert np.all(error[free & walking] < 1e-3)
    assert np.mean(free & walking) > 0.98


@pytest.mark.parametrize("exponent", [1.0, 1.7, 2.0, 3.0])
def test_the_force_between_two_is_the_slope_of_the_energy(exponent):
    rng = np.random.default_rng(int(10 * exponent))
    model = PowerLaw(exponent=exponent, **FREE)
    tried = 0
    while tried < 15:
        place, velocity = rng.uniform(-3.0, 3.0, (2, 2)), rng.normal(0.0, 1.0, (2, 2))
        x, v = place[0] - place[1], velocity[0] - velocity[1]

        def time(at, v=v):
            return time_to_contact(at[0], at[1], v[0], v[1], 0.5)

        if not smooth(time, x):
            continue
        expected = -slope(lambda at, time=time: energy(time(at), model), x)
        assert force(model, place, velocity) == pytest.approx(expected, rel=1e-6, abs=1e-6 * np.abs(expected).max())
        tried += 1


def test_the_force_of_a_wall_is_the_slope_of_the_energy():
    rng = np.random.default_rng(0)
    model = PowerLaw(**FREE)
    tried = {"face": 0, "corner": 0}
    while min(tried.values()) < 15:
        a, b = rng.uniform(-3.0, 3.0, (2, 2))
        place, velocity = rng.uniform(-3.0, 3.0, 2), rng.normal(0.0, 1.3, 2)

        def time(at, v=velocity, a=a, b=b):
            return time_to_segment(at[0], at[1], v[0], v[1], 0.25, a[0], a[1], b[0], b[1])

        if not smooth(time, place):
            continue
        along = (place + velocity * time(place) - a) @ (b - a) / ((b - a) @ (b - a))
        if min(abs(along), abs(along - 1.0)) < 0.05:
            continue  # between face and corner the second derivative has a step
        expected = -slope(lambda at, time=time: energy(time(at), model), place)
        got = force(model, [place], [velocity], walls=[[a, b]])
        assert got == pytest.approx(expected, rel=1e-6, abs=1e-6 * np.abs(expected).max())
        tried["face" if 0.0 < along < 1.0 else "corner"] += 1


def twin(scene, dt, model):
    """Return the next velocities by the formula of the paper, one pair after the other."""
    x, v, r = scene.position[0], scene.velocity[0], scene.radius[0]
    out = v.copy()
    for i in range(len(x)):
        total = (scene.desired_velocity(dt)[0, i] - v[i]) / model.relaxation_time
        for j in range(len(x)):
            p, w = x[i] - x[j], v[i] - v[j]
            if i == j or np.linalg.norm(p) >= model.neighbor_distance:
                continue
            reach = r[i] + r[j]
            if np.linalg.norm(p) <= reach:
                reach = 0.99 * np.linalg.norm(p)
            a, b, c = w @ w, -p @ w, p @ p - reach**2
            if b <= 0.0 or b * b - a * c <= 0.0:
                continue
            root = math.sqrt(b * b - a * c)
            tau = (b - root) / a
            if 0.0 < tau <= model.time_horizon:
                size = 1.5 * math.exp(-tau / 3.0) / (a * tau**2) * (2.0 / tau + 1.0 / 3.0)
                total -= size * (w - (a * p + b * w) / root)
        total *= min(1.0, model.max_acceleration / max(np.linalg.norm(total), 1e-12))
        after = v[i] + total * dt
        out[i] = after * min(1.0, scene.max_speed[0, i] / max(np.linalg.norm(after), 1e-12))
    return out


@pytest.mark.parametrize("seed", range(4))
def test_the_kernel_follows_the_text(seed):
    scene = crowd(seed, A=30, width=6.0, walls=())
    model = PowerLaw(neighbor_distance=4.0)
    assert model.velocity(scene, 0.1)[0] == pytest.approx(twin(scene, 0.1, model), abs=1e-7)


def test_a_wall_of_many_pieces_is_one_wall():
    whole = [[(-9.0, 0.0), (9.0, 0.0)]]
    pieces = [[(k - 9.0, 0.0), (k - 8.0, 0.0)] for k in range(18)]
    for x in (-0.4, 0.0, 0.3):
        one = force(PowerLaw(**FREE), [(x, 1.5)], [(0.4, -1.0)], walls=whole)
        assert force(PowerLaw(**FREE), [(x, 1.5)], [(0.4, -1.0)], walls=pieces) == pytest.approx(one)
        assert np.linalg.norm(one) > 0.1


def test_a_walker_stops_before_a_wall():
    scene = Scene.of([[0.0, 3.0]], [[0.0, -1.3]], preferred_velocity=[[0.0, -1.3]], walls=[[(-50.0, 0.0), (50.0, 0.0)]])
    for _ in range(1000):
        scene = PowerLaw().step(scene, 0.02)
        assert scene.position[0, 0, 1] > 0.25
    assert 0.0 < scene.position[0, 0, 1] - 0.25 < 0.3
    assert np.abs(scene.velocity).max() < 0.1


def test_the_middle_of_a_corridor_pulls_to_no_side():
    walls = [[(-50.0, -1.0), (50.0, -1.0)], [(50.0, 1.0), (-50.0, 1.0)]]
    assert force(PowerLaw(), [(0.0, 0.0)], [(1.3, 0.0)], walls=walls).tolist() == [0.0, 0.0]
    assert force(PowerLaw(), [(0.0, 0.3)], [(1.3, 0.2)], walls=walls)[1] < 0.0


def test_two_who_meet_pass_with_a_gap():
    scene = Scene.of([[-4.0, 0.0], [4.0, 0.1]], [[1.3, 0], [-1.3, 0]], preferred_velocity=[[1.3, 0], [-1.3, 0]])
    gaps = []
    for _ in range(400):
        scene = PowerLaw().step(scene, 0.02)
        gaps.append(np.linalg.norm(scene.position[0, 0] - scene.position[0, 1]))
    assert 0.5 < min(gaps) < 1.5
    assert scene.position[0, 0, 0] > 3.0
    assert scene.position[0, 1, 0] < -3.0


def test_bodies_that_overlap_and_approach_are_pushed_apart():
    push = force(PowerLaw(max_speed=99.0), [(0.0, 0.0), (0.4, 0.0)], [(0.5, 0.0), (-0.5, 0.0)])
    assert push == pytest.approx([-20.0, 0.0])
    assert force(PowerLaw(), [(0.0, 0.0), (0.4, 0.0)], [(-0.5, 0.0), (0.5, 0.0)]).tolist() == [0.0, 0.0]


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000), turn=st.floats(-3.0, 3.0), x=st.integers(-64, 64), mirror=st.booleans())
def test_turning_shifting_and_mirroring_the_scene(seed, turn, x, mirror):
    walls, model = [ROOM, PILLAR, SCREEN], PowerLaw()
    scene = crowd(seed, A=8, walls=walls)
    there = moved(scene, walls, turn, (x, -0.5 * x), mirror)
    expected = moved(scene.replace(velocity=model.velocity(scene, 0.1)), walls, turn, (x, -0.5 * x), mirror).velocity
    assert np.allclose(model.velocity(there, 0.1), expected, atol=1e-6)


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32), dt=st.sampled_from([1e-6, 0.1, 10.0]))
def test_extreme_parameters_in_a_heap_stay_bounded(seed, dt):
    rng = np.random.default_rng(seed)
    assert_bounded(extreme(PowerLaw, rng), heaped(rng), dt)


def test_a_negative_maximum_speed_is_named():
    with pytest.raises(InputError, match=r"PowerLaw: max_speed = -1.0 \[m/s\] is not allowed"):
        PowerLaw(max_speed=-1.0)

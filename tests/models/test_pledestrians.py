"""PLEdestrians: against UMANS, by its own law, and by behaviour."""

from __future__ import annotations

import numpy as np
import pytest
from engine_steps import circle, report, umans
from model_crowds import PILLAR, ROOM, SCREEN, crowd, moved

from crowdbot.core import InputError, Scene
from crowdbot.models import ORCA, PLEdestrians


def test_velocities_are_near_those_of_umans(reference):
    # UMANS tries 361 velocities (36 directions, steps of 0.18 m/s) and forbids contacts within 0.5 s in place of ORCA's
    # half planes: its free walkers choose 1.26 m/s for 1.33 m/s, and a fifth of the difference is left after a step of
    # 0.1 s at its relaxation time of 0.5 s, 0.014 m/s: the median. test_cost_model.py has its rule, and agrees.
    scene, after = umans(reference, "PLEdestrians")
    scene = scene.replace(preferred_speed=np.full(scene.shape, np.sqrt(2.23 / 1.26)))
    chosen = PLEdestrians(neighbor_distance=10.0, time_horizon=0.5, max_neighbors=59).velocity(scene, 0.1)
    relaxed = scene.velocity + 0.2 * (chosen - scene.velocity)
    share, median, _ = report("PLEdestrians, UMANS", np.linalg.norm(relaxed - after, axis=-1), 0.02, "m/s")
    assert share > 0.8
    assert median < 0.015


def effort(scene, velocity, dt=0.1, planning=3.0):
    away = scene.goal - scene.position
    distance = np.linalg.norm(away, axis=-1)
    speed = np.linalg.norm(scene.desired_velocity(dt), axis=-1)
    time = np.maximum(dt, np.minimum(planning, distance / speed))
    left = np.linalg.norm(away - time[..., None] * velocity, axis=-1)
    return time * (speed**2 + np.sum(velocity**2, axis=-1)) + 2.0 * speed * left


@pytest.mark.parametrize("seed", range(3))
def test_no_permitted_velocity_costs_less(seed):
    # whatever ORCA answers to any wish is permitted, or the least evil
    scene = crowd(seed, A=30, E=8)
    chosen = effort(scene, PLEdestrians().velocity(scene, 0.1))
    rng = np.random.default_rng(seed)
    for _ in range(60):
        wish = rng.normal(0.0, 1.0, (*scene.shape, 2))
        other = effort(scene, ORCA().velocity(scene.replace(preferred_velocity=wish), 0.1))
        feasible = other > chosen - 1e-7 * chosen
        assert np.mean(feasible) > 0.97  # where nothing is permitted the wish may still decide
    assert np.all(chosen <= effort(scene, ORCA().velocity(scene, 0.1)) * (1.0 + 1e-7))


def test_without_goals_it_is_orca():
    scene = crowd(3, A=60)
    wished = scene.replace(preferred_velocity=scene.desired_velocity(0.1))
    assert np.array_equal(PLEdestrians().velocity(wished, 0.1), ORCA().velocity(wished, 0.1))
    far = wished.replace(preferred_velocity=None, goal=scene.position + 1e7 * wished.preferred_velocity)
    far = far.replace(preferred_speed=np.linalg.norm(wished.preferred_velocity, axis=-1))
    assert np.allclose(PLEdestrians().velocity(far, 0.1), ORCA().velocity(far, 0.1), atol=1e-5)


def test_a_free_walk_has_the_preferred_speed_to_the_end():
    scene = Scene.of([[0.0, 0.0]], goal=[[3.0, 4.0]], preferred_speed=1.4)
    for _ in range(35):
        scene = PLEdestrians().step(scene, 0.1)
        assert np.linalg.norm(scene.velocity) == pytest.approx(1.4)
    for _ in range(2):
        scene = PLEdestrians().step(scene, 0.1)
    assert scene.position[0, 0] == pytest.approx([3.0, 4.0])


def test_who_is_hindered_near_the_goal_slows_down_rather_than_turns():
    scene = crowd(5, A=30, E=20, walls=(), width=9.0)
    wish = scene.desired_velocity(0.1)
    mine, orca = PLEdestrians().velocity(scene, 0.1), ORCA().velocity(scene, 0.1)
    hindered = np.linalg.norm(orca - wish, axis=-1) > 0.1
    speed = [np.linalg.norm(v, axis=-1)[hindered].mean() for v in (mine, orca)]
    assert speed[0] < speed[1]
    off = [np.abs(wish[..., 0] * v[..., 1] - wish[..., 1] * v[..., 0])[hindered].mean() for v in (mine, orca)]
    assert off[0] < off[1]


def test_turning_and_shifting_turns_and_shifts():
    scene = crowd(11, A=40)
    chosen = PLEdestrians().velocity(scene, 0.1)
    cos, sin = np.cos(1.1), np.sin(1.1)
    turned = PLEdestrians().velocity(moved(scene, (ROOM, PILLAR, SCREEN), 1.1, (30.0, -7.0)), 0.1)
    assert np.allclose(turned, chosen @ [[cos, sin], [-sin, cos]], atol=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_people_change_places_on_a_circle(seed):
    place = circle(20, 10.0, seed)  # with ten on 5 m it jams in the middle, as ORCA does
    scene = Scene.of(place, goal=-place)
    for _ in range(230):
        scene = PLEdestrians().step(scene, 0.1)
        apart = np.linalg.norm(scene.position[0, :, None] - scene.position[0], axis=-1) + np.eye(20)
        assert apart.min() > 0.4
    assert np.all(np.linalg.norm(scene.position + place, axis=-1) < 0.3)


def test_walkers_stop_before_a_wall():
    scene = Scene.of([[0.0, 0.0]], [[1.3, 0.0]], goal=[[9.0, 0.0]], walls=[[(4.0, -20.0), (4.0, 20.0)]])
    for _ in range(200):
        scene = PLEdestrians().step(scene, 0.1)
        assert scene.position[0, 0, 0] <= 3.75 + 1e-9
    assert scene.position[0, 0, 0] > 3.5


def test_a_bad_planning_time_is_named():
    with pytest.raises(InputError, match=r"planning_time = 0.0 \[s\] is not allowed, it must be at least 0.001"):
        PLEdestrians(planning_time=0.0)

"""Heuristics: against UMANS, against a slow twin, and by behaviour."""

from __future__ import annotations

import math

import numpy as np
import pytest
from engine_steps import circle, report, umans
from model_crowds import PILLAR, ROOM, SCREEN, crowd, moved

from crowdbot.core import InputError, Scene
from crowdbot.core.geometry import nearest_on_segment, time_to_contact, time_to_segment
from crowdbot.models import Heuristics
from crowdbot.models.vision.heuristics import ANGLES


def test_velocities_are_near_those_of_umans(reference):
    # UMANS tries directions in steps of 10 degrees and speeds in steps of 0.18 m/s; a tenth of a second at a relaxation
    # time of 0.5 s keeps a fifth of that: up to 0.2 (0.09 + 1.3 sin 5 deg) = 0.04 m/s where both mean the same choice.
    # Where two sides are nearly as good, the rough grid takes another; test_cost_model.py has its grid, and agrees.
    scene, after = umans(reference, "Moussaid")
    chosen = Heuristics(sight_distance=8.0, max_neighbors=59).velocity(scene, 0.1)
    share, median, _ = report("Heuristics, UMANS", np.linalg.norm(chosen - after, axis=-1), 0.04, "m/s")
    assert share > 0.75
    assert median < 0.025


def free_way(scene, i, velocity):
    """Return how far i can walk at ``velocity`` before a contact; who is in contact is in the way of coming nearer."""
    x, radius = scene.position[0, i], scene.radius[0, i]
    speed = np.hypot(*velocity)
    times = [math.inf]
    for j in range(scene.shape[1]):
        if j != i:
            offset, motion = x - scene.position[0, j], velocity - scene.velocity[0, j]
            times.append(
                time_to_contact(*offset, *motion, radius + scene.radius[0, j]) if offset @ motion < 0 else math.inf
            )
    return speed * min(*times, wall_time(scene, x, velocity, radius))


def wall_time(scene, x, velocity, radius):
    times = [math.inf]
    for wall in scene.walls.segments():
        away = x - nearest_on_segment(*x, *wall)
        if np.hypot(*away) > radius or away @ velocity < 0.0:
            times.append(time_to_segment(*x, *velocity, radius, *wall))
    return min(times)


def twin(scene, model, dt):
    """Return the velocities of environment 0, one person and one direction after the other."""
    out = np.zeros_like(scene.velocity[0])
    for i in range(scene.shape[1]):
        x, v, radius = scene.position[0, i], scene.velocity[0, i], scene.radius[0, i]
        wish = scene.desired_velocity(dt)[0, i]
        speed = np.hypot(*wish)
        best, least = None, math.inf
        side = 1.0 if wish[0] * v[1] - wish[1] * v[0] > 1e-9 * speed**2 else -1.0
        for k in range(ANGLES):
            angle = side * (-1) ** (k + 1) * ((k + 1) // 2) * 2.0 * model.field_of_view / (ANGLES - 1)
            way = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ wish / speed
            free = min(model.sight_distance, free_way(scene, i, speed * way))
            cost = model.sight_distance**2 + free**2 - 2.0 * model.sight_distance * free * np.cos(angle)
            if cost < least - 1e-9 * model.sight_distance**2:
                best, least = way, cost
        standing = scene.replace(velocity=np.zeros_like(scene.velocity))
        target = min(speed, free_way(standing, i, best) / model.relaxation_time) * best
        force = (target - v) / model.relaxation_time
        for j in range(scene.shape[1]):
            away = x - scene.position[0, j]
            if j != i:
                overlap = max(0.0, radius + scene.radius[0, j] - np.hypot(*away))
                force = force + model.contact_stiffness * overlap * away / np.hypot(*away)
        for wall in scene.walls.segments():
            away = x - nearest_on_segment(*x, *wall)
            force = force + model.contact_stiffness * max(0.0, radius - np.hypot(*away)) * away / np.hypot(*away)
        v = v + dt * force
        out[i] = v * min(1.0, scene.max_speed[0, i] / np.hypot(*v))
    return out


@pytest.mark.parametrize("seed", range(2))
def test_the_kernel_does_what_its_twin_does(seed):
    scene = crowd(seed, A=25)
    model = Heuristics(neighbor_distance=1e3, max_neighbors=30)
    assert np.allclose(model.velocity(scene, 0.1)[0], twin(scene, model, 0.1), atol=1e-9)


def test_turning_and_shifting_turns_and_shifts():
    scene = crowd(11, A=40)
    chosen = Heuristics().velocity(scene, 0.1)
    cos, sin = np.cos(1.1), np.sin(1.1)
    turned = Heuristics().velocity(moved(scene, (ROOM, PILLAR, SCREEN), 1.1, (30.0, -7.0)), 0.1)
    assert np.allclose(turned, chosen @ [[cos, sin], [-sin, cos]], atol=1e-7)


def test_a_free_walker_takes_up_the_desired_velocity_in_the_relaxation_time():
    scene = Scene.of([[0.0, 0.0]], goal=[[50.0, 0.0]])
    for step in range(20):
        scene = Heuristics().step(scene, 0.05)
        assert scene.velocity[0, 0, 0] == pytest.approx(1.3 * (1.0 - 0.9 ** (step + 1)), rel=1e-12)
    assert scene.velocity[0, 0, 1] == 0.0


def test_who_stands_in_the_way_is_passed_on_the_side_one_walks_to_else_on_the_right():
    def path(lateral):
        scene = Scene.of([[0.0, 0.0], [5.0, 0.0]], [[1.3, lateral], [0.0, 0.0]], goal=[[10.0, 0.0], [5.0, 0.0]])
        sides = []
        for _ in range(90):
            scene = Heuristics().step(scene, 0.1)
            assert np.linalg.norm(scene.position[0, 0] - scene.position[0, 1]) > 0.49
            sides.append(scene.position[0, 0, 1])
        assert scene.position[0, 0, 0] > 9.0
        return max(sides, key=abs)

    assert path(0.0) < -0.3
    assert path(-0.1) < -0.3
    assert path(0.1) > 0.3


def test_walkers_stop_before_a_wall():
    scene = Scene.of([[0.0, 0.0]], [[1.3, 0.0]], goal=[[9.0, 0.0]], walls=[[(4.0, -20.0), (4.0, 20.0)]])
    for _ in range(150):
        scene = Heuristics().step(scene, 0.1)
    assert 3.45 < scene.position[0, 0, 0] <= 3.75


def test_the_speed_leaves_the_time_to_stop():
    behind = Scene.of([[0.0, 0.0], [0.7, 0.0]], [[0.4, 0.0], [0.4, 0.0]], goal=[[9.0, 0.0], [9.0, 0.0]])
    narrow = Heuristics(field_of_view=1e-6)
    assert narrow.velocity(behind, 0.1)[0, 0, 0] == pytest.approx(0.4)  # 0.2 m of way in 0.5 s


def test_contact_pushes_and_never_beyond_its_end():
    scene = Scene.of([[0.0, 0.0], [0.4, 0.0]])
    push = Heuristics().velocity(scene, 0.01)[0]
    assert push == pytest.approx(np.array([[-62.5 * 0.1 * 0.01, 0.0], [62.5 * 0.1 * 0.01, 0.0]]))
    stiff = Heuristics(contact_stiffness=1e6).step(scene.replace(max_speed=np.full((1, 2), 9.0)), 0.1)
    assert stiff.position[0, :, 0] == pytest.approx([-0.1, 0.5])
    wall = Scene.of([[0.2, 1.0]], walls=[[(0.0, 0.0), (0.0, 2.0)]])
    assert Heuristics().velocity(wall, 0.01)[0, 0] == pytest.approx([62.5 * 0.05 * 0.01, 0.0])


@pytest.mark.parametrize("seed", range(3))
def test_people_change_places_on_a_circle(seed):
    place = circle(10, 5.0, seed)
    scene = Scene.of(place, goal=-place)
    for _ in range(130):
        scene = Heuristics().step(scene, 0.1)
        apart = np.linalg.norm(scene.position[0, :, None] - scene.position[0], axis=-1) + np.eye(10)
        assert apart.min() > 0.4
    assert np.all(np.linalg.norm(scene.position + place, axis=-1) < 0.3)


def test_people_at_one_place_come_apart():
    scene = Scene.of(np.zeros((2, 2)), goal=[[9.0, 0.0], [-9.0, 0.0]])
    for _ in range(20):
        scene = Heuristics().step(scene, 0.1)
    assert np.linalg.norm(scene.position[0, 0] - scene.position[0, 1]) > 0.5


def test_a_bad_sight_distance_is_named():
    with pytest.raises(InputError, match=r"sight_distance = 0.0 \[m\] is not allowed, it must be at least 0.01"):
        Heuristics(sight_distance=0.0)

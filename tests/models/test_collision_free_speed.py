"""Collision-free speed: against JuPedSim, against a slow twin, and by behaviour."""

from __future__ import annotations

import numpy as np
import pytest
from engine_steps import jupedsim, report
from model_crowds import crowd, moved

from crowdbot.core import InputError, Scene
from crowdbot.models import CollisionFreeSpeed

NAMES = [
    "crossing_CollisionFreeSpeed",
    "crossing_CollisionFreeSpeedV2",
    "corridor_CollisionFreeSpeedV2",
    "bottleneck_CollisionFreeSpeedV2",
]


@pytest.mark.parametrize("name", NAMES)
def test_next_positions_are_those_of_jupedsim(reference, name):
    scenes, _, after = jupedsim(reference, name)
    steps = [CollisionFreeSpeed().step(scene, 0.01).position for scene in scenes]
    error = np.min([np.linalg.norm(place - after[..., :2], axis=-1) for place in steps], axis=0)
    share, median, worst = report(name, error, 1e-5, "m")
    assert share == 1.0
    assert median < 1e-6
    assert worst < 1e-5


def twin(scene, model, dt):
    """Return the velocities of environment 0, one person after the other, as the paper says it."""
    place, radius = scene.position[0], scene.radius[0]
    wish = scene.desired_velocity(dt)[0]
    segments = scene.walls.segments().reshape(-1, 2, 2)
    out = np.zeros_like(wish)
    for i in range(len(place)):
        speed = np.hypot(*wish[i])
        direction = wish[i] / speed
        walls = [(foot(place[i], wall), wall) for wall in segments]
        walls = [(point, wall) for point, wall in walls if np.hypot(*(point - place[i])) <= model.neighbor_distance]
        others = [
            j
            for j in range(len(place))
            if j != i
            and np.hypot(*(place[j] - place[i])) < model.neighbor_distance
            and not any(crosses(place[i], place[j], wall) for _, wall in walls)
        ]
        turned = direction.copy()
        for j in others:
            away = place[i] - place[j]
            gap = np.hypot(*away) - radius[i] - radius[j]
            turned += model.strength * np.exp(-gap / model.range) * away / np.hypot(*away)
        for point, _ in walls:
            away = place[i] - point
            gap = np.hypot(*away) - radius[i]
            turned += model.wall_strength * np.exp(-gap / model.wall_range) * away / np.hypot(*away)
        turned /= np.hypot(*turned)
        for j in others:
            way, both = place[j] - place[i], radius[i] + radius[j]
            if turned @ way >= 0.0 and abs(turned[0] * way[1] - turned[1] * way[0]) <= both:
                speed = min(speed, max(0.0, (np.hypot(*way) - both) / model.time_gap))
        out[i] = min(speed, scene.max_speed[0, i]) * turned
    return out


def foot(point, wall):
    along = wall[1] - wall[0]
    return wall[0] + np.clip((point - wall[0]) @ along / (along @ along), 0.0, 1.0) * along


def crosses(a, b, wall):
    def side(p, q, r):
        return np.sign((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))

    c, d = wall
    return side(a, b, c) != side(a, b, d) and side(c, d, a) != side(c, d, b)


@pytest.mark.parametrize("seed", range(4))
def test_the_kernel_does_what_its_twin_does(seed):
    scene = crowd(seed, A=60)
    chosen = CollisionFreeSpeed().velocity(scene, 0.1)[0]
    expected = twin(scene, CollisionFreeSpeed(), 0.1)
    # bodies deep in walls and in each other have exponents whose rounding is large
    assert np.allclose(chosen, expected, rtol=1e-9, atol=1e-9)


def test_turning_and_shifting_turns_and_shifts():
    from model_crowds import PILLAR, ROOM, SCREEN

    scene = crowd(11, A=40)
    chosen = CollisionFreeSpeed().velocity(scene, 0.1)
    cos, sin = np.cos(1.1), np.sin(1.1)
    turned = CollisionFreeSpeed().velocity(moved(scene, (ROOM, PILLAR, SCREEN), 1.1, (30.0, -7.0)), 0.1)
    assert np.allclose(turned, chosen @ [[cos, sin], [-sin, cos]], atol=1e-7)


def test_a_file_keeps_its_time_gap_and_never_touches():
    place = np.stack([-1.1 * np.arange(12.0), np.zeros(12)], axis=-1)
    scene = Scene.of(place, radius=0.2, goal=place + [100.0, 0.0], preferred_speed=np.linspace(0.6, 1.6, 12))
    model = CollisionFreeSpeed(time_gap=0.8)
    for _ in range(300):
        scene = model.step(scene, 0.1)
        gaps = -np.diff(scene.position[0, :, 0]) - 0.4
        assert gaps.min() > 0.0
    assert np.allclose(scene.velocity[0, 1:, 0], 0.6, atol=0.02)  # the slow one leads
    assert np.allclose(gaps[:3], 0.8 * 0.6, atol=0.03)


def test_a_wall_hides_and_turns():
    free = Scene.of([[0.0, 0.0], [1.0, 0.0]], radius=0.2, goal=[[9.0, 0.0], [-9.0, 0.0]])
    between = free.replace(walls=Scene.of([[0.0, 0.0]], walls=[[(0.5, -1.0), (0.5, 1.0)]]).walls)
    model = CollisionFreeSpeed()
    assert model.velocity(free, 0.1)[0, 0, 0] == pytest.approx(0.6)
    assert model.velocity(between, 0.1)[0, 0, 0] == pytest.approx(1.3, rel=1e-3)
    along = Scene.of([[0.0, 0.25]], radius=0.2, goal=[[9.0, -3.0]], walls=[[(-9.0, 0.0), (9.0, 0.0)]])
    for _ in range(40):
        along = model.step(along, 0.1)
        assert along.position[0, 0, 1] > 0.2
    assert along.position[0, 0, 0] > 4.0


def test_coefficients_are_per_person():
    scene = Scene.of(
        [[0.0, 0.0], [1.0, 0.05], [0.0, 5.0], [1.0, 5.05]], radius=0.2, goal=[[9.0, 0.0]] * 2 + [[9.0, 5.0]] * 2
    )
    both = CollisionFreeSpeed(time_gap=np.array([0.5, 0.5, 2.0, 2.0]), strength=np.array([8.0, 8.0, 1.0, 1.0]))
    speed = np.linalg.norm(both.velocity(scene, 0.1)[0], axis=-1)
    assert speed[0] == pytest.approx(4.0 * speed[2], rel=1e-9)


def test_people_at_one_place_come_apart():
    scene = Scene.of(np.zeros((2, 2)), radius=0.2, goal=[[9.0, 1.0], [9.0, -1.0]])
    for _ in range(20):
        scene = CollisionFreeSpeed().step(scene, 0.1)
    assert np.linalg.norm(scene.position[0, 0] - scene.position[0, 1]) > 0.4


def test_who_has_arrived_stands():
    scene = Scene.of([[0.0, 0.0], [0.5, 0.0]], radius=0.2)
    assert np.all(CollisionFreeSpeed().velocity(scene, 0.1) == 0.0)


def test_a_bad_time_gap_is_named():
    with pytest.raises(InputError, match=r"time_gap = -0.1 \[s\] is not allowed, it must be at least 0"):
        CollisionFreeSpeed(time_gap=-0.1)


def test_without_a_time_gap_only_the_direction_is_chosen():
    file = Scene.of([[0.0, 0.0], [0.41, 0.0]], radius=0.2, goal=[[9.0, 0.0], [9.0, 0.0]], preferred_speed=1.3)
    found = CollisionFreeSpeed(time_gap=0.0, strength=0.5).velocity(file, 0.1)[0]
    assert np.linalg.norm(found, axis=-1) == pytest.approx([1.3, 1.3])


def test_people_who_want_to_walk_the_other_way_repel_by_their_share():
    def turn(other: float, **values: float) -> float:
        wish = [[1.3, 0.0], [other, 0.0]]
        scene = Scene.of([[0.0, 0.0], [0.5, 0.2]], radius=0.2, preferred_velocity=wish)
        vx, vy = CollisionFreeSpeed(**values).velocity(scene, 0.1)[0, 0]
        return float(np.arctan2(vy, vx))

    assert turn(-1.3) == turn(1.3) < 0.0
    assert turn(1.3, oncoming=0.2) == turn(1.3)
    assert turn(-1.3) < turn(-1.3, oncoming=0.2) < turn(-1.3, oncoming=0.0) == 0.0

"""VOG: against the CrowdBot simulator and a slow twin, and how groups keep together."""

from __future__ import annotations

import math

import numpy as np
import pytest

from crowdbot.core import InputError, Scene, stream
from crowdbot.models import ORCA, VOG, Mixture
from crowdbot.models.velocity_obstacles.vog import MEMORY

ABREAST = np.array([[0.0, 0.0], [0.0, 1.0], [0.0, 2.0]])
AHEAD = np.array([[1.3, 0.0]] * 3)


def unit(v):
    return v / np.linalg.norm(v) if np.linalg.norm(v) > 1e-5 else np.zeros(2)


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def turned(v, angle):
    return np.array([v[0] * math.cos(angle) - v[1] * math.sin(angle), v[0] * math.sin(angle) + v[1] * math.cos(angle)])


def cone_depth(c, x, v, other, reach, horizon):
    """Return how deep a velocity is in the velocity obstacle of someone at x (relative), from its geometry."""
    apex, d, n = 0.5 * (v + other), np.linalg.norm(x), unit(x)
    if d < reach:
        return 50.0 * max(0.0, (c - apex - (d - reach) * n) @ n)
    centre, radius = apex + x / horizon, reach / horizon
    behind = (c - apex) @ n - (d - reach) / horizon
    half = math.acos(reach / d)
    inside = [radius - (c - centre) @ turned(-n, side * half) for side in (1.0, -1.0)]
    if behind <= 0.0 or min(inside) < 0.0:
        return 0.0
    return 0.5 * (behind if behind < radius else inside[0 if cross(x, v - other) <= 0.0 else 1])


def fellow_costs(c, x, other, way):
    """Return the violations of staying with a fellow and of walking abreast, and whether it is in range."""
    d, n = np.linalg.norm(x), unit(x)
    if d < 1.2:
        q = c - other - x
        return [max(0.0, np.linalg.norm(q) - 1.0), max(0.0, abs(q @ way) - 0.2, abs(cross(way, q)) - 1.0)], True
    centre, half, along = other + 0.5 * x, math.acos(1.0 / d), (c - other) @ n
    beyond = max((c - centre) @ turned(-n, side * half) - 0.5 for side in (1.0, -1.0))
    return [max(0.0, beyond, 0.5 * (d - 1.0) - along, along - d - 1.0)], False


def cost(scene, a, c, calm=1.0, horizon=2.0):
    """Return the cost of a velocity of agent ``a``, without walls: obstacles and group apart from all the rest."""
    x, v, p, group = scene.position[0], scene.velocity[0], scene.preferred_velocity[0], scene.group[0]
    others = [j for j in range(len(x)) if j != a and np.linalg.norm(x[j] - x[a]) < 5.0]
    worst = max((cone_depth(c, x[j] - x[a], v[a], v[j], 0.6, horizon) for j in others), default=0.0)
    keys = []
    for j in np.flatnonzero((group == group[a]) & (group >= 0)):
        r, alike = x[j] - x[a], unit(p[a]) @ unit(p[j])
        both = min(np.linalg.norm(p[a]), np.linalg.norm(p[j])) > 0.5
        if j != a and not (both and alike <= 0.7):
            look = unit(p[a]) if np.linalg.norm(p[a]) > 0.5 else unit(v[a])
            keys.append((r @ r * (1.5 - 0.5 * look @ unit(r)) * (2.0 - alike if both else 1.0), j))
    total, talk, terms = 0.0, 1.0, 0
    for _, j in sorted(keys)[:2]:
        values, near = fellow_costs(c, x[j] - x[a], v[j], unit(p[a]))
        total, terms = total + sum(values), terms + len(values)
        talk = min(talk, 0.5 + 0.5 * values[1]) if near else talk
        if not near:  # counted twice, as the formation out of range is the same
            total, terms = total + sum(values), terms + 1
    shared = worst + (0.2 * talk * total / terms if terms else 0.0)
    off = np.sum((unit(c) - unit(p[a])) ** 2) + abs(np.linalg.norm(c) - np.linalg.norm(p[a]))
    rest = 0.15 * off + np.sum((unit(c) - unit(v[a])) ** 2) / calm**2
    rest += 10.0 * (c @ p[a] < 0.0) + 5.0 * (c @ c < 0.1 < p[a] @ p[a])
    return shared + 0.02 * off, shared + rest


def twin(scene, a):
    """Return the best velocity of agent ``a``: every sample of the three levels, one after the other."""
    v, p = scene.velocity[0, a], scene.preferred_velocity[0, a]
    scale = max(np.linalg.norm(p), np.linalg.norm(v))
    samples = [(p, 0.3 * scale), (v, 0.3 * scale), (0.5 * v, 0.4 * scale)]
    side = np.array([v[1], -v[0]])
    for k in range(8):
        b = 2.0 * math.pi * k / 8
        along = 0.5 * v * (1.0 + math.cos(b)) + 0.5 * side * math.sin(b)
        samples.append((along, (1.0 - abs(k - 4) / 8) * 0.5 * scale))
    for k in range(6):
        b = 2.0 * math.pi * (k + 0.5) / 6
        samples.append((0.5 * v + 0.3 * v * math.sin(b) + 0.3 * side * math.cos(b), 0.3 * scale))
        samples.append((v + 0.2 * scale * np.array([math.cos(b), math.sin(b)]), 0.4 * scale))
    best = (math.inf, v)
    kept = [[math.inf, np.zeros(2), 0.0], [math.inf, np.zeros(2), 0.0]]
    samples = samples[:2] + samples[3:11] + samples[11::2] + samples[12::2] + samples[2:3]  # in the order of the model
    for _ in range(3):
        kept[0][0] = kept[1][0] = math.inf
        for c, size in samples:
            rough, full = cost(scene, a, c)
            if rough <= kept[0][0]:
                kept[0 if rough > kept[1][0] else 1] = [rough, c, size]
            if full < best[0]:
                best = (full, c)
        samples = [
            (c + 0.3 * size * np.array(corner), 0.6 * size**2)
            for _, c, size in kept
            for corner in ((1, 1), (-1, 1), (-1, -1), (1, -1))
        ]
    return best[1] if np.linalg.norm(best[1]) >= 0.1 else np.zeros(2)


def walk(model, scene, steps):
    for _ in range(steps):
        scene = model.step(scene, 0.1)
    return scene


def group_of(place, velocity, **more):
    values = {"preferred_velocity": velocity, "radius": 0.33, "max_speed": 2.0, "group": [0] * len(place)} | more
    return Scene.of(place, velocity, **values)


@pytest.mark.parametrize("name", ["crossing", "corridor"])
def test_it_is_that_of_the_crowdbot_simulator(reference, name):
    data = np.load(reference / "crowdbot" / f"{name}_VOG.npz")
    v = data["v"].astype(float)
    # The simulator walks on before it chooses, and never sees its walls: they are on no layer of obstacles.
    scene = group_of(data["x"] + 0.1 * v, v, preferred_velocity=data["pref"], group=data["group_id"])
    error = np.abs(VOG(time_horizon=5.0, max_neighbors=200.0).velocity(scene, 0.1) - data["v_next"]).max(axis=-1)
    moving = np.linalg.norm(v, axis=-1) >= 0.1
    print(
        f"VOG {name}: {np.mean(error[moving] < 1e-4):.2%} of {moving.sum()} moving and"
        f" {np.mean(error[~moving] < 1e-4):.2%} of {(~moving).sum()} standing agents within 1e-4,"
        f" median {np.median(error):.1e}, worst {error.max():.1e}"
    )
    assert np.mean(error < 1e-4) >= 0.999


def test_it_is_its_slow_twin():
    rng = np.random.default_rng(2)
    for _ in range(6):
        place = rng.uniform(-2.5, 2.5, (8, 2))
        velocity, wish = rng.normal(0.0, 0.8, (8, 2)), rng.normal(0.0, 0.9, (8, 2))
        wish[:5] = [1.0, 0.3] + rng.normal(0.0, 0.2, (5, 2))
        scene = group_of(
            place, velocity, preferred_velocity=wish, radius=0.3, max_speed=9.0, group=[0] * 5 + [3, 3, -1]
        )
        chosen = VOG().velocity(scene, 0.1)[0]
        for a in range(8):
            if np.linalg.norm(velocity[a]) > 0.1:
                assert chosen[a] == pytest.approx(twin(scene, a), abs=1e-6)


@pytest.mark.parametrize(
    ("spacing", "low", "high"), [(0.8, 0.8, 0.8), (1.0, 1.0, 1.0), (1.6, 0.74, 0.86), (3.0, 0.74, 0.86)]
)
def test_three_abreast_keep_their_spacing_or_close_up(spacing, low, high):
    end = walk(VOG(), group_of(ABREAST * spacing, AHEAD), 120)
    gaps = np.linalg.norm(np.diff(end.position[0], axis=0), axis=-1)
    assert low - 1e-3 <= gaps.max() <= high + 1e-3
    assert np.all(np.diff(end.position[0, :, 1]) > 0.0)


def against_singles(weight):
    """Return how far a member is from the nearest fellow at most, after 13 s against six oncoming people, 20 times."""
    places = []
    for seed in range(20):
        rng = stream(seed, "against")
        singles = np.stack([rng.uniform(6.0, 14.0, 6), rng.uniform(-2.5, 2.5, 6)], axis=-1)
        places.append(np.concatenate([ABREAST * 0.8 - [0.0, 0.8], singles]))
    velocity = np.concatenate([AHEAD, np.tile([-1.3, 0.0], (6, 1))])
    scene = group_of(np.array(places), np.tile(velocity, (20, 1, 1)), group=[0] * 3 + [-1] * 6)
    members = walk(VOG(group_weight=weight), scene, 130).position[:, :3]
    gaps = np.linalg.norm(members[:, :, None] - members[:, None], axis=-1) + 99.0 * np.eye(3)
    return gaps.min(axis=2).max(axis=1)


def test_a_group_stays_together_against_a_stream():
    together, apart = against_singles(0.2), against_singles(0.0)
    print(f"VOG group of 3: median worst gap {np.median(together):.2f} m; without the group {np.median(apart):.2f} m")
    assert np.all(together < 2.0)
    assert np.median(together) < 1.0 < np.median(apart)


def test_groups_are_those_of_their_environment():
    place = np.array([[[0.0, 0.0], [0.0, 1.6]], [[0.0, 0.0], [0.0, 1.6]]])
    scene = group_of(place, np.tile([1.3, 0.0], (2, 2, 1)), group=[[5, 5], [5, 6]])
    end = walk(VOG(), scene, 100)
    gap = end.position[:, 1, 1] - end.position[:, 0, 1]
    assert gap[0] < 1.1
    assert gap[1] == pytest.approx(1.6)


def test_fellows_who_are_lost_unseen_or_walk_elsewhere_do_not_count():
    velocity = np.array([[1.3, 0.0], [1.3, 0.0]])
    scene = group_of([[0.0, 0.0], [0.0, 2.5]], velocity)
    assert not np.array_equal(VOG(group_weight=0.8).velocity(scene, 0.1)[0, 0], velocity[0])
    for other, model in (
        (scene, VOG(group_weight=0.8, group_distance=2.0)),
        (scene, VOG(group_weight=0.8, group_neighbors=0.0)),
        (scene, VOG(group_weight=0.8, closeness=0.0)),
        (scene.replace(visible=np.array([[True, False]])), VOG(group_weight=0.8)),
        (scene.replace(preferred_velocity=np.array([[[1.3, 0.0], [0.0, 1.3]]])), VOG(group_weight=0.8)),
    ):
        assert np.array_equal(model.velocity(other, 0.1)[0, 0], velocity[0])


def test_formation_walks_abreast():
    behind = group_of([[0.0, 0.0], [-0.9, 0.3]], np.array([[1.3, 0.0], [1.3, 0.0]]))
    abreast, free = (walk(VOG(group_weight=0.5, formation=f), behind, 150).position[0] for f in (0.2, 0.0))
    assert abs(abreast[0, 0] - abreast[1, 0]) < 0.4
    assert abs(free[0, 0] - free[1, 0]) == pytest.approx(0.9)


def test_the_scene_remembers_calm():
    calm = group_of([[0.0, 0.0]], [[1.3, 0.0]])
    first = VOG().step(calm, 0.1)
    assert first.memory[MEMORY].tolist() == [[2.0]]  # grows by 10 dt
    assert VOG().step(first, 0.1).memory[MEMORY].tolist() == [[3.0]]
    shy = group_of([[0.0, 0.0]], [[0.0, 1.3]], preferred_velocity=[[1.3, 0.0]])
    after = VOG().step(shy, 0.1)
    changed = np.sum((after.velocity - shy.velocity) ** 2)
    assert after.memory[MEMORY][0, 0] == pytest.approx(1.0 / (25.0 * changed) + 1.0)
    bold = shy.replace(memory={MEMORY: np.full((1, 1), 1e3), "other": np.zeros((1, 1))})
    assert VOG().velocity(bold, 0.1)[0, 0, 0] > VOG().velocity(shy, 0.1)[0, 0, 0]
    assert "other" in VOG().step(bold, 0.1).memory
    with pytest.raises(InputError, match="vog_calm has shape"):
        VOG().velocity(shy.replace(memory={MEMORY: np.zeros((1, 7))}), 0.1)


def test_nobody_walks_into_walls():
    wall = [[(0.0, -5.0), (0.0, 5.0)]]
    scene = group_of([[-5.0, 0.0], [-5.0, 2.0]], [[1.3, 0.0], [1.3, 0.0]], group=-1, walls=wall)
    for _ in range(60):
        scene = VOG().step(scene, 0.1)
        assert scene.position[0, :, 0].max() < -0.2
    pillar = [[(0.0, -0.5), (0.3, -0.5), (0.3, 0.5), (0.0, 0.5)]]
    around = walk(VOG(), group_of([[-5.0, 0.2]], [[1.3, 0.0]], walls=pillar), 100)
    assert around.position[0, 0, 0] > 3.0
    beside = group_of([[0.0, 0.4]], [[1.3, 0.0]], walls=[[(-9.0, 0.0), (9.0, 0.0)]])
    assert VOG().velocity(beside, 0.1)[0, 0] == pytest.approx([1.3, 0.0])  # along a wall nothing is lost
    inside = group_of([[0.0, 0.1]], [[1.3, 0.0]], walls=[[(-9.0, 0.0), (9.0, 0.0)]])
    assert VOG().velocity(inside, 0.1)[0, 0, 1] > 0.1


def test_external_agents_do_not_share_the_way():
    velocity = [[1.3, 0.0], [-1.3, 0.0]]
    robot = group_of([[0.0, 0.0], [4.0, 0.1]], velocity, group=-1, external=[False, True])
    alone = VOG(time_horizon=4.0).velocity(robot, 0.1)
    shared = VOG(time_horizon=4.0).velocity(robot.replace(external=np.zeros((1, 2), dtype=bool)), 0.1)
    assert np.array_equal(alone[0, 1], velocity[1])
    assert np.linalg.norm(alone[0, 0] - velocity[0]) > np.linalg.norm(shared[0, 0] - velocity[0])


def test_two_at_the_same_place_part():
    scene = group_of(np.zeros((2, 2)), np.zeros((2, 2)), preferred_velocity=np.tile([1.0, 0.0], (2, 1)), group=-1)
    end = walk(VOG(), scene, 30)
    assert np.linalg.norm(end.position[0, 0] - end.position[0, 1]) > 0.6


def test_wrong_input_is_explained():
    with pytest.raises(
        InputError, match="group_neighbors = 17.0 .* is not allowed, it must be at least 0 and at most 16"
    ):
        VOG(group_neighbors=17.0)
    with pytest.raises(InputError, match="time_horizon = 0.0"):
        VOG(time_horizon=0.0)


def test_a_person_who_comes_in_is_calm():
    assert VOG().memory_at_start == {"vog_calm": 1.0}
    assert Mixture((ORCA(), VOG())).memory_at_start == {"vog_calm": 1.0}

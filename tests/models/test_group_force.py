"""GroupForce: against PySocialForce, a plain twin, and by what people in groups must do."""

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
from crowdbot.models import GroupForce
from crowdbot.models.forces.group_force import VARIANTS

every_variant = pytest.mark.parametrize("variant", VARIANTS)


@pytest.mark.parametrize("name", ["crossing_nogroups", "crossing_pairs_triples", "corridor_groups"])
def test_one_step_agrees_with_pysocialforce(reference, capsys, name):
    steps = np.load(reference / "pysocialforce" / f"{name}.npz")
    about = json.loads((reference / "pysocialforce" / f"{name}.json").read_text(encoding="utf-8"))
    now, after = steps["now"].astype(np.float64), steps["next"].astype(np.float64)[..., 2:4]
    group = np.full(now.shape[1], -1)
    for number, members in enumerate(about["groups"] or []):
        group[members] = number
    scene = Scene.of(
        now[..., :2],
        now[..., 2:4],
        goal=now[..., 4:6],
        preferred_speed=steps["pref_speed"],
        group=group,
        walls=[[(ax, ay), (bx, by)] for ax, bx, ay, by in about["obstacles_x0x1y0y1"] or []],
    )
    error = np.linalg.norm(GroupForce(variant="pysocialforce").velocity(scene, about["dt"]) - after, axis=-1)
    walking = np.linalg.norm(after, axis=-1) > 1e-6
    with capsys.disabled():
        for some, who in ((error, "all"), (error[walking], "moving")):
            print(
                f"\n{name}, {who}: {np.mean(some < 1e-4):.2%} of {some.size} within 1e-4,"
                f" median {np.median(some):.0e}, worst {some.max():.0e}"
            )
    assert np.sum(walking) > 300
    assert np.mean(error[walking] < 1e-4) >= 0.99
    assert np.all(error[~walking] < 1e-4)


def twin(scene, dt):
    """Return the next velocities by the text of the papers, one pair after the other."""
    x, v, group = scene.position[0], scene.velocity[0], scene.group[0]
    out = v.copy()
    for i in range(len(x)):
        total = (scene.desired_velocity(dt)[0, i] - v[i]) / 0.5
        for j in range(len(x)):
            if i == j:
                continue
            d = np.linalg.norm(x[i] - x[j])
            n = (x[i] - x[j]) / d
            D = 2.0 * (v[j] - v[i]) + n
            t, B = D / np.linalg.norm(D), 0.35 * np.linalg.norm(D)
            theta = math.atan2(t[1], t[0]) - math.atan2(n[1], n[0])
            theta = (theta + math.pi) % (2.0 * math.pi) - math.pi
            along = math.exp(-d / B - (3.0 * B * theta) ** 2)
            across = -np.sign(theta) * math.exp(-d / B - (2.0 * B * theta) ** 2)
            total += 5.1 * (along * t + across * np.array([-t[1], t[0]]))
        mates = [j for j in range(len(x)) if j != i and group[i] >= 0 and group[j] == group[i]]
        if mates:
            middle = x[[i, *mates]].mean(axis=0) - x[i]
            if np.linalg.norm(middle) > len(mates) / 2.0:
                total += 3.0 * middle / np.linalg.norm(middle)
            others = x[mates].mean(axis=0) - x[i]
            angle = math.acos(v[i] @ others / np.linalg.norm(v[i]) / np.linalg.norm(others))
            total -= 4.0 * max(0.0, angle - math.pi / 2.0) * v[i]
            for j in mates:
                d = np.linalg.norm(x[i] - x[j])
                total += (x[i] - x[j]) / d * (d < 0.55)
        after = v[i] + total * dt
        out[i] = after * min(1.0, scene.max_speed[0, i] / np.linalg.norm(after))
    return out


@pytest.mark.parametrize("seed", range(4))
def test_the_kernel_follows_the_text(seed):
    group = np.random.default_rng(seed).integers(-1, 5, 20)
    scene = crowd(seed, A=20, width=5.0, walls=(), group=group)
    assert GroupForce().velocity(scene, 0.1)[0] == pytest.approx(twin(scene, 0.1), abs=1e-7)


@every_variant
def test_a_lone_walker_reaches_its_speed(variant):
    scene = Scene.of([[0.0, 0.0]], goal=[[100.0, 0.0]], preferred_speed=1.2)
    aim = 1.2 if variant == "moussaid" else 1.3 * 1.2
    for step in range(1, 61):
        scene = GroupForce(variant=variant).step(scene, 0.05)
        assert scene.velocity[0, 0, 0] == pytest.approx(aim * (1.0 - 0.9**step))


def test_the_package_stops_who_has_arrived():
    scene = Scene.of([[0.0, 0.0], [0.0, 5.0]], [[1.0, 0.0], [1.0, 0.0]], goal=[[0.49, 0.0], [0.51, 5.0]])
    chosen = GroupForce(variant="pysocialforce").velocity(scene, 0.1)[0]
    assert chosen[0].tolist() == [0.0, 0.0]
    assert chosen[1, 0] > 1.0


def test_two_who_meet_turn_to_the_same_side_each():
    scene = Scene.of([[-5.0, 0.0], [5.0, 0.1]], [[1.3, 0], [-1.3, 0]], goal=[[50.0, 0.0], [-50.0, 0.1]])
    gaps = []
    for _ in range(160):
        scene = GroupForce().step(scene, 0.05)
        gaps.append(np.linalg.norm(scene.position[0, 0] - scene.position[0, 1]))
    assert min(gaps) > 0.5
    assert scene.position[0, 0, 0] > 3.5
    assert scene.position[0, 1, 0] < -3.5


def walk(model, position, group, seconds=20.0, **more):
    position = np.asarray(position, dtype=float)
    scene = Scene.of(position, np.tile([1.2, 0.0], (len(position), 1)), preferred_speed=1.2,
                     goal=position + [1000.0, 0.0], group=group, **more)  # fmt: skip
    for _ in range(round(seconds / 0.05)):
        scene = model.step(scene, 0.05)
    return scene.position[0]


def test_a_pair_comes_together_and_stays_apart():
    near = walk(GroupForce(), [[0.0, 0.0], [0.0, 4.0]], [3, 3])
    far = walk(GroupForce(), [[0.0, 0.0], [0.0, 4.0]], [3, 4])
    assert 0.4 < np.linalg.norm(near[0] - near[1]) < 1.6
    assert np.linalg.norm(far[0] - far[1]) > 3.5
    assert walk(GroupForce(), [[0.0, 0.0], [0.0, 4.0]], [-1, -1]) == pytest.approx(far)


def test_who_walks_ahead_waits_for_the_group():
    place = [[6.0, 0.0], [0.0, 0.5], [0.0, -0.5]]
    waiting, alone = walk(GroupForce(), place, 0), walk(GroupForce(), place, [-1, -1, -1])
    assert waiting[:, 0].max() - waiting[:, 0].min() < 3.0
    assert alone[:, 0].max() - alone[:, 0].min() > 5.0


def test_groups_of_other_environments_and_the_invisible_do_not_count():
    place = np.array([[0.0, 0.0], [0.0, 4.0]])
    alone = Scene.of(place, goal=place + [99.0, 0.0], group=[1, -1])
    pair = Scene.of(np.stack([place, place]), goal=np.stack([place, place]) + [99.0, 0.0], group=[[1, -1], [-1, 1]])
    assert np.array_equal(GroupForce().velocity(pair, 0.1)[0], GroupForce().velocity(alone, 0.1)[0])
    unseen = Scene.of(place, goal=place + [99.0, 0.0], group=[1, 1], visible=[True, False])
    lonely = Scene.of(place[:1], goal=place[:1] + [99.0, 0.0])
    assert np.array_equal(GroupForce().velocity(unseen, 0.1)[0, 0], GroupForce().velocity(lonely, 0.1)[0, 0])


@every_variant
def test_the_numbers_of_members_do_not_matter(variant):
    scene = crowd(4, A=12, width=4.0, group=np.repeat([5, 2, -1], 4))
    order = np.random.default_rng(0).permutation(12)
    arrays = {n: getattr(scene, n)[:, order] for n in ("position", "velocity", "radius", "goal", "preferred_speed")}
    other = scene.replace(**arrays, group=scene.group[:, order], max_speed=scene.max_speed[:, order])
    expected = GroupForce(variant=variant).velocity(scene, 0.1)[:, order]
    assert np.allclose(GroupForce(variant=variant).velocity(other, 0.1), expected, rtol=0.0, atol=1e-12)
    if variant == "moussaid":
        assert np.array_equal(GroupForce().velocity(other, 0.1), expected)


def test_a_wall_of_many_pieces_pushes_once():
    whole, pieces = [[(-2.0, 0.0), (2.0, 0.0)]], [[(-2.0, 0.0), (0.0, 0.0)], [(0.0, 0.0), (2.0, 0.0)]]
    for x in (-0.1, 0.0, 0.1):
        pushes = [
            GroupForce().velocity(Scene.of([[x, 0.4]], walls=walls), 0.1)[0, 0].tolist() for walls in (whole, pieces)
        ]
        assert pushes[0] == pytest.approx([0.0, 0.1 * 10.0 * math.exp(-0.15 / 0.2)])
        assert pushes[1] == pytest.approx(pushes[0])


@every_variant
def test_nobody_walks_through_a_wall(variant):
    scene = Scene.of([[0.0, 3.0]], goal=[[0.0, -9.0]], walls=[[(-9.0, 0.0), (9.0, 0.0)]])
    for _ in range(200):
        scene = GroupForce(variant=variant).step(scene, 0.05)
    assert 0.1 < scene.position[0, 0, 1] < 1.5
    assert np.abs(scene.velocity).max() < 0.01


@every_variant
@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000), turn=st.floats(-3.0, 3.0), x=st.integers(-64, 64), mirror=st.booleans())
def test_turning_shifting_and_mirroring_the_scene(variant, seed, turn, x, mirror):
    walls, model = [ROOM, PILLAR, SCREEN], GroupForce(variant=variant)
    group = np.array([0, 0, 0, 1, 1, -1, 7, -1])
    if variant == "pysocialforce":  # its unwrapped angle turns with nothing
        turn, mirror = 0.0, False
    scene = crowd(seed, A=8, walls=walls, group=group)
    there = moved(scene, walls, turn, (x, -0.5 * x), mirror).replace(group=scene.group)
    expected = moved(scene.replace(velocity=model.velocity(scene, 0.1)), walls, turn, (x, -0.5 * x), mirror).velocity
    assert np.allclose(model.velocity(there, 0.1), expected, atol=1e-8)


@every_variant
@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32), dt=st.sampled_from([1e-6, 0.1, 10.0]))
def test_extreme_parameters_in_a_heap_stay_bounded(variant, seed, dt):
    rng = np.random.default_rng(seed)
    assert_bounded(extreme(GroupForce, rng, variant=variant), heaped(rng), dt)


def test_an_endless_wall_costs_no_time():
    scene = Scene.of([[0.0, 1.0]], goal=[[9.0, 1.0]], walls=[[(-1e9, 0.0), (1e9, 0.0)]])
    assert_bounded(GroupForce(variant="pysocialforce"), scene, 0.1)


def test_an_unknown_variant_is_named():
    with pytest.raises(InputError, match="variant 'pysocial-force' is unknown, did you mean 'pysocialforce'"):
        GroupForce(variant="pysocial-force")

"""Tangent: its verified parts, its choice against brute force, and its behaviour against the measured table."""

from __future__ import annotations

import math

import numpy as np
import pytest

from crowdbot.core import InputError, Scene
from crowdbot.models import Tangent
from crowdbot.models.vision.tangent_threats import MOST, THREAT, insert, least_change, threat_of_neighbor
from samples import sizes

PAIR = 0.66
"""Clearance of two people with the default personal area [m]."""


def crossing(angle, ahead, aside=0.0, model=None):
    """Return the smallest distance, and of both walkers the first reaction [s], lateral shift [m], speeds [m/s].

    Both begin 8 m before the meeting point at 1.3 m/s; the second, whose way is turned by ``angle``, is ``ahead``.
    """
    way = np.array([[1.0, 0.0], [math.cos(angle), math.sin(angle)]])
    left = np.stack([-way[:, 1], way[:, 0]], axis=-1)
    start = -8.0 * way + np.array([[0.0], [1.0]]) * (ahead * way + aside * left)
    scene = Scene.of(start, 1.3 * way, goal=start + 30.0 * way, preferred_speed=1.3, max_speed=2.0)
    track, velocity = [scene.position[0]], [scene.velocity[0]]
    for _ in range(240):
        scene = (model or Tangent()).step(scene, 0.05)
        track.append(scene.position[0])
        velocity.append(scene.velocity[0])
    track, velocity = np.array(track), np.array(velocity)
    changed = np.linalg.norm(velocity - velocity[0], axis=-1) > 0.01
    first = np.where(changed.any(axis=0), 0.05 * changed.argmax(axis=0), np.inf)
    shift = np.abs(np.einsum("tak,ak->ta", track - start, left)).max(axis=0)
    speed = np.linalg.norm(velocity, axis=-1)
    apart = np.linalg.norm(track[:, 0] - track[:, 1], axis=-1).min()
    return apart, first, shift, speed.min(axis=0), speed.max(axis=0)


def within(value, low, high):
    """Return whether a value is in the measured range, 20 % wider."""
    return 0.8 * low <= value <= 1.2 * high + 1e-9


TABLE = {
    # degrees: distance, first reaction and shift of who gives way, of the other, slowest of who gives way
    45: ((0.89, 0.96), (1.9, 2.1), (0.07, 0.07), None, (0.0, 0.0), (0.91, 0.99)),
    90: ((0.57, 0.64), (2.4, 2.6), (0.22, 0.30), (5.9, 6.2), (0.05, 0.19), (1.00, 1.08)),
    135: ((0.60, 0.63), (2.6, 3.0), (0.06, 0.08), (2.5, 3.0), (0.48, 0.57), (1.08, 1.14)),
}


@pytest.mark.parametrize("ahead", [0.2, 0.4])
@pytest.mark.parametrize("angle", TABLE)
def test_crossings_are_as_measured(angle, ahead):
    apart, first, shift, slowest, fastest = crossing(math.radians(angle), ahead)
    print(f"Tangent {angle} deg, {ahead} m: {apart:.2f} m, {first} s, {shift.round(3)} m, {slowest.round(2)} m/s")
    distance, begin, aside, other_begin, other_aside, slow = TABLE[angle]
    assert within(apart, *distance)
    assert within(first[0], *begin)
    assert within(shift[0], *aside)
    assert within(slowest[0], *slow)
    assert within(shift[1], *other_aside)
    assert within(first[1], *other_begin) if other_begin else first[1] == math.inf
    assert fastest[1] <= (1.2 * 1.4 if angle == 135 else 1.5)


def test_head_on_both_turn_the_same_way():
    apart, first, shift, slowest, _ = crossing(math.pi, 0.2)
    print(f"Tangent head on: {apart:.2f} m, {first} s, {shift.round(2)} m, {slowest.round(2)} m/s")
    assert within(apart, 0.66, 0.66)
    assert all(within(f, 1.9, 2.2) for f in first)
    assert within(shift.sum(), 0.24 + 0.47, 0.24 + 0.47)  # the original moves its agents in turn, so that one does more
    assert all(within(s, 1.21, 1.29) for s in slowest)


def test_at_a_tie_who_has_the_other_on_the_right_gives_way():
    apart, first, *_ = crossing(math.pi / 2, 0.0)  # the second comes from the right
    assert apart > 0.5
    assert first[0] < 3.0 < first[1]
    apart, first, *_ = crossing(-math.pi / 2, 0.0)
    assert first[1] < 3.0 < first[0]


def test_larger_errors_react_later_and_none_at_once():
    times = [
        crossing(math.pi / 2, 0.2, model=Tangent(direction_error=d, speed_error=s))[1][0]
        for d, s in ((0.0, 0.25), (0.25, 0.25), (0.5, 0.25), (0.5, 0.5), (1.0, 1.0))
    ]
    assert times == sorted(times)
    assert times[0] < 0.1
    assert times[-1] > 4.0


@pytest.mark.parametrize("angle", [20, 30, 60, 75, 100, 120, 150, 160, 170])
@pytest.mark.parametrize("ahead", [0.1, 0.5])
def test_nobody_touches_at_any_angle(angle, ahead):
    for side in (1.0, -1.0):
        assert crossing(side * math.radians(angle), ahead)[0] > 0.55


def test_free_walking_is_exact():
    rng = np.random.default_rng(0)
    velocity, goal = rng.normal(0.0, 0.7, (40, 2)), rng.uniform(-20.0, 20.0, (40, 2))
    goal[:5] = rng.uniform(-0.5, 0.5, (5, 2))
    model, alone = Tangent(), np.zeros((40, 2))
    chosen = model.velocity(
        Scene.of(alone, velocity, goal=goal, preferred_speed=1.3, max_speed=2.0, visible=False), 0.1
    )
    for v, g, got in zip(velocity, goal, chosen[0], strict=True):
        distance = np.linalg.norm(g)
        change = g / distance * min(1.3, distance / 0.1) - v
        expected = v + change * min(1.0, 0.13 / np.linalg.norm(change))
        expected *= min(1.0, min(2.0, distance) / np.linalg.norm(expected))  # no faster than to the goal in a second
        assert got == pytest.approx(expected)
    there = Scene.of([[1.0, 1.0]], [[0.3, 0.0]], goal=[[1.0, 1.0]])
    assert Tangent().velocity(there, 0.1).tolist() == [[[0.0, 0.0]]]


@pytest.mark.parametrize("distance", [1.0, 2.0, 4.0])
@pytest.mark.parametrize("aside", [-0.3, -0.1, 0.0, 0.2])
def test_a_standing_neighbor_turns_the_velocity_onto_the_nearer_tangent(distance, aside):
    place = np.array([[0.0, 0.0], [distance, aside]])
    scene = Scene.of(place, [[1.3, 0.0], [0.0, 0.0]], goal=[[30.0, 0.0], place[1]], preferred_speed=1.3, max_speed=2.0)
    chosen = Tangent().velocity(scene, 1.0)[0, 0]
    turn = math.atan2(abs(aside) - PAIR, distance)
    side = -math.copysign(1.0, aside) if aside != 0.0 else 1.0  # dead ahead: to the left
    length = 1.3 * math.cos(turn)
    expected = [length * math.cos(turn), side * length * math.sin(abs(turn))]
    assert chosen == pytest.approx(expected, abs=1e-9)


def threats_around(rng, count):
    """Return threats to a walker, its velocity, and the neighbours that make them."""
    threats, new = np.empty((MOST, THREAT)), np.zeros(THREAT)
    own, held = np.array([1.3, 0.0]), 0
    while held < count:
        place, velocity = rng.uniform(-4.0, 4.0, 2), rng.normal(0.0, 0.8, 2)
        if np.linalg.norm(place) > PAIR and threat_of_neighbor(
            new, *place, *own, *velocity, PAIR, 3.5, 15.0, True, 2.0
        ):
            held = insert(threats, held, new)
    return threats, own, held


def passes(threat, v):
    """Return whether a velocity passes a threat on either side, from the angle between it and the two tangents."""
    w = v - threat[1:3]
    if threat[0] == 2.0:
        return w @ threat[7:9] <= 1e-6
    if w @ threat[7:9] <= 0.0:
        return True
    sides = [threat[3] * w[1] - threat[4] * w[0], threat[5] * w[1] - threat[6] * w[0]]
    return sides[0] >= -1e-6 or sides[1] <= 1e-6


@pytest.mark.parametrize("cases", sizes(12, 40))
def test_the_least_change_is_the_least(cases):
    rng = np.random.default_rng(4)
    grid = np.stack(np.meshgrid(np.linspace(-2, 2, 101), np.linspace(-2, 2, 101)), axis=-1).reshape(-1, 2)
    found = 0
    for _ in range(cases):
        threats, own, held = threats_around(rng, rng.integers(1, 5))
        chosen = np.array(least_change(threats, held, np.empty((2 * MOST, 5)), np.empty(3), *own, 1.3, 2.0))
        free = [c for c in grid if np.linalg.norm(c) <= 2.0 and all(passes(t, c) for t in threats[:held])]
        if not all(passes(t, chosen) for t in threats[:held]):
            continue  # none is free in range, or only beyond the corners that are tried
        found += 1
        least = min((np.linalg.norm(c - own) for c in free), default=math.inf)
        assert np.linalg.norm(chosen - own) <= least + 1e-6
    assert found > 0.7 * cases


def test_dense_flows_do_not_touch():
    rng = np.random.default_rng(0)
    lattice = np.stack(np.meshgrid(np.arange(5.0), np.arange(4.0)), axis=-1).reshape(-1, 2) - [2.0, 0.0]
    up = np.stack([lattice[:, 0], -8.0 - lattice[:, 1]], axis=-1) + rng.uniform(-0.1, 0.1, (20, 2))
    right = np.stack([-8.0 - lattice[:, 1], lattice[:, 0]], axis=-1) + rng.uniform(-0.1, 0.1, (20, 2))
    way = np.concatenate([np.tile([0.0, 1.0], (20, 1)), np.tile([1.0, 0.0], (20, 1))])
    place = np.concatenate([up, right])
    scene = Scene.of(place, 1.3 * way, goal=place + 40.0 * way, preferred_speed=1.3)
    for _ in range(200):
        scene = Tangent().step(scene, 0.1)
        gaps = np.linalg.norm(scene.position[0][:, None] - scene.position[0][None], axis=-1) + 9.0 * np.eye(40)
        assert gaps.min() > 0.5
    assert np.mean(np.sum((scene.position[0] - place) * way, axis=-1)) > 15.0


def original(reference, name):
    """Return the steps of the original as it took them, one scene for each of its people, and the next velocities.

    It moves its people in turn: whoever comes later sees where the earlier ones already are.
    """
    data = np.load(reference / "crowdbot" / f"{name}_Tangent.npz")
    x, v, x_next, v_next = (data[key].astype(float) for key in ("x", "v", "x_next", "v_next"))
    A = x.shape[1]
    moved = np.tril(np.ones((A, A), dtype=bool), -1)[:, :, None]
    places, velocities = (
        np.where(moved, b[:, None], a[:, None]).reshape(-1, A, 2) for a, b in ((x, x_next), (v, v_next))
    )
    goal = np.repeat(data["goal"].astype(float), A, axis=0)
    return Scene.of(places, velocities, radius=0.2, goal=goal, preferred_speed=1.3, max_speed=2.0), v_next


@pytest.mark.parametrize("name", ["crossing", "corridor"])
def test_the_original_moves_the_same_way_mostly(reference, name):
    scene, after = original(reference, name)
    E, A = after.shape[:2]
    people = np.arange(A)

    def each(of_scenes):
        return of_scenes.reshape(E, A, A, -1)[:, people, people]

    chosen, velocity = each(Tangent().velocity(scene, 0.1)), each(scene.velocity)
    error = np.abs(chosen - after).max(axis=-1)
    apart = np.linalg.norm(each(scene.position)[:, :, None] - scene.position.reshape(E, A, A, 2), axis=-1)
    inside = np.sum(apart < PAIR, axis=-1) > 1  # besides oneself
    same = np.mean(np.sum((chosen - velocity) * (after - velocity), axis=-1) > 0.0)
    print(
        f"Tangent {name}: {np.mean(error < 1e-4):.1%} within 1e-4, median {np.median(error):.1e},"
        f" worst {error.max():.2f} m/s, {same:.0%} change to the same side; {inside.mean():.0%} are in another's"
        f" personal area, {np.mean(error[inside] < 1e-4):.1%} of them within 1e-4"
    )
    assert np.mean(error < 1e-4) > 0.6
    assert np.mean(error[inside] < 1e-4) > 0.99
    assert same > 0.88
    # what differs is who reacts, and to whom: those who react to nobody change by speed x time towards the goal
    way = each(scene.goal) - each(scene.position)
    change = 1.3 * way / np.linalg.norm(way, axis=-1, keepdims=True) - velocity
    change *= np.minimum(1.0, 0.13 / np.maximum(np.linalg.norm(change, axis=-1, keepdims=True), 1e-12))
    own, theirs = (np.abs(each_after - velocity - change).max(axis=-1) > 1e-4 for each_after in (chosen, after))
    wrong = error > 1e-4
    shares = [np.mean(wrong & own & ~theirs), np.mean(wrong & ~own & theirs), np.mean(wrong & own & theirs)]
    print("only ours react {:.1%}, only the original's {:.1%}, both, differently {:.1%}".format(*shares))
    assert not np.any(wrong & ~own & ~theirs)
    assert np.all(np.array(shares) < [0.11, 0.06, 0.23])


def test_walls_stop_and_are_followed():
    straight = Scene.of([[-5.0, 0.0]], [[1.3, 0.0]], goal=[[9.0, 0.0]], walls=[[(0.0, -5.0), (0.0, 5.0)]])
    slanted = straight.replace(goal=np.array([[[9.0, 9.0]]]))
    for _ in range(100):
        straight, slanted = Tangent().step(straight, 0.1), Tangent().step(slanted, 0.1)
        assert straight.position[0, 0, 0] <= -0.25
        assert slanted.position[0, 0, 0] <= -0.25 or slanted.position[0, 0, 1] > 4.9
    assert straight.position[0, 0, 0] > -0.3
    assert slanted.position[0, 0, 1] > 3.0
    beside = Scene.of([[0.0, 0.26]], [[1.3, 0.0]], goal=[[9.0, 0.26]], walls=[[(-9.0, 0.0), (9.0, 0.0)]])
    assert Tangent().velocity(beside, 0.1)[0, 0] == pytest.approx([1.3, 0.0])


def test_external_agents_are_given_the_way():
    robot = Scene.of(
        [[-2.0, 0.0], [0.0, -2.2]],
        [[1.3, 0.0], [0.0, 1.3]],
        goal=[[9.0, 0.0], [0.0, 9.0]],
        radius=[0.25, 0.6],
        external=[False, True],
        max_speed=2.0,
    )
    nearest = math.inf
    for _ in range(60):
        robot = Tangent().step(robot, 0.05)
        nearest = min(nearest, float(np.linalg.norm(robot.position[0, 0] - robot.position[0, 1])))
    assert nearest > 0.85  # bodies alone
    assert robot.velocity[0, 1].tolist() == [0.0, 1.3]


def test_two_at_the_same_place_part():
    scene = Scene.of(np.zeros((2, 2)), goal=[[9.0, 0.0], [9.0, 0.0]])
    for _ in range(60):
        scene = Tangent().step(scene, 0.1)
    assert np.linalg.norm(scene.position[0, 0] - scene.position[0, 1]) > 0.5


def test_wrong_input_is_explained():
    with pytest.raises(InputError, match="personal_area = -0.1"):
        Tangent(personal_area=-0.1)
    with pytest.raises(InputError, match="max_speed = -1.0"):
        Tangent(max_speed=-1.0)

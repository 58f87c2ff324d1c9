"""Contacts: overlaps end, walls hold, the slow twin, and crowds that are impossible."""

import math

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, Scene
from crowdbot.world import ContactModel

ROOM = [(0.0, 0.0), (0.0, 8.0), (8.0, 8.0), (8.0, 0.0)]  # clockwise: people are inside
PILLAR = [(3.0, 3.0), (4.0, 3.0), (4.0, 4.0), (3.0, 4.0)]
SCREEN = [(5.0, 1.0), (5.0, 4.0)]
KINDS = [ContactModel(), ContactModel("force"), ContactModel("force", stiffness=1e6)]
both = pytest.mark.parametrize("contact", KINDS, ids=["position", "force", "stiff force"])


def crowd(seed=0, A=40, E=1, width=8.0, walls=(ROOM, PILLAR, SCREEN), **more):
    rng = np.random.default_rng(seed)
    place = rng.uniform(0.3, width - 0.3, (E, A, 2))
    return Scene.of(
        place, rng.normal(0.0, 0.5, place.shape), radius=rng.uniform(0.15, 0.35, (E, A)), walls=walls, **more
    )


def overlaps(scene, e=0):
    """Return how deep every pair overlaps [m]."""
    place, radius = scene.position[e], scene.radius[e]
    gap = np.hypot(*np.moveaxis(place[:, None] - place[None], -1, 0)) - radius[:, None] - radius[None]
    np.fill_diagonal(gap, 1.0)
    return np.maximum(0.0, -gap)


def by_hand(scene, contact, dt):
    """The slow twin without walls: where everybody is after one look at all contacts."""
    place, radius, after = scene.position[0], scene.radius[0], scene.position[0].copy()
    gain = contact.stiffness * dt * dt
    for i in np.flatnonzero(scene.active[0] & ~scene.external[0]):
        pushes = []
        for j in np.flatnonzero(scene.active[0] & scene.visible[0]):
            away = place[i] - place[j]
            distance = math.hypot(*away)
            depth = radius[i] + radius[j] - distance
            if i != j and distance < (radius[i] + radius[j]) * (1.0 - 1e-4):
                half = 0.5 if contact.variant == "position" and not scene.external[0, j] else 1.0
                pushes.append(half * depth * away / distance)
        if pushes:
            count = len(pushes)
            share = 1.5 / (count + 0.5) if contact.variant == "position" else gain / (1.0 + 2.0 * count * gain)
            shift = share * np.sum(pushes, axis=0)
            after[i] += shift * min(1.0, radius[i] / max(math.hypot(*shift), 1e-300))
    return after


def rooms(scene):
    """Return for each agent which of the places that walls keep apart it is in."""
    x, y = scene.position[..., 0], scene.position[..., 1]
    outside = (x < 0.0) | (x > 8.0) | (y < 0.0) | (y > 8.0)
    return outside * 2 + ((x > 3.0) & (x < 4.0) & (y > 3.0) & (y < 4.0))


@pytest.mark.parametrize("contact", [ContactModel(iterations=1), ContactModel("force"), ContactModel("force", 4000.0)])
@pytest.mark.parametrize("dt", [0.01, 0.5])
def test_the_kernel_does_what_the_slow_twin_does(contact, dt):
    robots = np.arange(40) < 4
    hidden, here = np.arange(40) != 7, np.arange(40) != 9
    scene = crowd(1, width=4.0, walls=(), external=robots, visible=hidden, active=here)
    after = contact.resolve_overlaps(scene, scene, dt)
    np.testing.assert_allclose(after.position[0, here], by_hand(scene, contact, dt)[here], atol=1e-12)
    assert np.count_nonzero(after.position != scene.position) > 30


def test_two_share_the_push_and_a_robot_takes_none():
    pair = Scene.of([[0.0, 0.0], [0.3, 0.0]], radius=0.25)
    apart = ContactModel().resolve_overlaps(pair, pair, 0.1)
    np.testing.assert_allclose(apart.position[0], [[-0.1, 0.0], [0.4, 0.0]], atol=1e-12)
    robot = pair.replace(external=np.array([[True, False]]))
    apart = ContactModel().resolve_overlaps(robot, robot, 0.1)
    np.testing.assert_allclose(apart.position[0], [[0.0, 0.0], [0.5, 0.0]], atol=1e-12)
    ghost = robot.replace(visible=np.array([[False, True]]))
    assert ContactModel().resolve_overlaps(ghost, ghost, 0.1).digest() == ghost.digest()


def test_who_does_not_touch_keeps_every_byte():
    scene = Scene.of([[1.0, 1.0], [1.6, 1.0], [6.0, 6.0]], [[1.0, 0.0]] * 3, radius=0.3, walls=[ROOM])
    assert ContactModel().resolve_overlaps(scene, scene, 0.1).digest() == scene.digest()


def test_overlaps_of_a_crowd_end_in_a_few_steps():
    scene = crowd(2, A=60)
    assert overlaps(scene).max() > 0.1
    for _ in range(30):
        scene = ContactModel().resolve_overlaps(scene, scene, 0.1)
    assert overlaps(scene).max() < 1e-3


@both
@pytest.mark.parametrize("dt", [1e-3, 0.1, 10.0])
def test_overlaps_never_grow_and_nobody_goes_farther_than_a_radius(contact, dt):
    scene = crowd(3, A=50, width=4.0, walls=())
    for _ in range(5):
        after = contact.resolve_overlaps(scene, scene, dt)
        moved = np.hypot(*np.moveaxis(after.position - scene.position, -1, 0))
        assert np.all(moved <= scene.radius + 1e-12)
        assert overlaps(after).sum() <= overlaps(scene).sum() + 1e-9
        scene = after


def test_a_soft_force_accelerates_by_stiffness_times_overlap():
    pair = Scene.of([[0.0, 0.0], [0.4, 0.0]], radius=0.25)
    after = ContactModel("force", stiffness=50.0).resolve_overlaps(pair, pair, 1e-4)
    np.testing.assert_allclose(after.velocity[0, :, 0] / 1e-4, [-5.0, 5.0], rtol=1e-5)


def test_a_pair_pushed_by_force_comes_apart_without_swinging_at_any_step():
    for dt in (0.01, 0.1, 1.0, 100.0):
        scene = Scene.of([[0.0, 0.0], [0.2, 0.0]], radius=0.25)
        for _ in range(50):
            scene = ContactModel("force", stiffness=500.0).resolve_overlaps(scene, scene, dt)
            assert scene.position[0, 1, 0] - scene.position[0, 0, 0] <= 0.5 + 1e-9
        assert scene.position[0, 1, 0] - scene.position[0, 0, 0] > 0.45


@both
def test_velocities_follow_the_push_up_to_the_maximum_speed(contact):
    scene = crowd(4, width=4.0, walls=())
    after = contact.resolve_overlaps(scene, scene, 0.05)
    shift = (after.position - scene.position) / 0.05
    free = np.hypot(*np.moveaxis(scene.velocity + shift, -1, 0)) < scene.max_speed
    np.testing.assert_allclose(after.velocity[free], (scene.velocity + shift)[free], atol=1e-9)
    most = np.maximum(scene.max_speed, np.hypot(*np.moveaxis(scene.velocity, -1, 0)))
    assert np.all(np.hypot(*np.moveaxis(after.velocity, -1, 0)) <= most + 1e-9)


def test_who_walks_into_a_wall_slides_along_it():
    before = Scene.of([[4.0, 0.5]], [[1.0, -1.0]], radius=0.3, max_speed=2.0, walls=[ROOM])
    after = ContactModel().resolve_overlaps(before, before.advance(before.velocity, 0.3), 0.3)
    np.testing.assert_allclose(after.position[0, 0], [4.3, 0.3], atol=1e-9)
    np.testing.assert_allclose(after.velocity[0, 0], [1.0, -2.0 / 3.0], atol=1e-9)


def test_a_corner_holds():
    before = Scene.of([[0.5, 0.5]], [[-1.0, -1.2]], radius=0.3, walls=[ROOM])
    after = ContactModel().resolve_overlaps(before, before.advance(before.velocity, 1.0), 1.0)
    np.testing.assert_allclose(after.position[0, 0], [0.3, 0.3], atol=1e-9)


@pytest.mark.parametrize("speed", [0.5, 5.0, 50.0, 1e6])
def test_nobody_goes_through_a_wall_however_fast(speed):
    scene = crowd(5, A=60, walls=(ROOM, PILLAR))
    scene = scene.replace(active=rooms(scene) == 0)
    rng = np.random.default_rng(0)
    for _ in range(20):
        velocity = rng.normal(0.0, speed, scene.velocity.shape)
        scene = ContactModel().resolve_overlaps(scene, scene.advance(velocity, 0.1), 0.1)
        assert np.all(rooms(scene)[scene.active] == 0)


def test_nobody_is_pushed_through_a_thin_wall():
    place = [[5.0 - 0.01 - 0.05 * k, 2.0 + 0.01 * k] for k in range(20)]  # a heap beside the screen
    scene = Scene.of(place, radius=0.3, walls=[SCREEN])
    for _ in range(50):
        after = ContactModel().resolve_overlaps(scene, scene, 0.1)
        near = (after.position[0, :, 1] > 1.0) & (after.position[0, :, 1] < 4.0)
        came = (scene.position[0, :, 1] > 1.0) & (scene.position[0, :, 1] < 4.0)
        crossed = (scene.position[0, :, 0] < 5.0) != (after.position[0, :, 0] < 5.0)
        assert not np.any(crossed & near & came)
        scene = after
    assert overlaps(scene).max() < 0.01


def test_who_stands_in_a_pillar_comes_out_of_it():
    scene = Scene.of([[[3.1, 3.5]], [[3.5, 3.2]]], radius=0.3, walls=[PILLAR])
    for _ in range(3):
        scene = ContactModel().resolve_overlaps(scene, scene, 0.1)
    np.testing.assert_allclose(scene.position[:, 0], [[2.7, 3.5], [3.5, 2.7]], atol=1e-6)


def test_a_thin_pillar_does_not_suck_anybody_through():
    board = [(0.0, 0.0), (4.0, 0.0), (4.0, 0.05), (0.0, 0.05)]
    scene = Scene.of([[2.0, 0.06]], radius=0.3, walls=[board])
    after = ContactModel().resolve_overlaps(scene, scene, 0.1)
    np.testing.assert_allclose(after.position[0, 0], [2.0, 0.35], atol=1e-9)


def test_people_in_one_place_come_apart():
    scene = Scene.of(np.zeros((12, 2)), radius=0.25)
    for _ in range(60):
        scene = ContactModel().resolve_overlaps(scene, scene, 0.1)
    assert overlaps(scene).max() < 0.01
    assert np.abs(scene.position).max() < 3.0


@both
@pytest.mark.parametrize("A", [30, 700])
def test_batches_numbers_and_threads_do_not_matter(contact, A):
    scene = crowd(6, A=A, width=8.0)
    before = scene.replace(position=scene.position - 0.05)
    alone = contact.resolve_overlaps(before, scene, 0.1)
    giants = scene.replace(radius=scene.radius * 2.0)
    fields = ("position", "velocity", "radius")
    together = {name: np.concatenate([getattr(giants, name), getattr(scene, name)]) for name in fields}
    start = {**together, "position": np.repeat(before.position, 2, axis=0)}
    batch = contact.resolve_overlaps(Scene.of(**start, walls=scene.walls), Scene.of(**together, walls=scene.walls), 0.1)
    assert batch.position[1].tobytes() == alone.position[0].tobytes()
    order = np.random.default_rng(0).permutation(A)
    mixed = [Scene.of(*(getattr(s, n)[:, order] for n in fields[:2]), radius=s.radius[:, order], walls=s.walls)
             for s in (before, scene)]  # fmt: skip
    assert contact.resolve_overlaps(*mixed, 0.1).position.tobytes() == alone.position[:, order].tobytes()
    most = numba.get_num_threads()
    numba.set_num_threads(1)
    one = contact.resolve_overlaps(before, scene, 0.1)
    numba.set_num_threads(most)
    assert one.digest() == alone.digest()


@both
@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000), st.floats(1e-4, 100.0), st.floats(0.1, 8.0), st.integers(0, 60))
def test_an_impossible_crowd_takes_a_bounded_step(contact, seed, dt, width, A):
    scene = crowd(seed, A=A, width=0.6 + width)
    here = np.random.default_rng(seed).random((1, A)) < 0.8
    scene = scene.replace(active=here, position=np.where(here[..., None], scene.position, np.nan))
    before = scene.replace(position=np.where(here[..., None], [4.0, 2.0], np.nan))
    after = contact.resolve_overlaps(before, scene, dt)
    assert np.all(np.isfinite(after.position[here]))
    assert np.all(np.isfinite(after.velocity[here]))
    assert np.all(np.hypot(*(after.position - scene.position)[here].T) <= 8.0 * math.sqrt(2.0) + 1.0)
    assert np.array_equal(np.isnan(after.position), np.isnan(scene.position))


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"variant": "forc"}, 'variant="forc" must be position or force, did you mean'),
        ({"stiffness": 0.0}, 'stiffness="0.0" must be above 0 1/s2'),
        ({"stiffness": math.nan}, 'stiffness="nan" is not finite'),
        ({"iterations": 0}, 'iterations="0" must be at least 1 and at most 1000'),
    ],
)
def test_a_wrong_contact_is_explained(values, message):
    with pytest.raises(InputError, match=message):
        ContactModel(**values)

"""PlanarWorld with all that is off by default: nothing changes unasked, mazes, contacts, symmetry, substeps."""

import math

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, Scene, Twist, stream
from crowdbot.models import ORCA, Mixture, SocialForce
from crowdbot.world import (
    ContactModel,
    CrowdLimits,
    DifferentialDrive,
    JourneyAssignment,
    PeopleSource,
    PlanarWorld,
    Router,
    WaypointSequence,
    Zone,
)

ROOM = [(0.0, 0.0), (0.0, 8.0), (12.0, 8.0), (12.0, 0.0)]  # clockwise: people are inside
MAZE = [ROOM, [(4.0, 0.0), (4.0, 6.5)], [(8.0, 8.0), (8.0, 1.5)]]


def maze(seed, A=20, E=1, **more):
    rng = np.random.default_rng(seed)
    place, goal = rng.uniform((0.4, 0.4), (3.6, 7.6), (E, A, 2)), rng.uniform((8.4, 0.4), (11.6, 7.6), (E, A, 2))
    return Scene.of(place, goal=goal, walls=MAZE, radius=0.25, **more)


def everything(scene, seed=0, **more):
    far = Zone(((8.4, 0.4), (11.6, 0.4), (11.6, 7.6), (8.4, 7.6)), aim="random")
    near = Zone(((0.4, 0.4), (3.6, 0.4), (3.6, 7.6), (0.4, 7.6)), aim="random")
    settings = {
        "router": Router.of(MAZE, 0.3),
        "contact": ContactModel(),
        "limits": CrowdLimits(max_acceleration=5.0),
        "journeys": JourneyAssignment((WaypointSequence((far, near, far)),)),
        "sources": (PeopleSource(near, WaypointSequence((far,)), rate=0.5),),
        "heading_jitter": 1e-3,
        "substeps": 2,
    } | more
    which = np.arange(scene.shape[1]) % 2
    return PlanarWorld(scene, Mixture((ORCA(), SocialForce()), which), {}, 0.1, seed, **settings)


def test_nothing_changes_unasked():
    scene = maze(1)
    world = PlanarWorld(scene, ORCA(), {}, 0.1)
    expected, rng = scene, stream(0, "crowd")
    for k in range(20):
        expected = ORCA().step(expected, 0.1, rng).replace(time=(k + 1) / 10)
        assert world.step({}).digest() == expected.digest()
    assert dict(world.scene.memory) == {}
    assert world.scene.goal is scene.goal


@pytest.mark.parametrize("model", [ORCA(), SocialForce()], ids=["orca", "social force"])
def test_nobody_stands_behind_a_wall_for_ever(model):
    settings = {"leave_radius": 0.4, "heading_jitter": 1e-3, "contact": ContactModel()}
    led = PlanarWorld(maze(2), model, {}, 0.1, router=Router.of(MAZE, 0.3), **settings)
    straight = PlanarWorld(maze(2), model, {}, 0.1, **settings)
    while led.clock.time < 60.0 and np.any(led.scene.active):
        led.step({}), straight.step({})
    assert not np.any(led.scene.active)
    assert np.all(straight.scene.active)


def test_contacts_keep_a_crowd_without_avoidance_apart_and_inside():
    blind = ORCA(max_neighbors=0, time_horizon_walls=1e-3)
    world = PlanarWorld(maze(3, A=40), blind, {}, 0.1, contact=ContactModel(iterations=20))
    for _ in range(100):
        scene = world.step({})
    place = scene.position[0]
    gap = np.hypot(*np.moveaxis(place[:, None] - place[None], -1, 0)) + np.eye(40)
    assert gap.min() > 0.5 - 0.1
    assert np.all((place > 0.2) & (place < np.array([11.8, 7.8])))
    assert np.all((np.abs(place[:, 0] - 4.0) > 0.2) | (place[:, 1] > 6.5))


def test_people_are_pushed_aside_by_a_robot_that_does_not_stop():
    scene = Scene.of([[0.0, 0.0], [1.0, 0.05]], external=[True, False], heading=0.0, radius=0.3)
    blind = ORCA(max_neighbors=0)
    world = PlanarWorld(scene, blind, {0: DifferentialDrive(max_acceleration=100.0)}, 0.1, contact=ContactModel())
    for _ in range(30):
        scene = world.step({0: Twist(1.0, 0.0)})
        assert math.dist(scene.position[0, 0], scene.position[0, 1]) > 0.6 - 1e-3
    assert scene.position[0, 0].tolist() == pytest.approx([3.0, 0.0])


def test_the_symmetry_breaker_lets_people_pass_who_meet_exactly():
    def meet(heading_jitter, seed=0):
        scene = Scene.of([[-4.0, 0.0], [4.0, 0.0]], goal=[[4.0, 0.0], [-4.0, 0.0]])
        # both look only a moment ahead and share the work evenly, so that they stop in front of each other
        world = PlanarWorld(
            scene, SocialForce(), {}, 0.05, seed=seed, heading_jitter=heading_jitter, contact=ContactModel()
        )
        for _ in range(600):
            scene = world.step({})
        return scene

    stuck, passed = meet(0.0), meet(1e-3)
    assert np.all(np.abs(stuck.position[..., 0]) < 3.0)
    assert np.all(np.hypot(*np.moveaxis(passed.position - passed.goal, -1, 0)) < 0.3)
    assert meet(1e-3).digest() == passed.digest()
    assert meet(1e-3, seed=1).digest() != passed.digest()


def test_the_symmetry_breaker_turns_preferred_velocities_by_no_more_than_asked():
    scene = Scene.of(np.zeros((50, 2)) + np.arange(50)[:, None] * 9.0, preferred_velocity=np.tile([1.0, 0.0], (50, 1)))
    after = PlanarWorld(scene, ORCA(), {}, 0.1, heading_jitter=0.01).step({})
    angle = np.arctan2(after.velocity[0, :, 1], after.velocity[0, :, 0])
    assert np.abs(angle).max() <= 0.01
    assert np.abs(angle).max() > 0.008
    assert np.array_equal(after.preferred_velocity, scene.preferred_velocity)


def test_the_angle_of_a_person_follows_the_identity_and_not_the_place_in_the_arrays():
    scene = Scene.of(np.arange(6)[:, None] * [9.0, 0.0], preferred_velocity=np.tile([1.0, 0.0], (6, 1)))
    first, other = (PlanarWorld(scene, ORCA(), {}, 0.1, heading_jitter=0.1) for _ in range(2))
    first.step({})
    other.ids[:] = other.ids[:, ::-1]
    for world in (first, other):  # the identities of the second one change while it runs
        world.scene = scene
    one, two = first.step({}).velocity, other.step({}).velocity
    assert np.abs(one[0, :, 1]).max() > 0.01
    assert np.array_equal(one[0, :, 1], two[0, ::-1, 1])
    first.ids[:] = first.ids[:, ::-1]
    first.scene = scene
    assert np.array_equal(first.step({}).velocity, two)


def test_substeps_are_steps_between_which_the_robot_goes_on():
    scene = maze(4, external=np.arange(20) == 0)
    scene = scene.replace(velocity=np.where((np.arange(20) == 0)[None, :, None], [0.5, 0.0], scene.velocity))
    world = PlanarWorld(scene, ORCA(), {}, 0.4, substeps=4, robot_margin=0.0)
    rng, expected = stream(0, "crowd"), scene
    for _ in range(4):
        expected = ORCA().step(expected, 0.1, rng)
    after = world.step({})
    assert after.position[:, 1:].tobytes() == expected.position[:, 1:].tobytes()
    assert after.time == 0.4


def test_a_stiff_model_needs_substeps_and_has_them():
    crowd = Scene.of([[0.0, 0.0], [0.45, 0.0]], preferred_speed=0.0, max_speed=1.0, radius=0.25)
    contact = ContactModel("force", stiffness=2000.0)
    coarse = PlanarWorld(crowd, ORCA(max_neighbors=0), {}, 0.5, contact=contact).step({})
    fine = PlanarWorld(crowd, ORCA(max_neighbors=0), {}, 0.5, contact=contact, substeps=50).step({})
    gaps = [scene.position[0, 1, 0] - scene.position[0, 0, 0] for scene in (coarse, fine)]
    assert 0.45 < gaps[0] <= 0.5 + 1e-9
    assert gaps[1] == pytest.approx(0.5, abs=0.01)


def test_everything_at_once_is_the_same_alone_in_a_batch_and_with_one_thread():
    parts = [maze(seed, A=16, active=np.arange(16) < 10) for seed in (5, 6)]
    fields = ("position", "goal", "active", "radius")
    together = Scene.of(**{n: np.concatenate([getattr(p, n) for p in parts]) for n in fields}, walls=MAZE)
    batch, alone = everything(together, 7), everything(parts[1], 8)
    most = numba.get_num_threads()
    numba.set_num_threads(1)
    again = everything(parts[1], 8)
    for _ in range(120):
        again.step({})
    numba.set_num_threads(most)
    for _ in range(120):
        batch.step({}), alone.step({})
    assert alone.scene.digest() == again.scene.digest()
    assert alone.scene.position[0].tobytes() == batch.scene.position[1].tobytes()
    assert alone.scene.heading[0].tobytes() == batch.scene.heading[1].tobytes()
    assert alone.ids[0].tolist() == batch.ids[1].tolist()
    assert alone.ids.max() > 15


def test_any_whole_number_is_a_seed():
    for seed in (2**200, -5):
        assert everything(maze(1, A=4), seed).step({}).time == 0.1


def test_everything_at_once_goes_along_when_people_are_renumbered():
    scene = maze(9, A=16)
    order = np.random.default_rng(0).permutation(16)
    mixed = Scene.of(scene.position[:, order], goal=scene.goal[:, order], walls=MAZE, radius=0.25)
    first = everything(scene, sources=())
    second = PlanarWorld(
        mixed, Mixture((ORCA(), SocialForce()), (np.arange(16) % 2)[order]), {}, 0.1, router=first.router, ids=order,
        contact=first.contact, limits=first.limits, journeys=first.journeys, heading_jitter=1e-3, substeps=2,
    )  # fmt: skip
    for _ in range(100):
        first.step({}), second.step({})
    assert second.scene.position.tobytes() == first.scene.position[:, order].tobytes()


def test_a_world_can_go_on_from_a_scene_of_another():
    first = everything(maze(10), sources=(), journeys=None)
    for _ in range(30):
        first.step({})
    second = everything(first.scene, sources=(), journeys=None)
    assert second.step({}).digest() == first.step({}).digest()


def hostile_walls(rng):
    """Return a room with boxes, slivers and screens that overlap, touch and stick out."""
    boxes = [np.array([(0, 0), (1, 0), (1, 1), (0, 1)]) * rng.choice([1e-9, 0.05, 2.0], 2) for _ in range(4)]
    lines = [np.array([(0.0, 0.0), rng.choice([1e-12, 1.0, 6.0], 2)]) for _ in range(3)]
    return [ROOM, *(shape + rng.integers(0, 12, 2) for shape in [*boxes, *lines])]


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000))
def test_an_impossible_crowd_on_an_impossible_stage_takes_bounded_steps(seed):
    rng = np.random.default_rng(seed)
    walls = hostile_walls(rng)
    place = rng.integers(-2, 14, (1, 25, 2)) + rng.choice(
        [0.0, 0.1, 0.5], (1, 25, 2)
    )  # in walls, outside, in one place
    scene = Scene.of(place, goal=rng.integers(-2, 14, (1, 25, 2)), radius=rng.choice([0.05, 0.3, 0.6], (1, 25)),
                     active=rng.random(25) < 0.8, walls=walls)  # fmt: skip
    on = {"router": Router.of(walls, 0.3, unreachable="nearest"), "contact": ContactModel(), "heading_jitter": 1e-3}
    world = PlanarWorld(scene, ORCA(), {}, float(rng.choice([0.01, 0.1, 1.0])), **on)
    for _ in range(15):
        before = world.scene
        after = world.step({})
        assert np.all(np.isfinite(after.position[after.active]))
        moved = np.hypot(*(after.position - before.position)[after.active].T)
        # as far as the model goes, a radius for bodies, and out of a few walls
        assert np.all(moved <= (before.max_speed * world.dt + 6.0 * before.radius)[after.active] + 1e-9)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"heading_jitter": -0.1}, "heading_jitter -0.1 rad must be from 0 to pi"),
        ({"heading_jitter": math.nan}, "heading_jitter nan rad"),
        ({"substeps": 0}, "substeps = 0 must be a whole number from 1 to 10000"),
        ({"substeps": 1.5}, "substeps = 1.5"),
        ({"router": Router.of([*MAZE, [(4.0, 6.0), (4.0, 8.0)]])}, "cannot be reached"),
    ],
)
def test_a_wrong_world_is_explained(changes, message):
    with pytest.raises(InputError, match=message):
        PlanarWorld(maze(0), ORCA(), {}, 0.1, **changes)

"""Reactions of people to robots: what each kind does with several models, who reacts, and when."""

from __future__ import annotations

import math

import numpy as np
import pytest

from crowdbot.core import InputError, Scene, Twist
from crowdbot.models import ORCA, CollisionFreeSpeed, PowerLaw, SocialForce
from crowdbot.world import (
    REACTIONS,
    DifferentialDrive,
    PeopleSource,
    PhysicsWorld,
    PlanarWorld,
    Robot,
    RobotReaction,
    RobotReactions,
    WaypointSequence,
    Zone,
    add_person,
    join_worlds,
    people_by_reaction,
    put_environments,
    reaction_codes,
    remove_person,
    select_environments,
)

MODELS = {"orca": ORCA, "social-force": SocialForce, "collision-free-speed": CollisionFreeSpeed, "power-law": PowerLaw}
ROBOT, PERSON = 0, 1


def meeting(kind=None, *, model=ORCA, robot=(0.0, 0.0), person=(6.0, 0.4), goal=(-6.0, 0.4), walls=(), seed=0, **how):
    """Return a world with a robot that looks along x, and a person who walks towards it."""
    scene = Scene.of(
        [robot, person], goal=[robot, goal], heading=[0.0, math.pi], velocity=[(0.0, 0.0), (-1.3, 0.0)],
        external=[True, False], radius=[0.3, 0.25], walls=walls,
    )  # fmt: skip
    drive = DifferentialDrive(max_speed=2.0)
    reactions = None if kind is None else RobotReactions([[(RobotReaction(kind, **how), 1.0)]], members=[-1, 0])
    return PlanarWorld(scene, model(), {ROBOT: drive}, dt=0.05, seed=seed, reactions=reactions)


def drive(world, seconds, speed=0.0):
    """Advance a world, and return positions ``[T, 2, 2]``, headings of the person and the codes of their reaction."""
    rows = []
    for _ in range(round(seconds / 0.05)):
        scene = world.step({ROBOT: Twist(speed, 0.0)})
        codes = reaction_codes(scene)
        rows.append((scene.position[0].copy(), scene.heading[0, PERSON], 0 if codes is None else codes[0, PERSON]))
    return tuple(np.array(column) for column in zip(*rows, strict=True))


def distances(position):
    return np.hypot(*(position[:, PERSON] - position[:, ROBOT]).T)


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
def test_curious_people_stop_before_the_robot_look_at_it_and_walk_on(model):
    position, heading, code = drive(meeting("curious", model=model, duration=8.0), 24.0)
    near = distances(position)
    at = np.flatnonzero(code == REACTIONS.index("curious"))
    assert len(at) * 0.05 == pytest.approx(8.0, abs=0.11)
    assert near[at[-1]] == pytest.approx(0.3 + 0.25 + 1.0, abs=0.2)
    toward = position[at[-1], ROBOT] - position[at[-1], PERSON]
    turn = math.remainder(heading[at[-1]] - math.atan2(toward[1], toward[0]), 2.0 * math.pi)
    assert abs(turn) < 0.1
    assert position[-1, PERSON, 0] < -2.0  # it has passed the robot


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
def test_scared_people_keep_farther_away_and_walk_slower(model):
    plain, *_ = drive(meeting(model=model), 14.0, 0.3)
    scared, _, code = drive(meeting("scared", model=model), 14.0, 0.3)
    assert distances(scared).min() > distances(plain).min() + 0.25
    assert np.any(code == REACTIONS.index("scared"))
    assert scared[-1, PERSON, 0] > plain[-1, PERSON, 0]


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
def test_blocking_people_stand_in_front_of_the_robot(model):
    position, _, code = drive(meeting("block", model=model, duration=60.0), 15.0)
    x, y = (position[-1, PERSON] - position[-1, ROBOT]).tolist()
    assert code[-1] == REACTIONS.index("block")
    assert 0.6 < x < 1.8
    assert abs(y) < 0.4


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
def test_followers_walk_behind_the_robot(model):
    position, _, code = drive(meeting("follow", model=model, person=(3.5, 1.2), goal=(-6.0, 1.2)), 12.0, 0.5)
    x, _ = (position[-1, PERSON] - position[-1, ROBOT]).tolist()
    assert code[-1] == REACTIONS.index("follow")
    assert -2.5 < x < -0.8
    assert position[-1, PERSON, 0] > 3.0  # with the robot, against the own way


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_people_step_out_of_the_lane_of_a_robot_and_walk_on(side):
    world = meeting("give-way", person=(6.0, 0.1 * side), goal=(-6.0, 0.1 * side), gap=0.4, duration=20.0)
    position, _, code = drive(world, 16.0, 1.0)
    passing = np.argmin(np.abs(position[:, PERSON, 0] - position[:, ROBOT, 0]))
    assert code[passing] == REACTIONS.index("give-way")
    assert side * position[passing, PERSON, 1] > 0.3 + 0.25 + 0.3
    assert position[-1, PERSON, 0] < position[passing, PERSON, 0] - 2.0


def test_people_stop_before_the_lane_of_a_robot():
    """A person whose way crosses the lane waits beside it; without the reaction they cross before the robot."""
    how = {"person": (4.0, 3.0), "goal": (4.0, -4.0), "field_of_view": 2.0 * math.pi, "duration": 30.0}
    position, _, _ = drive(meeting("give-way", **how), 4.0, 0.8)
    assert position[:, PERSON, 1].min() > 0.7
    position, _, _ = drive(meeting("regular", **how), 4.0, 0.8)
    assert position[:, PERSON, 1].min() < 0.5


def test_nobody_gives_way_to_a_standing_robot():
    plain, *_ = drive(meeting(), 8.0)
    position, *_ = drive(meeting("give-way"), 8.0)
    np.testing.assert_allclose(position, plain, atol=0.02)


def test_people_turn_to_the_robot_while_they_walk():
    position, heading, code = drive(meeting("look", person=(4.0, 2.0), goal=(-6.0, 2.0)), 4.0)
    way = np.diff(position[:, PERSON], axis=0)
    walking = np.arctan2(way[:, 1], way[:, 0])
    turn = (heading[1:] - walking + math.pi) % (2.0 * math.pi) - math.pi
    assert turn[code[1:] == 8].max() > 0.6  # to the left, where the robot is
    assert np.abs(turn).max() <= math.pi / 4.0 + 0.05
    plain, *_ = drive(meeting(person=(4.0, 2.0), goal=(-6.0, 2.0)), 4.0)
    np.testing.assert_array_equal(position, plain)


def test_surprised_people_stop_and_look():
    position, heading, code = drive(meeting("look", speed=0.0, duration=30.0), 6.0)
    assert code[-1] == REACTIONS.index("look")
    assert np.ptp(position[-20:, PERSON], axis=0).max() < 1e-6
    x, y = (position[-1, ROBOT] - position[-1, PERSON]).tolist()
    assert math.remainder(heading[-1] - math.atan2(y, x), 2.0 * math.pi) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
def test_who_ignores_robots_walks_as_without_any(model):
    position, _, code = drive(meeting("ignore", model=model), 8.0, 0.4)
    plain, *_ = drive(meeting(model=model, robot=(0.0, 500.0)), 8.0, 0.4)
    np.testing.assert_array_equal(position[:, PERSON], plain[:, PERSON])
    assert set(code) == {REACTIONS.index("ignore")}


def test_who_is_impassive_avoids_the_robot_as_an_obstacle():
    position, *_ = drive(meeting("impassive", person=(6.0, 0.2), goal=(-6.0, 0.2)), 8.0, 0.6)
    plain, *_ = drive(meeting(person=(6.0, 0.2), goal=(-6.0, 0.2)), 8.0, 0.6)
    assert distances(position).min() > 0.3 + 0.25 - 0.05
    assert not np.array_equal(position, plain)
    still, *_ = drive(meeting("impassive", person=(6.0, 0.2), goal=(-6.0, 0.2)), 8.0)
    np.testing.assert_array_equal(still, drive(meeting(person=(6.0, 0.2), goal=(-6.0, 0.2)), 8.0)[0])


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
def test_regular_people_walk_as_without_reactions(model):
    position, _, code = drive(meeting("regular", model=model), 8.0, 0.4)
    np.testing.assert_array_equal(position, drive(meeting(model=model), 8.0, 0.4)[0])
    assert set(code) == {0}


def test_a_reaction_begins_at_its_distance():
    for distance in (1.5, 3.0, 5.0):
        position, _, code = drive(meeting("look", distance=distance), 4.5)
        first = int(np.argmax(code > 0))
        assert distances(position)[first - 1] <= distance
        assert distances(position)[first - 1] > distance - 0.14


def test_robots_behind_are_not_seen_unless_the_field_of_view_is_wide():
    away = {"person": (3.0, 0.0), "goal": (9.0, 0.0)}
    for angle, seen in ((math.pi, False), (2.0 * math.pi, True)):
        world = meeting("look", field_of_view=angle, **away)
        world.scene = world.scene.replace(heading=np.array([[0.0, 0.0]]))
        _, _, code = drive(world, 0.5)
        assert bool(np.any(code)) is seen


def test_robots_behind_walls_are_not_seen():
    wall = ((3.0, -2.0), (3.0, 2.0))
    still = {"person": (5.0, 0.0), "goal": (5.0, 0.0), "distance": 8.0}
    assert not np.any(drive(meeting("look", walls=[wall], **still), 0.5)[2])
    assert np.any(drive(meeting("look", **still), 0.5)[2])


def test_a_reaction_ends_soon_after_the_robot_is_lost():
    world = meeting("look", person=(3.0, 1.0), goal=(3.0, 1.0), duration=1000.0, distance=4.0)
    _, _, code = drive(world, 12.0, -1.0)
    seconds = np.count_nonzero(code) * 0.05
    assert seconds == pytest.approx(math.sqrt(36.0 - 1.0) - 3.0 + 1.0, abs=0.5)  # 1.5 times 4 m, and a second


def test_reactions_pause_and_may_happen_once():
    still = {"person": (3.0, 0.0), "goal": (3.0, 0.0), "duration": 1.0}
    _, _, code = drive(meeting("look", pause=2.0, **still), 8.0)
    starts = np.flatnonzero(np.diff(np.concatenate([[0], code])) > 0) * 0.05
    assert np.diff(starts) == pytest.approx([3.0, 3.0], abs=0.11)
    _, _, code = drive(meeting("look", pause=math.inf, **still), 8.0)
    assert np.count_nonzero(np.diff(np.concatenate([[0], code])) > 0) == 1


def test_invisible_and_absent_robots_cause_no_reaction():
    for field in ("visible", "active"):
        world = meeting("curious", person=(3.0, 0.0))
        world.scene = world.scene.replace(**{field: np.array([[False, True]])})
        assert not np.any(drive(world, 1.0)[2])


def crowd(seed, people=6, model=ORCA, kinds=("curious", "scared", "ignore", "give-way", "block")):
    """Return a world with a robot and people with several reactions."""
    rng = np.random.default_rng(seed)
    position = np.concatenate([[[0.0, 0.0]], rng.uniform(-4, 4, (people, 2))])
    scene = Scene.of(
        position,
        goal=-position,
        external=np.arange(people + 1) == 0,
        radius=0.2,
        heading=rng.uniform(-3, 3, people + 1),
    )
    groups = [[(RobotReaction(kind, duration=2.0, pause=1.0), 0.19) for kind in kinds]]
    reactions = RobotReactions(groups, members=[-1] + [0] * people)
    return PlanarWorld(scene, model(), {0: DifferentialDrive()}, 0.05, seed, reactions=reactions)


def bytes_of(world, e):
    scene, n = world.scene, int(world.slots[e])
    arrays = (scene.position, scene.velocity, scene.heading, *(scene.memory[name] for name in sorted(scene.memory)))
    return b"".join(np.ascontiguousarray(array[e, :n]).tobytes() for array in arrays)


def test_environments_of_a_batch_equal_their_worlds_alone():
    counts = [6, 3, 9]
    whole = join_worlds([crowd(seed, count) for seed, count in enumerate(counts)])
    alone = [crowd(seed, count) for seed, count in enumerate(counts)]
    for _ in range(60):
        whole.step({0: Twist(0.5, 0.1)})
        for item in alone:
            item.step({0: Twist(0.5, 0.1)})
    assert np.any(reaction_codes(whole.scene))
    assert [bytes_of(whole, e) for e in range(3)] == [bytes_of(item, 0) for item in alone]
    put_environments(whole, [1], crowd(7, 3))
    fresh, copy = crowd(7, 3), select_environments(whole, [2, 0])
    for _ in range(40):
        for item in (whole, fresh, copy):
            item.step({0: Twist(0.5, 0.1)})
    assert bytes_of(whole, 1) == bytes_of(fresh, 0)
    assert [bytes_of(copy, 0), bytes_of(copy, 1)] == [bytes_of(whole, 2), bytes_of(whole, 0)]


def test_shares_are_drawn_from_seed_and_id_alone():
    people = 4000
    groups = [[(RobotReaction("curious"), 0.2), (RobotReaction("scared"), 0.3)]]

    def rules(ids, seed):
        scene = Scene.of(np.arange(2 * people, dtype=float).reshape(people, 2))
        reactions = RobotReactions(groups, members=[0] * people)
        world = PlanarWorld(scene, ORCA(), {}, 0.1, seed, ids=ids, reactions=reactions)
        return world.scene.memory["reaction"][0]

    ids = np.arange(people)
    found, backward = rules(ids, 3), rules(ids[::-1].copy(), 3)
    np.testing.assert_array_equal(found, backward[::-1])
    assert np.mean(found == 1.0) == pytest.approx(0.2, abs=0.025)
    assert np.mean(found == 2.0) == pytest.approx(0.3, abs=0.03)
    assert np.mean(found == -1.0) == pytest.approx(0.5, abs=0.03)
    assert np.mean(rules(ids, 4) != found) > 0.4


def test_people_who_enter_draw_the_reactions_of_their_source():
    door = Zone(((3, -1), (4, -1), (4, 1), (3, 1)))
    away = WaypointSequence((Zone(((-9, -1), (-8, -1), (-8, 1), (-9, 1))),))
    scene = Scene.of(np.zeros((6, 2)), active=[True] + [False] * 5, external=[True] + [False] * 5)
    sources = [PeopleSource(door, away, rate=1.0, timing="regular", max_count=3)]
    reactions = RobotReactions([[(RobotReaction("look"), 1.0)]], sources=[0])
    world = PlanarWorld(scene, ORCA(), {0: DifferentialDrive()}, 0.1, sources=sources, reactions=reactions)
    for _ in range(30):
        world.step({0: Twist(0.0, 0.0)})
    assert world.scene.memory["reaction"][0].tolist().count(1.0) >= 2
    assert people_by_reaction(world.scene, world.ids[0])["look"][0] == 6
    person = add_person(world, (1.0, 3.0), (9.0, 3.0), 1.3, 0.25)
    world.step({0: Twist(0.0, 0.0)})
    assert world.scene.memory["reaction"][0, world.ids[0].tolist().index(person)] == -1.0


def test_a_scene_with_preferred_velocities_reacts_too():
    scene = Scene.of(
        [[0.0, 0.0], [3.0, 0.3]], preferred_velocity=[[0.0, 0.0], [-1.0, 0.0]], external=[True, False],
        heading=[0.0, math.pi],
    )  # fmt: skip
    reactions = RobotReactions([[(RobotReaction("curious"), 1.0)]], members=[-1, 0])
    world = PlanarWorld(scene, ORCA(), {0: DifferentialDrive()}, 0.1, reactions=reactions)
    for _ in range(60):
        world.step({0: Twist(0.0, 0.0)})
    assert np.hypot(*world.scene.position[0, 1]) == pytest.approx(1.5, abs=0.15)
    assert world.scene.preferred_velocity[0, 1].tolist() == [-1.0, 0.0]


def test_both_worlds_move_people_alike():
    robot = Robot.load("turtlebot2")
    scene = Scene.of(
        [[0.0, 0.0], [5.0, 0.5], [5.0, 3.0]], goal=[[0.0, 0.0], [-5.0, 0.5], [-5.0, 3.0]],
        external=[True, False, False], heading=[0.0, math.pi, math.pi], radius=[robot.radius, 0.25, 0.25],
    )  # fmt: skip
    groups = [[(RobotReaction("curious"), 1.0)], [(RobotReaction("ignore"), 1.0)]]
    reactions = RobotReactions(groups, members=[-1, 0, 1])
    physics = PhysicsWorld(scene, ORCA(), {0: robot}, dt=0.1, reactions=reactions)
    planar = PlanarWorld(scene, ORCA(), {0: robot.drive}, dt=0.1, reactions=reactions)
    for _ in range(40):
        physics.step({0: Twist(0.0, 0.0)})
        planar.step({0: Twist(0.0, 0.0)})
    np.testing.assert_allclose(physics.scene.position[0, 1:], planar.scene.position[0, 1:], atol=1e-3)
    assert people_by_reaction(physics.scene, physics.ids[0]) == {"ignore": [2], "curious": [1]}


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: RobotReaction("curios"), "kind = 'curios', did you mean 'curious'? must be one of regular, ignore"),
        (lambda: RobotReaction("look", speed=2.0), "speed = 2 must be from 0 to 1.3"),
        (lambda: RobotReaction("look", distance=math.nan), "distance = nan must be from 0 to inf"),
        (lambda: RobotReaction("look", gap=math.inf), "gap = inf must be from 0 to inf"),
        (lambda: RobotReactions([[(RobotReaction("look"), 0.7)] * 2]), "shares [0.7, 0.7] must be from 0 to 1"),
        (lambda: RobotReactions([], members=[0]), "members must be from -1 to -1"),
    ],
)
def test_wrong_reactions_are_refused(make, sentence):
    with pytest.raises(InputError) as caught:
        make()
    assert sentence in str(caught.value)


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
def test_random_crowds_with_all_reactions_stay_finite_and_repeat(model):
    kinds = [kind for kind in REACTIONS if kind != "regular"]

    def run():
        world = crowd(11, 30, model, kinds[:5])
        for tick in range(80):
            world.step({0: Twist(0.8, 0.4 * math.sin(0.2 * tick))})
        return world

    one = run()
    assert np.isfinite(one.scene.position).all()
    assert np.any(reaction_codes(one.scene))
    speed = np.hypot(*one.scene.velocity[0, 1:].T)
    assert np.all(speed <= one.scene.max_speed[0, 1:] + 1e-9)
    np.testing.assert_array_equal(one.scene.preferred_speed[0, 1:], 1.3)
    assert bytes_of(one, 0) == bytes_of(run(), 0)


def test_a_removed_robot_ends_the_reaction_and_who_leaves_has_none():
    world = meeting("curious", person=(3.0, 0.0), duration=100.0)
    assert drive(world, 1.0)[2][-1] == REACTIONS.index("curious")
    world.remove_robot(ROBOT)
    world.step({})
    assert reaction_codes(world.scene).tolist() == [[0, 0]]
    world = meeting("curious", person=(3.0, 0.0), duration=100.0)
    drive(world, 1.0)
    remove_person(world, PERSON)
    assert reaction_codes(world.scene).tolist() == [[0, 0]]


def test_people_react_to_the_nearest_of_several_robots():
    scene = Scene.of(
        [[0.0, 0.0], [3.0, 0.0], [0.0, 2.5]], goal=[[0.0, 0.0], [3.0, 0.0], [0.0, 2.5]], heading=[0.3, 0.0, 0.0],
        external=[False, True, True],
    )  # fmt: skip
    reactions = RobotReactions([[(RobotReaction("curious", gap=0.5, field_of_view=2 * math.pi), 1.0)]], members=[0])
    world = PlanarWorld(scene, ORCA(), {1: DifferentialDrive(), 2: DifferentialDrive()}, 0.05, reactions=reactions)
    for _ in range(100):
        world.step({1: Twist(0.0, 0.0), 2: Twist(0.0, 0.0)})
    assert world.scene.memory["reaction_state"][0, 0, 2] == 2.0
    assert np.hypot(*(world.scene.position[0, 0] - [0.0, 2.5])) == pytest.approx(1.0, abs=0.15)

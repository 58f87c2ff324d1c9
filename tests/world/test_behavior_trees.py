"""Behaviour trees of people: what conditions and actions do in a world, and that their state is a value."""

from __future__ import annotations

import math

import numpy as np
import pytest

from crowdbot.core import Scene, Twist
from crowdbot.models import ORCA, CollisionFreeSpeed, SocialForce
from crowdbot.world import (
    REACTIONS,
    DifferentialDrive,
    Direction,
    JourneyAssignment,
    PeopleSource,
    PhysicsWorld,
    PlanarWorld,
    Point,
    Robot,
    RobotReaction,
    RobotReactions,
    WaypointSequence,
    Zone,
    join_worlds,
    parse_behavior_tree,
    people_by_reaction,
    put_environments,
    reaction_codes,
    select_environments,
)

MODELS = {"orca": ORCA, "social-force": SocialForce, "collision-free-speed": CollisionFreeSpeed}
DT = 0.1
REGULAR = """
<BehaviorTree ID="Regular"><Fallback>
  <Sequence>
    <Inverter><IsGoalReached agent_id="{id}"/></Inverter>
    <RegularNav agent_id="{id}" time_step="{dt}"/>
  </Sequence>
  <UpdateGoal agent_id="{id}"/>
</Fallback></BehaviorTree>
"""
MEETS = """
<Fallback>
  <Sequence>
    <IsRobotVisible agent_id="{id}" distance="DISTANCE"/>
    <Inverter><TimeExpiredCondition seconds="SECONDS" ts="{dt}" only_once="ONCE"/></Inverter>
    <ACTION agent_id="{id}"/>
  </Sequence>
  <Sequence>
    <SetBlackboard output_key="agentid" value="{id}"/><SetBlackboard output_key="timestep" value="{dt}"/>
    <SubTree ID="Regular" id="agentid" dt="timestep"/>
  </Sequence>
</Fallback>
"""


def tree_of(body, **how):
    text = f'<root main_tree_to_execute="Main"><BehaviorTree ID="Main">{body}</BehaviorTree>{REGULAR}</root>'
    return parse_behavior_tree(text.encode(), "t.xml", **how)


def meets(action, distance=4.0, seconds=30.0, once=True, **how):
    body = MEETS.replace("DISTANCE", str(distance)).replace("SECONDS", str(seconds))
    return tree_of(body.replace("ONCE", str(once)).replace("ACTION", action), **how)


def world_of(bodies, people, *, stops=None, model=ORCA, robot=(0.0, 0.0), group=None, seed=0, then="stay", walls=()):
    """Return a world with a robot, agent 0, and people ``(x, y, heading)``, each with a tree and a way of stops."""
    places = [robot] + [(x, y) for x, y, _ in people]
    stops = stops or [[]] * len(people)
    goals = [robot] + [way[0][:2] if way else place for way, place in zip(stops, places[1:], strict=True)]
    scene = Scene.of(
        places, goal=goals, heading=[0.0, *(turn for _, _, turn in people)], external=[True] + [False] * len(people),
        radius=[0.3] + [0.25] * len(people), group=[-1, *(group or [-1] * len(people))], walls=walls,
    )  # fmt: skip
    ways = [WaypointSequence(tuple(Point(*stop) for stop in way), then) for way in stops if way]
    numbers = iter(range(len(ways)))
    which = [-1, *(next(numbers) if way else -1 for way in stops)]
    trees = [tree_of(body) if isinstance(body, str) else body for body in bodies]
    reactions = RobotReactions([[(tree, 1.0)] for tree in trees], members=[-1, *range(len(trees))])
    journeys = JourneyAssignment(tuple(ways), which) if ways else None
    drive = DifferentialDrive(max_speed=2.0)
    return PlanarWorld(scene, model(), {0: drive}, dt=DT, seed=seed, reactions=reactions, journeys=journeys)


def walk(world, seconds, speed=0.0):
    """Advance a world, and return positions ``[T, A, 2]``, headings and codes of reactions ``[T, A]``."""
    rows = []
    for _ in range(round(seconds / DT)):
        scene = world.step({0: Twist(speed, 0.0)})
        rows.append((scene.position[0].copy(), scene.heading[0].copy(), reaction_codes(scene)[0]))
    return tuple(np.array(column) for column in zip(*rows, strict=True))


def distances(position, one=1, two=0):
    return np.hypot(*(position[:, one] - position[:, two]).T)


def turn_to(position, heading, one, two):
    """Return the angle between the heading of agent ``one`` and the direction to ``two`` at the end."""
    x, y = position[-1, two] - position[-1, one]
    return math.remainder(heading[-1, one] - math.atan2(y, x), 2.0 * math.pi)


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
@pytest.mark.parametrize(
    ("action", "kind"),
    [("CuriousNav", "curious"), ("ScaredNav", "scared"), ("ThreateningNav", "block"), ("SurprisedNav", "look")],
)
def test_the_trees_of_hunavsim_choose_a_reaction_and_walk_on(action, kind, model):
    world = world_of([meets(action, seconds=3.0)], [(6.0, 0.4, math.pi)], stops=[[(-6.0, 0.4)]], model=model)
    position, heading, code = walk(world, 16.0)
    at = np.flatnonzero(code[:, 1] == REACTIONS.index(kind))
    assert distances(position)[at[0] - 1] <= 4.0 < distances(position)[at[0] - 2]
    assert 10 <= len(at) <= 30  # up to 3 s in sight of the robot, in steps of 0.1 s
    assert position[-1, 1, 0] < -2.0
    if kind == "look":
        stands = np.ptp(position[at[0] + 8 : at[-1], 1], axis=0).max()
        assert stands < 0.1
        assert abs(turn_to(position[: at[-1]], heading[: at[-1]], 1, 0)) < 0.1


def test_a_timer_runs_once_or_again_and_counts_only_its_own_ticks():
    for once, seen in ((True, 1), (False, 3)):
        world = world_of([meets("SurprisedNav", seconds=1.0, once=once)], [(3.0, 0.0, math.pi)])
        _, _, code = walk(world, 3.5)
        begins = np.flatnonzero(np.diff(np.concatenate([[0], code[:, 1]])) > 0)
        assert len(begins) >= seen
        assert (len(begins) == 1) is once


def test_robots_behind_a_person_or_a_wall_are_not_visible_but_near():
    wall = ((1.5, -2.0), (1.5, 2.0))
    for heading, walls, visible in ((math.pi, (), True), (0.0, (), False), (math.pi, [wall], False)):
        for condition in ("IsRobotVisible", "IsRobotNear"):
            body = f'<Sequence><{condition} distance="4"/><LookAtRobot/></Sequence>'
            world = world_of([body], [(3.0, 0.0, heading)], walls=walls)
            _, _, code = walk(world, 0.2)
            assert bool(code[0, 1] > 0) is (visible or condition == "IsRobotNear")


def test_without_a_robot_actions_that_need_one_fail():
    world = world_of(["<Fallback><CuriousNav/><RegularNav/></Fallback>"], [(3.0, 0.0, 0.0)], stops=[[(9.0, 0.0)]])
    world.scene = world.scene.replace(active=np.array([[False, True]]))
    position, _, code = walk(world, 3.0)
    assert position[-1, 1, 0] > 6.0
    assert not np.any(code)


def test_a_tree_decides_when_a_person_goes_to_the_next_stop():
    """A person waits for two seconds at each stop; without a wait they go on at once, and stay at the last one."""
    wait = """
    <Sequence>
      <Fallback><IsGoalReached/><ForceFailure><RegularNav/></ForceFailure></Fallback>
      <Wait seconds="2"/><UpdateGoal/>
    </Sequence>"""
    stops = [(3.0, 3.0, 0.3), (6.0, 3.0, 0.5)]
    world = world_of([wait, "<SubTree ID='Regular' id='id' dt='dt'/>"], [(0.0, 3.0, 0.0), (0.0, 5.0, 0.0)],
                     stops=[stops, [(3.0, 5.0), (6.0, 5.0)]], robot=(0.0, -20.0))  # fmt: skip
    position, *_ = walk(world, 14.0)
    speed = np.hypot(*np.diff(position[:, 1], axis=0).T) / DT
    still = [(k, x) for k, x in zip(range(len(speed)), position[1:, 1, 0], strict=True) if speed[k] < 1e-6]
    first = [k for k, x in still if x < 4.0]
    assert len(first) * DT == pytest.approx(2.0, abs=0.21)
    assert position[first[0], 1, 0] == pytest.approx(3.0 - 0.3, abs=0.15)
    assert position[-1, 1].tolist() == pytest.approx([6.0, 3.0], abs=0.1)  # nothing holds them there
    assert position[-1, 2].tolist() == pytest.approx([6.0, 5.0], abs=0.31)
    assert world.scene.memory["stop"][0, 1:].tolist() == [2.0, 2.0]


@pytest.mark.parametrize(("then", "stop", "there"), [("leave", 2.0, False), ("again", 6.0, True)])
def test_a_journey_that_is_led_ends_as_its_own_end_says(then, stop, there):
    world = world_of(["<UpdateGoal/>"], [(0.0, 3.0, 0.0)], stops=[[(3.0, 3.0), (0.0, 3.0)]], then=then)
    for _ in range(6):
        world.step({0: Twist()})
    assert bool(world.scene.active[0, 1]) is there
    assert world.scene.memory["stop"][0, 1] == stop


def test_moving_stops_of_people_who_are_held_stay_ahead_of_them():
    door = Zone(((9.0, 0.0), (10.0, 0.0), (10.0, 8.0), (9.0, 8.0)), aim="nearest")
    scene = Scene.of([[0.0, 2.0], [0.0, 4.0]])
    body = "<Fallback><Sequence><IsGoalReached/><UpdateGoal/></Sequence><RegularNav/></Fallback>"
    journeys = JourneyAssignment((WaypointSequence((Direction(0.0), door)), WaypointSequence((door,), "leave")), [0, 1])
    reactions = RobotReactions([[(tree_of(body), 1.0)]], members=[0, 0])
    world = PlanarWorld(scene, ORCA(), {}, dt=DT, journeys=journeys, reactions=reactions)
    for _ in range(90):
        world.step({})
    assert world.scene.goal[0, 0, 0] > world.scene.position[0, 0, 0] > 9.0  # a direction is never reached
    assert not world.scene.active[0, 1]


def test_nobody_moves_without_an_action():
    world = world_of(["<AlwaysFailure/>", "<StandStill/>"], [(3.0, 0.0, 0.0), (3.0, 3.0, 0.0)],
                     stops=[[(9.0, 0.0)], [(9.0, 3.0)]])  # fmt: skip
    position, _, code = walk(world, 1.0)
    assert np.ptp(position, axis=0).max() == 0.0
    assert not np.any(code)


def test_groups_stand_and_turn_to_each_other():
    talk = "<Fallback><TalkInGroup/><RegularNav/></Fallback>"
    people = [(3.0, 3.0, 0.0), (4.5, 3.0, 0.0), (3.0, 6.0, 0.0)]
    world = world_of([talk] * 3, people, stops=[[(12.0, y)] for _, y, _ in people], group=[4, 4, 5])
    position, heading, _ = walk(world, 4.0)
    assert np.ptp(position[:, 1:3], axis=0).max() < 1e-9
    assert abs(turn_to(position, heading, 1, 2)) < 0.05
    assert abs(turn_to(position, heading, 2, 1)) < 0.05
    assert position[-1, 3, 0] > 6.0  # alone in its group
    walks = "<KeepRunningUntilFailure><RegularNav/></KeepRunningUntilFailure>"
    once = f"<SequenceWithMemory><TalkInGroup seconds='2'/>{walks}</SequenceWithMemory>"
    world = world_of([once] * 2, people[:2], stops=[[(12.0, y)] for _, y, _ in people[:2]], group=[4, 4])
    position, *_ = walk(world, 4.0)
    assert np.count_nonzero(np.all(position[:, 1] == position[0, 1], axis=-1)) == 20


def test_the_members_of_a_group_ahead_wait_for_the_last_one():
    waits = '<Fallback><Sequence><IsGroupBehind distance="2"/><StandStill/></Sequence><RegularNav/></Fallback>'
    people = [(5.0, 3.0, 0.0), (0.0, 3.6, 0.0)]
    world = world_of([waits] * 2, people, stops=[[(14.0, 3.0)], [(14.0, 3.6)]], group=[1, 1], robot=(0.0, -9.0))
    position, *_ = walk(world, 14.0)
    apart = distances(position, 1, 2)
    first = int(np.argmax(apart < 2.0))
    assert np.ptp(position[:first, 1], axis=0).max() < 0.05  # the first one stands until the second one is near
    assert position[-1, 1:, 0].min() > 13.0
    assert apart[first:].max() < 2.2


def test_people_queue_behind_who_is_nearer_to_the_stop():
    """The first one is served for four seconds at the counter, while the others stand behind each other."""
    queue = """
    <ReactiveFallback>
      <Sequence><IsGoalReached/><Wait seconds="4"/><UpdateGoal/></Sequence>
      <Sequence><Inverter><IsGoalReached/></Inverter><QueueNav gap="0.3"/></Sequence>
    </ReactiveFallback>"""
    people = [(x, 3.0, 0.0) for x in (4.0, 2.6, 1.2)]
    world = world_of([queue] * 3, people, stops=[[(6.0, 3.0), (6.0, 30.0)]] * 3, robot=(0.0, -9.0),
                     model=CollisionFreeSpeed)  # fmt: skip
    position, *_ = walk(world, 5.0)
    assert position[-1, 1, 0] == pytest.approx(5.7, abs=0.15)
    gaps = -np.diff(position[-1, 1:, 0])
    assert gaps.min() > 0.5
    assert gaps.max() < 1.1
    assert np.abs(position[-1, 1:, 1] - 3.0).max() < 0.1
    walk(world, 12.0)
    assert world.scene.memory["stop"][0, 1:].tolist() == [1.0, 1.0, 1.0]


def test_people_follow_and_approach_each_other():
    people = [(3.0, 3.0, 0.0), (1.0, 3.0, 0.0), (1.0, 8.0, 0.0), (6.0, 8.0, math.pi)]
    bodies = [
        "<RegularNav/>",
        '<FollowPerson gap="0.4" speed="1.3"/>',
        '<ApproachPerson gap="0.6" distance="6"/>',
        "<StandStill/>",
    ]
    world = world_of(bodies, people, stops=[[(30.0, 3.0)], [], [], []], robot=(0.0, -9.0))
    position, _, code = walk(world, 10.0)
    assert 0.5 < distances(position, 2, 1)[-1] < 1.6
    assert position[-1, 2, 0] > 10.0
    assert distances(position, 3, 4)[-1] == pytest.approx(0.5 + 0.6, abs=0.15)
    assert not np.any(code)  # reactions to people are none to robots


def test_people_near_are_told_apart_from_robots():
    body = '<Sequence><IsPersonNear distance="2"/><StandStill/></Sequence>'
    both = f"<Fallback>{body}<RegularNav/></Fallback>"
    world = world_of([both, "<StandStill/>"], [(1.0, 0.0, 0.0), (6.0, 0.0, 0.0)], stops=[[(12.0, 0.0)], []])
    position, *_ = walk(world, 6.0)
    assert position[-1, 1, 0] == pytest.approx(4.1, abs=0.15)


@pytest.mark.parametrize("kind", ["ignore", "impassive"])
def test_regular_walk_may_ignore_robots_or_take_them_for_obstacles(kind):
    tree = tree_of("<RegularNav/>", regular=kind)
    action = tree_of({"ignore": "<IgnoreRobot/>", "impassive": "<ImpassiveNav/>"}[kind])
    paths = []
    for reaction in (tree, action, RobotReaction(kind)):
        scene = Scene.of([[0.0, 0.0], [6.0, 0.2]], goal=[[0.0, 0.0], [-6.0, 0.2]], external=[True, False], radius=0.25)
        reactions = RobotReactions([[(reaction, 1.0)]], members=[-1, 0])
        world = PlanarWorld(scene, ORCA(), {0: DifferentialDrive()}, dt=DT, reactions=reactions)
        paths.append(walk(world, 6.0, 0.5))
    np.testing.assert_array_equal(paths[0][0], paths[2][0])
    np.testing.assert_array_equal(paths[1][0], paths[2][0])
    assert set(paths[0][2][:, 1]) == {REACTIONS.index(kind)}


def test_people_without_trees_react_as_before_beside_people_with_trees():
    def run(with_tree):
        scene = Scene.of(
            [[0.0, 0.0], [6.0, 0.4], [0.0, 60.0]], goal=[[0.0, 0.0], [-6.0, 0.4], [9.0, 60.0]], heading=[0, math.pi, 0],
            external=[True, False, False],
        )  # fmt: skip
        groups = [[(RobotReaction("curious"), 1.0)], [(tree_of("<RegularNav/>"), 1.0)]]
        reactions = RobotReactions(groups[: 1 + with_tree], members=[-1, 0, 1 if with_tree else -1])
        return walk(PlanarWorld(scene, ORCA(), {0: DifferentialDrive()}, dt=DT, reactions=reactions), 8.0)

    for one, two in zip(run(False), run(True), strict=True):
        np.testing.assert_array_equal(one, two)


def crowd(seed, people=6, model=ORCA):
    """Return a world with a robot, and people who draw one of several trees and reactions."""
    rng = np.random.default_rng(seed)
    position = np.concatenate([[[0.0, 0.0]], rng.uniform(-4, 4, (people, 2))])
    scene = Scene.of(
        position, goal=-position, external=np.arange(people + 1) == 0, radius=0.2, group=[-1] + [3] * people,
        heading=rng.uniform(-3, 3, people + 1),
    )  # fmt: skip
    ways = (WaypointSequence((Point(3.0, 3.0), Point(-3.0, 3.0), Point(0.0, -3.0)), "again"),)
    repeats = (
        '<ReactiveSequence><IsRobotNear distance="3"/><Repeat num_cycles="3">'
        '<Sequence><Wait seconds="0.3"/><TalkInGroup/></Sequence></Repeat></ReactiveSequence>'
    )
    either = f"<Fallback>{repeats}<SubTree ID='Regular' id='id' dt='dt'/></Fallback>"
    group = [
        (meets("CuriousNav", seconds=2.0, once=False), 0.3), (meets("ScaredNav", 3.0, regular="ignore"), 0.2),
        (tree_of(either), 0.3), (RobotReaction("give-way"), 0.1),
    ]  # fmt: skip
    reactions = RobotReactions([group], members=[-1] + [0] * people)
    journeys = JourneyAssignment(ways, [-1] + [0] * people)
    return PlanarWorld(scene, model(), {0: DifferentialDrive()}, DT, seed, reactions=reactions, journeys=journeys)


def bytes_of(world, e):
    scene, n = world.scene, int(world.slots[e])
    arrays = (scene.position, scene.velocity, scene.heading, *(scene.memory[name] for name in sorted(scene.memory)))
    return b"".join(np.ascontiguousarray(array[e, :n]).tobytes() for array in arrays)


def test_environments_of_a_batch_equal_their_worlds_alone():
    counts = [6, 3, 9]
    whole = join_worlds([crowd(seed, count) for seed, count in enumerate(counts)])
    alone = [crowd(seed, count) for seed, count in enumerate(counts)]
    for _ in range(80):
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


@pytest.mark.parametrize("model", MODELS.values(), ids=MODELS)
def test_random_crowds_repeat_and_stay_finite(model):
    def run():
        world = crowd(11, 25, model)
        for tick in range(90):
            world.step({0: Twist(0.8, 0.4 * math.sin(0.2 * tick))})
        return world

    one = run()
    assert np.isfinite(one.scene.position).all()
    assert all(np.isfinite(values).all() for name, values in one.scene.memory.items() if name != "behavior_state")
    assert not np.isnan(one.scene.memory["behavior_state"]).any()
    assert np.all(np.hypot(*one.scene.velocity[0, 1:].T) <= one.scene.max_speed[0, 1:] + 1e-9)
    assert bytes_of(one, 0) == bytes_of(run(), 0)
    assert one.scene.memory["stop"][0, 1:].max() >= 1.0


def test_people_who_enter_draw_the_tree_of_their_source_with_a_fresh_state():
    door = Zone(((3, -1), (4, -1), (4, 1), (3, 1)))
    away = WaypointSequence((Zone(((-9, -1), (-8, -1), (-8, 1), (-9, 1))),))
    scene = Scene.of(np.zeros((4, 2)), active=[True] + [False] * 3, external=[True] + [False] * 3)
    sources = [PeopleSource(door, away, rate=1.0, timing="regular", max_count=2)]
    timer = '<Inverter><TimeExpiredCondition seconds="0.4" only_once="True"/></Inverter>'
    body = f"<Sequence>{timer}<SurprisedNav/></Sequence>"
    reactions = RobotReactions([[(tree_of(body), 1.0)]], sources=[0])
    world = PlanarWorld(scene, ORCA(), {0: DifferentialDrive()}, DT, sources=sources, reactions=reactions)
    seen = []
    for _ in range(25):
        world.step({0: Twist(0.0, 0.0)})
        seen.append(people_by_reaction(world.scene, world.ids[0]).get("look", []))
    found = [person for row in seen for person in row]
    assert sorted(set(found)) == [4, 5]
    assert [found.count(4), found.count(5)] == [3, 3]


def test_both_worlds_move_people_alike():
    robot = Robot.load("turtlebot2")
    scene = Scene.of(
        [[0.0, 0.0], [5.0, 0.5], [5.0, 3.0], [5.0, 4.0]], goal=[[0.0, 0.0], [-5.0, 0.5], [4.0, 3.0], [4.0, 4.0]],
        external=[True, False, False, False], heading=[0.0, math.pi, math.pi, math.pi], group=[-1, -1, 2, 2],
        radius=[robot.radius, 0.25, 0.25, 0.25],
    )  # fmt: skip
    talks = "<Sequence><IsGoalReached/><TalkInGroup seconds='1'/><UpdateGoal/></Sequence>"
    stops = f"<Fallback>{talks}<RegularNav/></Fallback>"
    groups = [[(meets("CuriousNav"), 1.0)], [(tree_of(stops), 1.0)]]
    ways = tuple(WaypointSequence((Point(4.0, y), Point(-5.0, y)), "stay") for y in (3.0, 4.0))
    how = {
        "reactions": RobotReactions(groups, members=[-1, 0, 1, 1]),
        "journeys": JourneyAssignment(ways, [-1, -1, 0, 1]),
    }
    physics = PhysicsWorld(scene, ORCA(), {0: robot}, dt=0.1, **how)
    planar = PlanarWorld(scene, ORCA(), {0: robot.drive}, dt=0.1, **how)
    for _ in range(40):
        physics.step({0: Twist(0.0, 0.0)})
        planar.step({0: Twist(0.0, 0.0)})
    np.testing.assert_allclose(physics.scene.position[0, 1:], planar.scene.position[0, 1:], atol=1e-3)
    np.testing.assert_array_equal(physics.scene.memory["behavior_state"], planar.scene.memory["behavior_state"])
    assert planar.scene.memory["stop"][0].tolist() == [0.0, 0.0, 1.0, 1.0]

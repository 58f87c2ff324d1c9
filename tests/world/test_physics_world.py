"""The physics world: robots as fast as commanded, people as in the plane until they are touched."""

import dataclasses
import functools
import tracemalloc

import mujoco
import numpy as np
import pytest
from physics_worlds import alone, crowded, facing, ram

from crowdbot.core import InputError, Scene, Twist
from crowdbot.humans import LIMBS, People
from crowdbot.models import ORCA
from crowdbot.world import (
    AckermannDrive,
    Chair,
    ContactModel,
    Cube,
    DifferentialDrive,
    JourneyAssignment,
    Light,
    PeopleSource,
    PhysicsStage,
    PhysicsWorld,
    PlanarWorld,
    Robot,
    Router,
    Table,
    Tree,
    World,
    Zone,
    builtin_robots,
)
from samples import sample, sizes

load = functools.cache(Robot.load)


@pytest.mark.parametrize("name", sample(builtin_robots(), 2))
def test_robots_reach_the_speed_that_is_commanded(name):
    """Within 2 % in steady state, from plain commands: drive, delay and motors are the world's."""
    robot = load(name)
    world = alone(robot)
    for forward, turn in ((1.0, 0.0), (0.0, 0.8), (0.5, 0.3), (-0.5, 0.0)):
        goal = Twist(forward * robot.drive.max_speed, turn * robot.drive.max_turn_rate)
        reached = []
        for _ in range(90):
            world.step({0: goal})
            reached.append([float(value[0]) for value in vars(world.twists[0]).values()])
        mean = np.mean(reached[-20:], axis=0)
        assert mean[0] == pytest.approx(goal.forward, rel=0.02, abs=0.02 * robot.drive.max_speed)
        assert mean[1] == pytest.approx(goal.turn, rel=0.02, abs=0.01)
        assert mean[2] == pytest.approx(0.0, abs=0.02)
    assert world.robot_bodies[0].tilt < 0.03
    assert world.contacts == ()


def test_pepper_goes_sideways_too():
    world = alone(load("pepper"))
    for _ in range(60):
        scene = world.step({0: Twist(0.0, 0.0, left=0.4)})
    assert world.twists[0].left[0] == pytest.approx(0.4, rel=0.02)
    assert scene.velocity[0, 0] == pytest.approx([0.0, 0.4], abs=0.01)


def test_commands_come_late():
    world = alone(load("wheelchair"), dt=0.05)  # 0.1 s
    moved = [float(world.step({0: Twist(0.5, 0.0)}).velocity[0, 0, 0]) for _ in range(4)]
    assert max(np.abs(moved[:2])) < 2e-3
    assert moved[3] > 0.02


def test_without_a_touch_people_walk_as_in_the_plane():
    """To the last bit, and whatever the plane offers: journeys, sources, exits, routes, limits, pushes, substeps."""
    robot = load("turtlebot2")
    scene = crowded(20, robot, size=16.0)
    away = scene.position.copy()
    away[0, -1] = 40.0, 40.0
    scene = scene.replace(position=away, goal=np.where(scene.external[..., None], away, scene.goal))
    options = {
        "router": Router.of(scene.walls),
        "contact": ContactModel(),
        "exits": [Zone([(-8.0, -8.0), (-6.0, -8.0), (-6.0, 8.0), (-8.0, 8.0)])],
        "heading_jitter": 1e-3,
        "substeps": 2,
        "leave_radius": 0.3,
    }
    flat = PlanarWorld(scene, ORCA(), {20: robot.drive}, 0.1, 3, **options)
    deep = PhysicsWorld(scene, ORCA(), {20: robot}, 0.1, 3, **options)
    assert isinstance(deep, World)
    for _ in range(40):
        one, other = flat.step({20: Twist()}), deep.step({20: Twist()})
    for name in ("position", "velocity", "heading", "active"):
        np.testing.assert_array_equal(getattr(one, name)[:, :20], getattr(other, name)[:, :20])
    assert not one.active.all()
    assert one.time == other.time == deep.clock.time


def test_near_a_robot_but_untouched_people_walk_as_in_the_plane():
    robot = load("turtlebot2")
    scene = Scene.of(
        [[0.0, 0.0], [1.0, 0.7]], goal=[[0.0, 0.0], [-3.0, 0.7]], radius=[robot.radius, 0.25], external=[True, False]
    )
    flat = PlanarWorld(scene, ORCA(), {0: robot.drive}, 0.1)
    deep = PhysicsWorld(scene, ORCA(), {0: robot}, 0.1)
    bodies = 0
    for _ in range(20):
        one, other = flat.step({0: Twist()}), deep.step({0: Twist()})
        bodies += int(np.count_nonzero(deep._people_bodies.agent >= 0))
        assert np.abs(one.position[0, 1] - other.position[0, 1]).max() < 1e-6
    assert bodies > 5
    assert deep.contact_events == ()


def test_the_same_seed_gives_the_same_bytes_and_people_come_and_go():
    robot = load("cuybot")
    scene = crowded(16, robot, size=6.0)

    def digests(seed):
        world = PhysicsWorld(scene, ORCA(), {16: robot}, 0.1, seed, leave_radius=0.4)
        found = [world.step({16: Twist(0.8, 0.5)}).digest() for _ in range(50)]
        return found, world.contact_events, world.limbs().start.tobytes(), world.scene.active.sum()

    first, again, other = digests(1), digests(1), digests(2)
    assert first == again
    assert first[2] != other[2]
    assert first[3] < 17


def test_a_pushed_person_goes_on_from_there():
    world = facing(load("cuybot"), gap=1.0, dt=0.1)
    for _ in range(40):
        scene = world.step({0: Twist(0.8, 0.0)})
    assert scene.position[0, 1, 0] > 1.3
    assert np.all(np.isfinite(scene.position))
    assert {contact.other for contact in world.contacts} <= {1}
    assert world.contact_events[0].first == ("robot", 0)
    assert world.contact_events[0].second == ("person", 1)
    (x,) = world.limbs().start[0, :1, 0]
    assert x == pytest.approx(scene.position[0, 1, 0], abs=0.3)
    for _ in range(40):
        scene = world.step({0: Twist(-0.8, 0.0)})
    assert np.abs(scene.velocity[0, 1]).max() < 0.05
    assert world.forces == ()


def test_limbs_of_everyone():
    world = facing(load("turtlebot2"))
    limbs = world.limbs()
    assert limbs.start.shape == (1, len(LIMBS), 3)
    assert limbs.parts[limbs.part[0]] == "pelvis"
    assert set(limbs.owner) == {1}
    world.scene = world.scene.replace(active=np.array([[True, False]]))
    assert np.all(world.limbs().radius == 0.0)


def test_a_spawner_may_move_people_and_robots_between_steps():
    world = facing(load("turtlebot2"), gap=1.0)
    world.step({0: Twist()})
    place = world.scene.position.copy()
    place[0] = [[3.0, 1.0], [0.0, 0.0]]
    world.scene = world.scene.replace(position=place, goal=place)
    scene = world.step({0: Twist()})
    assert scene.position[0] == pytest.approx(place[0], abs=1e-3)
    assert world.limbs().start[0, 0, 0] == pytest.approx(0.0, abs=0.3)


def test_robots_bump_into_robots_and_walls():
    robot = load("cuybot")
    scene = Scene.of([[0.0, 0.0], [1.5, 0.0]], heading=[0.0, np.pi], external=True, radius=robot.radius)
    world = PhysicsWorld(scene, ORCA(), {0: robot, 1: robot}, 0.1)
    seen = set()
    for _ in range(30):
        world.step({0: Twist(0.5, 0.0), 1: Twist(0.5, 0.0)})
        seen |= {(contact.robot, contact.other) for contact in world.contacts}
    assert seen == {(0, 1)}
    assert world.contact_events[0].cause == "mutual"
    assert world.contact_events[0].impact_speed == pytest.approx(1.0, rel=0.05)
    ring = [(1.0, -1.0), (2.0, -1.0), (2.0, 1.0), (1.0, 1.0)]
    room = [(-2.0, -2.0), (-2.0, 2.0), (3.0, 2.0), (3.0, -2.0)]
    for walls in ([ring], [room], [[(1.0, -1.0), (1.0, 1.0)]]):
        world = alone(robot, walls=walls)
        for _ in range(110):
            scene = world.step({0: Twist(0.6, 0.0)})
        edge = 3.0 if walls == [room] else 1.0
        assert scene.position[0, 0, 0] == pytest.approx(edge - 0.2865, abs=0.03)


def test_joints_are_commanded():
    world = alone(load("pepper"))
    world.command(0, {"HeadYaw": 0.5})
    for _ in range(40):
        world.step({0: Twist()})
    assert world.robot_bodies[0].joints()["HeadYaw"][0] == pytest.approx(0.5, abs=0.05)
    with pytest.raises(InputError, match="has no motor on joint 'HeadYow', did you mean 'HeadYaw'"):
        world.command(0, {"HeadYow": 0.5})
    with pytest.raises(InputError, match="agent 1 is not a robot; robots are \\[0\\]"):
        world.command(1, {"HeadYaw": 0.5})
    with pytest.raises(InputError, match="'left_wheel_joint' of cuybot is a wheel; use a Twist command"):
        alone(load("cuybot")).command(0, {"left_wheel_joint": 1.0})
    with pytest.raises(InputError, match="nan for joint 'HeadYaw'"):
        world.command(0, {"HeadYaw": float("nan")})


def test_props_stand_and_people_walk_around_those_that_stand_fast():
    robot = load("turtlebot2")
    props = (Table(0.0, 0.0, heading=0.3), Tree(3.0, 3.0), Cube(6.0, 0.0, size=0.5), Chair(-5.0, 3.0))
    scene = Scene.of([[-3.0, 0.05], [8.0, 8.0]], goal=[[3.0, 0.05], [8.0, 8.0]], external=[False, True])
    world = PhysicsWorld(scene, ORCA(), {1: robot}, 0.1, stage=PhysicsStage(props=props, lights=(Light(0.0, 0.0),)))
    nearest = np.inf
    for _ in range(40):
        scene = world.step({1: Twist()})
        nearest = min(nearest, float(np.hypot(*scene.position[0, 0])))
    assert nearest > 0.6
    assert len(scene.walls) == 0
    assert world.prop(2)[:3, 3] == pytest.approx([6.0, 0.0, 0.25], abs=1e-3)


def test_a_person_walks_into_a_cube_and_pushes_it():
    scene = Scene.of([[0.0, 0.0], [9.0, 9.0]], goal=[[5.0, 0.0], [9.0, 9.0]], external=[False, True])
    stage = PhysicsStage(props=(Cube(1.5, 0.0, size=0.4, mass=2.0),))
    world = PhysicsWorld(scene, ORCA(), {1: load("turtlebot2")}, 0.1, stage=stage)
    for _ in range(30):
        world.step({1: Twist()})
    assert world.prop(0)[0, 3] > 1.8
    assert {(event.first.kind, event.second.kind) for event in world.contact_events} == {("prop", "person")}


def test_few_bodies_are_enough_and_it_says_when_not():
    robot = load("cuybot")
    world = PhysicsWorld(crowded(60, robot, size=5.0), ORCA(), {60: robot}, 0.1, slots=3)
    world.step({60: Twist()})
    assert np.count_nonzero(world._people_bodies.agent >= 0) == 3
    assert world.skipped_people > 0


def test_what_cannot_be_is_refused():
    robot, plain = load("turtlebot2"), [[0.0, 0.0], [2.0, 0.0]]
    scene = Scene.of(plain, external=[True, False])

    def refused(match, scene=scene, robots=None, dt=0.1, **options):
        with pytest.raises(InputError, match=match):
            PhysicsWorld(scene, ORCA(), {0: robot} if robots is None else robots, dt, **options)

    refused("one environment, the scene has 2", scene=Scene.of(np.zeros((2, 1, 2)), external=True))
    refused("dt = 0.012 s must be a multiple of physics_dt = 0.005 s", dt=0.012)
    refused("physics_dt = 0.1 s must be from", physics_dt=0.1)
    refused("slots = -1 must be a whole number", slots=-1)
    refused("robots\\[0\\] is a DifferentialDrive; give a Robot", robots={0: DifferentialDrive()})
    refused("robot turtlebot2 of agent 0 is absent", scene=scene.replace(active=np.array([[False, True]])))
    refused("agent 1 has a drive but is not external", robots={1: robot})
    refused("2 bodies are given for 1 agents that are not robots", people=People.of(["man-20", "man-20"]))
    car = dataclasses.replace(robot, drive=AckermannDrive())
    refused('has a drive AckermannDrive and no steered wheels; use base="planar"', robots={0: car})
    refused("has no driven wheels", robots={0: dataclasses.replace(robot, wheels=())})
    with pytest.raises(InputError, match='Cube: mass="0.0" must be at least 0.001 kg'):
        Cube(0.0, 0.0, mass=0.0)
    with pytest.raises(InputError, match='Light: brightness="2.0" must be at most 1'):
        Light(0.0, 0.0, brightness=2.0)
    with pytest.raises(InputError, match="PhysicsStage: wall_height = -1.0 must"):
        PhysicsStage(wall_height=-1.0)


def test_a_car_is_pulled():
    drive = AckermannDrive(max_speed=2.0, wheelbase=1.0)
    world = alone(dataclasses.replace(ram(100.0, 0.5), drive=drive))
    for _ in range(80):
        world.step({0: Twist(1.0, 0.3)})
    assert world.twists[0].forward[0] == pytest.approx(1.0, rel=0.02)
    assert world.twists[0].turn[0] == pytest.approx(0.3, rel=0.02)


def test_people_who_come_in_have_bodies():
    robot = load("turtlebot2")
    scene = Scene.of([[8.0, 8.0], *[[0.0, 0.0]] * 5], external=[True] + [False] * 5, active=[True] + [False] * 5)
    from crowdbot.world import Direction, WaypointSequence

    source = PeopleSource(
        zone=Zone([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]),
        journey=WaypointSequence((Direction(0.0),)),
        rate=2.0,
    )
    world = PhysicsWorld(
        scene,
        ORCA(),
        {0: robot},
        0.1,
        sources=[source],
        ids=np.array([0, -1, -2, -3, -4, -5]),
        journeys=JourneyAssignment((), -1),
    )
    for _ in range(30):
        scene = world.step({0: Twist()})
    assert 2 <= scene.active.sum() <= 6
    there = np.flatnonzero(scene.active[0, 1:]) + 1
    limbs = world.limbs()
    for agent in there:
        rows = limbs.owner == agent
        assert np.all(limbs.radius[0, rows] > 0.0)
        middle = limbs.start[0, rows, :2].mean(axis=0)
        assert np.abs(middle - scene.position[0, agent]).max() < 0.4
    assert mujoco.mj_versionString()


@pytest.mark.parametrize("people", sizes(12, 30))
def test_a_crowd_stays_sound_and_memory_does_not_grow(people):
    """People go to and fro in a closed room among props and a robot; ``tools/endurance.py`` does it for long."""
    robot = load("cuybot")
    scene = crowded(people, robot, seed=2, size=9.0)
    scene = scene.replace(walls=Scene.of([[0.0, 0.0]], walls=[[(-6, -6), (-6, 6), (6, 6), (6, -6)]]).walls)
    stage = PhysicsStage(props=(Cube(2.0, 2.0), Table(-4.0, 4.0)))
    world = PhysicsWorld(scene, ORCA(), {people: robot}, 0.1, stage=stage, contact=ContactModel())
    draw, used = np.random.default_rng(0), []
    for k in range(150):
        if k % 30 == 0:
            goal = draw.uniform(-5.0, 5.0, scene.goal.shape)
            world.scene = world.scene.replace(goal=np.where(scene.external[..., None], scene.goal, goal))
        if k == 50:
            tracemalloc.start()
        now = world.step({people: Twist(0.5, 0.4)})
        here = now.position[now.active]
        assert np.all(np.isfinite(here))
        assert np.all(np.isfinite(world.data.qpos))
        assert np.abs(here).max() < 6.0
        if k in (90, 149):
            used.append(tracemalloc.get_traced_memory()[0])
    tracemalloc.stop()
    assert np.abs(world.prop(0)[:2, 3]).max() < 6.0
    assert used[1] - used[0] < 200_000
    events = [event for event in world.contact_events if event.second.kind == "person"]
    assert events
    assert max(event.simulated_peak for event in events) < 4000.0  # no limb is ever put inside of something

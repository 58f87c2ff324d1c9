"""Every drive and world of the room keeps its contract."""

import numpy as np
import pytest
from physics_worlds import ram

from crowdbot import world as room
from crowdbot.core import InputError, Pose, Scene, SpatialPose, Twist, Walls, builtin_classes, from_attributes
from crowdbot.humans import People
from crowdbot.models import ORCA

DRIVES = builtin_classes(room, room.Drive)
WORLDS = builtin_classes(room, room.World)
STAGE = room.PhysicsStage(props=(room.Cube(0.0, 3.0, size=0.4, fixed=True),))


@pytest.mark.parametrize("kind", DRIVES.values(), ids=list(DRIVES))
def test_drives(kind):
    drive = from_attributes(kind, {"max-speed": "0.8"})
    assert (drive.max_speed, kind.__dataclass_params__.frozen) == (0.8, True)
    pose, twist = Pose.of(np.zeros((3, 2)), 0.2), room.Twists.of(Twist(), 3)
    after, changed = drive.step(pose, twist, Twist(0.5, 0.5), 0.1)
    assert after.position.shape == (3, 2)
    assert after.heading.shape == changed.forward.shape == changed.turn.shape == changed.left.shape == (3,)
    assert np.all(changed.forward > 0.0)
    for _ in range(100):
        after, changed = drive.step(after, changed, Twist(), 0.1)
    assert changed.at(0) == Twist()


def build(kind, wall=9.0, latency=0.0):
    """Return a world of this kind with one robot at the origin, one person and a wall ahead; dt = 0.1 s."""
    start = Scene.of(
        [[0.0, 0.0], [5.0, 2.0]], goal=[[0.0, 0.0], [9.0, 2.0]], external=[True, False], heading=[0.0, 0.0],
        radius=[0.4, 0.25], walls=Walls.of([[(wall, -5.0), (wall, 5.0)], *STAGE.outlines()]),
    )  # fmt: skip
    robot = ram(50.0, 0.5)
    if latency:
        robot = room.Robot("ram", robot.model, robot.drive, latency, base="planar")
    people = People.of(["man-20"])
    if kind == "physics-world":
        bare = start.replace(walls=Walls.of([[(wall, -5.0), (wall, 5.0)]]))
        world = room.PhysicsWorld(bare, ORCA(), {0: robot}, 0.1, stage=STAGE, people=people)
    else:
        world = room.PlanarWorld(start, ORCA(), {0: robot.drive}, 0.1, latency={0: latency})
    world.embody({0: robot}, STAGE, people, walls=Walls.of([[(wall, -5.0), (wall, 5.0)]]))
    return world


def each_world(function):
    return pytest.mark.parametrize("kind", list(WORLDS))(function)


@each_world
def test_a_step_advances_scene_and_clock(kind):
    world = build(kind)
    scene = world.step({0: Twist(0.5, 0.0)})
    assert scene is world.scene
    assert scene.time == world.clock.time == pytest.approx(0.1)
    assert scene.shape == (1, 2)
    assert world.dt == 0.1
    assert world.ids.tolist() == [[0, 1]]
    assert world.twists[0].forward[0] > 0.0
    assert world.pose(0).position[0].tolist() == scene.position[0, 0].tolist()


@each_world
def test_without_contact_there_are_no_forces(kind):
    world = build(kind)
    for _ in range(3):
        world.step({0: Twist(0.5, 0.0)})
    assert (world.contacts, world.forces, world.contact_events) == ((), (), ())
    assert world.wall_clearance(0).shape == (1,)
    assert world.wall_clearance(0)[0] > 0.0


@each_world
def test_driving_into_a_wall_is_a_contact_with_it(kind):
    world, least = build(kind, wall=0.7), np.inf
    for _ in range(30):
        world.step({0: Twist(0.5, 0.0)})
        least = min(least, float(world.wall_clearance(0)[0]))
    assert least < 0.0
    assert bool(world.forces) == (kind == "physics-world") == bool(world.contact_events)


@each_world
def test_the_world_delays_commands_by_the_latency_of_the_robot(kind):
    world, moving = build(kind, latency=0.3), []
    for _ in range(6):
        world.step({0: Twist(0.5, 0.0)})
        moving.append(bool(world.twists[0].forward[0] > 0.05))
    assert moving == [False, False, False, True, True, True]


@each_world
def test_sensors_are_mounted_in_space_and_in_the_plane(kind):
    world = build(kind)
    world.step({0: Twist(0.5, 0.5)})
    frame = room.frame((0.2, 0.1, 0.5))
    mount = room.MountPlacement("", frame, (0.2, 0.1, 0.5, 0.0, 0.0, 0.0))
    flat, space = world.sensor_pose(0, mount, False), world.sensor_pose(0, mount, True)
    assert isinstance(flat, Pose)
    assert isinstance(space, SpatialPose)
    x, y = world.scene.position[0, 0]
    angle = world.scene.heading[0, 0]
    ahead = [x + 0.2 * np.cos(angle) - 0.1 * np.sin(angle), y + 0.2 * np.sin(angle) + 0.1 * np.cos(angle)]
    assert flat.position[0].tolist() == pytest.approx(ahead, abs=1e-6)
    assert space.position[0, :2].tolist() == pytest.approx(ahead, abs=1e-3)
    assert space.position[0, 2] == pytest.approx(0.5, abs=0.01)


@each_world
def test_sensors_see_props_and_bodies(kind):
    world = build(kind)
    world.step({0: Twist()})
    world.pose_people()
    assert len(world.plane_scene().walls) == len(build("planar-world").scene.walls)
    seen = world.body_scene()
    assert seen.bodies is not None
    assert seen.wall_height == STAGE.wall_height
    assert world.people.agents.tolist() == [1]
    feet = world.people.ends[0].reshape(-1, 3)[:, :2]
    assert np.hypot(*(feet.mean(axis=0) - world.scene.position[0, 1])) < 0.5


@each_world
def test_a_world_says_what_is_wrong_with_commands(kind):
    world = build(kind)
    with pytest.raises(InputError, match="robot 0 has no command"):
        world.step({})
    with pytest.raises(InputError, match="agent 1 has a command but is not a robot; robots are"):
        world.step({0: Twist(), 1: Twist()})


def test_a_planar_world_without_bodies_says_so():
    start = Scene.of([[0.0, 0.0]], external=[True])
    world = room.PlanarWorld(start, ORCA(), {0: room.DifferentialDrive()}, 0.1)
    with pytest.raises(InputError, match=r"no bodies of people and robots: call World\.embody first"):
        world.body_scene()


def test_the_room_shows_its_contracts():
    assert set(DRIVES) == {
        "ackermann-drive",
        "differential-drive",
        "legged-drive",
        "mecanum-drive",
        "omni-wheel-drive",
        "omnidirectional",
        "skid-steer-drive",
        "tricycle-drive",
        "velocity-servo",
    }
    assert set(WORLDS) == {"physics-world", "planar-world"}
    assert all(hasattr(room, name) for name in room.__all__)


@each_world
def test_a_selected_world_has_people_of_its_own(kind):
    world = build(kind)
    world.step({0: Twist()})
    world.pose_people()
    some = room.select_environments(world, [0])
    feet = world.people.ends[0].copy()
    np.testing.assert_array_equal(some.people.ends[0], feet)
    for _ in range(5):
        some.step({0: Twist()})
        some.pose_people()
    assert some.people is not world.people
    assert np.abs(some.people.ends[0] - feet).max() > 0.1
    np.testing.assert_array_equal(world.people.ends[0], feet)

"""Observation: what a robot knows, and the straight way to its goal."""

import math

import numpy as np
import pytest

from crowdbot.core import InputError, Pose, Scene, SpatialPose, Twist
from crowdbot.navigation import DriveLimits, Observation, VisiblePeople
from crowdbot.sensors import Infrared, Lidar2D
from crowdbot.world import DifferentialDrive, Twists

LIMITS = DriveLimits(1.0, 2.0, 1.0, 3.0)


def alone(**changes):
    known = {"pose": (0.0, 0.0, 0.0), "goal": (4.0, 0.0), "radius": 0.3, "limits": LIMITS, "dt": 0.1}
    return Observation(**(known | changes))


def crowd():
    place = [[1.0, 1.0], [3.0, 1.0], [1.0, 6.0], [0.0, 1.0]]
    return Scene.of(
        place,
        [[0.0, 0.5], [-1.0, 0.0], [0.0, 0.0], [1.0, 0.0]],
        heading=[math.pi / 2, 0.0, 0.0, 0.0],
        goal=[[9.0, 1.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]],
        radius=[0.3, 0.2, 0.25, 0.2],
        external=[True, False, False, False],
        active=[True, True, True, False],
        walls=[[(-5.0, -5.0), (5.0, -5.0)]],
        time=2.5,
    )


def test_from_a_scene():
    seen = Observation.of(crowd(), 0, LIMITS, dt=0.1)
    assert seen.pose == (1.0, 1.0, math.pi / 2)
    assert (seen.goal, seen.radius, seen.time, len(seen.walls)) == ((9.0, 1.0), 0.3, 2.5, 2)
    assert seen.people.position.tolist() == [[3.0, 1.0], [1.0, 6.0]]
    assert seen.people.velocity.tolist() == [[-1.0, 0.0], [0.0, 0.0]]
    assert seen.people.radius.tolist() == [0.2, 0.25]
    assert seen.twist.forward == pytest.approx(0.5)
    np.testing.assert_allclose(seen.velocity, [0.0, 0.5], atol=1e-15)


def test_nobody_knows_more_than_they_see():
    assert len(Observation.of(crowd(), 0, LIMITS, dt=0.1, sight=3.0).people) == 1
    masked = Observation.of(crowd(), 0, LIMITS, dt=0.1, seen=np.array([False, False, True, True]))
    assert masked.people.position.tolist() == [[1.0, 6.0]]


def test_clearances():
    seen = Observation.of(crowd(), 0, LIMITS, dt=0.1)
    np.testing.assert_allclose(seen.clearances, [1.5, 4.45])
    assert seen.nearest == pytest.approx(1.5)
    assert alone().nearest == math.inf


@pytest.mark.parametrize(
    ("goal", "bearing"),
    [((4.0, 0.0), 0.0), ((0.0, 3.0), 1.0), ((0.0, -3.0), -1.0), ((-2.0, 0.0), 2.0), ((0.0, 0.0), 0.0)],
)
def test_bearing(goal, bearing):
    assert abs(alone(goal=goal).bearing) == pytest.approx(abs(bearing) * math.pi / 2)


def test_it_turns_first_when_the_goal_is_behind():
    twist = alone(goal=(-4.0, 0.5)).towards_goal(0.8)
    assert twist.forward == 0.0
    assert twist.turn == 2.0
    assert alone(goal=(-4.0, -0.5)).towards_goal(0.8).turn == -2.0


def test_it_slows_near_the_goal():
    speeds = [alone(goal=(away, 0.0)).towards_goal(0.8).forward for away in (4.0, 0.3, 0.1, 0.0)]
    assert speeds[0] == 0.8
    assert sorted(speeds, reverse=True) == speeds
    assert speeds[-1] == 0.0


@pytest.mark.parametrize("goal", [(4.0, 0.0), (-3.0, 1.0), (0.0, -2.0), (0.05, 0.4), (-0.3, 0.0)])
def test_the_drive_arrives_and_stops_there(goal):
    drive = DifferentialDrive(*LIMITS[:4])
    pose, twist = Pose.of((0.0, 0.0), 0.0), Twists.of(Twist(), 1)
    for _ in range(150):
        here = (float(pose.position[0, 0]), float(pose.position[0, 1]), float(pose.heading[0]))
        command = alone(pose=here, goal=goal, twist=twist.at(0)).towards_goal(1.0)
        pose, twist = drive.step(pose, twist, command, 0.1)
    assert math.dist(pose.position[0], goal) < 0.1
    assert abs(twist.forward[0]) < 0.05


@pytest.mark.parametrize("acceleration", [0.5, 1.0, 2.0])
def test_the_braking_speed_stops_within_the_distance_with_a_reserve(acceleration):
    speed = alone(limits=DriveLimits(3.0, 2.0, acceleration, 3.0)).braking_speed(0.6)
    assert speed**2 / (2.0 * acceleration) == pytest.approx(0.8 * 0.6)  # v^2 = 2 a d


def test_unknown_accelerations_do_not_limit():
    fast = alone(limits=DriveLimits(1.0, 2.0))
    assert fast.braking_speed(0.1) == math.inf
    assert fast.turn_by(0.1) == pytest.approx(0.3)
    assert alone().turn_by(-0.001) == pytest.approx(-0.003)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"pose": (math.nan, 0.0, 0.0)}, "pose = \\(nan, 0.0, 0.0\\) is not finite"),
        ({"goal": (math.inf, 0.0)}, "goal"),
        ({"twist": Twist(math.nan)}, "twist"),
        ({"radius": -0.3}, "radius = -0.3 must be above 0"),
        ({"dt": 0.0}, "dt = 0.0 must be above 0"),
        ({"limits": DriveLimits(-1.0, 2.0)}, "max_speed = -1.0 must be above 0"),
        ({"limits": DriveLimits(1.0, math.nan)}, "max_turn_rate = nan must be above 0"),
    ],
)
def test_wrong_values_are_explained(changes, message):
    with pytest.raises(InputError, match=f"observation: {message}"):
        alone(**changes)


def test_nobody_is_an_empty_crowd():
    assert len(VisiblePeople.none()) == 0
    assert VisiblePeople.none().position.shape == (0, 2)


def test_people_have_ids_and_the_waypoint_is_the_goal_by_default():
    seen = Observation.of(crowd(), 0, LIMITS, dt=0.1)
    assert seen.people.ids.tolist() == [1, 2]
    numbered = Observation.of(crowd(), 0, LIMITS, dt=0.1, ids=np.array([10, 21, 35, 4]))
    assert numbered.people.ids.tolist() == [21, 35]
    assert VisiblePeople(np.zeros((2, 2)), np.zeros((2, 2)), np.ones(2)).ids.tolist() == [0, 1]
    assert (alone().waypoint, alone().remaining) == ((4.0, 0.0), 4.0)
    assert (alone().readings, alone().odometry, alone().scan, alone().tracks) == ({}, None, None, None)


def test_it_drives_to_the_waypoint_and_slows_by_the_length_of_the_path():
    aside = alone(waypoint=(0.0, 0.4))
    assert aside.bearing == 0.0
    assert aside.direction_to(aside.waypoint) == pytest.approx(math.pi / 2)
    assert aside.remaining == pytest.approx(0.4 + math.hypot(4.0, 0.4))
    assert aside.towards_goal(0.8) == Twist(0.0, 2.0, 0.0)
    assert alone(waypoint=(0.1, 0.0)).towards_goal(0.8).forward == 0.8
    with pytest.raises(InputError, match="observation: waypoint = \\(nan, 0.0\\) is not finite"):
        alone(waypoint=(math.nan, 0.0))


def test_the_scan_is_that_of_the_widest_horizontal_scanner():
    """Narrow, tilted and single beams come first, and stay readings by name."""
    scene = Scene.of([[2.0, 0.0]], radius=0.3)
    level, down = SpatialPose.of((0.0, 0.0, 0.3)), SpatialPose.of((0.0, 0.0, 0.3), pitch=1.2)
    readings = {
        "cliff": Lidar2D(rays=2, field_of_view=0.1).read(scene, level),
        "floor": Lidar2D(rays=900, field_of_view=4.0).read(scene, down),
        "range": Infrared().read(scene, level),
        "coarse": Lidar2D(rays=90, field_of_view=3.0).read(scene, level),
        "fine": Lidar2D(rays=180, field_of_view=3.0).read(scene, SpatialPose.of((0.0, 0.0, 0.3), roll=math.pi)),
        "again": Lidar2D(rays=180, field_of_view=3.0).read(scene, level),
    }
    seen = alone(readings=readings)
    assert seen.scan is readings["fine"]
    assert seen.readings.keys() == readings.keys()
    assert alone(readings={name: readings[name] for name in ("range", "floor")}).scan is None
    assert alone(readings={"cliff": readings["cliff"]}).scan is readings["cliff"]

"""The robots that ship: on their wheels, as large and heavy as they say, and as fast as commanded."""

import functools
from importlib import resources

import mujoco
import numpy as np
import pytest
from physics_worlds import alone, facing

from crowdbot.core import Pose, Scene, Twist, stream
from crowdbot.models import ORCA
from crowdbot.sensors import SensorView, WheelOdometry
from crowdbot.world import DifferentialDrive, Omnidirectional, PlanarWorld, Robot, Twists, builtin_robots
from crowdbot.world.urdf import BaseServo, mjcf
from samples import sample

NAMES = builtin_robots()
ASSETS = resources.files("crowdbot").joinpath("assets", "robots")
PUBLISHED = {  # mass [kg], height [m], and widest extent [m] with the tolerance; see the README files
    "cuybot": (100.0, 1.28, 0.573),
    "differential": (18.3, 0.355, 0.5),
    "pepper": (28.68, 1.21, 0.48),
    "qolo": (94.7, 1.79, 0.85),
    "turtlebot2": (6.3, 0.42, 0.36),
    "wheelchair": (172.0, 1.22, 1.11),
    "wheelchair-3d": (172.0, 1.22, 1.11),
    "wheelchair-rider": (172.0, 1.22, 1.11),
}
load = functools.cache(Robot.load)


@pytest.mark.parametrize("name", NAMES)
def test_they_are_as_published(name):
    robot = load(name)
    mass, height, extent = PUBLISHED[name]
    assert robot.model.warnings == ()
    assert robot.about
    assert robot.model.mass == pytest.approx(mass, rel=1e-3)
    assert robot.height == pytest.approx(height, abs=0.015)
    assert np.ptp(robot.footprint, axis=0).max() == pytest.approx(extent, abs=0.015)
    assert robot.model.root == "base_link"


@pytest.mark.parametrize("name", NAMES)
def test_the_footprint_is_what_the_colliders_take(name):
    robot = load(name)
    outline = robot.model.footprint(robot.posture)
    np.testing.assert_allclose(robot.footprint.min(axis=0), outline.min(axis=0), atol=1e-3)
    np.testing.assert_allclose(robot.footprint.max(axis=0), outline.max(axis=0), atol=1e-3)
    assert robot.radius == pytest.approx(np.hypot(*outline.T).max(), abs=1e-3)


@pytest.mark.parametrize("name", NAMES)
def test_they_stand_on_the_ground_and_see_from_inside_their_height(name):
    robot = load(name)
    points = robot.model.points(robot.posture)
    assert abs(points[:, 2].min()) < 1e-3
    assert robot.mounts
    for mount in robot.mounts:
        matrix = robot.sensor_frame(mount.name)
        assert 0.0 <= matrix[2, 3] <= robot.height + 0.05
        pose = Pose.of((1.0, 2.0), 0.5)
        heading = np.arctan2(matrix[1, 0], matrix[0, 0])
        flat, deep = pose.offset(matrix[0, 3], matrix[1, 3], heading), robot.sensor_pose(mount.name, pose)
        assert deep.position[:, :2] == pytest.approx(flat.position)
        scene = Scene.of([[9.0, 9.0]])
        for place in (flat, deep):
            assert mount.sensor.read(scene, place, stream(0, "scan")).pose is place


OWN = {  # what every robot senses with: names of its mounts by kind
    "cuybot": {"Lidar2D": 1, "WheelOdometry": 1, "DepthCamera": 1, "RGBCamera": 1},
    "differential": {"Lidar2D": 1, "WheelOdometry": 1, "Bumper": 1},
    "pepper": {
        "Lidar2D": 5,
        "Ultrasound": 2,
        "DepthCamera": 1,
        "RGBCamera": 2,
        "IMU": 1,
        "Bumper": 1,
        "WheelOdometry": 1,
    },
    "qolo": {"Lidar2D": 2, "Lidar3D": 2, "DepthCamera": 1, "RGBCamera": 1, "WheelOdometry": 1, "Bumper": 1},
    "turtlebot2": {
        "Lidar2D": 1,
        "DepthCamera": 1,
        "RGBCamera": 1,
        "WheelOdometry": 1,
        "IMU": 1,
        "Bumper": 1,
        "Infrared": 3,
    },
    "wheelchair": {"Lidar2D": 1, "WheelOdometry": 1, "IMU": 1},
    "wheelchair-3d": {"Lidar3D": 1, "DepthCamera": 2, "RGBCamera": 1, "WheelOdometry": 1, "IMU": 1},
    "wheelchair-rider": {"Lidar2D": 1, "WheelOdometry": 1, "IMU": 1},
}


@pytest.mark.parametrize("name", NAMES)
def test_every_robot_has_its_own_sensors_and_says_where_they_are_from(name):
    robot = load(name)
    kinds = [type(mount.sensor).__name__ for mount in robot.mounts]
    assert {kind: kinds.count(kind) for kind in kinds} == OWN[name]
    text = (ASSETS / name / "README.md").read_text(encoding="utf-8")
    for mount in robot.mounts:
        assert f"`{mount.name}`" in text
    for mount in robot.mounts:
        if isinstance(mount.sensor, WheelOdometry) and robot.base == "wheels":
            speeds = robot.wheel_speeds(Twist(0.0, 1.0))
            assert max(speeds.values()) * mount.sensor.wheel_radius == pytest.approx(0.5 * mount.sensor.track)
            assert {wheel.radius for wheel in robot.wheels} == {mount.sensor.wheel_radius}


def test_colour_cameras_look_where_their_frames_look():
    """Pepper's upper one ahead, the lower one 40 degrees down; as wide as high in pixels of one size."""
    pepper = load("pepper")
    ahead = {name: pepper.sensor_frame(name)[:3, 0] for name in ("camera_top", "camera_bottom")}
    assert ahead["camera_top"] == pytest.approx([1.0, 0.0, 0.0], abs=1e-6)
    assert np.degrees(np.arcsin(-ahead["camera_bottom"][2])) == pytest.approx(40.0, abs=0.01)
    lens = pepper.mount("camera_top").sensor.lens
    assert np.degrees(2.0 * np.arctan(0.5 * lens.width / lens.fx)) == pytest.approx(57.2, abs=0.01)
    assert np.degrees(2.0 * np.arctan(0.5 * lens.height / lens.fy)) == pytest.approx(44.3, abs=0.3)
    lens = load("qolo").mount("color_front").sensor.lens
    assert np.degrees(2.0 * np.arctan(0.5 * lens.height / lens.fy)) == pytest.approx(42.5, abs=0.2)
    for name, camera, depth in (("turtlebot2", "kinect_rgb", "kinect_depth"), ("cuybot", "camera", "depth")):
        robot = load(name)
        assert robot.sensor_frame(camera) == pytest.approx(robot.sensor_frame(depth))
        assert robot.mount(camera).sensor.field_of_view == robot.mount(depth).sensor.field_of_view


def test_cliff_sensors_see_the_floor_and_bumpers_what_touches():
    robot = load("turtlebot2")
    pose = Pose.of((0.0, 0.0), 0.0)
    free, near = Scene.of([[9.0, 9.0]]), Scene.of([[0.42, 0.0]], radius=0.25)
    for side in ("left", "centre", "right"):
        reading = robot.mount(f"cliff_{side}").sensor.read(free, robot.sensor_pose(f"cliff_{side}", pose))
        assert reading.ranges[0] == pytest.approx(0.0316)
    bumper, place = robot.mount("bumper").sensor, robot.sensor_pose("bumper", pose)
    assert not bumper.read(free, place).pressed.any()
    assert bumper.read(near, place).pressed.tolist() == [[True, False, False, False, False, False]]


def test_wheels_measure_what_was_driven_and_lasers_see_bodies_in_the_physics_world():
    """Sensors of a robot in the physics world: odometry within 1 %, the laser meets a leg where it is."""
    world = facing(load("turtlebot2"), gap=2.0, dt=0.1)
    wheels = world.robot_bodies[0].robot.mount("odometry").sensor
    last, state = wheels.measure(SensorView(world.scene, world.pose(0)), wheels.begin())
    for _ in range(20):
        world.step({0: Twist(0.4, 0.0)})
        last, state = wheels.measure(SensorView(world.scene, world.pose(0)), state)
    assert last.estimate.position[0] == pytest.approx(world.pose(0).position[0], abs=0.01)
    laser = world.robot_bodies[0].robot.mount("laser").sensor
    scan = laser.read(world.body_scene().without(0), world.robot_bodies[0].sensor_pose("laser"))
    met = scan.hit[0] == 1
    assert 2 <= met.sum() < 60
    away = world.scene.position[0, 1, 0] - world.scene.position[0, 0, 0]
    assert np.abs(scan.ranges[0, met] - away).max() < 0.4


def resting(robot):
    """Return physics and data after two seconds on the floor, with the motors holding the posture."""
    planar = robot.base == "planar"
    servo = BaseServo(4.0 * robot.model.mass, 1.5 * robot.model.mass) if planar else None
    physics = mjcf(robot.model, base="planar" if planar else "free", floor=True, servo=servo).load()
    physics.opt.timestep = 0.005
    data = mujoco.MjData(physics)
    for joint, position in robot.posture.items():
        data.joint(joint).qpos = data.actuator(joint).ctrl = position
    mujoco.mj_step(physics, data, 400)
    return physics, data


@pytest.mark.parametrize("name", NAMES)
def test_they_stand_still(name):
    robot = load(name)
    physics, data = resting(robot)
    place = data.body("base_link").xpos.copy()
    assert abs(place[2]) < 2e-3
    mujoco.mj_step(physics, data, 400)
    assert np.linalg.norm(data.body("base_link").xpos - place) < 1e-4
    assert data.body("base_link").xmat[8] > np.cos(np.radians(0.1))
    for joint, position in robot.posture.items():
        assert data.joint(joint).qpos[0] == pytest.approx(position, abs=0.05)


def command(robot, data, twist):
    if robot.base == "planar":
        for name, value in (("forward", twist.forward), ("left", twist.left), ("turn", twist.turn)):
            data.actuator(f"base_{name}").ctrl = value
        return
    for joint, speed in robot.wheel_speeds(twist).items():
        data.actuator(joint).ctrl = speed


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(("forward", "turn"), sample([(0.5, 0.3), (1.0, 0.0), (-0.5, 0.0), (0.0, 1.0)], 1, rows=True))
def test_they_reach_the_speed_that_is_commanded(name, forward, turn):
    """Within 1 % in steady state, without overshoot."""
    robot = load(name)
    goal = Twist(forward * robot.drive.max_speed, turn * robot.drive.max_turn_rate)
    world = alone(robot)
    reached = []
    for _ in range(80):
        world.step({0: goal})
        reached.append([float(world.twists[0].forward[0]), float(world.twists[0].turn[0])])
    plane = robot.drive.step(Pose.of((0.0, 0.0), 0.0), Twists.of(goal, 1), goal, 0.05)[1].at(0)
    for part, asked, most in ((0, plane.forward, robot.drive.max_speed), (1, plane.turn, robot.drive.max_turn_rate)):
        speeds = np.array(reached)[:, part]
        assert speeds[-20:].mean() == pytest.approx(asked, rel=0.01, abs=0.002 * most)
        assert np.abs(speeds).max() <= 1.05 * abs(asked) + 0.005 * most


def test_pepper_goes_sideways():
    robot = load("pepper")
    physics, data = resting(robot)
    for _ in range(400):
        command(robot, data, Twist(0.0, 0.0, left=0.4))
        mujoco.mj_step(physics, data)
    speed = np.zeros(6)
    mujoco.mj_objectVelocity(physics, data, mujoco.mjtObj.mjOBJ_XBODY, 1, speed, 1)
    assert speed[4] == pytest.approx(0.4, rel=0.02)


def test_wheels_turn_as_their_geometry_says():
    speeds = load("qolo").wheel_speeds(Twist(0.38, 1.0))
    assert speeds == {
        "left_wheel_joint": pytest.approx((0.38 - 0.27) / 0.19),
        "right_wheel_joint": pytest.approx((0.38 + 0.27) / 0.19),
    }
    ahead = load("pepper").wheel_speeds(Twist(0.1, 0.0))
    assert ahead["WheelB"] == pytest.approx(0.0, abs=1e-9)  # its axle points ahead: its rollers do the work
    assert ahead["WheelFL"] == pytest.approx(-ahead["WheelFR"])


@pytest.mark.parametrize("name", NAMES)
def test_their_drives_move_them_in_the_plane(name):
    robot = load(name)
    assert isinstance(robot.drive, Omnidirectional if name == "pepper" else DifferentialDrive)
    scene = Scene.of([[0.0, 0.0], [8.0, 1.0]], radius=[robot.radius, 0.25], external=[True, False])
    world = PlanarWorld(scene, ORCA(), {0: robot.drive}, dt=0.1)
    for _ in range(50):
        world.step({0: Twist(0.3, 0.0)})
    assert world.scene.position[0, 0, 0] == pytest.approx(1.5, abs=0.1)

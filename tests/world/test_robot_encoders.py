"""Wheels and joints of robots in both worlds, as encoders see them, and the URDF text of robots."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from crowdbot.core import Scene, Twist
from crowdbot.models import ORCA
from crowdbot.sensors import SensorView
from crowdbot.world import (
    DifferentialDrive,
    PhysicsWorld,
    PlanarWorld,
    Robot,
    builtin_robots,
    joint_states,
    read_urdf,
    robot_description,
    wheel_geometry,
    wheel_rotation,
)
from crowdbot.world.urdf import Capsule, Cylinder, Sphere

WALL = [[(0.6, -3.0), (0.6, 3.0), (0.8, 3.0), (0.8, -3.0)]]


def alone(robot: Robot, walls: object = ()) -> Scene:
    return Scene.of([[0.0, 0.0]], external=[True], heading=[0.0], radius=robot.radius, walls=walls)


@pytest.mark.parametrize("name", builtin_robots())
def test_the_wheels_of_a_robot_are_those_of_its_odometry(name: str) -> None:
    robot = Robot.load(name)
    geometry, sensor = wheel_geometry(robot), robot.mount("odometry").sensor
    assert geometry is not None
    assert geometry.track == pytest.approx(sensor.track, rel=1e-9)  # type: ignore[attr-defined]
    assert geometry.radius.tolist() == [sensor.wheel_radius] * len(geometry.joints)  # type: ignore[attr-defined]
    assert geometry.sideways == (name == "pepper")
    assert geometry.center == pytest.approx(0.0 if name != "pepper" else geometry.position[:, 0].mean())


def test_a_robot_without_wheels_has_no_geometry() -> None:
    puck = Robot.disc("puck", DifferentialDrive(), 0.3)
    assert wheel_geometry(puck) is None
    world = PlanarWorld(alone(puck), ORCA(), {0: puck.drive}, dt=0.1)
    assert wheel_rotation(world, 0, None) is None


def test_wheels_are_simulated_in_the_physics_world_only() -> None:
    robot, pepper = Robot.load("turtlebot2"), Robot.load("pepper")
    geometry = wheel_geometry(robot)
    plane = PlanarWorld(alone(robot), ORCA(), {0: robot.drive}, dt=0.1)
    assert wheel_rotation(plane, 0, geometry).angle is None  # type: ignore[union-attr]
    world = PhysicsWorld(alone(robot), ORCA(), {0: robot}, dt=0.1)
    before = wheel_rotation(world, 0, geometry).angle  # type: ignore[union-attr]
    for _ in range(20):
        world.step({0: Twist(0.3)})
    after = wheel_rotation(world, 0, geometry, 0).angle  # type: ignore[union-attr]
    assert (after - before)[0] * 0.035 == pytest.approx(world.scene.position[0, 0, 0], rel=0.02)
    assert joint_states(world, 0, robot)["wheel_left_joint"][0] == after[0, 0]
    pulled = PhysicsWorld(alone(pepper), ORCA(), {0: pepper}, dt=0.1)
    assert wheel_rotation(pulled, 0, wheel_geometry(pepper)).angle is None  # type: ignore[union-attr]


def test_wheels_that_slip_at_a_wall_are_counted() -> None:
    """The robot pushes against a wall: it stands, its wheels do not."""
    robot = Robot.load("differential")
    world = PhysicsWorld(alone(robot, WALL), ORCA(), {0: robot}, dt=0.1)
    wheels, geometry = robot.mount("odometry").sensor, wheel_geometry(robot)
    state = wheels.begin()
    for _ in range(40):
        view = SensorView(world.scene, world.pose(0), wheels=wheel_rotation(world, 0, geometry, 0))
        last, state = wheels.measure(view, state)
        world.step({0: Twist(0.5)})
    assert world.scene.position[0, 0, 0] < 0.4
    assert last.estimate.position[0, 0] > world.scene.position[0, 0, 0] + 0.5
    carried = world.scene.position.copy()
    carried[0, 0] = (-2.0, 1.0)
    world.scene = world.scene.replace(position=carried)
    world.step({0: Twist()})
    view = SensorView(world.scene, world.pose(0), wheels=wheel_rotation(world, 0, geometry, 0))
    again, _ = wheels.measure(view, state)
    assert np.abs(again.estimate.position - last.estimate.position).max() < 0.1  # carrying turns no wheel


def test_joints_rest_in_the_posture_and_at_their_targets() -> None:
    pepper = Robot.load("pepper")
    world = PlanarWorld(alone(pepper), ORCA(), {0: pepper.drive}, dt=0.1)
    found = joint_states(world, 0, pepper, targets={"HeadYaw": 0.5})
    assert found["HeadYaw"] == (0.5, 0.0)
    assert found["LShoulderPitch"] == (1.5, 0.0)
    assert set(found) == {joint.name for joint in pepper.model.joints.values() if joint.size == 1}
    world.step({0: Twist(0.3)})
    speed = joint_states(world, 0, pepper)["WheelFL"][1]
    assert speed == pytest.approx(pepper.wheel_speeds(world.twists[0].at(0))["WheelFL"])


@pytest.mark.parametrize("name", builtin_robots())
def test_the_description_of_a_robot_is_its_file(name: str) -> None:
    robot = Robot.load(name)
    text = robot_description(robot)
    assert text.startswith("<?xml")
    assert all(f'"{link}"' in text for link in robot.model.links)
    folder = next(iter(robot.model.meshes.values())).parents[1] if robot.model.meshes else None
    if folder is None:
        again = read_urdf(text)
        assert again.mass == pytest.approx(robot.model.mass)
        assert {name: matrix.tolist() for name, matrix in again.poses().items()} == {
            name: matrix.tolist() for name, matrix in robot.model.poses().items()
        }


def test_capsules_are_described_by_shapes_that_urdf_has() -> None:
    pepper = Robot.load("pepper")
    text = robot_description(pepper)
    assert "<capsule" in pepper.model.source
    assert "<capsule" not in text
    again = read_urdf(text)
    for name, link in pepper.model.links.items():
        for kind in ("visuals", "collisions"):
            parts, described = getattr(link, kind), getattr(again.links[name], kind)
            rounded = [part for part in parts if isinstance(part.shape, Capsule)]
            assert len(described) == len(parts) + 2 * len(rounded)
            for part in rounded:
                (tube,) = [item for item in described if np.array_equal(item.origin, part.origin)]
                assert tube.shape == Cylinder(part.shape.radius, part.shape.length)
                for end in (0.5, -0.5):
                    center = part.origin[:3, 3] + end * part.shape.length * part.origin[:3, 2]
                    balls = [item for item in described if np.allclose(item.origin[:3, 3], center, atol=1e-12)]
                    assert Sphere(part.shape.radius) in [ball.shape for ball in balls]
                    assert {ball.color for ball in balls} == {part.color}


def test_a_robot_without_a_file_is_described_by_its_links() -> None:
    arm = read_urdf(
        """<robot name="arm"><link name="foot"><inertial><mass value="3"/><inertia ixx="1" iyy="1" izz="1" ixy="0"
        ixz="0" iyz="0"/></inertial><collision><geometry><box size="1 2 3"/></geometry></collision></link>
        <link name="hand"><visual><origin xyz="1 0 0" rpy="0.1 0.2 0.3"/><geometry><sphere radius="0.2"/></geometry>
        <material name="red"><color rgba="1 0 0 1"/></material></visual></link><link name="tip"/>
        <joint name="elbow" type="revolute"><parent link="foot"/><child link="hand"/><axis xyz="0 1 0"/>
        <origin xyz="0 0 1" rpy="0 0 1"/><limit lower="-1" upper="2" effort="5" velocity="3"/></joint>
        <joint name="wrist" type="continuous"><parent link="hand"/><child link="tip"/><axis xyz="0 0 1"/>
        <mimic joint="elbow" multiplier="2"/></joint></robot>"""
    )
    bare = dataclasses.replace(arm, source="")
    robot = dataclasses.replace(Robot.disc("arm", DifferentialDrive(), 0.3), model=bare, footprint=np.zeros((0, 2)))
    again = read_urdf(robot_description(robot))
    assert again.mass == pytest.approx(arm.mass)
    for place in ({}, {"elbow": 0.7}):
        for name, matrix in arm.poses(place).items():
            assert again.poses(place)[name] == pytest.approx(matrix, abs=1e-12)
    assert (again.joints["elbow"].lower, again.joints["elbow"].upper) == (-1.0, 2.0)
    assert again.links["hand"].visuals[0].color == (1.0, 0.0, 0.0, 1.0)
    assert math.isinf(again.joints["wrist"].upper)

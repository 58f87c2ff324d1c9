"""Servos of wheels and of planar bases: the speed that is commanded, within the force of the motors."""

import dataclasses
import math

import mujoco
import numpy as np
import pytest
from physics_worlds import alone, ram

from crowdbot.core import Twist, Walls
from crowdbot.world import PhysicsStage, Robot
from crowdbot.world.physics.robots.wheel_servo import lag

WHEELED = ("cuybot", "differential", "qolo", "turtlebot2", "wheelchair")


def with_drive(robot, **limits):
    return dataclasses.replace(robot, drive=dataclasses.replace(robot.drive, **limits))


@pytest.mark.parametrize("step", [0.002, 0.005, 0.01])
def test_turtlebot_turns_as_asked_at_cruise(step):
    """It turned at 2.09 rad/s, with 25.7 rad/s2, before wheels were solved together with their tyres."""
    robot = Robot.load("turtlebot2")
    world = alone(robot, dt=0.02, physics_dt=step)
    turns = []
    for k in range(150):
        world.step({0: Twist(0.5, 0.0 if k < 75 else 0.5)})
        turns.append(float(world.twists[0].turn[0]))
    assert max(turns) <= 0.5 * 1.01
    assert turns[-1] == pytest.approx(0.5, rel=0.005)
    assert np.abs(np.diff(turns)).max() / 0.02 <= 1.02 * robot.drive.max_turn_acceleration
    assert float(world.twists[0].forward[0]) == pytest.approx(0.5, rel=0.005)


@pytest.mark.parametrize("name", WHEELED)
def test_wheels_in_the_air_reach_their_speed_without_oscillation(name):
    """A stiff explicit motor would throw a light wheel to and fro between its torque limits."""
    robot = Robot.load(name)
    world = alone(robot, dt=0.02, physics_dt=0.01)
    world.engine_model.opt.gravity[:] = 0.0
    world.data.qpos[2] += 1.0
    world.data.qvel[:] = 0.0
    joints = [wheel.joint for wheel in robot.wheels]
    speeds = []
    goal = Twist(0.5 * robot.drive.max_speed, 0.0)
    try:
        for _ in range(150):
            world.step({0: goal})
            speeds.append([world.robot_body(0).joints()[joint][1] for joint in joints])
    finally:
        world.engine_model.opt.gravity[2] = -9.81
    wanted = robot.wheel_speeds(goal)
    for joint, row in zip(joints, np.transpose(speeds), strict=True):
        assert row[-1] == pytest.approx(wanted[joint], rel=0.01)
        assert row.max() <= 1.01 * wanted[joint]
        assert np.all(np.diff(row) > -1e-3 * wanted[joint])


def test_a_motor_pushes_with_its_torque_and_not_more():
    """Against a wall, tyres push with the torque of both motors by the radius of the wheels."""
    robot = with_drive(Robot.load("differential"), max_speed=0.3)
    model = robot.model
    joints = dict(model.joints)
    for wheel in robot.wheels:
        motor = dataclasses.replace(joints[wheel.joint].motor, effort=1.0)
        joints[wheel.joint] = dataclasses.replace(joints[wheel.joint], motor=motor)
    weak = dataclasses.replace(robot, model=dataclasses.replace(model, joints=joints))
    wall = Walls.of([[(0.5, -2.0), (0.7, -2.0), (0.7, 2.0), (0.5, 2.0)]])
    world = alone(weak, walls=wall)
    forces = []
    for _ in range(80):
        world.step({0: Twist(0.3, 0.0)})
        forces.append(sum(row.force for row in world.forces))
    assert np.mean(forces[-20:]) == pytest.approx(2.0 * 1.0 / 0.08, rel=0.03)


def test_a_slippery_floor_limits_what_tyres_bear():
    """On a floor with friction 0.05, the robot gains speed no faster than the floor allows; slipping tyres jerk."""
    robot = with_drive(Robot.load("differential"), max_acceleration=2.0)
    world = alone(robot, stage=PhysicsStage(friction=0.05))
    speeds = [0.0]
    for _ in range(40):
        world.step({0: Twist(1.0, 0.0)})
        speeds.append(float(world.twists[0].forward[0]))
    assert np.all(np.array(speeds)[10:] < 0.05 * 9.81 * 0.05 * np.arange(10, 41))
    assert 0.2 < speeds[-1] < 1.0


def test_upright_cylinders_do_not_find_contacts_out_of_rounding_errors():
    """The engine once found a contact as deep as the radius of this robot while it turned on the spot."""
    world = alone(Robot.load("differential"), dt=0.1)
    model = world.engine_model
    cylinders = np.flatnonzero(model.geom_type == mujoco.mjtGeom.mjGEOM_CYLINDER)
    assert len(cylinders)
    tilts = []
    for _ in range(50):
        world.step({0: Twist(0.0, 1.5)})
        tilts.append(world.robot_body(0).tilt)
        axes = world.data.geom_xmat[cylinders][:, [2, 5]]
        assert np.all(np.hypot(*axes.T) > 1e-9)
    assert max(tilts) < 1e-3


def test_a_planar_base_keeps_its_velocity_in_curves():
    """The servo does not lag behind: no sideways speed at full speed and turn rate."""
    robot = Robot.load("pepper")
    world = alone(robot, dt=0.02, physics_dt=0.005)
    for _ in range(200):
        world.step({0: Twist(0.4, 1.5, left=0.2)})
    twist = world.twists[0]
    assert (float(twist.forward[0]), float(twist.left[0]), float(twist.turn[0])) == pytest.approx(
        (0.4, 0.2, 1.5), rel=0.005, abs=0.002
    )


def test_a_planar_base_pulls_with_four_newton_for_each_kilogram():
    robot = ram(50.0, 1.0)
    wall = Walls.of([[(0.6, -2.0), (0.8, -2.0), (0.8, 2.0), (0.6, 2.0)]])
    world = alone(robot, walls=wall)
    forces = []
    for _ in range(60):
        world.step({0: Twist(3.0, 0.0)})
        forces.append(sum(row.force for row in world.forces))
    assert np.mean(forces[-20:]) == pytest.approx(4.0 * 50.0, rel=0.02)


def test_the_time_constant_is_at_least_two_steps():
    assert lag(0.002) == 0.01
    assert lag(0.02) == 0.04
    assert math.isclose(lag(0.005), 0.01)

"""Bases of every kind drive in both worlds as they are asked."""

import math

import numpy as np
import pytest
from base_texts import base_file

from crowdbot.benchmark import measure_drives
from crowdbot.core import RobotError, Scene, Twist
from crowdbot.models import ORCA
from crowdbot.world import PhysicsStage, PhysicsWorld, PlanarWorld, Robot, import_robot
from samples import sample

DT = 0.05


def robot_of(folder, kind, text=None):
    """Return the robot of a maker's file with a kind of base."""
    file = folder / "maker.urdf.xacro"
    file.write_text(text or base_file(kind))
    made = import_robot(file, "maker")
    for name, content in made.texts.items():
        (folder / name).write_text(content)
    return Robot.load(folder)


def scene_of(robot):
    return Scene.of([[0.0, 0.0]], external=[True], heading=[0.0], radius=robot.radius)


def driven(world, twist, seconds=3.0):
    """Return the twist over the last half second: forward, turn, left."""
    rows = []
    for _ in range(round(seconds / DT)):
        scene = world.step({0: twist})
        rows.append((*scene.position[0, 0], scene.heading[0, 0]))
    rows = np.array(rows)[-11:]
    turn = np.diff(np.unwrap(rows[:, 2]))
    middle = rows[:-1, 2] + 0.5 * turn
    step = np.diff(rows[:, :2], axis=0)
    ahead = np.cos(middle) * step[:, 0] + np.sin(middle) * step[:, 1]
    aside = np.cos(middle) * step[:, 1] - np.sin(middle) * step[:, 0]
    return np.mean([ahead, turn, aside], axis=1) / DT


COMMANDS = {
    "skid-steer": [(0.8, 0.0), (0.0, 1.0), (0.5, 1.0), (-0.5, 0.7)],
    "mecanum": [(0.8, 0.0), (0.0, 1.0), (0.5, 1.0), (0.0, 0.0, 0.6), (0.4, 0.5, -0.4)],
    "omnidirectional": [(0.8, 0.0), (0.0, 1.0), (0.5, 1.0), (0.0, 0.0, 0.6), (0.4, 0.5, -0.4)],
    "ackermann": [(0.8, 0.0), (0.6, 0.4), (-0.5, 0.3)],
    "tricycle": [(0.8, 0.0), (0.6, 0.6), (-0.5, 0.4)],
    "legged": [(0.8, 0.0), (0.0, 1.0), (0.5, 1.0), (0.0, 0.0, 0.4)],
}


@pytest.mark.parametrize("kind", COMMANDS)
def test_every_kind_drives_as_asked_in_both_worlds(tmp_path, kind):
    robot = robot_of(tmp_path, kind)
    assert robot.base == ("planar" if kind == "legged" else "wheels")
    for row in COMMANDS[kind]:
        twist = Twist(*row)
        flat = driven(PlanarWorld(scene_of(robot), ORCA(), {0: robot.drive}, DT), twist)
        solid = driven(PhysicsWorld(scene_of(robot), ORCA(), {0: robot}, DT), twist)
        many = 3 if kind != "skid-steer" else 2  # skid-steer bases slide sideways, in both worlds
        np.testing.assert_allclose(flat[:many], twist[:many], atol=1e-3)  # chords
        assert solid[2] == pytest.approx(flat[2], abs=0.05 * max(abs(twist.forward), 0.2))
        speed = math.hypot(twist.forward, twist.left)
        np.testing.assert_allclose(solid[:many][[0, *range(2, many)]], flat[:many][[0, *range(2, many)]],
                                   atol=0.05 * max(speed, 0.2))  # fmt: skip
        assert solid[1] == pytest.approx(twist.turn, rel=0.05, abs=0.01)


@pytest.mark.parametrize("friction", [0.4, 1.0])
def test_skid_steering_finds_its_slip_on_any_floor(tmp_path, friction):
    robot = robot_of(tmp_path, "skid-steer")
    world = PhysicsWorld(scene_of(robot), ORCA(), {0: robot}, DT, stage=PhysicsStage(friction=friction))
    forward, turn, _ = driven(world, Twist(0.3, 0.8))
    assert (forward, turn) == (pytest.approx(0.3, rel=0.05), pytest.approx(0.8, rel=0.05))
    body = world.robot_bodies[0]
    weight = robot.model.mass * 9.81
    assert body.loads.sum() == pytest.approx(weight, rel=0.02)
    speeds = [body.joints()[wheel.joint][1] * wheel.radius for wheel in robot.wheels]
    effective = (max(speeds) - min(speeds)) / 0.8
    assert effective / robot.drive.track == pytest.approx(robot.drive.slip_factor, rel=0.15)


def test_a_skid_steer_base_stays_where_it_is(tmp_path):
    robot = robot_of(tmp_path, "skid-steer")
    world = PhysicsWorld(scene_of(robot), ORCA(), {0: robot}, DT)
    driven(world, Twist(0.0, 1.0), 1.0)
    driven(world, Twist(), 1.0)
    before = world.pose(0)
    driven(world, Twist(), 2.0)
    np.testing.assert_allclose(world.pose(0).position, before.position, atol=1e-4)
    np.testing.assert_allclose(world.pose(0).heading, before.heading, atol=1e-4)


def test_a_ghost_skids_as_any_other_robot(tmp_path):
    robot = robot_of(tmp_path, "skid-steer")
    world = PhysicsWorld(scene_of(robot), ORCA(), {0: robot}, DT, ghosts=(0,))
    forward, turn, _ = driven(world, Twist(0.3, 0.8))
    assert (forward, turn) == (pytest.approx(0.3, rel=0.05), pytest.approx(0.8, rel=0.05))


def test_wheels_turn_as_the_drive_computes(tmp_path):
    for kind in ("mecanum", "omnidirectional"):
        robot = robot_of(tmp_path, kind)
        twist = Twist(0.3, 0.2, 0.1)
        speeds = np.abs(list(robot.wheel_speeds(twist).values()))  # the axles of the file point outwards
        np.testing.assert_allclose(np.sort(speeds), np.sort(np.abs(robot.drive.wheel_speeds(twist))), atol=1e-6)


def test_a_car_does_not_steer_its_inner_wheel_beyond_its_joint(tmp_path):
    robot = robot_of(tmp_path, "ackermann")
    for sign in (1.0, -1.0):
        angles = robot.steering(robot.drive.motion(sign * robot.drive.max_steering))
        assert max(abs(angle) for angle in angles.values()) == pytest.approx(0.5)


def test_a_tricycle_with_rear_motors_is_driven_by_them(tmp_path):
    control = "<ros2_control name='c' type='system'>" + "".join(
        f"<joint name='rear_{side}_joint'><command_interface name='velocity'/></joint>" for side in ("left", "right")
    ) + "</ros2_control></robot>"  # fmt: skip
    robot = robot_of(tmp_path, "tricycle", base_file("tricycle").replace("</robot>", control))
    assert type(robot.drive).__name__ == "AckermannDrive"
    assert [wheel.driven for wheel in robot.wheels if wheel.steering] == [False]
    forward, turn, _ = driven(PhysicsWorld(scene_of(robot), ORCA(), {0: robot}, DT), Twist(0.6, 0.4))
    assert (forward, turn) == (pytest.approx(0.6, rel=0.05), pytest.approx(0.4, rel=0.05))


def test_wrong_rollers_are_explained(tmp_path):
    robot_of(tmp_path, "mecanum")
    file = tmp_path / "robot.xml"
    file.write_text(file.read_text().replace('rollers="0.785398163"', 'rollers="2"'))
    with pytest.raises(RobotError, match="rollers = 2.0 rad of '.*' must be at most 1.4"):
        Robot.load(tmp_path)


HUSKY = "husky/husky_description/urdf/husky.urdf.xacro"
JACKAL = "jackal/jackal_description/urdf/jackal.urdf.xacro"


def real_robot(source, folder):
    made = import_robot(source, "real")
    for path, content in made.texts.items():
        (folder / path).write_text(content)
    for path, file in made.copies.items():
        (folder / path).parent.mkdir(exist_ok=True)
        (folder / path).write_bytes(file.read_bytes())
    return Robot.load(folder)


@pytest.mark.parametrize("step", sample([0.005, 0.002, 0.01], 1))
@pytest.mark.parametrize("name", [HUSKY, JACKAL])
def test_real_skid_steer_robots_do_not_overshoot(urdf, tmp_path, name, step):
    real_robot(urdf / name, tmp_path)
    grid = measure_drives([str(tmp_path)], steps=[step], quick=True).rows[0].grid
    assert grid.overshoot <= 0.05
    assert grid.steady_error <= 0.02
    assert grid.path_error <= 0.02
    assert not grid.fallen


@pytest.mark.parametrize("name", [HUSKY, JACKAL])
def test_real_skid_steer_robots_turn_as_asked(urdf, tmp_path, name):
    robot = real_robot(urdf / name, tmp_path)
    for row in ((0.0, 1.0), (0.5, 0.0), (0.5, 1.0)):
        forward, turn, _ = driven(PhysicsWorld(scene_of(robot), ORCA(), {0: robot}, DT), Twist(*row))
        assert forward == pytest.approx(row[0], rel=0.05, abs=0.01)
        assert turn == pytest.approx(row[1], rel=0.05, abs=0.01)


@pytest.mark.parametrize("step", sample([0.005, 0.002, 0.01], 1))
@pytest.mark.parametrize("kind", COMMANDS)
def test_every_kind_passes_the_drive_laboratory(tmp_path, kind, step):
    robot_of(tmp_path, kind)
    grid = measure_drives([str(tmp_path)], steps=[step], quick=True).rows[0].grid
    assert grid.overshoot <= 0.05
    assert grid.steady_error <= 0.02
    assert not grid.fallen


def test_a_base_that_is_pulled_keeps_its_speed_in_fast_curves(urdf, tmp_path):
    made = import_robot(urdf / "pepper/pepper.urdf", "real")
    for path, content in made.texts.items():
        (tmp_path / path).write_text(content)
    robot = Robot.load(tmp_path)
    assert robot.drive.max_lateral_acceleration == 1.0
    forward, turn, left = driven(PhysicsWorld(scene_of(robot), ORCA(), {0: robot}, DT), Twist(1.0, 3.0))
    assert (forward, turn) == (pytest.approx(1.0, rel=0.02), pytest.approx(1.0, rel=0.02))
    assert abs(left) < 0.02

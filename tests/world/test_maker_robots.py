"""Robots in the styles of many makers: kind of base, mass, and how they drive."""

from __future__ import annotations

from pathlib import Path

import pytest
from maker_texts import MAKERS, write_maker
from physics_worlds import alone, assert_drives_as_asked

from crowdbot.benchmark.drives.laboratory import maker_robot
from crowdbot.core import Element, Twist
from crowdbot.world import import_robot
from crowdbot.world.urdf import mjcf
from samples import sample

DRIVEN = ("classic_diff", "mecanum", "kiwi3", "kiwi4", "ackermann", "quadruped", "balancing", "conditional_xacro",
          "sdf_diff", "swerve", "sphere_wheels", "swivel_castors", "german_skid", "six_wheels", "mesh_wheels",
          "manipulator", "tricycle", "tracked", "sprung", "rear_steering")  # fmt: skip
KINDS = ("classic_diff", "mecanum", "kiwi3", "ackermann", "quadruped", "swerve", "sphere_wheels", "six_wheels",
         "mesh_wheels", "tracked", "sprung", "rear_steering")  # fmt: skip
"""A robot for each kind of base, wheel and suspension; ``make sweeps`` drives the others, too."""


@pytest.mark.parametrize("name", MAKERS)
def test_base_and_mass_are_those_of_the_file(tmp_path: Path, name: str) -> None:
    made = import_robot(write_maker(tmp_path, name), name)
    assert made.kind == MAKERS[name][1]
    assert made.mass == pytest.approx(MAKERS[name][2])


@pytest.mark.parametrize("name", sample(DRIVEN, KINDS))
def test_a_robot_of_a_maker_drives_as_asked(tmp_path: Path, name: str) -> None:
    assert_drives_as_asked(write_maker(tmp_path, name))


def test_a_base_that_balances_is_kept_upright(tmp_path: Path) -> None:
    with maker_robot(write_maker(tmp_path, "balancing")) as (robot, kind):
        assert (robot.base, kind) == ("planar", "differential")


def test_tyres_do_not_grip_more_than_rubber(tmp_path: Path) -> None:
    made = import_robot(write_maker(tmp_path, "classic_diff"), "r")
    rows = {guess.what: guess for guess in made.guesses}
    assert rows["friction of wheel_left_link"].value == "1"
    assert rows["friction of wheel_left_link"].source == "rubber; the file has 200"
    assert 'mu1 value="1"' in made.texts["r.urdf"]


def test_both_front_wheels_of_a_car_steer(tmp_path: Path) -> None:
    with maker_robot(write_maker(tmp_path, "ackermann")) as (robot, _):
        angles = robot.steering(robot.drive.motion(0.3))
    assert angles["left_knuckle_joint"] > angles["right_knuckle_joint"] > 0.25


def test_a_wheel_that_steers_without_a_limit_turns_across(tmp_path: Path) -> None:
    with maker_robot(write_maker(tmp_path, "tricycle")) as (robot, _):
        assert robot.drive.turning_radius == 0.0


def test_wheels_without_motors_hold_a_base_that_steers(tmp_path: Path) -> None:
    """Soft tyres of a free axle would creep sideways, and reactions to the steering turned the base."""
    with maker_robot(write_maker(tmp_path, "rear_steering")) as (robot, _):
        held = {wheel.joint: (wheel.driven, wheel.steering) for wheel in robot.wheels}
        assert held["fork_l_joint"] == held["fork_r_joint"] == (False, "")
        world = alone(robot, dt=0.02, physics_dt=0.01)
        turns = []
        for _ in range(20):
            world.step({0: Twist(0.0, robot.drive.max_turn_rate)})
            turns.append(abs(float(world.twists[0].turn[0])))
        angle, rate = world.robot_body(0).joints()["pivot_joint"]
    assert (angle, rate) == (pytest.approx(-0.4, abs=0.005), pytest.approx(-1.0, rel=0.01))
    assert max(turns) < 0.001


def test_a_mesh_around_an_axle_rolls_as_an_ellipsoid(tmp_path: Path) -> None:
    with maker_robot(write_maker(tmp_path, "mesh_wheels")) as (robot, _):
        radii = {wheel.joint: wheel.radius for wheel in robot.wheels}
        geoms = _colliders(mjcf(robot.model, wheels=radii).root, "left_link")
        assert [geom.attributes["type"] for geom in geoms] == ["ellipsoid"]
        assert [float(value) for value in geoms[0].attributes["size"].split()] == pytest.approx([0.06, 0.06, 0.015])
        assert {collider.attributes["type"] for collider in _colliders(mjcf(robot.model).root, "left_link")} == {"mesh"}


def _colliders(root: Element, link: str) -> list[Element]:
    found, waiting = [], [root]
    while waiting:
        element = waiting.pop()
        waiting += element.children
        if element.tag == "geom" and element.attributes["name"].startswith(f"{link}/0"):
            found.append(element)
    return found


def test_springs_of_wheels_are_fixed_and_told(tmp_path: Path) -> None:
    made = import_robot(write_maker(tmp_path, "sprung"), "r")
    rows = {guess.what: guess.value for guess in made.guesses}
    assert rows["joint left_spring"] == rows["joint right_spring"] == "fixed"
    assert "motor of left_spring" not in rows


def test_the_inner_wheel_of_a_car_keeps_its_joint_limit(tmp_path: Path) -> None:
    """The plugin allows 0.5 rad in the middle, for which the inner wheel would need 0.63 of its 0.6 rad."""
    with maker_robot(write_maker(tmp_path, "ackermann")) as (robot, _):
        angles = robot.steering(robot.drive.motion(robot.drive.max_steering))
    assert 0.55 < max(angles.values()) <= 0.6


def test_six_wheels_have_three_axles(tmp_path: Path) -> None:
    with maker_robot(write_maker(tmp_path, "six_wheels")) as (robot, _):
        assert robot.drive.axles == 3
        assert robot.drive.slip_factor == pytest.approx(1.74, abs=0.01)


def test_a_ball_joint_is_fixed_and_told(tmp_path: Path) -> None:
    made = import_robot(write_maker(tmp_path, "sdf_diff"), "r")
    assert any(
        "'caster_joint' is a ball joint, which is not supported; it is fixed" in remark for remark in made.remarks
    )

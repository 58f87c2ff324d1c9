"""Robots in the styles of many makers: kind of base, mass, and how they drive."""

from __future__ import annotations

from pathlib import Path

import pytest
from maker_texts import MAKERS, write_maker

from crowdbot.benchmark.drives import measure_drives
from crowdbot.benchmark.drives.maker_robots import maker_robot
from crowdbot.world import import_robot

DRIVEN = ("classic_diff", "mecanum", "kiwi3", "kiwi4", "ackermann", "quadruped", "balancing", "conditional_xacro",
          "sdf_diff", "swerve", "sphere_wheels", "swivel_castors")  # fmt: skip


@pytest.mark.parametrize("name", MAKERS)
def test_base_and_mass_are_those_of_the_file(tmp_path: Path, name: str) -> None:
    made = import_robot(write_maker(tmp_path, name), name)
    assert made.kind == MAKERS[name][1]
    assert made.mass == pytest.approx(MAKERS[name][2])


@pytest.mark.parametrize("name", DRIVEN)
def test_a_robot_of_a_maker_drives_as_asked(tmp_path: Path, name: str) -> None:
    file = write_maker(tmp_path, name)
    grid = measure_drives(["differential"], steps=[0.005], quick=True, makers=[file]).makers[0].grid
    assert grid.overshoot <= 0.05
    assert grid.steady_error <= 0.05
    assert grid.path_error <= 0.05
    assert not grid.fallen


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


def test_a_ball_joint_is_fixed_and_told(tmp_path: Path) -> None:
    made = import_robot(write_maker(tmp_path, "sdf_diff"), "r")
    assert any("'caster_joint' is a ball joint, which is not supported; it is fixed" in one for one in made.remarks)

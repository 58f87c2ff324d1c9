"""Small rules of trials: which names are code, sensors of robot types, zones and ways of people."""

from __future__ import annotations

import dataclasses
import shutil
from pathlib import Path

import pytest

from crowdbot.core import InputError, TrialError
from crowdbot.navigation import Straight
from crowdbot.sensors import IMU, GroundTruthPeople, Lidar2D
from crowdbot.trials import Mount, RobotGoal, RobotSpec, check_trial, is_code, parse_trial
from crowdbot.trials.robot import _assets, _merge_sensors
from crowdbot.world import DifferentialDrive


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("a.py", True), ("mine/A.PY", True), ("a.pyc", True), ("a.pyo", True), ("a.pyw", True), ("a.pyd", True),
        ("a.so", True), ("a.py. ", True), ("a.py..", True), ("__pycache__/a.txt", True), ("b/__PyCache__/a", True),
        ("a.csv", False), ("a.py.txt", False), ("py", False), ("my__pycache__/a", False), ("a.npz", False),
    ],
)  # fmt: skip
def test_names_of_code_on_any_system(name: str, code: bool) -> None:
    assert is_code(name) is code


def test_own_sensors_replace_those_of_the_type_by_name_and_others_follow() -> None:
    carried = tuple(Mount(name=name, sensor=Lidar2D()) for name in ("front", "back"))
    own = (Mount(name="people", sensor=GroundTruthPeople()), Mount(name="back", sensor=IMU()))
    merged = _merge_sensors(carried, own)
    assert [(mount.name, type(mount.sensor).__name__) for mount in merged] == [
        ("front", "Lidar2D"), ("back", "IMU"), ("people", "GroundTruthPeople"),
    ]  # fmt: skip
    assert _merge_sensors((), own) == own
    assert _merge_sensors(carried, ()) == carried


HALL = """<trial name="hall" duration="4" step="0.05">
  <stage walkable="-6,-3 6,-3 6,3 -6,3">{inside}</stage>
  {routing}
  <crowd type="orca"/>
  {people}
</trial>"""
WALL = '<wall points="0,-3 0,3"/>'
ROUTING = '<routing radius="0.25"/>'


def problems(people: str, inside: str = "", routing: str = "") -> str:
    with pytest.raises(TrialError) as caught:
        check_trial(parse_trial(HALL.format(people=people, inside=inside, routing=routing)))
    return str(caught.value)


def test_a_goal_zone_of_a_single_person_is_a_polygon_in_the_hall() -> None:
    person = '<agent x="-4" y="0" goal="3,0" goal-zone="{zone}"/>'
    assert "goal-zone" in problems(person.format(zone="2,-1 4,1 4,-1 2,1"))
    assert "goal zone" in problems(person.format(zone="20,-1 21,-1 21,1"))
    good = parse_trial(HALL.format(people=person.format(zone="2,-1 4,-1 4,1 2,1"), inside="", routing=""))
    assert check_trial(good) is None


def test_a_way_that_a_wall_blocks_is_named_by_who_would_walk_it() -> None:
    person = '<agent x="-4" y="0" goal="3,0"/>'
    assert "there is no path from its place to the goal for a body of radius 0.25 m" in problems(person, WALL, ROUTING)
    crowd = '<spawner count="1" zone="-5,-1 -4,-1 -4,1" goal="3,-1 4,-1 4,1"/>'
    assert "there is no path from its zone to the goal zone" in problems(crowd, WALL, ROUTING)
    door = '<wall points="0,-3 0,-1"/><wall points="0,1 0,3"/>'
    for people in (person, crowd):
        assert check_trial(parse_trial(HALL.format(people=people, inside=door, routing=ROUTING))) is None


def test_a_mount_keeps_what_is_not_changed() -> None:
    mount = Mount(name="front", sensor=Lidar2D(), x=0.2)
    assert dataclasses.replace(mount, y=0.1) == Mount(name="front", sensor=Lidar2D(), x=0.2, y=0.1)


def test_only_a_robot_of_a_folder_has_files(tmp_path: Path) -> None:
    shutil.copytree(_assets("turtlebot2"), tmp_path / "mine")
    settings = {"x": 0.0, "y": 0.0, "goal": RobotGoal(5.0, 0.0), "navigator": Straight()}
    own = RobotSpec(type="mine", folder=tmp_path, **settings).files()
    assert {path.name for path in own} >= {"robot.xml", "turtlebot2.urdf"}
    assert all(path.is_relative_to(tmp_path / "mine") for path in own)
    assert RobotSpec(type="turtlebot2", **settings).files() == ()
    assert RobotSpec(drive=DifferentialDrive(), **settings).files() == ()


def test_a_trial_has_at_most_20000_single_people() -> None:
    trial = parse_trial(HALL.format(people='<agent x="-4" y="0" goal="3,0"/>', inside="", routing=""))
    with pytest.raises(InputError, match="20001 agents are too many, at most 20000"):
        dataclasses.replace(trial, agents=trial.agents * 20_001)

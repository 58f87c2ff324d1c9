"""Limits of the base come from controller files of ROS 1 and 2 and from ros2_control tags."""

import numpy as np
import pytest
from base_texts import base_file

from crowdbot.core import InputError
from crowdbot.world import import_robot
from crowdbot.world.robots.controllers import read_controllers
from samples import sizes

ROS_2 = """
controller_manager:
  ros__parameters:
    update_rate: 50
    base_controller:
      type: diff_drive_controller/DiffDriveController
    broadcaster: {type: joint_state_broadcaster/JointStateBroadcaster}
base_controller:
  ros__parameters:
    left_wheel_names: ["left_joint"]
    right_wheel_names: ["right_joint"]
    wheel_separation: 0.4
    wheel_radius: 0.1
    linear.x.max_velocity: 0.7
    linear.x.max_acceleration: 1.9
    angular:
      z:
        max_velocity: 1.3
        has_acceleration_limits: false
        max_acceleration: 0.2
"""
ROS_1 = """
base:
  type: "diff_drive_controller/DiffDriveController"
  left_wheel: 'left_joint'
  right_wheel: ['right_joint']
  linear: {x: {has_velocity_limits: true, max_velocity: 0.7, max_acceleration: 1.9}}
  angular: {z: {max_velocity: 1.3}}
"""


def values(made):
    return {guess.what: (guess.value, guess.status) for guess in made.guesses}


@pytest.mark.parametrize("text", [ROS_2, ROS_1])
def test_limits_of_a_controller_file_are_taken(tmp_path, text):
    (tmp_path / "r.xacro").write_text(base_file("differential"))
    (tmp_path / "control.yml").write_text(text)
    found = values(import_robot(tmp_path / "r.xacro", "r", controllers=[tmp_path / "control.yml"]))
    assert found["max-speed"] == ("0.7 m/s", "file")
    assert found["max-acceleration"] == ("1.9 m/s2", "file")
    assert found["max-turn-rate"] == ("1.3 rad/s", "file")
    assert found["max-turn-acceleration"] == ("3 rad/s2", "guess")
    assert found["kind of base"] == ("differential", "file")


def test_a_controller_file_of_the_package_is_found(tmp_path):
    (tmp_path / "urdf").mkdir()
    (tmp_path / "config").mkdir()
    (tmp_path / "package.xml").write_text("<package><name>bot</name></package>")
    (tmp_path / "urdf" / "r.xacro").write_text(base_file("differential"))
    (tmp_path / "config" / "a.yaml").write_text("just: [a, list]\n")
    (tmp_path / "config" / "b.yaml").write_text("{broken")
    (tmp_path / "config" / "c.yaml").write_text(ROS_2.replace("left_joint", "another_joint"))
    assert values(import_robot(tmp_path / "urdf" / "r.xacro", "r"))["max-speed"][1] == "guess"
    (tmp_path / "config" / "d.yaml").write_text(ROS_2)
    made = import_robot(tmp_path / "urdf" / "r.xacro", "r")
    assert values(made)["max-speed"] == ("0.7 m/s", "file")
    assert next(guess for guess in made.guesses if guess.what == "max-speed").source == "base_controller in d.yaml"


def test_wheels_with_a_prefix_of_the_launch_file_are_those_of_the_robot(tmp_path):
    (tmp_path / "config").mkdir()
    (tmp_path / "package.xml").write_text("<package><name>bot</name></package>")
    (tmp_path / "r.xacro").write_text(base_file("differential"))
    text = ROS_1.replace("'left_joint'", "'$(arg prefix)left_joint'").replace("right_joint", "$(var prefix)right_joint")
    (tmp_path / "config" / "control.yaml").write_text(text)
    assert values(import_robot(tmp_path / "r.xacro", "r"))["max-acceleration"] == ("1.9 m/s2", "file")


def test_a_controller_file_that_the_robot_file_names_is_read(tmp_path):
    plugin = (
        "<gazebo><plugin filename='gz_ros2_control-system' name='x'><parameters>{}</parameters></plugin></gazebo>"
        "</robot>"
    )
    file = tmp_path / "r.xacro"
    (tmp_path / "somewhere").mkdir()
    (tmp_path / "somewhere" / "base.yaml").write_text(ROS_2)
    file.write_text(base_file("differential").replace("</robot>", plugin.format("somewhere/base.yaml")))
    assert values(import_robot(file, "r"))["max-speed"] == ("0.7 m/s", "file")
    file.write_text(base_file("differential").replace("</robot>", plugin.format("nothing.yaml")))
    assert "'nothing.yaml' is missing; give --controllers FILE" in import_robot(file, "r").remarks[-1]
    file.write_text(base_file("differential").replace("</robot>", plugin.format("../../outside.yaml")))
    assert "is outside the robot folder" in import_robot(file, "r").remarks[-1]


def test_limits_of_ros2_control_tags_are_taken(tmp_path):
    control = "".join(
        f"<joint name='{name}_joint'><command_interface name='velocity'><param name='min'>-6</param>"
        "<param name='max'>6</param></command_interface></joint>"
        for name in ("left", "right")
    )
    file = tmp_path / "r.xacro"
    file.write_text(
        base_file("differential").replace("</robot>", f"<ros2_control name='c'>{control}</ros2_control></robot>")
    )
    found = import_robot(file, "r")
    row = next(guess for guess in found.guesses if guess.what == "max-speed")
    assert (row.value, row.source, row.status) == ("0.6 m/s", "<ros2_control> of the wheels", "file")
    assert "motor of left_joint" not in values(found)


def test_a_tricycle_controller_gives_speeds_of_its_wheel(tmp_path):
    (tmp_path / "t.yaml").write_text(
        "trike:\n  type: tricycle_controller/TricycleController\n  traction_joint_name: t\n  steering_joint_name: s\n"
        "  wheel_radius: 0.1\n  wheelbase: 0.7\n  traction: {max_velocity: 5.0, max_acceleration: 4.0}\n"
        "  steering: {max_position: 0.9, max_velocity: 1.5}\n"
    )
    (one,) = read_controllers(tmp_path / "t.yaml")
    assert one.values == {"radius": 0.1, "wheelbase": 0.7, "max_steering": 0.9, "max_steering_rate": 1.5,
                          "max_speed": 0.5, "max_acceleration": 0.4}  # fmt: skip
    assert one.joints == ("t", "s")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("a: !include x\n", "c.yaml"),
        ("{", "c.yaml"),
        ("a:\n\t- b", "c.yaml"),
        ("x" * 400_000, "has more than 300000 bytes"),
        ("\xff\xfe", "is not UTF-8 text"),
        (None, "there is no controller file"),
    ],
)
def test_a_wrong_controller_file_is_told(tmp_path, text, sentence):
    (tmp_path / "r.xacro").write_text(base_file("differential"))
    if text is not None:
        (tmp_path / "c.yaml").write_bytes(text.encode("latin-1"))
    with pytest.raises(InputError, match=sentence):
        import_robot(tmp_path / "r.xacro", "r", controllers=[tmp_path / "c.yaml"])


@pytest.mark.parametrize("count", sizes(200, 10_000))
def test_damaged_controller_files_are_refused_or_read(tmp_path, count):
    rng = np.random.default_rng(5)
    path = tmp_path / "c.yaml"
    words = (
        "{",
        "}",
        "[",
        ": ",
        "\n",
        "  ",
        "- ",
        "'",
        '"',
        "1e999",
        ".nan",
        "ros__parameters",
        "type",
        "-1",
        "0",
        "null",
    )
    outcomes = {"read": 0, "refused": 0}
    for _ in range(count):
        text = (ROS_2, ROS_1)[int(rng.integers(2))]
        for _ in range(int(rng.integers(1, 6))):
            at = int(rng.integers(0, len(text)))
            text = text[:at] + words[int(rng.integers(len(words)))] + text[at + int(rng.integers(0, 6)) :]
        path.write_text(text)
        try:
            controllers = read_controllers(path)
            outcomes["read"] += 1
            assert all(0.0 < value < 1e6 for one in controllers for value in one.values.values())
        except InputError as error:
            outcomes["refused"] += str(error).startswith(str(path))
    assert sum(outcomes.values()) == count
    assert min(outcomes.values()) > 0

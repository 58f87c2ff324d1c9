"""The launch examples for Nav2 and move_base: their parameters, topics and frames are those of the bridge."""

import json
import re
import runpy
import subprocess
import sys
import types
from dataclasses import replace
from xml.etree import ElementTree

import pytest
import yaml
from navigation_parameters import MOVE_BASE, NAV2, OLD_AMCL
from page_commands import ROOT, page_commands

from crowdbot.bridges import BridgeClock, RobotInterface, open_transport, run_bridge
from crowdbot.trials import load_trial

FOLDER = ROOT / "examples" / "navigation_launch"
sys.path.insert(0, str(ROOT / "tests" / "bridges"))
from bridge_runs import MemoryTransport  # noqa: E402

NAV2_FILES = ["humble", "jazzy", "lyrical"]
READ = """
import json, sys
import rclpy

found = {}
for name in sys.argv[2:]:
    context = rclpy.Context()
    rclpy.init(args=["--ros-args", "--params-file", sys.argv[1]], context=context, domain_id=87)
    space, _, last = name.rpartition("/")
    node = rclpy.create_node(
        last, namespace=f"/robot/{space}".rstrip("/"), context=context,
        automatically_declare_parameters_from_overrides=True, start_parameter_services=False,
    )
    found[name] = {key: one.value for key, one in node.get_parameters_by_prefix("").items()}
    node.destroy_node()
    rclpy.shutdown(context=context)
print(json.dumps(found, default=list))
"""
"""A process of ROS 2 that prints the parameters which nodes of these names get from a file."""


def text_of(distribution, robot="robot"):
    """Return the text of a file of parameters, as launch substitutes it."""
    return (FOLDER / "nav2" / f"nav2_{distribution}.yaml").read_text().replace("$(var robot)", robot)


def nav2(distribution):
    """Return the parameters of each node."""
    nodes = yaml.safe_load(text_of(distribution))["robot"]
    result = {}
    for name, inside in nodes.items():
        space, rows = (f"{name}/{name}", inside[name]) if name in inside else (name, inside)
        result[space] = dict(flat(rows["ros__parameters"]))
    return result


def flat(rows, before=""):
    """Yield names with dots, and values, of nested mappings."""
    for name, value in rows.items():
        if isinstance(value, dict):
            yield from flat(value, f"{before}{name}.")
        else:
            yield before + name, value


@pytest.fixture(scope="module")
def trial():
    return load_trial(str(FOLDER / "hall.xml"))


@pytest.fixture(scope="module")
def frames(trial):
    """Parent of each frame of one second of the trial."""
    transport = MemoryTransport(["/tf", "/tf_static"])
    run_bridge(replace(trial, duration=0.5), [transport], 0, None, BridgeClock("free"))
    rows = [row for item in transport.sent if item.topic.startswith("/tf") for row in item.message.transforms]
    return {row.child_frame_id: row.header.frame_id for row in rows}


def check_values(rows, trial, frames):
    """Check topics, frames and limits among parameters by name, whatever the stack."""
    known = {output.name: output for output in RobotInterface.of(trial).outputs}
    kinds = {"map": "nav_msgs/msg/OccupancyGrid", "odom": "nav_msgs/msg/Odometry", "scan": "sensor_msgs/msg/LaserScan"}
    topics = {name: value for name, value in rows.items() if str(value).startswith("/")}
    for name, value in topics.items():
        assert known[value].kind == kinds[value.rpartition("/")[2]], (name, value)
        # Nav2 subscribes scans as sensor data, and odometry by the default of the middleware, which may be reliable
        assert known[value].quality.reliable == (not value.endswith("scan")), value
    used = {name: value for name, value in rows.items() if re.search(r"(global|local|base|odom)_frame(_id)?$", name)}
    assert {*used.values()} <= {*frames, *frames.values()}, used
    for name, value in used.items():
        assert value == "robot/base_link" or "base" not in name, (name, value)
    return topics


def test_the_frames_are_a_chain_from_the_map_to_the_scanner(frames):
    assert frames["robot/scan"] == "robot/base_link"
    assert frames["robot/base_link"] == "robot/odom"
    assert frames["robot/odom"] == "map"


@pytest.mark.parametrize("distribution", NAV2_FILES)
def test_every_parameter_of_nav2_has_a_name_that_nav2_knows(distribution):
    found = nav2(distribution)
    assert {*found} == {*NAV2[distribution]}
    for node, rows in found.items():
        assert {*rows} - NAV2[distribution][node] == set(), node
        assert rows["use_sim_time"] is True


@pytest.mark.parametrize("distribution", NAV2_FILES)
def test_topics_frames_and_limits_of_nav2_are_those_of_the_bridge(distribution, trial, frames):
    robot = trial.robots[0]
    scan = next(mount.sensor for mount in robot.sensors if mount.name == "scan")
    found = nav2(distribution)
    topics = {}
    for rows in found.values():
        topics |= check_values(rows, trial, frames)
    assert {*topics.values()} == {"/map", "/robot/odom", "/robot/scan"}
    for costmap in ("local_costmap/local_costmap", "global_costmap/global_costmap"):
        rows = found[costmap]
        assert rows["robot_radius"] == robot.radius
        assert rows["obstacle_layer.scan.raytrace_max_range"] <= scan.range_max
    assert found["global_costmap/global_costmap"]["static_layer.map_subscribe_transient_local"] is True
    control = found["controller_server"]
    speed = control.get("FollowPath.max_vel_x", control.get("FollowPath.vx_max"))
    turn = control.get("FollowPath.max_vel_theta", control.get("FollowPath.wz_max"))
    limits = robot.drive
    assert (speed, turn) == (limits.max_speed, limits.max_turn_rate)
    model = control.get("FollowPath.motion_model", "DiffDrive")  # a plugin since Lyrical
    assert model == "DiffDrive" or f"FollowPath.{model}.plugin" in control
    assert found["velocity_smoother"]["max_velocity"] == [speed, 0.0, turn]
    for node, rows in found.items():
        for name, value in rows.items():
            if name in ("plugins", "navigators") or name.endswith(("_plugins", "_plugin")):
                for item in [value] if isinstance(value, str) else value:
                    assert f"{item}.plugin" in rows, (node, item)


@pytest.mark.live
@pytest.mark.parametrize("distribution", NAV2_FILES)
def test_ros_2_gives_the_parameters_to_the_nodes_of_the_launch_file(distribution, tmp_path):
    file = tmp_path / "parameters.yaml"
    file.write_text(text_of(distribution))
    wanted = nav2(distribution)
    done = subprocess.run([sys.executable, "-c", READ, file, *wanted], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    document = json.loads(done.stdout.splitlines()[-1])
    for rows in document.values():
        rows.pop("start_type_description_service", None)  # of every node
    assert document == wanted


class Action:
    """What a launch file makes: the name of its class, and its arguments."""

    def __init__(self, kind, *arguments, **named):
        self.kind, self.arguments, self.named = kind, arguments, named


def launch_modules():
    """Return modules of the names of launch that only note what is made."""
    names = {
        "launch": ["LaunchDescription"],
        "launch.actions": ["DeclareLaunchArgument"],
        "launch.conditions": ["IfCondition"],
        "launch.substitutions": ["LaunchConfiguration", "PathJoinSubstitution"],
        "launch_ros": [],
        "launch_ros.actions": ["Node"],
        "launch_ros.parameter_descriptions": ["ParameterFile"],
    }
    result = {}
    for name, classes in names.items():
        result[name] = types.ModuleType(name)
        for class_ in classes:
            setattr(result[name], class_, lambda *args, kind=class_, **named: Action(kind, *args, **named))
    return result


def test_the_launch_file_starts_the_nodes_that_have_parameters(monkeypatch, trial):
    for name, module in launch_modules().items():
        monkeypatch.setitem(sys.modules, name, module)
    made = runpy.run_path(str(FOLDER / "nav2" / "nav2.launch.py"))["generate_launch_description"]().arguments[0]
    defaults = {item.arguments[0]: item.named["default_value"] for item in made if item.kind == "DeclareLaunchArgument"}
    assert defaults == {"robot": trial.robots[0].name, "parameters": "nav2_jazzy.yaml", "amcl": "false", "rviz": "true"}
    nodes = {item.named.get("name", "rviz"): item.named for item in made if item.kind == "Node"}
    servers = {name for name in nodes if not name.startswith(("lifecycle", "rviz"))}
    for distribution in NAV2_FILES:
        assert servers == {name for name in nav2(distribution) if "/" not in name}
    listed = [node["parameters"][0]["node_names"] for name, node in nodes.items() if name.startswith("lifecycle")]
    assert sorted(name for names in listed for name in names) == sorted(servers)
    remapped = {name: dict(nodes[name]["remappings"]) for name in servers}
    assert remapped["velocity_smoother"] == {"cmd_vel": "cmd_vel_nav", "cmd_vel_smoothed": "cmd_vel"}
    assert remapped["controller_server"] == remapped["behavior_server"] == {"cmd_vel": "cmd_vel_nav"}
    inputs = {input_topic.name: input_topic.kinds for input_topic in RobotInterface.of(trial).inputs}
    assert "geometry_msgs/msg/Twist" in inputs["/robot/cmd_vel"]
    assert "geometry_msgs/msg/PoseStamped" in inputs["/robot/goal_pose"]


def move_base(file, robot="robot"):
    """Return the parameters of a file of move_base, with slashes of ROS 1 as dots."""
    text = (FOLDER / "move_base" / file).read_text().replace("$(arg robot)", robot)
    return dict(flat(yaml.safe_load(text)))


def test_every_parameter_of_move_base_has_a_name_that_it_knows():
    assert {*move_base("move_base.yaml")} - MOVE_BASE == set()
    assert {*move_base("amcl.yaml")} - OLD_AMCL == set()


def test_topics_frames_and_limits_of_move_base_are_those_of_the_bridge(trial, frames):
    rows, robot = move_base("move_base.yaml"), trial.robots[0]
    assert {*check_values(rows, trial, frames).values()} == {"/map", "/robot/odom", "/robot/scan"}
    check_values(move_base("amcl.yaml"), trial, frames)
    assert rows["DWAPlannerROS.max_vel_trans"] == rows["DWAPlannerROS.max_vel_x"] == robot.drive.max_speed
    assert rows["DWAPlannerROS.max_vel_theta"] == robot.drive.max_turn_rate
    assert rows["global_costmap.robot_radius"] == rows["local_costmap.robot_radius"] == robot.radius


def test_roslaunch_gives_the_parameters_to_the_nodes(roslaunch):
    command = [roslaunch, "--dump-params", str(FOLDER / "move_base" / "move_base.launch"), "amcl:=true", "rviz:=false"]
    done = subprocess.run([*command, "robot:=bot"], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    wanted = {
        f"/bot/{node}/{name.replace('.', '/')}": value
        for node in ("move_base", "amcl")
        for name, value in move_base(f"{node}.yaml", "bot").items()
    }
    assert yaml.safe_load(done.stdout) == wanted
    launch = ElementTree.parse(FOLDER / "move_base" / "move_base.launch")
    assert [node.get("pkg") for node in launch.iter("node")] == ["move_base", "amcl", "rviz"]


@pytest.mark.parametrize("page", ["nav2", "move-base", "person-detector"])
def test_the_simulation_of_a_page_is_a_trial_with_a_bridge(page):
    ((order, file, option, bridge, *_),) = page_commands(page, "crowdbot")
    assert (order, option) == ("run", "--bridge")
    assert load_trial(str(ROOT / file)).name == "hall"
    assert open_transport(bridge).name == bridge


@pytest.mark.parametrize(("page", "program"), [("nav2", "ros2"), ("move-base", "roslaunch")])
def test_the_launch_file_of_a_page_exists(page, program):
    files = [word for words in page_commands(page, program) for word in words if "launch/" in word]
    assert files
    assert all((ROOT / file).is_file() for file in files)


@pytest.mark.parametrize("stack", ["nav2", "move_base"])
def test_rviz_shows_topics_that_exist_with_their_quality(stack, trial):
    shown = yaml.safe_load((FOLDER / stack / "crowd.rviz").read_text())["Visualization Manager"]
    known = {output.name: output.quality for output in RobotInterface.of(trial).outputs}
    topics = [item.get("Topic", item.get("Marker Topic")) for item in shown["Displays"]]
    names = [topic["Value"] if isinstance(topic, dict) else topic for topic in topics if topic]
    assert {"/map", "/robot/scan", "/crowd/markers"} <= {*names}
    for topic in topics:
        if isinstance(topic, dict) and topic["Value"] in known:
            quality = known[topic["Value"]]
            assert (topic["Durability Policy"] == "Transient Local") == quality.latched
            assert (topic["Reliability Policy"] == "Reliable") <= quality.reliable
    goals = [item["Topic"] for item in shown["Tools"] if "Topic" in item]
    assert goals == (["/robot/move_base_simple/goal"] if stack == "move_base" else [shown["Tools"][1]["Topic"]])

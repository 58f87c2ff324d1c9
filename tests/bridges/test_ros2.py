"""The ROS 2 node, with a robot program of rclpy in a process of its own."""

from __future__ import annotations

import importlib
import json
import os
import signal
import subprocess
import sys
import time
import types
from pathlib import Path

import pytest
import rclpy.node
from action_msgs.msg import GoalStatus
from bridge_runs import MemoryTransport, Running
from geometry_msgs.msg import TransformStamped
from rclpy.qos import DurabilityPolicy, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from rosbags.interfaces import Nodetype

from crowdbot.bridges import SERVICES, BridgeClock, interface_store, open_transport, run_bridge
from crowdbot.bridges.joint_actions import INVALID_GOAL
from crowdbot.bridges.ros2 import Ros2Node
from crowdbot.bridges.ros2.messages import fill_message, message_fields
from crowdbot.core import InputError
from crowdbot.recording import read_episode, replay
from crowdbot.trials import load_trial

HERE = Path(__file__).parent
STEP = 50_000_000
LOCAL = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}


@pytest.fixture(autouse=True)
def local(monkeypatch, tmp_path):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path / "log"))


def robot(domain, seconds=60.0, program="ros2_robot.py"):
    """Start the robot program, or another one."""
    words = [sys.executable, str(HERE / program), str(domain), str(seconds)]
    return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ})


def ended(process, seconds=120):
    out, errors = process.communicate(timeout=seconds)
    assert process.returncode == 0, errors
    return json.loads(out.splitlines()[-1])


class Driver(MemoryTransport):
    """The same commands in memory."""

    def publish(self, messages):
        for item in (message for message in messages if message.topic == "/tf"):
            turn = 0.3 if item.nanoseconds // STEP % 7 < 4 else -0.3
            self.inbox.receive("/robot/cmd_vel", {"linear": {"x": 0.4}, "angular": {"z": turn}}, "ros2")


def test_a_robot_program_steps_the_simulation_with_its_commands_and_the_digest_is_that_of_a_free_run(tmp_path, domain):
    trial = load_trial("frontal", duration=4.0)
    process = robot(domain)
    node = Ros2Node(domain)
    with Running(trial, [node], "commands", out=tmp_path) as running:
        done = running.end(120.0)
    seen = ended(process)
    free = run_bridge(trial, [Driver()], 0, tmp_path / "free", BridgeClock("free"))
    assert done.digest == free.digest
    assert (tmp_path / "episode.mcap").read_bytes() == (tmp_path / "free" / "episode.mcap").read_bytes()
    assert replay(tmp_path / "episode.mcap").equal
    orders = read_episode(tmp_path / "episode.mcap").orders
    assert len(orders) == done.steps == 80  # no command is lost
    assert [item for item in seen["ticks"] if item] == [STEP * k for k in range(1, 81)]
    assert seen["scans"] > 0  # best effort
    assert (seen["beams"] > 100, seen["frame"]) == (True, "robot/scan")
    assert seen["odometry"] >= 80
    assert seen["map"] > 100
    assert seen["urdf"] > 100
    assert set(node.missing) >= {"tf2_msgs/msg/TFMessage", "people_msgs/msg/People"}


def test_a_robot_program_drives_in_real_time_and_the_robot_stops_when_it_is_killed(tmp_path, domain):
    words = ["run", "frontal", "--set", "duration=16", "--bridge", f"ros2:{domain}", "--out", str(tmp_path)]
    server = subprocess.Popen(
        [sys.executable, "-m", "crowdbot", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    process = robot(domain, 4.0)
    seen = ended(process)  # it ends: the commands stop
    _, errors = server.communicate(timeout=120)
    assert server.returncode == 0, errors
    assert "tf2_msgs/msg/TFMessage" in errors
    assert seen["sent"] > 40
    assert seen["late"][len(seen["late"]) // 2] < 60_000_000
    episode = read_episode(tmp_path / "episode.mcap")
    last = max(seconds for seconds, _ in episode.orders)
    speed = abs(episode.velocity[:, episode.robots[0]]).max(axis=-1)
    assert speed[episode.times > last + 2.0].max() < 1e-6
    assert speed.max() > 0.3


def test_another_program_calls_the_services(tmp_path, domain):
    node = Ros2Node(domain)
    with Running(load_trial("frontal", duration=300.0), [node], out=tmp_path) as running:
        answers = ended(robot(domain, program="ros2_services.py"))
        assert running.run.control.may_step
    refused = [False, "the simulation must be paused"]
    assert answers == [refused, "done", [True, ""], [True, ""], "done", "done"]
    assert (tmp_path / "episode-2.mcap").exists()  # after the reset
    assert node.missing_services == tuple(f"simulation_interfaces/srv/{item.kind}" for item in SERVICES.values())


LAB = """<trial name="lab" duration="600" step="0.05"><crowd type="orca"/>
  <robot name="pepper" type="pepper" x="0" y="0" default-sensors="false"><goal x="9" y="0"/>
    <navigator type="external"/></robot>
</trial>"""


@pytest.fixture
def with_control_msgs(tmp_path):
    """Variables of programs that find ``control_msgs``, which the wheels of rclpy lack, as after sourcing ROS."""
    words = [sys.executable, str(HERE / "ros2_types.py"), str(tmp_path / "types")]
    done = subprocess.run(words, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    added = {"PYTHONPATH": tmp_path / "types" / "py", "LD_LIBRARY_PATH": tmp_path / "types" / "lib"}
    found = {name: os.pathsep.join(filter(None, [str(path), os.environ.get(name)])) for name, path in added.items()}
    return os.environ | found


def test_a_client_of_rclpy_sends_goals_to_the_ros2_node(with_control_msgs, domain, tmp_path):
    path = tmp_path / "lab.xml"
    path.write_text(LAB, encoding="utf-8")
    words = [sys.executable, "-m", "crowdbot", "run", str(path), "--bridge", f"ros2:{domain}"]
    client = [sys.executable, str(HERE / "ros2_action_client.py"), str(domain)]
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "env": with_control_msgs}
    with subprocess.Popen(words, **options) as server, subprocess.Popen(client, **options) as program:
        try:
            found = ended(program)
        finally:
            program.kill()
            server.send_signal(signal.SIGINT)
            _, errors = server.communicate(timeout=60)
    assert found == {
        "result": [GoalStatus.STATUS_SUCCEEDED, 0], "feedback": True, "position": 0.5, "accepted_cancel": 1,
        "canceled": [GoalStatus.STATUS_CANCELED, 0], "replaced": [GoalStatus.STATUS_ABORTED, INVALID_GOAL],
        "newer": [GoalStatus.STATUS_SUCCEEDED, 0], "rejected": True,
    }  # fmt: skip
    assert "no joint 'HeadYow', did you mean 'HeadYaw'?" in errors
    assert "control_msgs" not in errors
    assert "Traceback" not in errors


def ros_class(kind):
    """Return a class as rosidl makes it, from the definition of a type."""
    parts = interface_store().fielddefs[kind][1]
    types = {name: ros_type(node) for name, node in parts if name != "structure_needs_at_least_one_member"}

    class Message:
        def __init__(self):
            for name, text in types.items():
                setattr(self, name, empty(text))

        def get_fields_and_field_types(self):
            return types

    Message.__name__ = kind.rpartition("/")[2]
    return Message


def empty(text):
    if "sequence" in text:
        return []
    package, sign, name = text.partition("/")
    return vars(sys.modules[f"{package}.msg"])[name]() if sign else {"string": "", "double": 0.0}.get(text, 0)


def ros_type(node):
    kind, detail = node
    if kind == Nodetype.NAME:
        return detail.replace("/msg/", "/")
    if kind == Nodetype.BASE:
        return {"float64": "double", "bool": "boolean"}.get(detail[0], detail[0])
    return f"sequence<{ros_type(detail[0])}>"


def test_requests_and_responses_of_simulation_interfaces_fit_their_types(monkeypatch):
    """rosidl makes such classes where a user's ROS has the package."""
    package = types.ModuleType("simulation_interfaces.msg")
    monkeypatch.setitem(sys.modules, "simulation_interfaces", types.ModuleType("simulation_interfaces"))
    monkeypatch.setitem(sys.modules, "simulation_interfaces.msg", package)
    for name in ("std_msgs", "geometry_msgs"):
        importlib.import_module(f"{name}.msg")
    kinds = [kind for kind in interface_store().fielddefs if kind.startswith("simulation_interfaces/")]
    for kind in kinds:
        setattr(package, kind.rpartition("/")[2], ros_class(kind))
    driver = MemoryTransport([])
    with Running(load_trial("frontal", duration=1.0), [driver], "step"):
        for name, service in SERVICES.items():
            request = getattr(package, f"{service.kind}_Request")()
            response = fill_message(
                getattr(package, f"{service.kind}_Response")(), driver.call(name, message_fields(request))
            )
            assert response.__dict__.keys() >= response.get_fields_and_field_types().keys()
            if hasattr(response, "result"):
                assert 0 < response.result.result < 256, name
    states = fill_message(package.GetEntitiesStates_Response(), {"states": [{"pose": {"position": {"x": 2}}}]})
    assert states.states[0].pose.position.x == 2.0
    assert message_fields(states)["states"][0]["pose"]["position"]["x"] == 2.0


class KeptPublisher:
    """Takes the place of a publisher of rclpy for a type whose library is not there."""

    def __init__(self):
        self.sent = []

    def publish(self, data):
        self.sent.append(data)

    def get_subscription_count(self):
        return 1


def test_transforms_are_sent_where_tf2_msgs_is_installed(monkeypatch, domain):
    """The wheels have no ``tf2_msgs``; a user's ROS has. Its class is made from the definition, as rosidl does it."""
    kind, kept, profiles = "tf2_msgs/msg/TFMessage", {}, {}
    package = types.ModuleType("tf2_msgs.msg")
    package.TFMessage = ros_class(kind)
    monkeypatch.setitem(sys.modules, "tf2_msgs", types.ModuleType("tf2_msgs"))
    monkeypatch.setitem(sys.modules, "tf2_msgs.msg", package)
    create = rclpy.node.Node.create_publisher

    def create_publisher(self, message, topic, profile, **options):
        profiles[topic] = profile
        if message is not package.TFMessage:
            return create(self, message, topic, profile, **options)
        kept[topic] = KeptPublisher()
        return kept[topic]

    monkeypatch.setattr(rclpy.node.Node, "create_publisher", create_publisher)
    node = Ros2Node(domain)
    with Running(load_trial("frontal", duration=1.0), [node], "free") as running:
        running.end(60.0)
    assert kind not in node.missing
    assert set(kept) == {"/tf", "/tf_static"}
    depths = {"/clock": 1, "/tf": 100, "/robot/odom": 10, "/robot/scan": 5, "/map": 1, "/tf_static": 1}
    assert {topic: profiles[topic].depth for topic in depths} == depths
    unreliable = {topic for topic in depths if profiles[topic].reliability == ReliabilityPolicy.BEST_EFFORT}
    latched = {topic for topic in depths if profiles[topic].durability == DurabilityPolicy.TRANSIENT_LOCAL}
    assert (unreliable, latched) == ({"/robot/scan"}, {"/map", "/tf_static"})
    assert len(kept["/tf"].sent) >= 20
    seen = {topic: read_transforms(item.sent[-1], package.TFMessage()) for topic, item in kept.items()}
    assert {("map", "robot/odom"), ("robot/odom", "robot/base_link")} <= seen["/tf"]
    assert ("robot/base_link", "robot/scan") in seen["/tf_static"]


def read_transforms(data, message):
    """Return parents and children of the transforms in CDR; each is read by the real library of its type."""
    types_of = message.get_fields_and_field_types()
    assert types_of == {"transforms": "sequence<geometry_msgs/TransformStamped>"}
    store, kind = interface_store(), "geometry_msgs/msg/TransformStamped"
    found = store.deserialize_cdr(data, "tf2_msgs/msg/TFMessage").transforms
    rows = [deserialize_message(bytes(store.serialize_cdr(one, kind)), TransformStamped) for one in found]
    assert all(row.header.stamp.sec <= 1 for row in rows)
    return {(row.header.frame_id, row.child_frame_id) for row in rows}


def test_addresses_and_domains():
    assert open_transport("ros2:7").domain == 7
    assert open_transport("ros2", {"host": "0.0.0.0"}).everywhere
    with pytest.raises(InputError, match="ros2:seven must be ros2 or ros2:DOMAIN, such as ros2:7"):
        open_transport("ros2:seven")
    with pytest.raises(InputError, match="ROS domain 233 must be from 0 to 232"):
        Ros2Node(233)


def test_another_trial_changes_the_topics(domain):
    node = Ros2Node(domain)
    driver = MemoryTransport()
    with Running(load_trial("frontal", duration=1.0), [node, driver], "step"):
        assert "/robot/scan" in node._publishers
        answer = driver.call("load_world", {"world_resource": {"uri": "circle-crossing"}})
        assert answer["result"]["result"] == 1
        names = {output.name for output in driver.interfaces[-1].outputs}
        end = time.monotonic() + 10.0
        while not set(node._publishers) <= names:
            if time.monotonic() > end:
                pytest.fail("it is not reached in time")
        assert not node.wants("/robot/scan")
        assert not node.wants("/robot/")

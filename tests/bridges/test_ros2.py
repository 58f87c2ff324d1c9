"""The ROS 2 node, with a robot program of rclpy in a process of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from bridge_runs import MemoryTransport, Running

from crowdbot.bridges import BridgeClock, open_transport, run_bridge
from crowdbot.bridges.ros2 import Ros2Node
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


def robot(domain, seconds=60.0):
    """Start the robot program."""
    words = [sys.executable, str(HERE / "ros2_robot.py"), str(domain), str(seconds)]
    return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env={**os.environ})


def ended(process):
    out, errors = process.communicate(timeout=120)
    assert process.returncode == 0, errors
    return json.loads(out.splitlines()[-1])


def free_domain(offset):
    return 1 + (os.getpid() * 7 + offset) % 100


class Driver(MemoryTransport):
    """The same commands in memory."""

    def publish(self, messages):
        for one in (one for one in messages if one.topic == "/tf"):
            turn = 0.3 if one.nanoseconds // STEP % 7 < 4 else -0.3
            self.inbox.receive("/robot/cmd_vel", {"linear": {"x": 0.4}, "angular": {"z": turn}}, "ros2")


def test_a_robot_program_steps_the_simulation_with_its_commands_and_the_digest_is_that_of_a_free_run(tmp_path):
    trial, domain = load_trial("frontal", duration=4.0), free_domain(0)
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
    assert [one for one in seen["ticks"] if one] == [STEP * k for k in range(1, 81)]
    assert seen["scans"] >= 39
    assert (seen["beams"] > 100, seen["frame"]) == (True, "robot/scan")
    assert seen["odometry"] >= 80
    assert seen["map"] > 100
    assert seen["urdf"] > 100
    assert set(node.missing) >= {"tf2_msgs/msg/TFMessage", "people_msgs/msg/People"}


def test_a_robot_program_drives_in_real_time_and_the_robot_stops_when_it_is_killed(tmp_path):
    domain = free_domain(1)
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


def test_addresses_and_domains():
    assert open_transport("ros2:7").domain == 7
    assert open_transport("ros2", {"host": "0.0.0.0"}).everywhere
    with pytest.raises(InputError, match="ros2:seven must be ros2 or ros2:DOMAIN, such as ros2:7"):
        open_transport("ros2:seven")
    with pytest.raises(InputError, match="ROS domain 233 must be from 0 to 232"):
        Ros2Node(233)


def test_another_trial_changes_the_topics():
    node = Ros2Node(free_domain(2))
    driver = MemoryTransport()
    with Running(load_trial("frontal", duration=1.0), [node, driver], "step"):
        assert "/robot/scan" in node._publishers
        answer = driver.call("load_world", {"world_resource": {"uri": "circle-crossing"}})
        assert answer["result"]["result"] == 1
        names = {one.name for one in driver.interfaces[-1].outputs}
        end = time.monotonic() + 10.0
        while not set(node._publishers) <= names:
            if time.monotonic() > end:
                pytest.fail("it is not reached in time")
        assert not node.wants("/robot/scan")
        assert not node.wants("/robot/")

"""The rosless node, with a robot program of rclpy, both in a network of their own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from bridge_runs import MemoryTransport
from partner_runs import MESH, NETWORK

from crowdbot.bridges import BridgeClock, open_transport, run_bridge
from crowdbot.bridges.rosless import RoslessNode
from crowdbot.core import InputError
from crowdbot.recording import read_episode
from crowdbot.trials import load_trial

HERE = Path(__file__).parent
STEP = 50_000_000


class Driver(MemoryTransport):
    """The commands of the robot program in memory."""

    def publish(self, messages):
        for one in (one for one in messages if one.topic == "/tf"):
            turn = 0.3 if one.nanoseconds // STEP % 7 < 4 else -0.3
            self.inbox.receive("/robot/cmd_vel", {"linear": {"x": 0.4}, "angular": {"z": turn}}, "rosless")


def test_a_robot_program_of_rclpy_steps_the_simulation_and_the_digest_is_that_of_a_free_run(namespaces, tmp_path):
    words = "run frontal --set duration=4 --seed 0 --clock commands --bridge rosless:7 --out"
    script = f"""{NETWORK}
{sys.executable} -m crowdbot {words} {tmp_path} >{tmp_path}/simulation.txt 2>&1 &
{sys.executable} {HERE}/ros2_robot.py 7 100 4  # it answers as long as there is a next step
wait
"""
    environment = {**os.environ, **MESH, "ROS_LOG_DIR": str(tmp_path)}
    command = [namespaces, "--net", "bash", "-eu", "-c", script]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stderr + (tmp_path / "simulation.txt").read_text()
    seen = json.loads(done.stdout.splitlines()[-1])
    run_bridge(load_trial("frontal", duration=4.0), [Driver()], 0, tmp_path / "free", BridgeClock("free"))
    episode = read_episode(tmp_path / "episode.mcap")
    assert len(episode.orders) == 80  # no command is lost
    assert (tmp_path / "episode.mcap").read_bytes() == (tmp_path / "free" / "episode.mcap").read_bytes()
    assert seen["scans"] > 0  # best effort
    assert (seen["beams"] > 100, seen["frame"]) == (True, "robot/scan")
    assert min(seen["odometry"], seen["map"], seen["urdf"]) > 70


def test_addresses_and_domains(monkeypatch):
    assert open_transport("rosless:7").domain == 7
    monkeypatch.setenv("ROS_DOMAIN_ID", "9")
    assert open_transport("rosless").domain == 9
    with pytest.raises(InputError, match="rosless:seven must be rosless or rosless:DOMAIN, such as rosless:7"):
        open_transport("rosless:seven")
    with pytest.raises(InputError, match="ROS domain 233 must be from 0 to 232"):
        RoslessNode(233)

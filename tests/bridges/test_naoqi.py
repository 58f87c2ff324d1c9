"""The NAOqi bridge, with a fake robot of the real qi in a process of its own."""

from __future__ import annotations

import itertools
import json
import math
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from bridge_runs import MemoryTransport, Running

from crowdbot.bridges import BridgeClock, open_transport, run_bridge
from crowdbot.bridges.naoqi import NaoqiBridge
from crowdbot.bridges.naoqi.memory_keys import memory_values
from crowdbot.bridges.naoqi.robot_link import RewriteCycle
from crowdbot.core import InputError
from crowdbot.messages import Messages
from crowdbot.recording import read_episode
from crowdbot.trials import load_trial, parse_trial

LEAST = 0.2
"""Least share of virtual reads, also on a computer that has much else to do."""
HERE = Path(__file__).parent
TRIAL = """<trial name="naoqi" duration="{seconds}">
  <crowd type="orca"/>
  <agent x="2.5" y="0"/>
  <robot name="pepper" x="0" y="0"><goal x="9" y="0"/><navigator type="external"/>
    <drive type="omnidirectional" max-speed="0.55" max-acceleration="0.55"/>
    <sensor name="base_laser_front" type="lidar2d" rays="15" field-of-view="1.0472" range-max="3" rate="10"
      x="0.06" z="0.26"/>
    <sensor name="base_laser_left" type="lidar2d" rays="15" field-of-view="1.0472" range-max="3" rate="10"
      z="0.26" heading="1.5708"/>
    <sensor name="sonar_front" type="ultrasound" rate="10" z="0.3"/>
    <sensor name="bumper" type="bumper" z="0.07" radius="0.262" sectors="3" first="0" low="-0.05" high="0.05"/>
  </robot>
</trial>
"""


def trial(seconds):
    return parse_trial(TRIAL.format(seconds=seconds), place="naoqi")


class FakeRobot:
    """The fake robot in a process."""

    def __init__(self, *words):
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port = probe.getsockname()[1]
        self.words = words
        self.url = f"tcp://127.0.0.1:{self.port}"

    def __enter__(self):
        command = [sys.executable, str(HERE / "naoqi_robot.py"), str(self.port), *self.words]
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        assert self.process.stdout.readline() == "ready\n"
        return self

    def ask(self):
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())

    def kill(self):
        self.process.kill()
        self.process.communicate()

    def __exit__(self, *error):
        self.kill()


def wait(reached, seconds=20.0):
    end = time.monotonic() + seconds
    while not reached():
        if time.monotonic() > end:
            pytest.fail("it is not reached in time")
        time.sleep(0.01)


def test_a_program_on_the_robot_sees_the_virtual_person_and_its_motion_moves_the_virtual_robot(tmp_path):
    with FakeRobot() as robot:
        bridge = NaoqiBridge(robot.url)
        with Running(trial(6.0), [bridge], out=tmp_path) as running:
            done = running.end(120.0)
        told = robot.ask()
    assert bridge.share > LEAST
    assert told["virtual"] > 100
    assert any("reads saw the virtual values of the robot, which rewrites them" in one for one in running.notes)
    assert 0.6 < told["nearest"] < 1.1
    assert done.metrics["collision"] == 0.0
    episode = read_episode(tmp_path / "episode.mcap")
    place = episode.position[:, episode.robots[0], 0]
    assert 0.6 < place[-1] < 2.2  # it has driven, and stopped before the person


def test_the_digest_in_odd_portions_is_that_of_a_free_run_and_all_sensors_are_written(tmp_path):
    with FakeRobot("still") as robot:
        driver = MemoryTransport([])
        with Running(trial(2.0), [NaoqiBridge(robot.url), driver], "step", out=tmp_path) as running:
            for steps in (3, 1, 16, 7, 13):
                assert driver.call("step_simulation", {"steps": steps})["result"]["result"] == 1
            done = running.end()
        memory = robot.ask()["values"]
        free = run_bridge(trial(2.0), [], 0, tmp_path / "free", BridgeClock("free"))
    assert done.digest == free.digest
    assert all(f"Device/SubDeviceList/Platform/{one}/Sensor/Value" in memory for one in ("Front/Sonar", "Back/Bumper"))


@pytest.mark.sweep
def test_killed_robots_and_writers_are_noticed_and_connected_again(tmp_path):
    with FakeRobot() as robot:
        bridge = NaoqiBridge(robot.url)
        with Running(trial(120.0), [bridge], out=tmp_path) as running:
            inbox = running.run.port.inbox
            wait(lambda: inbox.count.received > 5)
            os.kill(bridge._process.pid, signal.SIGKILL)
            wait(lambda: bridge.connections == 2)
            robot.kill()
            wait(lambda: bridge._problem)
            count = inbox.count.received
            time.sleep(1.5)
            assert inbox.count.received == count
            scene = running.run.port.interface
            assert scene.trial.name == "naoqi"
            with robot:
                wait(lambda: bridge.connections == 3)
                wait(lambda: inbox.count.received > count)
    episode = read_episode(tmp_path / "episode.mcap")
    times = [seconds for seconds, _ in episode.orders]
    stop = max((b - a, a) for a, b in itertools.pairwise(times))[1]
    speed = abs(episode.velocity[:, episode.robots[0]]).max(axis=-1)
    assert speed[(episode.times > stop + 1.3) & (episode.times < stop + 1.5)].max() < 1e-6


@pytest.mark.parametrize(
    "seconds", [pytest.param(4, marks=pytest.mark.sweep), pytest.param(600, marks=pytest.mark.soak)]
)
def test_the_share_of_virtual_reads_stays_high(seconds):
    with FakeRobot() as robot:
        bridge = NaoqiBridge(robot.url)
        with Running(trial(seconds + 30.0), [bridge]):
            before = robot.ask()
            time.sleep(seconds)
            told = {name: value - before[name] for name, value in robot.ask().items() if name in ("reads", "virtual")}
    print(f"naoqi: {bridge.remark()}; the program: {told['virtual'] / told['reads']:.3f} of {told['reads']}")
    assert bridge.share > LEAST
    assert told["virtual"] / told["reads"] > LEAST
    assert 0.008 < bridge.cycle < 0.05


def test_points_of_a_laser_are_in_the_frame_of_the_device_from_left_to_right():
    make = Messages()
    ranges = np.full(15, np.inf, dtype=np.float32)
    ranges[14] = 1.0  # the leftmost beam
    half = math.radians(30.0)
    scan = make.make(
        "sensor_msgs/msg/LaserScan", header=make.header(0), angle_min=-half, angle_max=half,
        angle_increment=2.0 * half / 14, time_increment=0.0, scan_time=0.15, range_min=0.1, range_max=3.0,
        ranges=ranges, intensities=np.zeros(0, dtype=np.float32),
    )  # fmt: skip
    found = memory_values("base_laser_front", scan)
    name = "Device/SubDeviceList/Platform/LaserSensor/Front/Horizontal/Seg{:02}/{}/Sensor/Value"
    assert len(found) == 30
    assert found[name.format(1, "X")] == pytest.approx(math.cos(half), abs=1e-6)
    assert found[name.format(1, "Y")] == pytest.approx(math.sin(half), abs=1e-6)
    assert math.hypot(found[name.format(15, "X")], found[name.format(15, "Y")]) == pytest.approx(3.0)
    assert found[name.format(15, "Y")] < 0.0


def test_the_cycle_is_the_median_of_what_was_seen():
    cycle = RewriteCycle()
    assert cycle.next_moment() == 0.0
    for moment in (0.0, 0.012, 0.024, 0.1, 0.112, 0.2):  # two were missed
        cycle.note(moment)
    assert cycle.length == pytest.approx(0.012)
    assert cycle.next_moment() == pytest.approx(0.212)


def test_addresses_and_robots_that_do_not_fit():
    assert open_transport("naoqi:10.0.0.2").url == "tcp://10.0.0.2:9559"
    assert open_transport("naoqi:tcp://10.0.0.2:1").url == "tcp://10.0.0.2:1"
    with pytest.raises(InputError, match="naoqi: must be naoqi:HOST or naoqi:tcp://HOST:PORT"):
        open_transport("naoqi")
    with pytest.raises(InputError, match="naoqi needs a robot with sensors such as base_laser_front"):
        run_bridge(load_trial("frontal", duration=1.0), [NaoqiBridge("tcp://127.0.0.1:1")])


def test_a_robot_that_is_not_there_is_told(monkeypatch):
    monkeypatch.setattr("crowdbot.bridges.naoqi.bridge.STARTUP", 2.0)
    with pytest.raises(InputError, match="naoqi cannot connect to tcp://127.0.0.1:1"):
        run_bridge(trial(1.0), [NaoqiBridge("tcp://127.0.0.1:1")])

"""The NAOqi bridge, with a fake robot of the real qi in a process of its own."""

from __future__ import annotations

import contextlib
import json
import math
import os
import random
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import qi
from bridge_runs import MemoryTransport, Running, wait
from partner_runs import OdometryMemory, recording_of, time_until_still

from crowdbot.bridges import BridgeClock, open_transport, run_bridge
from crowdbot.bridges.naoqi import NaoqiBridge
from crowdbot.bridges.naoqi.bridge import OdometryFollower, memory_values
from crowdbot.bridges.naoqi.robot_link import MotionReader, RewriteCycle
from crowdbot.core import InputError
from crowdbot.messages import Messages
from crowdbot.recording import read_episode
from crowdbot.trials import load_trial, parse_trial

LEAST = 0.2
"""Least share of virtual reads, also on a computer that has much else to do."""
HERE = Path(__file__).parent
ENDLESS = '<end collision="false" goal="false"/>'
TRUTH = "/pepper/ground_truth/odom"
TRIAL = """<trial name="naoqi" duration="{seconds}">
  <crowd type="orca"/>
  {end}<agent x="2.5" y="0"/>
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


def trial(seconds, end=""):
    return parse_trial(TRIAL.format(seconds=seconds, end=end), place="naoqi")


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


@pytest.mark.live
def test_a_program_on_the_robot_sees_the_virtual_person_and_its_motion_moves_the_virtual_robot(tmp_path):
    with FakeRobot() as robot:
        bridge = NaoqiBridge(robot.url)
        with Running(trial(6.0), [bridge], out=tmp_path) as running:
            done = running.end(120.0)
        told = robot.ask()
    assert bridge.share > LEAST
    assert told["virtual"] > 100
    assert any("reads saw the virtual values of the robot, which rewrites them" in note for note in running.notes)
    assert 0.6 < told["nearest"] < 1.1
    assert done.metrics["collision"] == 0.0
    episode = read_episode(tmp_path / "episode.mcap")
    place = episode.position[:, episode.robots[0], 0]
    assert 0.6 < place[-1] < 2.2  # it has driven, and stopped before the person


@pytest.mark.live
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
    assert all(
        f"Device/SubDeviceList/Platform/{item}/Sensor/Value" in memory for item in ("Front/Sonar", "Back/Bumper")
    )


KILLS = pytest.mark.parametrize(
    "count", [pytest.param(3, marks=pytest.mark.sweep), pytest.param(20, marks=pytest.mark.soak)]
)


@KILLS
def test_killed_robots_and_writers_are_noticed_and_connected_again(count, tmp_path):
    """The robot is killed, and every other time the process that writes its memory, too."""
    rng, stops, memory = random.Random(count), [], OdometryMemory(TRUTH)
    with FakeRobot("loop") as robot:
        bridge = NaoqiBridge(robot.url)
        with Running(trial(3600.0, ENDLESS), [bridge, memory], out=tmp_path) as running:
            inbox = running.run.port.inbox
            for k in range(count):
                before, connections = inbox.count.received, bridge.connections
                wait(lambda before=before: inbox.count.received > before + 5)
                time.sleep(rng.uniform(0.0, 0.3))
                if k % 2:
                    os.kill(bridge._process.pid, signal.SIGKILL)
                    wait(lambda connections=connections: bridge.connections == connections + 1)
                    connections += 1
                robot.kill()
                wait(lambda: bridge._problem)
                bridge._problem = ""
                stops.append(time_until_still(memory))
                robot.__enter__()
                wait(lambda connections=connections: bridge.connections == connections + 1)
            before = inbox.count.received
            wait(lambda: inbox.count.received > before + 5)
    assert len(stops) == count
    assert max(stops) < 4.0  # 0.5 s of simulated time, and braking, on a busy computer
    seen = recording_of(tmp_path / "episode.mcap")
    assert seen["speed"] > 0.05
    assert (seen["outcome"], seen["equal"]) == ("interrupted", True)


@KILLS
def test_killed_simulations_leave_the_robot_its_own_values_and_a_recording_that_can_be_read(count, tmp_path):
    rng, file = random.Random(count), tmp_path / "pepper.xml"
    file.write_text(TRIAL.format(seconds=3600, end=ENDLESS))
    with FakeRobot() as robot, contextlib.ExitStack() as stack:
        words = [sys.executable, "-m", "crowdbot", "run", str(file), "--bridge", f"naoqi:{robot.url}", "--out"]
        for k in range(count):
            before, out = robot.ask()["virtual"], tmp_path / f"out{k}"
            process = subprocess.Popen([*words, str(out)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            stack.callback(process.wait)
            stack.callback(process.kill)
            wait(lambda before=before: robot.ask()["virtual"] > before + 20, 120.0)
            time.sleep(rng.uniform(0.0, 1.0))
            process.kill()
            process.wait()
            time.sleep(0.5)  # the writer ends with the simulation
            first = robot.ask()
            time.sleep(0.3)
            second = robot.ask()
            assert second["reads"] > first["reads"]
            assert second["virtual"] == first["virtual"]
            episode = read_episode(out / "episode.mcap")
            assert (len(episode.orders) > 0, episode.complete) == (True, False)


TEN_MINUTES = pytest.param(600, marks=[pytest.mark.soak, pytest.mark.timeout(900)])
"""Seconds of the longest runs; a test is ended after ten minutes if it does not say more."""


@pytest.mark.live
@pytest.mark.parametrize("seconds", [3, pytest.param(30, marks=pytest.mark.sweep), TEN_MINUTES])
def test_a_control_loop_of_20_hz_loses_no_command(seconds):
    """The program on the robot reads its memory and commands another velocity in each period.

    A command that is over before the velocity is read again is not seen; the link tells each time in which that can be.
    """
    with FakeRobot("loop") as robot:
        bridge, came = NaoqiBridge(robot.url), []
        take = bridge._take
        bridge._take = lambda fields: (came.append((fields, time.monotonic())), take(fields))
        with Running(trial(seconds + 60.0, ENDLESS), [bridge]):
            first = len(robot.ask()["sent"])
            time.sleep(seconds)
            sent = robot.ask()["sent"][first:]
            time.sleep(0.3)
    moments = {}
    for fields, moment in came:
        if "velocity" in fields:
            moments.setdefault(fields["velocity"][0], moment)
    gaps = [fields["unread"] for fields, _ in came if "unread" in fields]
    unseen = [k for k, (velocity, _) in enumerate(sent[:-1]) if velocity not in moments]
    times = [moment for _, moment in sent]
    lost = [k for k in unseen if not any(begin <= times[k + 1] and times[k] <= end for begin, end in gaps)]
    delays = sorted(moments[velocity] - moment for velocity, moment in sent if velocity in moments)
    median, p99 = delays[len(delays) // 2], delays[round(0.99 * (len(delays) - 1))]
    print(f"naoqi: {len(sent)} commands, {len(lost)} lost, {1e3 * median:.2f} ms, {1e3 * p99:.2f} ms (99 %)")
    print(f"{bridge.remark()}; {len(unseen)} commands were over meanwhile")
    assert len(sent) > 10 * seconds
    assert lost == []
    assert len(unseen) < 0.2 * len(sent)
    assert median < 0.05


@pytest.mark.live
def test_the_virtual_robot_is_where_the_odometry_of_the_real_one_ends():
    memory = OdometryMemory(TRUTH)
    with FakeRobot("idle") as robot:
        session = qi.Session()
        with Running(trial(300.0), [NaoqiBridge(robot.url), memory]) as running:
            session.connect(robot.url)
            motion = session.service("ALMotion")
            # The first pose of the odometry is that of the virtual robot, so the real one stands until it has come.
            wait(lambda: running.run.port.inbox.count.velocities)
            for velocity in ((0.4, 0.0, 0.5), (0.3, -0.2, -0.8), (0.0, 0.3, 0.0), (-0.2, 0.0, 1.0)):
                motion.move(*velocity)
                time.sleep(0.7)
            motion.stopMove()
            place = robot.ask()["place"]
            # Position and heading are corrected apart: neither tells that the other has arrived.
            wait(lambda: math.dist(pose_of(memory)[:2], place[:2]) < 0.01 and abs(pose_of(memory)[2] - place[2]) < 0.02)
            assert math.hypot(*place[:2]) > 0.3
        session.close()


def test_a_follower_corrects_the_pose_in_its_own_frame_and_is_aligned_anew_after_a_jump():
    follower = OdometryFollower(0.0, 0.0, math.pi / 2)
    assert follower.command((0.3, 0.1, 0.2), (5.0, 5.0, 1.0)) == pytest.approx((0.3, 0.1, 0.2))
    follower.note_virtual(0.1, 0.0, math.pi / 2 + 0.1)  # it has gone aside, and turned too far
    forward, left, turn = follower.command((0.0, 0.0, 0.0), (5.0, 5.0, 1.0))
    assert (forward, left) == pytest.approx((0.2 * math.sin(0.1), 0.2 * math.cos(0.1)))
    assert turn == pytest.approx(-0.2)
    assert follower.command((0.2, 0.0, 0.0), (5.0, 7.5, 1.0)) == pytest.approx((0.2, 0.0, 0.0))  # carried elsewhere
    assert follower.command((0.2, 0.0, 0.0), (5.0 + math.cos(1.0), 7.5 + math.sin(1.0), 1.0))[0] == pytest.approx(2.2)
    follower.align()
    assert follower.command((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)) == pytest.approx((0.0, 0.0, 0.0))


def pose_of(memory):
    """Return x, y [m] and heading [rad] of the virtual robot."""
    pose = memory.sent[-1].message.pose.pose
    return pose.position.x, pose.position.y, 2.0 * math.atan2(pose.orientation.z, pose.orientation.w)


@pytest.mark.parametrize("seconds", [pytest.param(4, marks=pytest.mark.sweep), TEN_MINUTES])
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


class Motion:
    """ALMotion of a robot whose velocity is that of its time."""

    def __init__(self, now):
        self.now = now

    def getRobotVelocity(self):  # noqa: N802
        return [0.1 * self.now[0], 0.0, 0.0]

    def getRobotPosition(self, use_sensors):  # noqa: N802
        return [0.5, 0.0, 0.0]


def test_a_command_that_is_over_before_the_velocity_is_read_again_is_told():
    now, lines = [0.0], []
    reader = MotionReader(Motion(now), lines.append, lambda: now[0])
    for now[0] in (0.0, 0.01, 0.029, 0.06, 0.07):
        reader.read()
    velocities = [line["velocity"][0] for line in lines if "velocity" in line]
    assert velocities == pytest.approx([0.0, 0.001, 0.0029, 0.006, 0.007])
    assert [line["unread"] for line in lines if "unread" in line] == [[0.029, 0.06]]

    bridge = NaoqiBridge("tcp://127.0.0.1:1")
    assert bridge.remark() == ""
    for line in lines:
        bridge._take(line)
    assert bridge.remark() == (
        "naoqi: 1 times, the velocity of the robot was not read for more than 20 ms (at most 31 ms), and the virtual"
        " robot followed its odometry alone"
    )


def test_addresses_and_robots_that_do_not_fit():
    assert open_transport("naoqi:10.0.0.2").url == "tcp://10.0.0.2:9559"
    assert open_transport("naoqi:tcp://10.0.0.2:1").url == "tcp://10.0.0.2:1"
    with pytest.raises(InputError, match="naoqi: must be naoqi:HOST or naoqi:tcp://HOST:PORT"):
        open_transport("naoqi")
    with pytest.raises(InputError, match="naoqi needs a robot with sensors such as base_laser_front"):
        run_bridge(load_trial("frontal", duration=1.0), [NaoqiBridge("tcp://127.0.0.1:1")])


@pytest.mark.live
def test_a_robot_that_is_not_there_is_told(monkeypatch):
    monkeypatch.setattr("crowdbot.bridges.naoqi.bridge.STARTUP", 2.0)
    with pytest.raises(InputError, match="naoqi cannot connect to tcp://127.0.0.1:1"):
        run_bridge(trial(1.0), [NaoqiBridge("tcp://127.0.0.1:1")])

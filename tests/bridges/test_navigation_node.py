"""The reference navigation node of the examples: its planner, its driver, and its programs over each transport."""

from __future__ import annotations

import functools
import math
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from bridge_runs import MemoryTransport, Running
from navigation_runs import EXAMPLES, navigate
from test_naoqi import FakeRobot

from crowdbot.bridges import BridgeClock, run_bridge
from crowdbot.bridges.naoqi import NaoqiBridge
from crowdbot.recording import read_episode
from crowdbot.trials import load_trial

sys.path.insert(0, str(EXAMPLES))
from local_planner import CELL, LocalPlanner
from scan_driver import ScanDriver, heading_of

HERE = Path(__file__).parent
ANGLES = np.linspace(-math.pi, math.pi, 361)
FREE = [math.inf] * 361


def scan_of(points):
    """Return ranges of a full scan that sees points (x, y) of a robot at the origin."""
    ranges = np.full(len(ANGLES), np.inf)
    for x, y in points:
        beam = int(np.argmin(np.abs(ANGLES - math.atan2(y, x))))
        ranges[beam] = min(ranges[beam], math.hypot(x, y))
    return ranges


@pytest.fixture
def local(monkeypatch, tmp_path):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path / "log"))


@pytest.mark.parametrize(("goal", "sign"), [((5.0, 0.0), 0), ((2.0, 2.0), 1), ((2.0, -2.0), -1)])
def test_without_obstacles_it_drives_to_the_goal(goal, sign):
    speed, turn = LocalPlanner().command(FREE, -math.pi, math.radians(1), goal)
    assert speed > 0.2
    assert np.sign(round(turn, 1)) == sign


def test_clearance_is_the_distance_to_the_nearest_point():
    points = [(1.0, 0.2), (1.3, -0.4), (-0.5, 0.9)]
    found = LocalPlanner().clearance(scan_of(points), -math.pi, math.radians(1))
    cells = [(round(x / CELL), round(y / CELL)) for x, y in points]
    for x in range(-20, 31):
        for y in range(-20, 31):
            distance = CELL * min(math.dist((x, y), cell) for cell in cells)
            assert found.get((x, y), math.inf) == (pytest.approx(distance) if distance <= 1.0 else math.inf)
    assert LocalPlanner().clearance([math.nan, 0.0, math.inf, 9.0], 0.0, 0.1) == {}


def test_the_path_goes_around_a_wall():
    wall = [(1.5, y) for y in np.arange(-1.0, 2.5, 0.02)]
    planner = LocalPlanner()
    clearance = planner.clearance(scan_of(wall), -math.pi, math.radians(1))
    path = planner.path(clearance, (2.8, 0.0))
    assert path[-1] == (28, 0)
    assert min(y for _, y in path) * CELL < -1.0
    assert all(clearance.get(cell, math.inf) >= planner.radius for cell in path[3:])


def test_a_closed_ring_has_no_path():
    ring = [(0.6 * math.cos(a), 0.6 * math.sin(a)) for a in ANGLES]
    speed, turn = LocalPlanner().command(scan_of(ring), -math.pi, math.radians(1), (5.0, 0.0))
    assert speed < 0.1
    assert turn != 0.0


def test_a_scan_is_answered_once_and_when_its_pose_is_known():
    driver = ScanDriver()
    assert driver.take_pose(5, 0.0, 0.0, 0.0) is None
    assert driver.take_scan(5, FREE, -math.pi, math.radians(1)) is None  # no goal
    driver.take_goal(3.0, 0.0)
    assert driver.take_scan(10, FREE, -math.pi, math.radians(1)) is None  # the pose is older
    assert driver.take_pose(10, 0.0, 0.0, math.pi / 2)[1] < 0.0  # the goal is to the right
    assert driver.take_pose(11, 0.0, 0.0, 0.0) is None
    assert driver.take_scan(11, FREE, -math.pi, math.radians(1))[0] == pytest.approx(0.8)
    assert (driver.commands, driver.arrived) == (2, False)


def test_a_robot_at_its_goal_stays_there_until_another_one_comes():
    driver = ScanDriver()
    driver.take_goal(1.0, 0.0)
    driver.take_scan(1, FREE, -math.pi, math.radians(1))
    assert driver.take_pose(1, 0.9, 0.1, 0.0) == (0.0, 0.0)
    driver.take_scan(2, FREE, -math.pi, math.radians(1))
    assert driver.take_pose(2, 0.7, 0.1, 0.0) == (0.0, 0.0)
    assert (driver.arrived, driver.done, driver.summary()) == (True, False, "arrived after 2 commands")
    driver.take_goal(3.0, 0.0)
    driver.take_scan(3, FREE, -math.pi, math.radians(1))
    assert driver.take_pose(3, 0.7, 0.1, 0.0)[0] > 0.0
    fixed = ScanDriver((1.0, 0.0))
    fixed.take_goal(9.0, 0.0)
    fixed.take_scan(1, FREE, -math.pi, math.radians(1))
    assert fixed.take_pose(1, 1.0, 0.0, 0.0) == (0.0, 0.0)
    assert fixed.done


class Driver(MemoryTransport):
    """The driver of the nodes in memory."""

    def start(self, interface, inbox):
        super().start(interface, inbox)
        goal = interface.trial.robots[0].goal
        self.driver = ScanDriver((goal.x, goal.y))

    def publish(self, messages):
        for item in messages:
            command, message = None, item.message
            if item.topic == "/robot/odom":
                place, turn = message.pose.pose.position, message.pose.pose.orientation
                command = self.driver.take_pose(item.nanoseconds, place.x, place.y, heading_of(turn.z, turn.w))
            elif item.topic == "/robot/scan":
                ranges = message.ranges.tolist()
                command = self.driver.take_scan(item.nanoseconds, ranges, message.angle_min, message.angle_increment)
            if command is not None:
                twist = {"linear": {"x": command[0]}, "angular": {"z": command[1]}}
                self.inbox.receive("/robot/cmd_vel", twist, "memory")


@functools.cache
def reference():
    """Return the metrics of the run in which nothing lies between the driver and the simulation."""
    done = run_bridge(load_trial(str(EXAMPLES / "pillar.xml")), [Driver()], 0, None, BridgeClock("free"))
    assert done.outcome == "success"
    return done.metrics


def test_the_page_names_every_program_and_its_first_commands_start_one():
    page = (EXAMPLES.parents[1] / "docs" / "how-to" / "navigation-node.md").read_text(encoding="utf-8")
    programs = sorted(item.name for item in EXAMPLES.glob("navigate_*.py"))
    assert [program for program in programs if f"`{program} " not in page] == []
    trial, program = re.search(r"^crowdbot run (\S+) .*?^python (\S+) --goal 4,0$", page, re.M | re.S).groups()
    goal = load_trial(str(EXAMPLES.parents[1] / trial)).robots[0].goal
    assert (goal.x, goal.y) == (4.0, 0.0)
    assert Path(program).name in programs


def check(seen):
    """It has driven around the pillar to the goal, on the way of the reference, and touched nothing."""
    assert (seen["outcome"], seen["collision"]) == ("success", 0.0), seen
    assert seen["path_length"] == reference()["path_length"] > 4.1
    assert "commands" in seen["printed"]


@pytest.mark.live
@pytest.mark.usefixtures("local")
@pytest.mark.parametrize(
    ("transport", "program"),
    [
        ("rosbridge", "navigate_rosbridge.py"),
        ("ros2", "navigate_ros2.py"),
        ("foxglove", "navigate_foxglove.py"),
        pytest.param("rosbridge-client", "navigate_rosbridge.py", marks=pytest.mark.sweep),
    ],
)
def test_a_node_drives_a_robot_around_a_pillar_to_its_goal(transport, program, tmp_path):
    check(navigate(transport, program, tmp_path))


@pytest.mark.live
@pytest.mark.usefixtures("ros1")
def test_a_node_of_ros1_drives_a_robot_around_a_pillar_to_its_goal(tmp_path):
    check(navigate("ros1", "navigate_ros1.py", tmp_path))


@pytest.mark.live
@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["navigate_foxglove.py", "--port", "9"], "no simulation at ws://127.0.0.1:9 "),
        (["navigate_rosbridge.py", "--port", "9", "--wait", "1"], "no server at 127.0.0.1:9 within 1 s; start one"),
        (["navigate_naoqi.py", "tcp://127.0.0.1:9", "--goal", "3,0"], "no robot at tcp://127.0.0.1:9: "),
    ],
)
def test_a_node_that_is_started_first_ends_with_a_sentence(words, message):
    words = [sys.executable, str(EXAMPLES / words[0]), *words[1:]]
    process = subprocess.run(words, capture_output=True, text=True, timeout=60)
    assert process.returncode == 1
    assert message in process.stderr.splitlines()[-1]
    assert "Traceback" not in process.stderr


@pytest.mark.soak  # on a busy computer, half of the reads see the values of the real robot, and the program is slow
def test_a_program_on_a_pepper_drives_around_a_virtual_person_to_its_goal(tmp_path):
    trial = load_trial(str(EXAMPLES / "pepper.xml"), duration=600.0)
    goal = trial.robots[0].goal
    with FakeRobot("idle") as robot, Running(trial, [NaoqiBridge(robot.url)], out=tmp_path) as running:
        words = [sys.executable, str(EXAMPLES / "navigate_naoqi.py"), robot.url, "--goal", f"{goal.x},{goal.y}"]
        process = subprocess.run(words, capture_output=True, text=True, timeout=600)
        done = running.end(60.0)
    assert process.returncode == 0, process.stderr
    assert "arrived after" in process.stdout
    assert (done.outcome, done.metrics["collision"]) == ("success", 0.0)
    episode = read_episode(tmp_path / "episode.mcap")
    places = episode.position[:, episode.robots[0]]
    assert abs(places[:, 1]).max() > 0.2  # it has seen the person in its way, who is only in the memory

"""A real robot in a trial: the guard of its commands, and runs with a simulated robot in its place."""

from __future__ import annotations

import json
import math
import re
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from bridge_runs import MemoryTransport
from hypothesis import given
from hypothesis import strategies as st
from motion_senders import Motive

from crowdbot.bridges import BridgeClock, CommandGuard, DrivingArea, GuardLimits, JoinRun, run_bridge
from crowdbot.cli import main
from crowdbot.cli.join.stop_key import StopKey
from crowdbot.core import InputError, Twist
from crowdbot.recording import read_episode, replay
from crowdbot.trials import load_trial

HERE = Path(__file__).parent
FIELD = DrivingArea(-50.0, -50.0, 50.0, 50.0)
numbers = st.floats(-3.0, 3.0)


@given(st.lists(st.tuples(numbers, numbers, numbers, st.floats(0.001, 0.3)), max_size=40))
def test_no_command_exceeds_the_limits(rows):
    limits = GuardLimits(speed=0.6, turn=0.8, acceleration=0.5, turn_acceleration=1.0)
    guard, now, last = CommandGuard(FIELD, limits), 0.0, Twist()
    for forward, turn, left, dt in rows:
        now += dt
        guard.note_pose(0.0, 0.0, 0.0, now)
        guard.note_command(Twist(forward, turn, left), now)
        found = guard.next_command(now)
        assert math.hypot(found.forward, found.left) <= limits.speed + 1e-9
        assert abs(found.turn) <= limits.turn + 1e-9
        assert math.hypot(found.forward - last.forward, found.left - last.left) <= limits.acceleration * dt + 1e-9
        assert abs(found.turn - last.turn) <= limits.turn_acceleration * dt + 1e-9
        last = found
    assert guard.stops == []


def driving(area=FIELD, **limits):
    """Return a guard whose robot drives with 0.5 m/s at the origin, at 2 s."""
    guard = CommandGuard(area, GuardLimits(**limits))
    for k in range(41):
        guard.note_pose(0.0, 0.0, 0.0, 0.05 * k)
        guard.note_command(Twist(0.5), 0.05 * k)
        guard.next_command(0.05 * k)
    return guard


def test_a_lost_link_stops_at_once_and_until_it_is_released():
    guard = driving()
    guard.note_command(Twist(0.5), 2.5)
    assert guard.next_command(2.4).forward == pytest.approx(0.5)
    assert guard.next_command(2.51) == Twist()
    assert guard.reason == "the link is lost: no pose of the robot for 0.5 s"
    guard.note_command(Twist(0.5), 2.52)
    assert guard.next_command(2.53) == Twist()
    assert "no pose" in guard.release(2.6)
    guard.note_pose(0.0, 0.0, 0.0, 2.7)
    assert guard.release(2.7) == ""
    assert guard.next_command(2.71) == Twist()  # commands from before the release are forgotten
    guard.note_command(Twist(0.5), 2.75)
    assert guard.next_command(2.81).forward == pytest.approx(0.05)


def test_without_commands_it_slows_down_and_drives_on_with_the_next():
    guard = driving(acceleration=1.0)
    for k in range(1, 12):
        guard.note_pose(0.0, 0.0, 0.0, 2.0 + 0.1 * k)
        found = guard.next_command(2.0 + 0.1 * k)
    assert (found, guard.reason) == (Twist(), "")


def test_it_stops_before_the_edge_of_its_area_and_outside():
    guard = driving(DrivingArea(-1.0, -1.0, 0.2, 1.0))
    assert "would leave its area" in guard.reason
    guard = driving()
    guard.note_pose(60.0, 0.0, 0.0, 2.01)
    assert guard.next_command(2.02) == Twist()
    assert guard.reason == "the robot has left its area at 60.00, 0.00"


def test_nothing_leaves_before_the_first_pose():
    guard = CommandGuard(FIELD)
    guard.next_command(0.0)
    guard.note_command(Twist(0.4), 0.1)
    assert guard.next_command(0.1) == Twist()
    assert (guard.waits, guard.reason) == (True, "")


def test_after_a_late_first_pose_the_robot_drives():
    guard = CommandGuard(FIELD)
    for k in range(10):
        guard.note_command(Twist(0.4), 0.1 * k)
        assert guard.next_command(0.1 * k) == Twist()
    guard.note_pose(0.0, 0.0, 0.0, 1.0)
    assert guard.waits is False
    guard.note_command(Twist(0.4), 1.0)
    assert guard.next_command(1.0).forward == pytest.approx(0.05)  # 0.5 m/s2 for 0.1 s
    assert guard.stops == []


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: DrivingArea.of("1,2,3"), "must be x0,y0,x1,y1 in m, such as"),
        (lambda: DrivingArea.of("3,0,1,2"), "x0 < x1 and y0 < y1"),
        (lambda: GuardLimits(speed=0.0), "speed"),
        (lambda: CommandGuard(FIELD).note_command(Twist(math.nan), 0.0), "must be finite"),
        (lambda: JoinRun(load_trial("frontal"), [], CommandGuard(FIELD), "Robot"), "has no robot 'Robot'"),
        (lambda: JoinRun(load_trial("frontal"), [], CommandGuard(FIELD), command="/odom"), "/odom is an input"),
    ],
)
def test_bad_values(make, message):
    with pytest.raises(InputError, match=message):
        make()


def test_messages_and_keys_stop_and_release():
    run = JoinRun(load_trial("frontal", duration=0.5), [MemoryTransport()], CommandGuard(FIELD))
    port = run.port
    port.inbox.receive("/odom", {"pose": {"pose": {"position": {"x": 3.0}}}}, "test")
    port.inbox.receive("/robot/stop", {"data": True}, "test")
    assert port.guard.reason == "a stop message"
    port.inbox.receive("/robot/stop", {"data": False}, "test")
    assert port.guard.reason == ""
    key = StopKey(port.request_stop)
    key.take_line("")
    assert port.guard.reason == "the key"
    key.take_line("Go")
    assert port.guard.reason == ""
    with pytest.raises(InputError, match="needs pose, as in nav_msgs/Odometry"):
        port.inbox.receive("/odom", {"twist": {}}, "test")
    with pytest.raises(InputError, match="must be a finite number"):
        port.inbox.receive("/odom", {"pose": {"pose": {"position": {"x": math.nan}}}}, "test")


def test_a_robot_that_waits_for_its_first_pose_says_so():
    notes = []
    trial = load_trial("frontal", duration=0.5)
    port = JoinRun(trial, [MemoryTransport()], CommandGuard(FIELD), note=notes.append).port
    port.send_command(0)
    assert notes == []
    port.want(Twist(0.4))
    port.send_command(0)
    port.send_command(0)
    assert notes == ["robot 'robot' stands: no pose has come on /odom yet"]
    port.inbox.receive("/odom", {"pose": {"pose": {"position": {"x": 3.0}}}}, "test")
    port.send_command(0)
    assert notes[1:] == ["the robot may drive"]


def start_robot(*words):
    return subprocess.Popen([sys.executable, str(HERE / "real_robot.py"), *words], stdout=subprocess.PIPE, text=True)


def ended(process):
    out, _ = process.communicate(timeout=60)
    return json.loads(out.splitlines()[-1])


def join(tmp_path, bridge, *words):
    return main(["join", "frontal", "--area=-20,-20,20,20", "--bridge", bridge, "--out", str(tmp_path), *words])


@pytest.mark.live
def test_a_robot_with_a_rosbridge_server_drives_in_a_trial(tmp_path, capsys):
    robot = start_robot("rosbridge")
    port = robot.stdout.readline().strip()
    words = ("--set", "duration=4", "--set", "end/collision=false", "--max-speed", "0.6", "--max-acceleration", "1")
    assert join(tmp_path, f"rosbridge-client:ws://127.0.0.1:{port}", *words) == 0
    seen, said = ended(robot), capsys.readouterr().err
    assert 1.2 < seen["driven"] < 2.4
    assert 0.59 < seen["fastest"] <= 0.6 + 1e-9
    assert "age median" in said
    assert "commands passed on after" in said
    episode = read_episode(tmp_path / "episode.mcap")
    path = episode.position[:, episode.robots[0]]
    assert math.dist(path[0], path[-1]) == pytest.approx(seen["driven"], abs=0.25)
    start = load_trial("frontal").robots[0]
    assert path[0] == pytest.approx((start.x, start.y), abs=0.05)
    assert replay(tmp_path / "episode.mcap").equal


@pytest.mark.live
def test_motion_capture_moves_the_avatar_of_a_robot_and_its_silence_stops_the_robot(tmp_path, capsys):
    run_bridge(
        load_trial("frontal", duration=0.2), [], clock=BridgeClock("free")
    )  # a compiler would hold up the sender
    robot = start_robot("rosbridge")
    port = robot.stdout.readline().strip()
    motive = Motive()
    motive.start()
    words = [
        "--set",
        "duration=7",
        "--set",
        "end/collision=false",
        "--mocap",
        f"natnet:127.0.0.1:{motive.port}#Cart=robot",
        "--link-timeout",
        "1.5",
    ]
    silence = threading.Thread(target=end_after, args=(motive, tmp_path / "episode.mcap", 3.0))
    silence.start()
    assert join(tmp_path, f"rosbridge-client:ws://127.0.0.1:{port}", *words) == 0
    silence.join()
    seen, said = ended(robot), capsys.readouterr().err
    assert re.search(r"motion capture robot: \d{2,} samples", said)
    assert "is stopped: the link is lost: no pose of the robot for 1.5 s" in said
    assert seen["driven"] > 0.1  # with the commands of its software, before the silence
    assert seen["stopped"] > 5
    episode = read_episode(tmp_path / "episode.mcap")
    path = episode.position[:, episode.robots[0]]
    moved = path[abs(path[:, 1] - 1.0) < 0.01]  # the cart drives along y = 1 m, its odometry is somewhere else
    assert len(moved) > 20
    assert moved[-1, 0] - moved[0, 0] > 0.5
    assert replay(tmp_path / "episode.mcap").equal


def end_after(motive, file, seconds):
    """End the motion capture some time after the recording has begun."""
    end = time.monotonic() + 60.0
    while not file.exists() and time.monotonic() < end:
        time.sleep(0.05)
    time.sleep(seconds)
    motive.end.set()
    motive.join()


@pytest.mark.live
def test_a_lost_link_stops_the_robot(tmp_path, capsys):
    robot = start_robot("rosbridge", "1.5")
    port = robot.stdout.readline().strip()
    words = ("--set", "duration=4", "--set", "end/collision=false", "--link-timeout", "0.3")
    assert join(tmp_path, f"rosbridge-client:ws://127.0.0.1:{port}", *words) == 0
    seen, said = ended(robot), capsys.readouterr().err
    assert "robot 'robot' is stopped: the link is lost: no pose of the robot for 0.3 s" in said
    assert seen["stopped"] > 10
    assert seen["driven"] < 0.9


def test_a_robot_with_ros2_drives_in_a_trial(domain, tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path / "log"))
    robot = start_robot("ros2", str(domain))
    words = ("--set", "duration=6", "--set", "end/collision=false")
    assert join(tmp_path, f"ros2:{domain}", *words) == 0
    seen, said = ended(robot), capsys.readouterr().err
    assert seen["driven"] > 0.3, said
    assert seen["fastest"] <= 0.5 + 1e-9
    assert seen["stopped"] > 5  # scans of the virtual scanner
    assert "poses of the robot, age median" in said


def test_the_command_refuses_what_does_not_fit(tmp_path, capsys):
    assert main(["join", "frontal", "--area=0,0,1,1"]) == 2
    assert "crowdbot join needs --bridge" in capsys.readouterr().err
    assert join(tmp_path, "ros2", "--clock", "free") == 2
    assert "--clock free does not fit a real robot" in capsys.readouterr().err

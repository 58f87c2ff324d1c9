"""The ROS 1 node, with a real rosmaster, Debian's tools and a robot program of rospy in processes of their own."""

from __future__ import annotations

import asyncio
import contextlib
import gc
import json
import os
import random
import re
import signal
import socket
import struct
import subprocess
import sys
import time
import urllib.error
import urllib.request
import warnings
import xmlrpc.client
from importlib.resources import files
from pathlib import Path

import pytest
from bridge_runs import MemoryTransport, Running, wait
from ros1_master import RosMaster

from crowdbot.bridges import BridgeClock, Inbox, RobotInterface, open_transport, run_bridge
from crowdbot.bridges.ros1 import Ros1Node, session
from crowdbot.bridges.ros1.session import pack_header, unpack_header
from crowdbot.core import InputError
from crowdbot.recording import read_episode, replay
from crowdbot.trials import load_trial

STEP = 50_000_000
TRIAL = load_trial("frontal", duration=4.0)


@pytest.fixture(scope="module")
def master(ros1, tmp_path_factory):
    with RosMaster(tmp_path_factory.mktemp("ros")) as found:
        yield found


def ended(process, seconds=60):
    out, errors = process.communicate(timeout=seconds)
    assert process.returncode == 0, errors
    return json.loads(out.splitlines()[-1])


class Driver(MemoryTransport):
    """The commands of the robot program in memory."""

    def publish(self, messages):
        for item in (message for message in messages if message.topic == "/clock"):
            turn = 0.3 if item.nanoseconds // STEP % 7 < 4 else -0.3
            self.inbox.receive("/robot/cmd_vel", {"linear": {"x": 0.4}, "angular": {"z": turn}}, "ros1")


@pytest.mark.live
def test_a_robot_program_steps_the_simulation_with_its_commands_and_the_digest_is_that_of_a_free_run(master, tmp_path):
    with Running(TRIAL, [Ros1Node(master.url)], "commands", out=tmp_path) as running:
        process = master.open("ros1_robot.py", "60")
        done = running.end(120.0)
    seen = ended(process)
    free = run_bridge(TRIAL, [Driver()], 0, tmp_path / "free", BridgeClock("free"))
    assert done.digest == free.digest
    assert (tmp_path / "episode.mcap").read_bytes() == (tmp_path / "free" / "episode.mcap").read_bytes()
    assert replay(tmp_path / "episode.mcap").equal
    assert len(read_episode(tmp_path / "episode.mcap").orders) == done.steps == 80  # no command is lost
    assert [item for item in seen["ticks"] if item] == [STEP * k for k in range(1, 81)]
    assert seen["scans"] >= 39
    assert (seen["beams"] > 100, seen["frame"]) == (True, "robot/scan")
    assert seen["odometry"] >= 80
    assert seen["map"] > 100
    assert seen["now"] == 4.0  # simulated time
    assert seen["laser"][0] > -4.5 + 1.0  # looked up by tf: the robot has moved


@pytest.mark.live
@pytest.mark.parametrize("turns", range(6))
def test_connections_that_come_while_a_node_closes_its_listeners_are_closed(master, turns, monkeypatch):
    clients, close = [], session.close_listener

    async def close_late(listener):
        """Close a listener some turns of its loop after a connection, which it has perhaps not accepted yet."""
        clients.append(socket.create_connection(listener.sockets[0].getsockname()))
        for _ in range(turns):
            await asyncio.sleep(0)
        await close(listener)

    monkeypatch.setattr(session, "close_listener", close_late)
    node, interface = Ros1Node(master.url), RobotInterface.of(TRIAL)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        node.start(interface, Inbox(interface))
        node.stop()
        gc.collect()
    assert len(clients) == 2  # TCPROS, and the API of the node
    for client in clients:
        with client, contextlib.suppress(ConnectionResetError):  # never accepted
            client.settimeout(30.0)
            assert client.recv(1) == b""
    assert [str(item.message) for item in caught] == []


@pytest.mark.sweep
def test_the_tools_of_ros_see_topics_rates_and_parameters_and_call_the_services(master, tmp_path):
    trial = load_trial("frontal", duration=60.0)
    with Running(trial, [Ros1Node(master.url)]) as running:
        names = {output.name for output in RobotInterface.of(trial).outputs}
        assert names | {"/robot/cmd_vel", "/rosout"} <= set(master.tool("rostopic", "list").split())
        hertz = master.open("rostopic", "hz", "/robot/scan")
        markers = master.tool("rostopic", "echo", "-n1", "/crowd/markers")
        assert 'frame_id: "map"' in markers
        line = [next(line for line in hertz.stdout if "average rate" in line) for _ in range(3)][-1]
        hertz.kill()
        hertz.communicate()
        assert 7.0 < float(line.split(":")[1]) < 13.0
        assert master.call("getParam", "/use_sim_time") is True
        assert "<robot" in master.call("getParam", "/robot_description")
        refused = master.tool("rosservice", "call", "/crowdbot/step")
        assert "success: False" in refused
        assert "must be paused" in refused
        master.tool("rosservice", "call", "/crowdbot/pause")
        assert not running.run.control.may_step
        assert "success: True" in master.tool("rosservice", "call", "/crowdbot/step")
        master.tool("rosservice", "call", "/crowdbot/unpause")
        assert running.run.control.may_step
        master.tool("rosservice", "call", "/crowdbot/reset")
        stamped = master.open("ros1_robot.py", "30", "stamped")
        wait(lambda: running.run.port.inbox.count.received > 0)
        stamped.kill()
        stamped.communicate()
        master.tool("rosnode", "kill", "/crowdbot")  # ends the run
        assert running.end().outcome == "interrupted"
    assert "/crowdbot/pause" not in master.state()[2]
    assert master.call("hasParam", "/use_sim_time") is False
    assert [name for name, nodes in master.state()[0].items() if "/crowdbot" in nodes] == []


@pytest.mark.live
def test_a_bag_that_ros_records_holds_the_messages_with_their_types(master, tmp_path):
    bag, topics = tmp_path / "run.bag", ("/robot/scan", "/tf", "/map", "/people")
    recorder = master.open("rosbag", "record", "-O", str(bag), *topics)  # roscpp
    node, driver = Ros1Node(master.url), MemoryTransport([])
    with Running(TRIAL, [node, driver], "step") as running:
        wait(lambda: all(node.wants(topic) for topic in topics))
        for _ in range(10):  # a reading is best effort: a recorder that is slow for a moment loses some of them
            assert driver.call("step_simulation", {"steps": 8})["result"]["result"] == 1
        running.end()
    time.sleep(0.5)
    recorder.send_signal(signal.SIGINT)
    recorder.communicate(timeout=30)
    told = master.tool("rosbag", "info", str(bag))
    assert re.search(r"sensor_msgs/LaserScan +\[90c7ef2dc6895d81024acba2ac42f369\]", told)
    assert re.search(r"tf2_msgs/TFMessage +\[94810edda583a504dfda3829e70d7eec\]", told)
    assert int(re.search(r"/robot/scan +(\d+) msgs", told)[1]) > 10
    assert re.search(r"/map +1 msg", told)


@pytest.mark.sweep
def test_killed_programs_and_masters_are_noticed_and_connect_again(ros1, tmp_path):
    trial = load_trial("frontal", duration=300.0)
    with RosMaster(tmp_path) as master, Running(trial, [Ros1Node(master.url)], out=tmp_path / "out") as running:
        inbox = running.run.port.inbox
        for kill_master in (False, True):
            first, before = master.open("ros1_robot.py", "60"), inbox.count.received
            assert first.stdout.readline() == "ready\n"
            wait(lambda before=before: inbox.count.received > before + 10)
            first.kill()
            first.communicate()
            if kill_master:
                master.end()
                master.begin()
                wait(lambda: "/crowdbot/pause" in (master.state() or [0, 0, {}])[2])
                assert "/robot/scan" in master.state()[0]
            settled = inbox.count.received
            time.sleep(1.0)
            assert inbox.count.received == settled
        again, before = master.open("ros1_robot.py", "60"), inbox.count.received
        assert again.stdout.readline() == "ready\n"
        wait(lambda: inbox.count.received > before + 10)
        again.kill()
        again.communicate()
        time.sleep(1.7)
    episode = read_episode(tmp_path / "out" / "episode.mcap")
    times = sorted(seconds for seconds, _ in episode.orders)
    speed = abs(episode.velocity[:, episode.robots[0]]).max(axis=-1)
    gaps = [a for a, b in zip(times, [*times[1:], episode.times[-1]], strict=True) if b - a > 1.0]
    assert len(gaps) == 3
    for stop in gaps:
        quiet = (episode.times > stop + 1.0) & (episode.times < stop + 1.6)
        assert speed[quiet].max() < 1e-6  # after 0.5 s of silence, and braking
    assert speed.max() > 0.3
    assert replay(tmp_path / "out" / "episode.mcap").equal


@pytest.mark.live
def test_another_trial_changes_the_topics(master):
    node, driver = Ros1Node(master.url), MemoryTransport([])
    with Running(load_trial("frontal", duration=1.0), [node, driver], "step"):
        assert "/robot/scan" in master.state()[0]
        answer = driver.call("load_world", {"world_resource": {"uri": "circle-crossing"}})
        assert answer["result"]["result"] == 1
        names = {output.name for output in driver.interfaces[-1].outputs}
        wait(lambda: {item for item, nodes in master.state()[0].items() if "/crowdbot" in nodes} == names | {"/rosout"})
        assert not node.wants("/robot/")


@pytest.mark.live
def test_hostile_connections_leave_the_node_working(master, capfd):
    rng = random.Random(3)
    node, driver = Ros1Node(master.url), MemoryTransport([])
    with Running(load_trial("frontal", duration=1.0), [node, driver], "step"):
        api = master.call("lookupNode", "/crowdbot")
        port = node._session._port
        frame = pack_header({"callerid": "/x", "topic": "/robot/scan", "type": "*", "md5sum": "*"})
        call = pack_header({"callerid": "/x", "service": "/crowdbot/pause", "md5sum": "*"}) + struct.pack("<I", 0)
        for _ in range(300):
            data = bytearray(rng.choice([frame, call, b"\xff" * 40]))
            for _ in range(rng.randint(0, 4)):
                data[rng.randrange(len(data))] = rng.randrange(256)
            with socket.create_connection(("127.0.0.1", port)) as hostile:
                hostile.sendall(data)
        for body in (b"", b"<x>", b"\x00" * 1000, b"<methodCall><methodName>publisherUpdate</methodName></methodCall>"):
            request = urllib.request.Request(api, data=body or b" ", headers={"Content-Type": "text/xml"})
            with urllib.request.urlopen(request, timeout=5) as response:
                assert b"methodResponse" in response.read()
        page = {"Content-Type": "text/plain", "Origin": "http://evil.example"}  # what a browser lets any page send
        for origin in ("http://evil.example", "null"):
            body = xmlrpc.client.dumps(("/x", "by a page"), "shutdown").encode()
            request = urllib.request.Request(api, data=body, headers=page | {"Origin": origin})
            with pytest.raises(urllib.error.HTTPError, match="403"):
                urllib.request.urlopen(request, timeout=5)
        wrong = pack_header({"callerid": "/x", "topic": "/robot/scan", "type": "std_msgs/String", "md5sum": "0"})
        with socket.create_connection(("127.0.0.1", port)) as other:
            other.sendall(wrong)
            assert b"error=/robot/scan is sensor_msgs/LaserScan" in other.recv(4096)
        wait(lambda: not node.wants("/robot/scan"))
        assert driver.call("step_simulation", {"steps": 20})["result"]["result"] == 1
    assert "Traceback" not in capfd.readouterr().err


@pytest.mark.live
def test_addresses_and_masters_that_are_not_there(monkeypatch):
    monkeypatch.setenv("ROS_MASTER_URI", "http://127.0.0.1:1")
    assert open_transport("ros1").master == "http://127.0.0.1:1"
    assert open_transport("ros1", {"host": "10.0.0.3"}).host == "10.0.0.3"
    with pytest.raises(InputError, match="ros1:seven must be ros1 or ros1:http://HOST:PORT, such as ros1:http://loc"):
        open_transport("ros1:seven")
    with pytest.raises(InputError, match="ros1 cannot start a node: http://127.0.0.1:1 does not answer"):
        run_bridge(TRIAL, [open_transport("ros1")])
    with pytest.raises(InputError, match=r"a field of a TCPROS header must be name=value"):
        unpack_header(struct.pack("<I", 3) + b"abc")
    with pytest.raises(InputError, match="ends within a field"):
        unpack_header(b"abc")


def test_the_file_for_rviz_shows_topics_that_exist():
    trial = load_trial("circle-crossing")
    text = files("crowdbot").joinpath("assets", "bridges", "crowdbot.rviz").read_text()
    interface = RobotInterface.of(trial)
    topics = {output.name for output in (*interface.outputs, *interface.inputs)}
    shown = set(re.findall(r"Topic: (/\S+)", text))
    assert {"/map", "/robot/scan", "/robot/odom", "/crowd/markers", "/robot/goal_pose"} == shown <= topics
    prefix = re.search(r"TF Prefix: (\S+)", text)[1]
    assert prefix == trial.robots[0].name


@pytest.mark.sweep
def test_the_page_runs(master, tmp_path):
    page = (Path(__file__).parents[2] / "docs" / "how-to" / "ros1.md").read_text(encoding="utf-8")
    (tmp_path / "drive.py").write_text(re.search(r'title="drive.py"\n(.*?)```', page, re.S)[1])
    words = re.search(r"^crowdbot (run .*--bridge ros1 .*)$", page, re.M)[1].split()
    environment = {**os.environ, "ROS_MASTER_URI": master.url, "ROS_IP": "127.0.0.1"}
    command = [sys.executable, "-m", "crowdbot", *words, "--set", "duration=8"]
    simulation = subprocess.Popen(command, cwd=tmp_path, env=environment, stdout=subprocess.DEVNULL)
    driver = master.open(str(tmp_path / "drive.py"))
    assert simulation.wait(120) == 0
    _, errors = driver.communicate(timeout=30)
    assert driver.returncode == 0, errors
    assert len(read_episode(tmp_path / "driven" / "episode.mcap").orders) > 20
    assert replay(tmp_path / "driven" / "episode.mcap").equal

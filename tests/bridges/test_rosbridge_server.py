"""The rosbridge server and client with real other parties in processes of their own."""

import asyncio
import contextlib
import gc
import json
import socket
import subprocess
import sys
import threading
import warnings
from pathlib import Path

import aiohttp
import pytest
from bridge_runs import MemoryTransport, Running, serve, wait

from crowdbot.bridges import BridgeClock, Inbox, RobotInterface, open_transport, run_bridge
from crowdbot.bridges.rosbridge.client import RosbridgeClient
from crowdbot.bridges.rosbridge.server import RosbridgeServer
from crowdbot.core import InputError
from crowdbot.recording import read_episode, replay
from crowdbot.trials import load_trial

CLIENT = Path(__file__).with_name("roslibpy_client.py")
QUIT = {"state": {"state": 3}}


def start_client(port, job, number=0):
    """Start roslibpy in another process."""
    return subprocess.Popen([sys.executable, CLIENT, str(port), job, str(number)], stdout=subprocess.PIPE, text=True)


def answer_of(process, timeout=90):
    out, _ = process.communicate(timeout=timeout)
    assert process.returncode == 0
    return json.loads(out)


@pytest.fixture(scope="module")
def trial():
    return load_trial("frontal", duration=60.0)


@pytest.mark.live
def test_roslibpy_sees_topics_services_and_entities(trial):
    running, server = serve(trial)
    with running:
        found = answer_of(start_client(server.port, "look"))
    assert {"/robot/scan", "/robot/cmd_vel", "/tf", "/map", "/people"} <= {*found["topics"]}
    assert found["type"] == "sensor_msgs/msg/LaserScan"
    assert "/crowdbot/step_simulation" in found["services"]
    assert found["service_type"] == "simulation_interfaces/srv/StepSimulation"
    assert "/crowdbot" in found["nodes"]
    assert found["details"] == ["geometry_msgs/msg/Twist", "geometry_msgs/msg/Vector3"]
    assert found["time"] >= 0.0
    assert 31 in found["features"]
    assert found["x"] == trial.robots[0].x


def control_loop(trial, count, out):
    """Let roslibpy answer ``count`` steps in real time; return the run, its summary, and the counts of the client."""
    running, server = serve(trial, out=out)
    with running:
        counts = answer_of(start_client(server.port, "control", count), 90 + count / 8)
        received = running.run.port.inbox.count.received
        assert server.sessions == []
    return running, received, counts


@pytest.mark.live
def test_a_control_loop_of_roslibpy_loses_no_command(trial, tmp_path):
    running, received, counts = control_loop(trial, 100, tmp_path)
    assert (counts["sent"], received) == (100, 100)
    assert counts["rays"] == 360
    assert counts["scans"] >= 0.4 * 100
    assert counts["maps"] == 1
    latency = running.run.port.inbox.latency.summary()
    assert 1 <= latency.commands <= 100  # commands of one step count once; `crowdbot bench bridges` measures the time
    assert "ms (median)" in running.notes[-1]
    assert replay(tmp_path / "episode.mcap").equal


def speeds(memory):
    rows = [item.message for item in list(memory.sent) if item.topic == "/robot/ground_truth/odom"]
    return [row.twist.twist.linear.x for row in rows]


@pytest.mark.parametrize("kills", [pytest.param(3, marks=pytest.mark.sweep), pytest.param(20, marks=pytest.mark.soak)])
def test_a_killed_client_leaves_a_robot_that_stops_and_a_whole_recording(trial, kills, tmp_path):
    memory = MemoryTransport(topics=("/robot/ground_truth/odom",))
    server = RosbridgeServer(port=0)
    with Running(trial, [server, memory], rate=2.0, out=tmp_path) as running:
        for _ in range(kills):
            client, before = start_client(server.port, "control", 100_000), running.run.port.inbox.count.received
            wait(lambda before=before: running.run.port.inbox.count.received > before + 5)
            client.kill()
            client.communicate()
            wait(lambda: not server.sessions and speeds(memory)[-1] == 0.0)
    assert max(speeds(memory)) > 0.1
    assert read_episode(tmp_path / "episode.mcap").metadata["outcome"] == "interrupted"
    assert replay(tmp_path / "episode.mcap").equal


@pytest.mark.live
def test_the_client_role_joins_a_server_and_comes_back_after_its_death():
    interface = RobotInterface.of(load_trial("frontal"))
    empty = RobotInterface(interface.trial, (), (), ())
    server = RosbridgeServer(port=0)
    server.start(empty, Inbox(empty))
    joined = RosbridgeClient(f"ws://127.0.0.1:{server.port}")
    with Running(load_trial("frontal", duration=120.0), [joined], rate=1.0) as running:
        found = answer_of(start_client(server.port, "control", 20))
        assert (found["sent"], found["rays"], found["maps"]) == (20, 360, 1)
        wait(lambda: running.run.port.inbox.count.received >= 20)  # the server may still pass some on
        assert running.run.port.inbox.count.received == 20
        server.stop()
        again = RosbridgeServer(port=server.port)
        again.start(empty, Inbox(empty))
        found = answer_of(start_client(again.port, "look"))  # it waits for the services
        assert joined.connections == 2
        assert found["x"] > -4.5
        again.stop()


async def publish(port, topic, messages):
    """Publish messages all at once."""
    async with aiohttp.ClientSession() as http, http.ws_connect(f"http://127.0.0.1:{port}/") as socket:
        for message in messages:
            await socket.send_json({"op": "publish", "topic": topic, "msg": message})
        await socket.send_str('{"op": "call_service", "service": "/rosapi/get_time", "id": "1"}')
        await socket.receive(timeout=20)


@pytest.mark.live
def test_the_client_role_gets_every_command_of_a_burst():
    interface = RobotInterface.of(load_trial("frontal"))
    server = RosbridgeServer(port=0)
    server.start(empty := RobotInterface(interface.trial, (), (), ()), Inbox(empty))
    joined = RosbridgeClient(f"ws://127.0.0.1:{server.port}")
    with Running(load_trial("frontal", duration=120.0), [joined], rate=1.0) as running:
        assert answer_of(start_client(server.port, "control", 1))["sent"] == 1  # it waits until this one is subscribed
        asyncio.run(publish(server.port, "/robot/cmd_vel", [{"linear": {"x": 0.01 * k}} for k in range(10)]))
        wait(lambda: running.run.port.inbox.count.received >= 11)
        server.stop()


@pytest.mark.live
def test_a_client_needs_a_server():
    with pytest.raises(InputError, match="cannot join ws://127.0.0.1:9"):
        run_bridge(load_trial("frontal", duration=1.0), [RosbridgeClient("ws://127.0.0.1:9")])
    with pytest.raises(InputError, match="is no WebSocket address"):
        open_transport("rosbridge-client:127.0.0.1:9090")


async def connect(port, **options):
    """Return the status of a connection: 101 if it is accepted."""
    async with aiohttp.ClientSession() as http:
        try:
            async with http.ws_connect(f"http://127.0.0.1:{port}/", **options) as socket:
                await socket.send_str('{"op": "call_service", "service": "/rosapi/get_time", "id": "1"}')
                return json.loads((await socket.receive(timeout=20)).data)["op"]
        except aiohttp.WSServerHandshakeError as error:
            return error.status


@pytest.mark.live
def test_who_may_connect():
    interface = RobotInterface.of(load_trial("frontal"))
    with pytest.raises(InputError, match="is open to everybody"):
        RosbridgeServer(host="0.0.0.0")
    server = RosbridgeServer(port=0)
    server.start(interface, Inbox(interface))
    answers = [
        asyncio.run(connect(server.port, **options)) for options in ({}, {"origin": f"http://127.0.0.1:{server.port}"})
    ]
    refused = [
        asyncio.run(connect(server.port, origin=origin))
        for origin in ("https://evil.example", "null", "", "file://", "http://[", "http://localhost:8080")
    ]
    with pytest.raises(InputError, match="rosbridge cannot listen on 127.0.0.1"):
        RosbridgeServer(port=server.port).start(interface, Inbox(interface))
    server.stop()
    assert answers == ["service_response"] * 2
    assert refused == [403] * 6
    server = RosbridgeServer(port=0, host="0.0.0.0", token="abc")
    server.start(interface, Inbox(interface))
    bearer = {"headers": {"Authorization": "Bearer abc"}}
    answers = [asyncio.run(connect(server.port, **options)) for options in ({}, {"params": {"token": "abd"}})]
    answers += [asyncio.run(connect(server.port, **options)) for options in (bearer, {"params": {"token": "abc"}})]
    server.stop()
    assert answers == [403, 403, "service_response", "service_response"]


@pytest.mark.live
def test_a_client_that_does_not_read_holds_nobody_up():
    trial = load_trial("frontal", duration=20.0)
    server = RosbridgeServer(port=0)

    async def sleep_forever():
        async with aiohttp.ClientSession() as http, http.ws_connect(f"http://127.0.0.1:{server.port}/") as socket:
            for topic in ("/robot/scan", "/robot/scan/reading", "/tf", "/people"):
                await socket.send_str(json.dumps({"op": "subscribe", "topic": topic}))
            await socket.send_str("\x00" * 1000)
            await socket.send_bytes(b"\xff" * 1000)
            while not done.is_set():
                await asyncio.sleep(0.05)

    done = threading.Event()
    with Running(trial, [server], "step") as running:
        thread = threading.Thread(target=asyncio.run, args=(sleep_forever(),))
        thread.start()
        wait(lambda: server.sessions and len(server.sessions[0].subscriptions) == 4)
        running.run.control.state = 1
        running.run.clock = BridgeClock("free")
        running.run.port.inbox.wake()
        waiting = [
            len(subscription._waiting) for session in server.sessions for subscription in session.subscriptions.values()
        ]
        summary = running.end(90.0)
        done.set()
        thread.join(20.0)
    assert summary.steps == 400
    assert max(waiting) <= 1


@pytest.mark.live
def test_a_frame_that_is_too_large_ends_only_its_own_connection():
    interface = RobotInterface.of(load_trial("frontal"))
    server = RosbridgeServer(port=0)
    server.start(interface, Inbox(interface))

    async def flood():
        async with aiohttp.ClientSession() as http, http.ws_connect(f"http://127.0.0.1:{server.port}/") as socket:
            await socket.send_str("[" * ((4 << 20) - 1))
            first = (await socket.receive(timeout=20)).json()["op"]
            await socket.send_str("[" * (5 << 20))
            last = await socket.receive(timeout=20)
            return first, last.type, socket.close_code, last.extra

    seen = ("status", aiohttp.WSMsgType.CLOSE, 1009, "a frame may have at most 4 MiB")
    assert asyncio.run(flood()) == seen
    assert asyncio.run(connect(server.port)) == "service_response"
    server.stop()


@pytest.mark.live
@pytest.mark.parametrize("turns", range(6))
def test_a_connection_that_comes_while_a_server_stops_is_closed(turns):
    interface, clients = RobotInterface.of(load_trial("frontal")), []
    server = RosbridgeServer(port=0)
    server.start(interface, Inbox(interface))

    def end(rest):
        """End the server after some turns of its loop, while it accepts."""
        loop = asyncio.get_running_loop()
        loop.call_soon(end, rest - 1) if rest else server._server._end.set()

    def connect():
        clients.append(socket.create_connection(("127.0.0.1", server.port)))
        end(turns)

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        server._server.call(connect)
        wait(lambda: clients)
        server.stop()
        gc.collect()
    with clients[0] as client, contextlib.suppress(ConnectionResetError):  # never accepted
        client.settimeout(60.0)
        assert client.recv(1) == b""
    assert [str(item.message) for item in caught] == []

"""The Foxglove server, with a client of its own protocol over a real socket."""

from __future__ import annotations

import contextlib
import json
import random
import socket
import struct
import time
from importlib.resources import files

import pytest
from bridge_runs import Running, endless_trial
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from crowdbot.bridges import BridgeClock, Inbox, RobotInterface, interface_store, message_of, open_transport, run_bridge
from crowdbot.bridges.foxglove import FoxgloveServer, foxglove_layout
from crowdbot.core import InputError
from crowdbot.data import McapReader
from crowdbot.messages import Messages
from crowdbot.recording import read_episode, replay
from crowdbot.trials import load_trial

pytestmark = pytest.mark.live

TRIAL = load_trial("frontal", duration=2.0)
SHORT = load_trial("frontal", duration=1.0)
LONG = load_trial("frontal", **{"duration": 86400.0, "end/goal": "false", "end/collision": "false"})


class Client:
    """A client of the protocol foxglove.sdk.v1."""

    def __init__(self, ws):
        self.ws, self.channels, self.services, self.info = ws, {}, {}, None
        self.messages, self.times, self.statuses, self.responses, self.states = [], [], [], {}, []
        self._topics, self.played = {}, []

    def read(self, reached, seconds=60.0):
        """Take what arrives until something is reached."""
        end = time.monotonic() + seconds
        while not reached():
            if time.monotonic() > end:
                pytest.fail("it is not reached in time")
            with contextlib.suppress(TimeoutError):
                self._take(self.ws.recv(timeout=0.1))

    def _take(self, data):
        if isinstance(data, bytes):
            self._take_bytes(data)
            return
        message = json.loads(data)
        if message["op"] == "serverInfo":
            self.info = message
        elif message["op"] == "advertise":
            self.channels |= {item["topic"]: item for item in message["channels"]}
        elif message["op"] == "unadvertise":
            gone = message["channelIds"]
            self.channels = {topic: channel for topic, channel in self.channels.items() if channel["id"] not in gone}
        elif message["op"] == "advertiseServices":
            self.services |= {item["name"]: item for item in message["services"]}
        elif message["op"] == "status":
            self.statuses.append(message["message"])
        elif message["op"] == "serviceCallFailure":
            self.responses[message["callId"]] = message["message"]

    def _take_bytes(self, data):
        if data[0] == 1:
            number, nanoseconds = struct.unpack_from("<IQ", data, 1)
            self.messages.append((self._topics[number], nanoseconds, data[13:]))
        elif data[0] == 2:
            self.times.append(struct.unpack_from("<Q", data, 1)[0])
        elif data[0] == 3:
            _, call, size = struct.unpack_from("<III", data, 1)
            self.responses[call] = data[13 + size :]
        elif data[0] == 5:
            self.states.append(data[1])
            self.played.append(struct.unpack_from("<QfB", data, 2))

    def subscribe(self, *topics):
        numbers = {len(self._topics) + k + 1: topic for k, topic in enumerate(topics)}
        self._topics |= numbers
        rows = [{"id": number, "channelId": self.channels[topic]["id"]} for number, topic in numbers.items()]
        self.ws.send(json.dumps({"op": "subscribe", "subscriptions": rows}))

    def advertise(self, number, topic, kind, encoding="json"):
        row = {"id": number, "topic": topic, "encoding": encoding, "schemaName": kind}
        self.ws.send(json.dumps({"op": "advertise", "channels": [row]}))

    def publish(self, number, data):
        self.ws.send(struct.pack("<BI", 1, number) + data)

    def call(self, name, payload=None, encoding="cdr", **fields):
        """Call a service with fields, or with bytes, and return the response, or the text of the failure."""
        service = self.services[f"/crowdbot/{name}"]
        kind = service["request"]["schemaName"]
        if payload is None:
            payload = bytes(interface_store().serialize_cdr(message_of(fields, kind), kind))
        number = len(self.responses) + 1
        head = struct.pack("<BIII", 2, service["id"], number, len(encoding))
        self.ws.send(head + encoding.encode() + payload)
        self.read(lambda: number in self.responses)
        result = self.responses[number]
        if isinstance(result, str):
            return result
        return interface_store().deserialize_cdr(result, service["response"]["schemaName"])

    def playback(self, command, speed=1.0, seek=None):
        self.ws.send(struct.pack("<BBfBQI", 3, command, speed, seek is not None, seek or 0, 2) + b"r1")


@contextlib.contextmanager
def joined(server):
    with connect(f"ws://127.0.0.1:{server.port}", subprotocols=["foxglove.sdk.v1"], close_timeout=0.2) as ws:
        client = Client(ws)
        client.read(lambda: client.info and client.channels and client.services)
        yield client


def names(reader):
    return [(message.topic.topic, message.stamp, bytes(message.data)) for message in reader.messages()]


def test_clients_offer_the_subprotocol_of_the_app_or_of_its_predecessor():
    server = FoxgloveServer(port=0)
    interface = RobotInterface.of(TRIAL)
    server.start(interface, Inbox(interface))
    address = f"ws://127.0.0.1:{server.port}"
    for offered in ("foxglove.sdk.v1", "foxglove.websocket.v1"):
        with connect(address, subprotocols=["other", offered], close_timeout=0.2) as ws:
            assert ws.subprotocol == offered
            assert json.loads(ws.recv(timeout=20.0))["op"] == "serverInfo"
    with connect(address, close_timeout=0.2) as ws, pytest.raises(ConnectionClosed) as refused:
        ws.recv(timeout=20.0)
    assert refused.value.rcvd.reason == "offer foxglove.sdk.v1 or foxglove.websocket.v1"
    server.stop()


def test_channels_are_the_topics_of_the_trial_and_messages_those_of_the_recorder(tmp_path):
    server = FoxgloveServer(port=0)
    with Running(TRIAL, [server], "step", out=tmp_path) as running, joined(server) as client:
        interface = running.run.port.interface
        assert set(client.channels) == {output.name for output in interface.outputs}
        scan = client.channels["/robot/scan"]
        assert (scan["encoding"], scan["schemaName"]) == ("cdr", "sensor_msgs/msg/LaserScan")
        assert (scan["schemaEncoding"], scan["schema"]) == ("ros2msg", Messages().definition(scan["schemaName"]))
        assert client.info["capabilities"] == ["clientPublish", "services", "time", "playbackControl"]
        client.subscribe("/robot/scan", "/tf", "/map", "/tf_static", "/people")
        client.read(lambda: {"/map", "/tf_static"} <= {topic for topic, _, _ in client.messages})
        ticks = 0
        for steps in (3, 1, 16, 7, 13):  # odd portions
            client.call("step_simulation", steps=steps)
            ticks += steps
            newest = ticks // 2 * 10**8  # a scan every second step of 0.05 s
            client.read(lambda newest=newest: ("/robot/scan", newest) in {row[:2] for row in client.messages})
        done = running.end()
    free = run_bridge(TRIAL, [], 0, tmp_path / "free", BridgeClock("free"))
    assert done.digest == free.digest
    with (tmp_path / "episode.mcap").open("rb") as stream:
        recorded = {name[:2]: name[2] for name in names(McapReader(stream))}
    both = [(data, recorded[topic, stamp]) for topic, stamp, data in client.messages if (topic, stamp) in recorded]
    scans = [stamp for topic, stamp, _ in client.messages if topic == "/robot/scan"]
    assert scans == sorted(set(scans))  # the newest of a burst, and none twice
    assert len(both) > 15  # at least the newest scan, transforms and people of each portion
    assert all(sent == written for sent, written in both)


def test_a_client_drives_the_robot_by_json_and_cdr_and_the_episode_replays(tmp_path):
    server, make = FoxgloveServer(port=0), Messages()
    with Running(TRIAL, [server], "step", out=tmp_path) as running, joined(server) as client:
        inbox = running.run.port.inbox
        client.advertise(1, "/robot/cmd_vel", "geometry_msgs/Twist")
        client.advertise(2, "/robot/cmd_vel", "geometry_msgs/msg/Twist", "cdr")
        for k in range(20):
            json_form = k % 2 == 0
            twist = {"linear": {"x": 0.4}, "angular": {"z": 0.1}}
            cdr = make.encode_message(make.twist(0.4, 0.1, 0.0))
            client.publish(1 if json_form else 2, json.dumps(twist).encode() if json_form else cdr)
            count = k + 1
            client.read(lambda count=count: inbox.count.received == count)
            client.call("step_simulation", steps=2)
        done = running.end()
    orders = [order for _, order in read_episode(tmp_path / "episode.mcap").orders]
    assert len(orders) == 20
    assert {(order.forward, order.turn, order.source) for order in orders} == {(0.4, 0.1, "foxglove")}
    assert done.metrics["path_length"] > 0.4
    assert replay(tmp_path / "episode.mcap").equal


def test_services_answer_and_errors_are_those_of_the_protocol():
    server = FoxgloveServer(port=0)
    with Running(SHORT, [server], "step"), joined(server) as client:
        assert "robot" in client.call("get_entities").entities
        state = client.call("get_entity_state", entity="robot").state
        assert state.header.frame_id == "map"
        assert client.call("get_entity_state", entity="nobody").result.result != 1
        assert "no CDR of simulation_interfaces/msg/StepSimulation_Request" in client.call("step_simulation", b"\0\1")
        assert client.call("get_entities", b"{", "xml") == "encoding 'xml' is not supported; use json or cdr"


def test_a_client_pauses_and_plays():
    server = FoxgloveServer(port=0)
    with Running(load_trial("frontal", duration=60.0), [server]) as running, joined(server) as client:
        client.read(lambda: len(client.times) > 3)
        client.playback(1)
        client.read(lambda: client.states == [1] and not running.run.control.may_step)
        client.read(lambda: True)
        tick = client.times[-1]
        client.playback(0)
        client.read(lambda: client.states == [1, 0] and client.times[-1] > tick)
        assert running.run.control.may_step


def test_a_client_sets_the_speed_and_goes_to_a_time():
    server = FoxgloveServer(port=0)
    with Running(endless_trial(600.0), [server], rate=0.1) as running, joined(server) as client:
        client.read(lambda: len(client.times) > 1)
        client.playback(0, speed=20.0)
        client.read(lambda: client.played and client.times[-1] > 10**9)
        assert client.played[0][1:] == (20.0, 0)
        client.playback(0, speed=0.01)
        client.read(lambda: running.run.pace.rate == pytest.approx(0.01))
        later = server.now + 2 * 10**9
        client.playback(0, speed=0.01, seek=later)  # it hurries
        client.read(lambda: client.times[-1] >= later)
        assert client.played[-1][::2] == (later, 1)
        client.playback(1, speed=0.01, seek=later + 10**9)  # while it pauses: steps
        client.read(lambda: client.times[-1] == later + 10**9)
        client.playback(1, speed=0.01, seek=5 * 10**8)
        client.playback(1, speed=200.0)
        client.read(lambda: len(client.statuses) >= 2)
        assert (
            f"a live run cannot go back from {later / 1e9 + 1:g} s to 0.5 s; it can begin again, at 0 s"
            in client.statuses[0]
        )
        assert "the speed 200 must be from 0.001 to 100 times real time" in client.statuses[1]
        assert client.played[-1][2] == 0
        client.playback(1, speed=0.01, seek=0)
        client.read(lambda: client.times[-1] == 0)


def test_a_run_that_follows_another_clock_has_no_speed():
    server = FoxgloveServer(port=0)
    with Running(SHORT, [server], "step"), joined(server) as client:
        client.playback(1, speed=2.0)
        client.read(lambda: client.statuses)
        assert "the speed cannot be set: the time of this run is that of another clock" in client.statuses[0]


def test_wrong_messages_are_told_and_the_run_goes_on():
    server = FoxgloveServer(port=0)
    with Running(SHORT, [server], "step"), joined(server) as client:
        client.advertise(1, "/robot/cmd_vel", "geometry_msgs/Twist")
        client.advertise(2, "/robot/cmd_val", "geometry_msgs/Twist")
        client.publish(1, b'{"linear": {"x": "fast"}}')
        client.publish(2, b"{}")
        client.publish(9, b"{}")
        client.read(lambda: len(client.statuses) >= 2)
        assert "linear" in client.statuses[0]
        assert "'/robot/cmd_val' is not an input, did you mean '/robot/cmd_vel'" in client.statuses[1]
        assert client.call("get_simulation_state").result.result == 1


def test_hostile_frames_leave_the_server_working(capfd):
    rng = random.Random(2)
    server = FoxgloveServer(port=0)
    good = [
        json.dumps({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 1}]}).encode(),
        json.dumps(
            {"op": "advertise", "channels": [{"id": 1, "topic": "/robot/cmd_vel", "encoding": "json"}]}
        ).encode(),
        struct.pack("<BI", 1, 1) + b'{"linear": {"x": 1}}',
        struct.pack("<BIII", 2, 1, 1, 4) + b"json{}",
        struct.pack("<BBfBQI", 3, 1, 1.0, 0, 0, 2) + b"r1",
    ]
    with Running(LONG, [server], "step") as running:  # a frame that means "play" does not end the run
        frames = 0
        while frames < 3000:
            with contextlib.suppress(ConnectionClosed), joined(server) as client:
                for _ in range(300):
                    frames += 1
                    data = bytearray(rng.choice(good))
                    for _ in range(rng.randint(0, 5)):
                        data[rng.randrange(len(data))] = rng.randrange(256)
                    text = rng.random() < 0.5
                    client.ws.send(bytes(data).decode("latin-1") if text else bytes(data))
        with joined(server) as client:
            assert client.call("get_simulation_state").result.result == 1
        assert running.thread.is_alive()
    assert "Traceback" not in capfd.readouterr().err


def test_clients_come_and_go_and_topics_without_subscribers_are_not_converted():
    server = FoxgloveServer(port=0)
    with Running(SHORT, [server], "step"):
        for k in range(20):
            with joined(server) as client:
                client.subscribe("/robot/scan")
                if k % 2:
                    client.ws.socket.close()  # killed: no closing handshake
                else:
                    client.read(lambda: server.wants("/robot/scan"))
        end = time.monotonic() + 10.0
        while server.wants("/robot/scan"):
            if time.monotonic() > end:
                pytest.fail("it is not reached in time")
            time.sleep(0.01)
        assert not server.wants("/robot/")
        assert server.wants("/clock")


def test_another_trial_brings_its_channels():
    server = FoxgloveServer(port=0)
    with Running(SHORT, [server], "step"), joined(server) as client:
        assert "/robot/scan" in client.channels
        session = client.info["sessionId"]
        answer = client.call("load_world", world_resource={"uri": "circle-crossing"})
        assert answer.result.result == 1, answer
        client.read(lambda: client.info["sessionId"] != session)
        wanted = {output.name for output in RobotInterface.of(load_trial("circle-crossing")).outputs}
        client.read(lambda: set(client.channels) == wanted)


def test_only_allowed_topics_are_offered():
    server = FoxgloveServer(port=0, topics=["/robot/*", "/crowdbot/get_*"])
    with Running(SHORT, [server], "step"), joined(server) as client:
        assert all(channel.startswith("/robot/") for channel in client.channels)
        assert "/crowdbot/step_simulation" not in client.services
        client.advertise(1, "/crowdbot/order", "std_msgs/String")
        client.publish(1, b"{}")
        client.playback(1)
        client.read(lambda: len(client.statuses) >= 2)
    assert "'/crowdbot/order' is not among the topics" in client.statuses[0]
    assert "'/crowdbot/set_simulation_state' is not among the services" in client.statuses[1]


def test_addresses_and_ports():
    assert open_transport("foxglove:9123").port == 9123
    with pytest.raises(InputError, match="foxglove:ws must be foxglove or foxglove:PORT, such as foxglove:8765"):
        open_transport("foxglove:ws")
    with pytest.raises(InputError, match="port 70000 must be from 0 to 65535"):
        FoxgloveServer(port=70000)
    with pytest.raises(InputError, match=r"a server on 0\.0\.0\.0 is open to everybody; give a token"):
        FoxgloveServer(host="0.0.0.0")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(InputError, match=rf"foxglove cannot listen on 127\.0\.0\.1:{port}"):
            run_bridge(SHORT, [FoxgloveServer(port=port)])


def test_the_layout_that_ships_shows_topics_that_exist():
    trial = load_trial("frontal")
    layout = json.loads(files("crowdbot").joinpath("assets", "bridges", "foxglove-layout.json").read_text())
    assert layout == foxglove_layout(trial)
    interface = RobotInterface.of(trial)
    outputs, inputs = ({row.name for row in rows} for rows in (interface.outputs, interface.inputs))
    panels = layout["configById"]
    assert set(panels["3D!scene"]["topics"]) <= outputs
    assert panels["3D!scene"]["layers"]["urdf"]["topic"] in outputs
    assert {panels["Teleop!drive"]["topic"], panels["3D!scene"]["publish"]["poseTopic"]} <= inputs
    assert {path["value"].split(".")[0] for path in panels["Plot!speed"]["paths"]} <= outputs
    camera = foxglove_layout(load_trial("crossing-flows"))
    assert set(_leaves(camera["layout"])) == set(camera["configById"])


def _leaves(node):
    return [node] if isinstance(node, str) else _leaves(node["first"]) + _leaves(node["second"])

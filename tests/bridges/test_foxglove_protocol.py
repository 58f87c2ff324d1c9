"""The Foxglove protocol without a network: channels, queues, commands, services, hostile input."""

import json
import random
import struct

import pytest

from crowdbot.bridges import Inbox, RobotInterface, interface_store
from crowdbot.bridges.foxglove.session import FoxgloveGraph, FoxgloveSession, decode_fields
from crowdbot.core import InputError
from crowdbot.messages import Messages
from crowdbot.recording import StepMessage
from crowdbot.trials import load_trial

MAKE, TRIAL = Messages(), load_trial("frontal")


@pytest.fixture
def graph():
    interface = RobotInterface.of(TRIAL)
    return FoxgloveGraph(interface, Inbox(interface), lambda function, *values: function(*values))


@pytest.fixture
def session(graph):
    session = FoxgloveSession(graph, lambda: None)
    assert [text["op"] for text in texts(session)] == ["serverInfo", "advertise", "advertiseServices"]
    return session


def texts(session):
    return [json.loads(item) for item in session.take()[0] if isinstance(item, str)]


def send(session, op, **fields):
    session.handle(json.dumps({"op": op} | fields))


def subscribe(session, number, topic):
    send(session, "subscribe", subscriptions=[{"id": number, "channelId": session.graph.channels[topic][0]}])


def message(topic, nanoseconds):
    return StepMessage(topic, "std_msgs/msg/String", nanoseconds, MAKE, bytes([nanoseconds]))


def test_a_slow_client_gets_the_newest_message_all_events_and_latched_ones_late(graph, session):
    graph.deliver([message("/map", 1)])
    for k, topic in enumerate(("/robot/scan", "/crowdbot/orders", "/map"), 1):
        subscribe(session, k, topic)
    for k in range(2, 5):
        graph.deliver([message("/robot/scan", k), message("/crowdbot/orders", k), message("/people", k)])
    frames, _ = session.take()
    assert [(struct.unpack_from("<BIQ", frame), frame[13:]) for frame in frames] == [
        ((1, 1, 4), b"\4"), ((1, 2, 2), b"\2"), ((1, 2, 3), b"\3"), ((1, 2, 4), b"\4"), ((1, 3, 1), b"\1"),
    ]  # fmt: skip
    assert graph.wanted == {"/robot/scan", "/crowdbot/orders", "/map"}
    send(session, "unsubscribe", subscriptionIds=[1])
    graph.deliver([message("/robot/scan", 9)])
    assert session.take() == ([], None)


def test_commands_services_and_the_clock(graph, session):
    row = {"id": 3, "topic": "/robot/cmd_vel", "encoding": "json", "schemaName": "geometry_msgs/Twist"}
    send(session, "advertise", channels=[row])
    assert "/clock" in graph.wanted
    session.handle(struct.pack("<BI", 1, 3) + b'{"linear": {"x": 0.5}}')
    assert [order.forward for order in graph.inbox.take_orders()] == [0.5]
    graph.deliver([message("/clock", 7)])
    assert session.take()[0] == [struct.pack("<BQ", 2, 7)]
    service = next(k for k, name in graph.services.items() if name == "get_simulation_state")
    session.handle(struct.pack("<BIII", 2, service, 9, 4) + b"json{}")
    (call,) = graph.inbox.take_calls()
    call.answer({"state": {"state": 1}, "result": {"result": 1}})
    (answer,) = session.take()[0]
    assert struct.unpack_from("<BIII3s", answer) == (3, service, 9, 3, b"cdr")
    kind = "simulation_interfaces/msg/GetSimulationState_Response"
    assert interface_store().deserialize_cdr(answer[16:], kind).state.state == 1
    session.handle(struct.pack("<BIII", 2, service, 9, 3) + b"xml")
    assert "encoding 'xml' is not supported" in texts(session)[0]["message"]


def test_a_client_sees_and_uses_what_is_allowed_only():
    interface = RobotInterface.of(TRIAL)
    graph = FoxgloveGraph(interface, Inbox(interface), print, ["/robot/scan", "/crowdbot/get_*"])
    session = FoxgloveSession(graph, lambda: None)
    _, channels, services = texts(session)
    assert [item["topic"] for item in channels["channels"]] == ["/robot/scan"]
    assert {item["name"].startswith("/crowdbot/get_") for item in services["services"]} == {True}
    row = {"id": 3, "topic": "/robot/cmd_vel", "encoding": "json", "schemaName": "geometry_msgs/Twist"}
    send(session, "advertise", channels=[row])
    session.handle(struct.pack("<BI", 1, 3) + b'{"linear": {"x": 0.5}}')
    session.handle(struct.pack("<BBfBQI", 3, 1, 1.0, 0, 0, 2) + b"r1")
    said = [text["message"] for text in texts(session)]
    assert "'/robot/cmd_vel' is not among the topics" in said[0]
    assert "'/crowdbot/set_simulation_state' is not among the services" in said[1]
    assert (graph.inbox.take_orders(), graph.inbox.take_calls()) == ([], [])


GOOD_FRAMES = (
    json.dumps({"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 1}]}).encode(),
    json.dumps({"op": "unsubscribe", "subscriptionIds": [1]}).encode(),
    json.dumps({"op": "advertise", "channels": [{"id": 1, "topic": "/a", "encoding": "json"}]}).encode(),
    struct.pack("<BI", 1, 1) + b'{"linear": {"x": 1}}',
    struct.pack("<BIII", 2, 1, 1, 4) + b"json{}",
    struct.pack("<BBfBQI", 3, 1, 1.0, 0, 0, 2) + b"r1",
)


def hostile_frame(rng):
    """Return a frame that a hostile client could send."""
    data = bytearray(rng.choice(GOOD_FRAMES))
    for _ in range(rng.randint(0, 5)):
        data[rng.randrange(len(data))] = rng.randrange(256)
    return bytes(data).decode("latin-1") if rng.random() < 0.5 else bytes(data[: rng.randint(0, len(data))])


@pytest.mark.parametrize("seed", range(3))
def test_hostile_frames_leave_nothing_behind(graph, seed):
    rng = random.Random(seed)
    session = FoxgloveSession(graph, lambda: None)
    for k in range(1000):
        session.handle(hostile_frame(rng))
        graph.deliver([message("/clock", k % 256)])
        graph.inbox.take_calls()
    session.handle("[" * 100_000)
    session.close()
    assert (graph.sessions, graph.wanted) == ([], frozenset())


def test_messages_of_clients_are_bounded():
    with pytest.raises(InputError, match="a message has 2000000 bytes"):
        decode_fields(b" " * 2_000_000, "json", "std_msgs/msg/String")
    with pytest.raises(InputError, match="must be a JSON object"):
        decode_fields(b"[]", "json", "std_msgs/msg/String")
    with pytest.raises(InputError, match="message type 'a/b' is unknown"):
        decode_fields(b"", "cdr", "a/b")

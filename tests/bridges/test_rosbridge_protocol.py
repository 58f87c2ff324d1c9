"""The rosbridge protocol without a network: frames, subscriptions, relays, hostile input."""

import base64
import io
import json
import random
import resource
import string

import cbor2
import numpy as np
import pytest
from PIL import Image

from crowdbot.bridges import Inbox, RobotInterface, fields_of, plain_fields
from crowdbot.bridges.rosbridge.frames import MOST_TEXT, FrameReader, OutgoingMessage, dump_json, encode_cbor
from crowdbot.bridges.rosbridge.graph import ROSAPI, RosGraph, type_details
from crowdbot.bridges.rosbridge.session import ClientSession, Subscription
from crowdbot.core import InputError
from crowdbot.messages import Messages
from crowdbot.recording import StepMessage
from crowdbot.trials import load_trial

MAKE = Messages()


@pytest.fixture
def graph():
    interface = RobotInterface.of(load_trial("frontal"))
    return RosGraph(interface, Inbox(interface), lambda function, *values: function(*values))


def client(graph, now=None):
    times = now if now is not None else [0.0]
    return ClientSession(graph, lambda: None, clock=lambda: times[0])


def send(session, **frame):
    session.handle(json.dumps(frame))


def taken(session):
    """Return all frames that wait for a client."""
    found = []
    while (row := session.take())[0]:
        found += row[0]
    return [json.loads(one) if isinstance(one, str) else cbor2.loads(one) for one in found]


def scan(nanoseconds=50_000_000, value=2.0):
    message = MAKE.make(
        "sensor_msgs/msg/LaserScan",
        header=MAKE.header(nanoseconds, "robot/scan"),
        angle_min=0.0, angle_max=1.0, angle_increment=0.5, time_increment=0.0, scan_time=0.1, range_min=0.0,
        range_max=10.0,
        ranges=np.array([value, np.inf, np.nan], dtype=np.float32),
        intensities=np.zeros(3, dtype=np.float32),
    )  # fmt: skip
    return OutgoingMessage.of(StepMessage("/robot/scan", "sensor_msgs/msg/LaserScan", nanoseconds, MAKE, message))


@pytest.mark.parametrize("compression", ["none", "png", "cbor", "cbor-raw"])
def test_a_message_arrives_in_every_form(graph, compression):
    session = client(graph)
    send(session, op="subscribe", topic="/robot/scan", type="sensor_msgs/LaserScan", compression=compression)
    message = scan()
    graph.deliver([message])
    (frame,) = taken(session)
    if compression == "png":
        with io.BytesIO(base64.b64decode(frame["data"])) as buffer, Image.open(buffer) as image:
            frame = json.loads(image.convert("RGB").tobytes())
    assert (frame["op"], frame["topic"]) == ("publish", "/robot/scan")
    if compression == "cbor-raw":
        assert (frame["msg"]["secs"], frame["msg"]["nsecs"]) == (0, 50_000_000)
        again = MAKE.decode_message(frame["msg"]["bytes"], "sensor_msgs/msg/LaserScan")
        assert plain_fields(again)["ranges"] == [2.0, None, None]
    elif compression == "cbor":
        tag = frame["msg"]["ranges"]
        assert tag.tag == 85
        np.testing.assert_array_equal(np.frombuffer(tag.value, "<f4"), np.float32([2.0, np.inf, np.nan]))
        assert frame["msg"]["header"]["stamp"] == {"sec": 0, "nanosec": 50_000_000}
    else:
        assert frame["msg"]["ranges"] == [2.0, None, None]


def test_bytes_are_base64_in_json_and_bytes_in_cbor():
    image = MAKE.make(
        "sensor_msgs/msg/Image", header=MAKE.header(0), height=1, width=2, encoding="mono8", is_bigendian=0, step=2,
        data=np.array([7, 200], dtype=np.uint8),
    )  # fmt: skip
    assert base64.b64decode(plain_fields(image)["data"]) == bytes([7, 200])
    assert cbor2.loads(encode_cbor(fields_of(image)))["data"] == bytes([7, 200])


def test_the_text_of_a_message_with_bytes_is_that_of_json(graph):
    pixels = np.arange(256, dtype=np.uint8)
    for data in (pixels, pixels[:0]):
        image = MAKE.make(
            "sensor_msgs/msg/Image", header=MAKE.header(0, 'a"b'), height=1, width=data.size, encoding="mono8",
            is_bigendian=0, step=data.size, data=data,
        )  # fmt: skip
        (text,) = OutgoingMessage.of(StepMessage("/i", "sensor_msgs/msg/Image", 0, MAKE, image)).frames(
            "none", None, ""
        )
        assert text == dump_json({"op": "publish", "topic": "/i", "msg": plain_fields(image)})


def test_cbor_is_read_by_an_independent_library():
    rng = random.Random(5)

    def value(depth):
        kinds = [
            lambda: rng.randint(-(2**63), 2**63 - 1), rng.random, lambda: rng.choice([True, False, None]),
            lambda: "".join(rng.choices(string.printable + "äπ", k=rng.randint(0, 40))),
            lambda: rng.randbytes(rng.randint(0, 300)),
        ]  # fmt: skip
        if depth:
            kinds += [lambda: [value(depth - 1) for _ in range(rng.randint(0, 30))]]
            kinds += [lambda: {str(k): value(depth - 1) for k in range(rng.randint(0, 5))}]
        return rng.choice(kinds)()

    for _ in range(200):
        one = value(3)
        assert cbor2.loads(encode_cbor(one)) == one
    with pytest.raises(InputError, match="a set has no form"):
        encode_cbor({1, 2})


def test_only_the_newest_message_waits_for_a_slow_client(graph):
    session = client(graph)
    send(session, op="subscribe", topic="/robot/scan")
    for k in range(1000):
        graph.deliver([scan(k, float(k))])
    assert [item["msg"]["ranges"][0] for item in taken(session)] == [999.0]
    assert session.subscriptions["/robot/scan"].dropped == 999


def test_a_queue_keeps_as_many_as_the_client_asks_for(graph):
    session = client(graph)
    send(session, op="subscribe", topic="/robot/scan", queue_length=3)
    for k in range(10):
        graph.deliver([scan(k, float(k))])
    assert [item["msg"]["ranges"][0] for item in taken(session)] == [7.0, 8.0, 9.0]


def test_topics_come_in_the_order_of_their_messages_and_take_turns(graph):
    """A client that has subscribed the clock last gets it before an image of the same step."""
    session = client(graph)
    for topic, depth in (("/image", 1), ("/flood", 3), ("/clock", 1)):
        send(session, op="subscribe", topic=topic, queue_length=depth)

    def offer(*topics):
        for topic in topics:
            session.offer(OutgoingMessage(topic, "std_msgs/msg/String", 0, lambda: {"data": ""}))

    offer("/clock", "/image")
    assert [row["topic"] for row in taken(session)] == ["/clock", "/image"]
    offer("/flood", "/flood", "/flood", "/clock", "/image")
    assert json.loads(session.take()[0][0])["topic"] == "/flood"
    offer("/clock", "/image", "/flood")
    assert [row["topic"] for row in taken(session)] == ["/clock", "/image", "/flood", "/flood", "/flood"]


def test_throttled_messages_keep_their_distance_in_real_time(graph):
    now = [0.0]
    session = client(graph, now)
    send(session, op="subscribe", topic="/robot/scan", throttle_rate=250)
    times = []
    for k in range(100):
        now[0] = 0.05 * k
        graph.deliver([scan(k)])
        times += [now[0]] * len(taken(session))
    assert len(times) == 20
    assert min(np.diff(times)) >= 0.25 - 1e-9


def test_the_strictest_of_several_subscriptions_counts(graph):
    session = client(graph)
    for name, rate in (("a", 500), ("b", 100)):
        send(session, op="subscribe", id=name, topic="/robot/scan", throttle_rate=rate)
    assert session.subscriptions["/robot/scan"]._interval == 0.1
    send(session, op="unsubscribe", id="b", topic="/robot/scan")
    assert session.subscriptions["/robot/scan"]._interval == 0.5
    send(session, op="unsubscribe", topic="/robot/scan")
    assert session.subscriptions == {}
    assert graph.wanted == frozenset()


def test_fragments_out_are_read_as_fragments_in(graph):
    session = client(graph)
    send(session, op="subscribe", topic="/robot/scan", fragment_size=50)
    graph.deliver([scan()])
    frames = taken(session)
    assert len(frames) > 4
    assert {frame["op"] for frame in frames} == {"fragment"}
    reader = FrameReader()
    random.Random(1).shuffle(frames)
    whole = [found for frame in frames if (found := reader.read(json.dumps(frame))) is not None]
    assert [item["op"] for item in whole] == ["publish"]


def test_a_command_becomes_an_order(graph):
    session = client(graph)
    send(session, op="advertise", topic="/robot/cmd_vel", type="geometry_msgs/Twist")
    send(session, op="publish", topic="/robot/cmd_vel", msg={"linear": {"x": 0.3}, "angular": {"z": 0.1}})
    assert [(order.forward, order.turn, order.source) for order in graph.inbox.take_orders()] == [
        (0.3, 0.1, "rosbridge")
    ]
    assert taken(session) == []


def test_a_late_subscriber_gets_latched_topics(graph):
    make = OutgoingMessage("/map", "nav_msgs/msg/OccupancyGrid", 0, lambda: {"info": {}})
    graph.deliver([make])
    session = client(graph)
    send(session, op="subscribe", topic="/map")
    assert [item["topic"] for item in taken(session)] == ["/map"]


def test_clients_hear_each_other(graph):
    one, two = client(graph), client(graph)
    send(one, op="advertise", topic="/chat", type="std_msgs/String")
    send(two, op="subscribe", topic="/chat", type="std_msgs/String")
    send(one, op="publish", topic="/chat", msg={"data": "hi"}, latch=True)
    three = client(graph)
    send(three, op="subscribe", topic="/chat", compression="cbor")
    assert [row[0]["msg"] for row in (taken(two), taken(three))] == [{"data": "hi"}] * 2
    one.close()
    assert "/chat" not in graph.topics
    assert graph.latched == {}


def test_a_client_offers_a_service_to_another(graph):
    server, caller = client(graph), client(graph)
    send(server, op="advertise_service", service="/add", type="example/Add")
    send(caller, op="call_service", id="7", service="/add", args={"a": 1})
    (asked,) = taken(server)
    assert (asked["op"], asked["service"], asked["args"]) == ("call_service", "/add", {"a": 1})
    send(server, op="service_response", id=asked["id"], service="/add", values={"sum": 3}, result=True)
    assert taken(caller) == [
        {"op": "service_response", "service": "/add", "values": {"sum": 3}, "result": True, "id": "7"}
    ]
    send(caller, op="call_service", id="8", service="/add")
    server.close()
    (failed,) = taken(caller)
    assert (failed["id"], failed["result"]) == ("8", False)
    assert "gone" in failed["values"]


def test_a_client_offers_an_action_to_another(graph):
    server, caller = client(graph), client(graph)
    send(server, op="advertise_action", action="/count", type="example/Count")
    send(caller, op="send_action_goal", id="g", action="/count", action_type="example/Count", args={}, feedback=True)
    (goal,) = taken(server)
    send(server, op="action_feedback", id=goal["id"], action="/count", values={"n": 1})
    send(caller, op="cancel_action_goal", id="g", action="/count")
    assert taken(server) == [{"op": "cancel_action_goal", "id": goal["id"], "action": "/count"}]
    send(server, op="action_result", id=goal["id"], action="/count", values={}, status=5, result=True)
    assert [(item["op"], item["id"]) for item in taken(caller)] == [("action_feedback", "g"), ("action_result", "g")]


@pytest.mark.parametrize(
    ("service", "values", "fields"),
    [
        ("reset_simulation", [4], {"scope": 4}),  # its type has constants
        ("step_simulation", [9], {"steps": 9}),  # its type has a default
        ("set_entity_state", ["robot", {}, True], {"entity": "robot", "state": {}, "set_pose": True}),
        ("get_current_world", [], {}),
        ("not_a_service", [1], {}),
    ],
)
def test_the_fields_of_a_request_may_be_a_list(graph, service, values, fields):
    assert graph.positional(f"/crowdbot/{service}", values) == fields


def test_the_steps_of_the_simulation_are_an_action(graph):
    session = client(graph)
    frame = {"op": "send_action_goal", "id": "g", "action": "/crowdbot/simulate_steps", "args": {"steps": 40}}
    send(session, **frame, feedback=True)
    done = 0
    while calls := graph.inbox.take_calls():
        (call,) = calls
        done += call.request["steps"]
        if done == 20:
            send(session, op="cancel_action_goal", id="g", action="/crowdbot/simulate_steps")
        call.answer({"result": {"result": 1, "error_message": ""}})
    rows = taken(session)
    assert [row["op"] for row in rows] == ["action_feedback"] * 10 + ["action_result"]
    assert (rows[-1]["status"], rows[-2]["values"]) == (5, {"completed_steps": 20, "remaining_steps": 20})


@pytest.mark.parametrize("name", sorted(ROSAPI))
def test_rosapi_answers(graph, name):
    values = {
        "topic": "/robot/scan", "type": "sensor_msgs/LaserScan", "service": "/crowdbot/step_simulation",
        "node": "/crowdbot",
    }  # fmt: skip
    if name in ("service_request_details", "service_response_details"):
        values["type"] = "simulation_interfaces/srv/StepSimulation"
    session = client(graph)
    send(session, op="call_service", id="1", service=f"/rosapi/{name}", args=values)
    (answer,) = taken(session)
    assert answer["result"] is True, answer
    send(session, op="call_service", id="2", service=f"/rosapi/{name}", args={"type": 3, "topic": [], "service": None})
    assert taken(session)[0]["id"] == "2"


def test_message_details_name_all_types():
    found = {detail["type"]: detail for detail in type_details("sensor_msgs/LaserScan")}
    assert {*found} == {"sensor_msgs/msg/LaserScan", "std_msgs/msg/Header", "builtin_interfaces/msg/Time"}
    row = found["sensor_msgs/msg/LaserScan"]
    assert row["fieldarraylen"][row["fieldnames"].index("ranges")] == 0
    with pytest.raises(InputError, match="is unknown"):
        type_details("no/Such")


REFUSED = [
    ("{", "is not JSON"),
    ("[]", 'must be a JSON object with "op"'),
    ('{"op": 3}', 'must be a JSON object with "op"'),
    ('{"op": "fly"}', "the operation 'fly' is unknown"),
    ('{"op": "subscribe"}', "subscribe needs 'topic'"),
    ('{"op": "subscribe", "topic": "a b"}', "is not a name of ROS"),
    (
        '{"op": "subscribe", "topic": "/robot/scan", "type": "std_msgs/String"}',
        "has the type sensor_msgs/msg/LaserScan",
    ),
    ('{"op": "subscribe", "topic": "/robot/scan", "compression": "zip"}', "compression 'zip' is unknown"),
    ('{"op": "subscribe", "topic": "/robot/scan", "queue_length": 1000000000}', "queue_length from 0"),
    ('{"op": "subscribe", "topic": "/robot/scan", "fragment_size": 0}', "at least 16"),
    ('{"op": "subscribe", "topic": "/robot/scan", "throttle_rate": NaN}', "throttle_rate must"),
    ('{"op": "unsubscribe", "topic": "/robot/scan"}', "is not subscribed"),
    ('{"op": "publish", "topic": "/robot/scan", "msg": {}}', "is sent by the simulation"),
    ('{"op": "publish", "topic": "/robot/cmd_vel", "msg": {"linear": {"x": 1e999}}}', "finite number"),
    ('{"op": "publish", "topic": "/robot/cmd_vel", "msg": 3}', "'msg' must be of type dict"),
    (
        '{"op": "advertise", "topic": "/robot/cmd_vel", "type": "std_msgs/String"}',
        "has the type geometry_msgs/msg/Twist",
    ),
    ('{"op": "unadvertise", "topic": "/x"}', "is not advertised"),
    ('{"op": "service_response", "id": "1", "service": "/a"}', "nobody waits"),
    ('{"op": "advertise_service", "service": "/crowdbot/step_simulation", "type": "x"}', "offered by the simulation"),
    ('{"op": "fragment", "id": "1", "data": "x", "num": 3, "total": 2}', "num and total"),
    ('{"op": "cancel_action_goal", "id": "9", "action": "/a"}', "there is no goal"),
    ('{"op": "set_level", "level": "loud"}', "must be one of"),
    ("[" * 100_000, "is not JSON"),
    ('{"op":' + '{"a":' * 60 + "1" + "}" * 61, 'with "op"'),
    ('{"op": "publish", "x":' + "[" * 60 + "]" * 60 + "}", "deeper than 40"),
    ('{"op": "publish", "topic": ' + "9" * 5000 + "}", "is not JSON"),
    ('{"op": "' + "x" * MOST_TEXT + '"}', "at most 4194304"),
]


@pytest.mark.parametrize(("text", "message"), REFUSED, ids=[message[:20] for _, message in REFUSED])
def test_bad_frames_are_answered_with_a_status(graph, text, message):
    session = client(graph)
    session.handle(text)
    (answer,) = taken(session)
    assert (answer["op"], answer["level"]) == ("status", "error")
    assert message in answer["msg"]


def test_the_level_of_status_messages_is_the_choice_of_the_client(graph):
    session = client(graph)
    for level, count in (("info", 1), ("error", 1), ("none", 0)):
        send(session, op="set_level", level=level)
        session.handle("{")
        assert len(taken(session)) == count
    send(session, op="set_level", level="warning")
    session.status("info", "quiet")
    session.status("warning", "loud", "7")
    assert [(item["msg"], item["id"]) for item in taken(session)] == [("loud", "7")]


def test_the_list_of_allowed_topics_holds_for_all_operations():
    interface = RobotInterface.of(load_trial("frontal"))
    graph = RosGraph(interface, Inbox(interface), lambda function, *values: function(*values), ["/robot/*"])
    session = client(graph)
    send(session, op="subscribe", topic="/robot/scan")
    send(session, op="publish", topic="/robot/cmd_vel", msg={"linear": {"x": 0.1}})
    assert taken(session) == []
    for frame in (
        {"op": "subscribe", "topic": "/people"},
        {"op": "publish", "topic": "/crowdbot/order", "msg": {"data": "{}"}},
        {"op": "advertise", "topic": "/chat", "type": "std_msgs/String"},
        {"op": "advertise_service", "service": "/add", "type": "x/Y"},
        {"op": "call_service", "service": "/crowdbot/reset_simulation"},
        {"op": "send_action_goal", "action": "/crowdbot/simulate_steps", "args": {"steps": 1}},
    ):
        send(session, **frame)
        (answer,) = taken(session)
        assert "is not in the list of allowed topics" in answer.get("msg", answer.get("values", "")), frame


def test_fragments_of_a_client_are_bounded():
    reader = FrameReader()

    def read_parts(count, size, **values):
        for k in range(count):
            reader.read(json.dumps({"op": "fragment", "id": str(k), "data": "x" * size, "num": 0, "total": 2} | values))

    for number in range(8):
        read_parts(1, 400_000, num=number, total=5000)
    with pytest.raises(InputError, match="fragments wait for more than"):
        read_parts(1, 1_100_000, num=9, total=5000)
    with pytest.raises(InputError, match="16 messages"):
        read_parts(20, 1)
    inner = json.dumps({"op": "fragment", "id": "2", "data": "", "num": 0, "total": 1})
    with pytest.raises(InputError, match="cannot contain fragments"):
        reader.read(json.dumps({"op": "fragment", "id": "1", "data": inner, "num": 0, "total": 1}))


def test_what_waits_for_a_client_is_bounded_in_bytes(graph):
    reader, writer = client(graph), client(graph)
    for k in range(60):
        send(reader, op="subscribe", topic=f"/chat{k}", queue_length=1000)
    for k in range(60):
        send(writer, op="publish", topic=f"/chat{k}", msg={"data": "x" * 1_000_000})
    waiting = [frame["topic"] for frame in taken(reader)]
    assert waiting == [f"/chat{k}" for k in range(33)]  # 32 MiB of this client; what has no room then is dropped
    assert [row.dropped for row in reader.subscriptions.values()] == [0] * 33 + [1] * 27
    for k in range(40):
        send(writer, op="publish", topic="/chat0", msg={"data": f"{k:02}" + "x" * 1_000_000})
    assert [frame["msg"]["data"][:2] for frame in taken(reader)] == [f"{k:02}" for k in range(7, 40)]
    send(writer, op="publish", topic="/chat0", msg={"data": "x" * 1_000_000})
    send(reader, op="unsubscribe", topic="/chat0")
    send(writer, op="publish", topic="/chat1", msg={"data": "x"})
    assert len(taken(reader)) == 1


def test_what_clients_leave_in_the_server_is_bounded_in_bytes(graph):
    session = client(graph)
    for k in range(5):
        send(session, op="publish", topic=f"/kept{k}", msg={"data": "x" * 4_000_000}, latch=True)
    (refused,) = taken(session)
    assert "'/kept4': with this message, the latched messages of clients take 19.1 MiB" in refused["msg"]
    send(session, op="publish", topic="/kept0", msg={"data": "x"}, latch=True)  # it makes room
    send(session, op="publish", topic="/kept4", msg={"data": "x" * 4_000_000}, latch=True)
    assert taken(session) == []
    for k in range(6):
        request = {"resource_string": "x" * 3_000_000}
        send(session, op="call_service", service="/crowdbot/load_world", args=request, id=str(k))
    (answer,) = taken(session)
    assert (answer["id"], answer["result"]) == ("5", False)
    assert "the calls that wait for the next step would take 17.2 MiB" in answer["values"]
    assert len(graph.inbox.take_calls()) == 5
    for _ in range(17):
        order = json.dumps({"order": "add-element", "xml": f'<agent x="1" y="0"><!--{"x" * 990_000}--></agent>'})
        send(session, op="publish", topic="/crowdbot/order", msg={"data": order})
    (refused,) = taken(session)
    assert "the orders that wait for the next step would take 16.1 MiB" in refused["msg"]
    assert len(graph.inbox.take_orders()) == 16


@pytest.mark.parametrize("name", ["id", "topic", "type", "service", "level"])
def test_names_and_words_of_a_frame_are_short(graph, name):
    session = client(graph)
    frame = {"op": "subscribe", "topic": "/robot/scan"} | {name: "x" * 1001}
    send(session, **frame)
    (answer,) = taken(session)
    assert answer["msg"] == f"'{name}' has 1001 characters, at most 1000 are allowed"
    send(session, op="subscribe", topic="/robot/scan", id=[1])
    assert "id must be a text or a number" in taken(session)[0]["msg"]


def test_a_client_cannot_advertise_a_topic_endlessly(graph):
    session = client(graph)
    for k in range(1001):
        send(session, op="advertise", topic="/chat", type="std_msgs/String", id=str(k))
    (answer,) = taken(session)
    assert "1000 advertisements of one topic are too many" in answer["msg"]


def hostile_frame(rng):
    """Return a frame that a hostile client could send."""
    words = ["subscribe", "unsubscribe", "publish", "advertise", "unadvertise", "call_service", "fragment", "set_level",
             "advertise_service", "service_response", "send_action_goal", "cancel_action_goal", "status", "auth", "x",
             "action_result", "action_feedback", "unadvertise_service", "advertise_action"]  # fmt: skip
    names = ["/robot/scan", "/robot/cmd_vel", "/robot/goal_pose", "/crowdbot/order", "/crowdbot/step_simulation",
             "/rosapi/topics", "/rosapi/message_details", "/crowdbot/simulate_steps", "/chat", "", "//", "a b",
             "/crowdbot/spawn_entity", "/crowdbot/get_entities"]  # fmt: skip

    def value(depth=0):
        kinds = [None, True, -1, 0, 10**30, 0.5, float("inf"), float("nan"), "", "x" * rng.randint(0, 200), [], {}]
        if depth < 4 and rng.random() < 0.5:
            return rng.choice([[value(depth + 1)] * rng.randint(0, 5), {rng.choice("abxyz"): value(depth + 1)}])
        return rng.choice(kinds)

    keys = [
        "topic",
        "type",
        "msg",
        "service",
        "args",
        "id",
        "num",
        "total",
        "data",
        "level",
        "action",
        "values",
        "throttle_rate",
        "queue_length",
        "fragment_size",
        "compression",
        "latch",
        "result",
        "status",
        "feedback",
    ]
    frame = {"op": rng.choice(words)}
    for key in rng.sample(keys, rng.randint(0, 10)):
        named = key in ("topic", "service", "action") and rng.random() < 0.8
        frame[key] = rng.choice(names) if named else value()
    text = json.dumps(frame)
    chance = rng.random()
    if chance < 0.1:
        at = rng.randrange(len(text))
        text = text[:at] + rng.choice(['"', "{", "\x00", "\ud800", "9" * 5000, "[" * 3000]) + text[at:]
    elif chance < 0.15:
        text = text[: rng.randrange(len(text))]
    return text


def attack(graph, count, seed):
    rng = random.Random(seed)
    session = client(graph)
    for k in range(count):
        session.handle(hostile_frame(rng))
        if k % 50 == 0:
            graph.deliver([scan(k)])
            while session.take()[0]:
                pass
            graph.inbox.take_orders()
            for call in graph.inbox.take_calls():
                call.answer({"result": {"result": 4, "error_message": ""}})
        if k % 1000 == 999:
            session.close()
            session = client(graph)
    return session


def test_hostile_frames_leave_nothing_behind(graph):
    session = attack(graph, 3000, 0)
    assert session.errors >= 0
    session.close()
    assert (graph.sessions, graph.advertised, graph.services, graph.actions) == ([], {}, {}, {})
    other = client(graph)
    send(other, op="subscribe", topic="/robot/scan")
    graph.deliver([scan()])
    assert len(taken(other)) == 1


@pytest.mark.sweep
def test_many_hostile_frames_do_not_grow_the_memory(graph):
    attack(graph, 5000, 1).close()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for seed in range(10):
        attack(graph, 10_000, seed).close()
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 30_000  # [kB]


def test_a_subscription_without_requests_sends_nothing():
    one = Subscription("/chat")
    assert one.wait_time(0.0) is None
    assert one.remove(None)

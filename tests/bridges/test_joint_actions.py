"""Goals of FollowJointTrajectory: feedback, tolerances, cancel and preemption, and each transport that carries them."""

import json
import os
import random
import subprocess
import sys
from pathlib import Path

import pytest
from bridge_runs import MemoryTransport, Running, serve
from page_runs import FENCE, HOW_TO
from ros1_master import PYTHON, RosMaster
from test_joint_trajectory import Sender, lab, trajectory

from crowdbot.bridges import BridgeClock, Inbox, RobotInterface, interface_store, run_bridge
from crowdbot.bridges.inbox import ServiceCall
from crowdbot.bridges.joint_actions import (
    ABORTED,
    CANCELED,
    GOAL_VIOLATED,
    INVALID_GOAL,
    INVALID_JOINTS,
    OLD_STAMP,
    PATH_VIOLATED,
    REJECTED,
    SUCCEEDED,
    SUCCESSFUL,
    JointActions,
    goal_end,
)
from crowdbot.bridges.ros1 import Ros1Node
from crowdbot.bridges.ros1.actions import ActionServer
from crowdbot.bridges.rosbridge.client import RosbridgeClient
from crowdbot.bridges.rosbridge.graph import RosGraph
from crowdbot.bridges.rosbridge.server import RosbridgeServer
from crowdbot.bridges.rosbridge.session import ClientSession
from crowdbot.core import InputError
from crowdbot.messages import Ros1Messages
from crowdbot.recording import replay
from crowdbot.simulation import Simulation
from crowdbot.trials import parse_trial
from web.simulator_session import wait_until

ACTION = "/pepper/follow_joint_trajectory"


class Client(Sender):
    """Sends goals and messages at instants [s], and keeps feedback and results of the goals in the order of sending."""

    def __init__(self, goals, sent=None):
        super().__init__(sent or {})
        self.goals = {round(time * 1e9): fields for time, fields in goals.items()}
        self.feedback, self.results, self.calls = [], [], []

    def publish(self, messages):
        super().publish(messages)
        now = messages[-1].nanoseconds
        fields = self.goals.pop(now, None)
        if fields == "cancel":
            self.calls[-1].canceled = True
        elif fields is not None:
            self.feedback.append([])
            self.results.append([])
            take = self.inbox.call(ACTION, fields, self.results[-1].append, self.name, self.feedback[-1].append)
            self.calls.append(take)


def run(goals, sent=None, trial=None, out=None):
    client = Client(goals, sent)
    client.done = run_bridge(trial or lab(), [client], 0, out, BridgeClock("free"))
    assert all(len(rows) == 1 for rows in client.results)  # each goal has one result
    return client


def goal(*points, path=(), end=(), wait=0.0, **words):
    """Return the fields of a goal; tolerances are rows of name, position and velocity."""
    fields = {"trajectory": trajectory(*points, **words)}
    for key, rows in (("path_tolerance", path), ("goal_tolerance", end)):
        fields[key] = [{"name": name, "position": position, "velocity": velocity} for name, position, velocity in rows]
    return {**fields, "goal_time_tolerance": {"sec": int(wait), "nanosec": round(wait % 1 * 1e9)}}


def test_a_goal_has_feedback_on_simulated_time_and_a_result(tmp_path):
    fields = goal((0.4, (0.8,)), path=[("HeadYaw", 0.001, 0.0)], end=[("HeadYaw", 0.001, 0.01)])
    client = run({0.2: fields}, out=tmp_path)
    assert client.results == [[goal_end(SUCCEEDED, SUCCESSFUL)]]
    rows = client.feedback[0]
    assert [row["header"]["stamp"]["nanosec"] for row in rows] == [k * 50_000_000 for k in range(4, 13)]
    assert rows[4]["joint_names"] == ["HeadYaw"]
    assert rows[4]["desired"]["positions"] == pytest.approx([0.4])
    assert rows[4]["actual"]["positions"] == pytest.approx([0.4])
    assert rows[4]["error"]["positions"] == pytest.approx([0.0])
    assert rows[4]["desired"]["time_from_start"] == {"sec": 0, "nanosec": 200_000_000}
    assert client.positions()[1.5] == pytest.approx(0.8)
    assert replay(client.done.path).equal


def test_a_path_tolerance_aborts_and_the_robot_keeps_its_latest_target():
    fast = goal((0.1, (1.5,)), (1.2, (1.5,)), path=[("HeadYaw", 0.05, 0.0)])
    client = run({0.2: fast}, trial=lab(1.4, "physics"))
    ((answer,),) = client.results
    assert (answer["status"], answer["result"]["error_code"]) == (ABORTED, PATH_VIOLATED)
    assert answer["result"]["error_string"].startswith("path tolerance: HeadYaw is off by ")
    assert len(client.feedback[0]) < 5


def test_a_goal_tolerance_waits_for_the_joints_and_aborts_after_its_time():
    fast = ((0.05, (1.5,)),)
    patient = run({0.2: goal(*fast, end=[("HeadYaw", 0.05, 0.0)])}, trial=lab(1.4, "physics"))
    assert patient.results == [[goal_end(SUCCEEDED, SUCCESSFUL)]]
    assert patient.feedback[0][-1]["header"]["stamp"]["nanosec"] > 250_000_000  # it has waited for the motor
    late = run({0.2: goal(*fast, end=[("HeadYaw", 0.0001, 0.0)], wait=0.05)}, trial=lab(1.4, "physics"))
    (answer,) = late.results[0]
    assert (answer["status"], answer["result"]["error_code"]) == (ABORTED, GOAL_VIOLATED)
    assert late.feedback[0][-1]["header"]["stamp"]["nanosec"] == 350_000_000  # 0.05 s + 0.05 s are over


def test_a_canceled_goal_stops_where_it_is():
    client = run({0.2: goal((1.0, (1.0,))), 0.6: "cancel"})
    assert client.results == [[goal_end(CANCELED, SUCCESSFUL, "canceled")]]
    assert [client.positions()[time] for time in (0.6, 1.5)] == pytest.approx([0.4, 0.4])


@pytest.mark.parametrize(
    "newer",
    [
        {"goals": {0.6: goal((0.4, (0.0,)))}},
        {"sent": {0.6: ("/pepper/joint_trajectory", trajectory((0.4, (0.0,))))}},
        {"sent": {0.6: ("/pepper/joint_command", {"name": ["HeadYaw"], "position": [0.0]})}},
    ],
)
def test_a_newer_goal_or_target_of_a_joint_ends_a_goal_as_canceled(newer):
    both = goal((1.0, (1.0, 0.3)), joints=("HeadYaw", "HeadPitch"))
    client = run({0.2: both, **newer.get("goals", {})}, newer.get("sent"))
    (answer,) = client.results[0]
    assert (answer["status"], answer["result"]["error_code"]) == (CANCELED, INVALID_GOAL)
    assert "moves its joints" in answer["result"]["error_string"]
    assert client.positions()[1.5] == pytest.approx(0.0)
    assert client.positions("HeadPitch")[1.5] == pytest.approx(0.12, abs=0.02)  # stops, too
    assert [rows[0]["status"] for rows in client.results[1:]] == [SUCCEEDED] * len(newer.get("goals", {}))


@pytest.mark.parametrize(
    ("fields", "code", "text"),
    [
        ({}, INVALID_GOAL, "a goal needs trajectory"),
        (goal((0.5, (9.0,))), INVALID_GOAL, "'HeadYaw' of pepper cannot be at 9 rad"),
        (goal((0.5, (0.1,)), joints=("HeadYow",)), INVALID_JOINTS, "no joint 'HeadYow', did you mean 'HeadYaw'?"),
        (goal((0.05, (0.1,)), stamp=0.1), OLD_STAMP, "it ends at 0.15 s, before the current time 0.2 s"),
        (goal((0.5, (0.1,)), path=[("Head", 1, 0)]), INVALID_GOAL, "path_tolerance: 'Head' is no joint of the tra"),
        ({**goal((0.5, (0.1,))), "goal_tolerance": [3]}, INVALID_GOAL, "goal_tolerance must be a list"),
    ],
)
def test_a_goal_that_cannot_be_followed_is_rejected_with_its_code(fields, code, text):
    client = run({0.2: fields})
    ((answer,),) = client.results
    assert (answer["status"], answer["result"]["error_code"]) == (REJECTED, code)
    assert text in answer["result"]["error_string"]
    assert client.feedback == [[]]


def test_goals_end_with_the_run_and_at_a_new_beginning():
    client = run({1.2: goal((3.0, (1.0,)))})
    assert client.results == [[goal_end(ABORTED, INVALID_GOAL, "the run has ended")]]
    with pytest.raises(InputError, match="the run has ended"):
        client.inbox.call(ACTION, goal((0.1, (0.1,))), print, "test")

    memory, answers, seen = MemoryTransport(), [], []
    with Running(lab(600.0), [memory], "free") as running:
        memory.inbox.call(ACTION, goal((300.0, (1.0,))), answers.append, "test", seen.append)
        wait_until(lambda: seen)
        memory.call("reset_simulation")
        wait_until(lambda: answers)
        assert answers == [goal_end(ABORTED, INVALID_GOAL, "the trial begins again")]
        running.run.stop.asked = True


@pytest.fixture
def graph():
    interface = RobotInterface.of(lab())
    return RosGraph(interface, Inbox(interface), lambda function, *values: function(*values))


def test_rosbridge_carries_goals_feedback_results_and_cancellations(graph):
    session = ClientSession(graph, lambda: None)

    def send(**frame):
        session.handle(json.dumps(frame))

    def taken():
        frames = []
        while (row := session.take())[0]:
            frames += map(json.loads, row[0])
        return frames

    fields = goal((0.5, (0.1,)))
    send(op="send_action_goal", id="a", action=ACTION, action_type="x/y", args=fields, feedback=True)
    send(op="send_action_goal", id="a", action=ACTION, args=fields)
    (refused,) = taken()
    assert (refused["result"], "'a' is active" in refused["values"]) == (False, True)
    (call,) = graph.inbox.take_calls()
    assert call.request == fields
    call.feedback({"joint_names": ["HeadYaw"]})
    send(op="cancel_action_goal", id="a", action=ACTION)
    assert call.canceled
    call.answer(goal_end(CANCELED, SUCCESSFUL, "canceled"))
    feedback, result = taken()
    assert feedback == {
        "op": "action_feedback", "id": "a", "action": ACTION, "values": {"joint_names": ["HeadYaw"]}
    }  # fmt: skip
    assert result == {
        "op": "action_result", "id": "a", "action": ACTION, "status": CANCELED, "result": True,
        "values": {"error_code": 0, "error_string": "canceled"},
    }  # fmt: skip

    send(op="send_action_goal", id="b", action=ACTION, args=fields)
    send(op="send_action_goal", id="c", action=ACTION, args={})
    kept, rejected = graph.inbox.take_calls()
    rejected.answer(goal_end(REJECTED, INVALID_GOAL, "no"))
    assert [(item["id"], item["status"], item["result"], item["values"]) for item in taken()] == [
        ("c", ABORTED, False, "no")
    ]
    session.close()
    assert kept.canceled  # nobody watches the robot any more


def actionlib_server(keep=lambda topic, data: None, monotonic=lambda: 0.0):
    """Return the server of an action and the inbox that receives its goals."""
    interface = RobotInterface.of(lab())
    inbox, action = Inbox(interface), interface.actions[0]
    server = ActionServer(action, inbox, Ros1Messages(), keep, lambda function, *values: function(*values), monotonic)
    return server, inbox


def test_the_topics_of_actionlib_carry_goals_states_and_cancellations():
    sent, now = [], [0.0]
    codec = Ros1Messages()

    def keep(topic, data):
        kind = next(item.kind for item in server.outputs if item.name == topic)
        sent.append((topic.rpartition("/")[2], codec.message(data, kind)))

    server, inbox = actionlib_server(keep, lambda: now[0])
    take, cancel = (item.name for item in server.inputs)
    identity = {"stamp": {"sec": 3, "nanosec": 0}, "id": "a"}
    server.receive(take, {"goal_id": identity, "goal": goal((0.5, (0.1,)))}, "ros1")
    server.receive(take, {"goal_id": {**identity, "id": "b"}, "goal": {}}, "ros1")
    first, second = inbox.take_calls()
    first.feedback({"joint_names": ["HeadYaw"], "desired": {"positions": [0.1]}})
    name, message = sent[-1]
    assert (name, message.status.status, message.feedback.joint_names) == ("feedback", 1, ["HeadYaw"])
    assert message.feedback.desired.positions.tolist() == [0.1]
    second.answer(goal_end(REJECTED, INVALID_GOAL, "no"))
    name, message = sent[-2]
    assert (name, message.status.goal_id.id, message.status.status) == ("result", "b", 5)
    assert (message.result.error_code, message.result.error_string) == (-1, "no")
    server.receive(cancel, {"id": "x", "stamp": {"sec": 0, "nanosec": 0}}, "ros1")
    assert not first.canceled
    server.receive(cancel, {"id": "", "stamp": {"sec": 0, "nanosec": 0}}, "ros1")
    assert first.canceled
    first.answer(goal_end(CANCELED, SUCCESSFUL, "canceled"))
    name, message = sent[-1]
    assert [(row.goal_id.id, row.status) for row in message.status_list] == [("a", 2), ("b", 5), ("x", 7)]
    now[0] = 6.0
    server.tell_states()
    assert sent[-1][1].status_list == []


@pytest.mark.parametrize(
    ("stamps", "identity", "canceled"),
    [
        ((0, 0), ("a", 0), [True, False]),  # a time of 0 is none, also where goals have none
        ((0, 0), ("x", 0), [False, False]),
        ((0, 0), ("", 0), [True, True]),
        ((3, 5), ("", 4), [True, False]),
        ((3, 5), ("", 5), [True, True]),
        ((3, 5), ("b", 4), [True, True]),
        ((0, 5), ("b", 0), [False, True]),
        ((0, 5), ("", 4), [True, False]),
    ],
)
def test_actionlib_cancels_a_goal_by_its_id_and_goals_up_to_a_time(stamps, identity, canceled):
    """The rules of ``ActionServerBase::cancelCallback`` of actionlib."""
    server, inbox = actionlib_server()
    take, cancel = (item.name for item in server.inputs)
    for name, seconds in zip("ab", stamps, strict=True):
        goal_id = {"stamp": {"sec": seconds, "nanosec": 0}, "id": name}
        server.receive(take, {"goal_id": goal_id, "goal": goal((0.5, (0.1,)))}, "ros1")
    calls = inbox.take_calls()
    name, seconds = identity
    server.receive(cancel, {"id": name, "stamp": {"sec": seconds, "nanosec": 0}}, "ros1")
    assert [call.canceled for call in calls] == canceled


def identity_of(name, seconds):
    return {"id": name, "stamp": {"sec": seconds, "nanosec": 0}}


def states_of(steps):
    """Return what the server does for steps of ``ros1_action_rules.py``: states after each, and the results."""
    codec, now, states, results, waiting = Ros1Messages(), [100.0], [], [], []

    def row(status):
        return [status.goal_id.id, status.status]

    def keep(topic, data):
        name = topic.rpartition("/")[2]
        if name == "result":
            results.append(row(codec.message(data, server.outputs[2].kind).status))
        elif name == "status":
            states[-1] = [row(item) for item in codec.message(data, server.outputs[0].kind).status_list]

    server, inbox = actionlib_server(keep, lambda: now[0])
    take, cancel = (item.name for item in server.inputs)
    inbox.begin_instant(100 * 10**9)
    for word, *values in steps:
        states.append([])
        if word == "goal":
            server.receive(take, {"goal_id": identity_of(*values), "goal": goal((0.5, (0.1,)))}, "ros1")
        elif word == "cancel":
            server.receive(cancel, identity_of(*values), "ros1")
        elif word == "take":
            waiting += inbox.take_calls()
            for call in list(waiting):
                if call.canceled:
                    waiting.remove(call)
                    call.answer(goal_end(CANCELED, SUCCESSFUL, "canceled"))
                else:
                    call.feedback({})
        else:
            now[0] += values[0]
            inbox.begin_instant(round(now[0] * 1e9))
        server.tell_states()
    return [states, results]


def test_a_cancellation_that_comes_before_its_goal_recalls_it():
    early = [["cancel", "a", 0], ["goal", "a", 7], ["take"]]
    assert states_of(early) == [[[["a", 7]], [["a", 8]], [["a", 8]]], [["a", 8]]]
    late = [["cancel", "", 20], ["goal", "a", 20], ["goal", "b", 21], ["goal", "c", 0], ["take"]]
    assert states_of(late)[0][-1] == [["a", 8], ["b", 1], ["c", 1]]
    assert states_of([early[0], ["wait", 6.0], *early[1:]])[0][-1] == [["a", 1]]  # forgotten
    assert states_of([late[0], ["wait", -90.0], late[1], ["take"]])[0][-1] == [["a", 1]]  # the trial begins again


def test_goals_without_an_id_are_different_goals():
    steps = [["goal", "", 0], ["goal", "", 0]]
    assert [state for _, state in states_of(steps)[0][-1]] == [0, 0]


def test_a_goal_that_was_canceled_before_the_simulation_took_it_ends_no_other():
    first, second = (goal((1.0, (value,))) for value in (1.0, -1.0))
    actions, answers = JointActions(), []
    calls = [ServiceCall(ACTION, fields, answers.append, "test") for fields in (first, second)]
    simulation = Simulation(lab(), 0)
    calls[1].canceled = True
    for call in calls:
        actions.begin(call, "pepper", simulation)
    assert answers == [goal_end(CANCELED, SUCCESSFUL, "canceled")]


def test_the_states_of_goals_are_those_of_the_real_actionlib(ros1, tmp_path):
    draw = random.Random(0)
    words = [
        lambda: ["goal", draw.choice("abcd"), draw.choice([0, 10, 20, 30])],
        lambda: ["cancel", draw.choice(["", *"abcd"]), draw.choice([0, 0, 5, 10, 25])],
        lambda: ["take"],
        lambda: ["wait", draw.choice([1.0, 6.0])],
    ]
    lists = [[draw.choices(words, (5, 3, 3, 1))[0]() for _ in range(12)] for _ in range(500)]
    path = tmp_path / "steps.json"
    path.write_text(json.dumps(lists))
    command = [PYTHON, str(Path(__file__).with_name("ros1_action_rules.py")), str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, env=os.environ | {"PYTHONPATH": ""})
    assert done.returncode == 0, done.stderr
    for steps, wanted in zip(lists, json.loads(done.stdout), strict=True):
        assert states_of(steps) == wanted, steps


def test_the_types_of_ros1_are_those_of_control_msgs():
    """Checksums as published with control_msgs 1.5 of ROS Noetic."""
    codec, kind = Ros1Messages(), "control_msgs/msg/FollowJointTrajectory"
    assert codec.checksum(f"{kind}ActionGoal") == "cff5c1d533bf2f82dd0138d57f4304bb"
    assert codec.checksum(f"{kind}ActionResult") == "c4fb3b000dc9da4fd99699380efcc5d9"
    assert codec.checksum(f"{kind}ActionFeedback") == "d8920dc4eae9fc107e00999cce4be641"


def answer_of(process):
    out, errors = process.communicate(timeout=120)
    assert process.returncode == 0, errors
    return json.loads(out.splitlines()[-1])


def roslibpy_client(port):
    command = [sys.executable, str(Path(__file__).with_name("roslibpy_client.py")), str(port), "follow"]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


FOLLOWED = {"feedback": True, "result": [0, ""], "canceled": [0, "canceled"], "rejected": True}


@pytest.mark.live
def test_roslibpy_sends_goals_to_the_server_and_over_a_server_of_others():
    running, server = serve(lab(600.0))
    with running:
        assert answer_of(roslibpy_client(server.port)) == FOLLOWED
    empty = RobotInterface(lab(), (), (), ())
    relay = RosbridgeServer(port=0)
    relay.start(empty, Inbox(empty))
    with Running(lab(600.0), [RosbridgeClient(f"ws://127.0.0.1:{relay.port}")]):
        assert answer_of(roslibpy_client(relay.port)) == FOLLOWED
    relay.stop()


@pytest.mark.live
def test_the_program_of_the_page_turns_the_head(tmp_path):
    blocks = {block["title"]: block["text"] for block in FENCE.finditer((HOW_TO / "joints.md").read_text("utf-8"))}
    running, server = serve(parse_trial(blocks["head.xml"], place="head"))
    with running:
        path = tmp_path / "turn_head.py"
        path.write_text(blocks["turn_head.py"].replace("9090", str(server.port)), encoding="utf-8")
        done = subprocess.run([sys.executable, str(path)], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert lines[0] == "[0.0, 0.0]"
    assert len(lines) > 20
    assert "'error_code': 0" in lines[-1]


@pytest.mark.live
def test_a_client_of_actionlib_sends_goals_to_the_ros1_node(ros1, tmp_path):
    codec, name = Ros1Messages(), "FollowJointTrajectory"
    parts = {part: f"control_msgs/msg/{name}Action{part}" for part in ("Goal", "Result", "Feedback")}
    path = tmp_path / "types.json"
    path.write_text(json.dumps({part: codec.definition(kind) for part, kind in parts.items()}))
    with RosMaster(tmp_path) as master, Running(lab(600.0), [Ros1Node(master.url)]):
        assert answer_of(master.open("ros1_action_client.py", str(path))) == {
            "feedback": True, "result": [3, 0], "canceled": [2, 0], "rejected": [5, -2]
        }  # fmt: skip
    assert "control_msgs/msg/JointTolerance" not in interface_store().types

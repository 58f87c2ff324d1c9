"""The robot port: orders, clocks and messages; what is recorded is what is sent."""

import dataclasses
import threading
import time

import numpy as np
import pytest
from bridge_runs import MemoryTransport, Running

from crowdbot.bridges import BridgeClock, Inbox, Pace, RobotInterface, run_bridge, steered_trial
from crowdbot.core import InputError
from crowdbot.data import McapReader
from crowdbot.navigation import ExternalNavigator
from crowdbot.recording import read_episode, replay
from crowdbot.trials import load_trial, parse_trial
from web.simulator_session import wait_until

STEP = 50_000_000
NOT_SENT = ("/crowdbot/digest", "/robot/cmd_vel")
"""Recorded topics that are not sent: the digest, and the command, whose topic is an input."""


@pytest.fixture(scope="module")
def trial():
    return load_trial("frontal", duration=3.0)


def drive(transport, forward, turn=0.0, robot="robot"):
    fields = {"linear": {"x": forward}, "angular": {"z": turn}}
    transport.inbox.receive(f"/{robot}/cmd_vel", fields, "test")


class Driver(MemoryTransport):
    """Answers every step with a command that depends on its time."""

    def publish(self, messages):
        super().publish(messages)
        for item in (message for message in messages if message.topic == "/tf"):
            drive(self, 0.4, 0.3 if item.nanoseconds // STEP % 7 < 4 else -0.3)


def recorded(path):
    with path.open("rb") as stream:
        return [(message.topic.topic, message.stamp, bytes(message.data)) for message in McapReader(stream).messages()]


def test_a_steered_run_replays_to_the_byte(trial, tmp_path):
    done = run_bridge(trial, [Driver()], 0, tmp_path, BridgeClock("free"))
    assert replay(done.path).equal
    assert done.digest == read_episode(done.path).digest
    assert done.metrics["path_length"] > 0.8


def test_the_digest_does_not_depend_on_the_name_of_the_transport(trial):
    class Named(Driver):
        def publish(self, messages):
            MemoryTransport.publish(self, messages)
            self.inbox.receive("/robot/cmd_vel", {"linear": {"x": 0.4}}, self.name)

    digests = set()
    for name in ("rosbridge", "foxglove"):
        transport = Named()
        transport.name = name
        digests.add(run_bridge(trial, [transport], 0, None, BridgeClock("free")).digest)
    assert len(digests) == 1


@pytest.mark.parametrize("mode", ["paced", "commands", "step", "follow"])
def test_the_clock_does_not_change_the_result(trial, mode, tmp_path):
    free = run_bridge(trial, [Driver()], 0, tmp_path / "free", BridgeClock("free"))
    driver = Driver()
    with Running(trial, [driver], mode, 40.0 if mode == "paced" else 1.0, tmp_path / mode) as running:
        if mode == "step":
            answers = [driver.call("step_simulation", {"steps": steps}) for steps in (1, 7, 22, 30)]
            assert [answer["result"]["result"] for answer in answers] == [1, 1, 1, 1]
        for k in range(90 if mode == "follow" else 0):
            now = 37_000_000 * k
            driver.inbox.receive("/clock", {"clock": {"sec": now // 10**9, "nanosec": now % 10**9}}, "test")
            time.sleep(0.002)
        done = running.end()
    assert done.outcome == free.outcome
    assert (tmp_path / mode / "episode.mcap").read_bytes() == (tmp_path / "free" / "episode.mcap").read_bytes()


def test_what_is_recorded_is_what_is_sent(trial, tmp_path):
    driver = Driver()
    done = run_bridge(trial, [driver], 0, tmp_path, BridgeClock("free"))
    sent = {(item.topic, item.nanoseconds, item.cdr) for item in driver.sent}
    rows = [row for row in recorded(done.path) if row[0] not in NOT_SENT]
    assert len(rows) > 200
    assert [row[:2] for row in rows if row not in sent] == []
    assert {item.topic for item in driver.sent} == {row[0] for row in rows}
    assert [row[0] for row in rows].count("/map") == 1


def test_topics_keep_the_announced_type_frame_and_rate(tmp_path):
    robot = (
        '<robot name="bot" type="pepper" x="0" y="0" cameras="false"><goal x="9" y="0"/><navigator type="straight"/>'
    )
    text = f'<trial name="all" duration="2"><crowd type="orca"/>{robot}</robot></trial>'
    trial = parse_trial(text, place="all")
    transport = MemoryTransport()
    run_bridge(trial, [transport], 0, None, BridgeClock("free"))
    interface = transport.interfaces[0]
    known = {output.name: output for output in interface.outputs}
    assert {item.topic for item in transport.sent} <= {*known}
    for name, topic in known.items():
        items = [item for item in transport.sent if item.topic == name]
        assert {one.kind for one in items} <= {topic.kind}, name
        frames = {one.message.header.frame_id for one in items if hasattr(one.message, "header")}
        assert frames <= {topic.frame}, name
        if topic.rate:
            steps = max(1, round(1 / topic.rate / trial.step))
            assert len(items) == pytest.approx(2.0 / (steps * trial.step), abs=2), name
        elif topic.quality.latched:
            assert len(items) == 1, name


def test_commands_are_newest_only_and_counted(trial):
    inbox = Inbox(RobotInterface.of(trial))
    for k in range(5000):
        inbox.receive("/robot/cmd_vel", {"linear": {"x": k / 10_000}}, "test")
    (order,) = inbox.take_orders()
    assert (order.forward, order.source) == (0.4999, "test")
    assert inbox.count.received == 5000
    assert inbox.take_orders() == []


def test_a_stamped_velocity_is_read_too(trial):
    inbox = Inbox(RobotInterface.of(trial))
    stamped = {"header": {"frame_id": "base_link"}, "twist": {"linear": {"x": 0.2, "y": 0.1}, "angular": {"z": -1}}}
    inbox.receive("/robot/cmd_vel", stamped, "test")
    assert inbox.take_orders()[0].twist == (0.2, -1.0, 0.1)


@pytest.mark.parametrize(
    ("topic", "fields", "message"),
    [
        ("/robot/cmd_vel", {"linear": {"x": float("nan")}}, "linear.x = 'nan' must be a finite"),
        ("/robot/cmd_vel", {"linear": {"x": "1"}}, "must be a finite number"),
        ("/robot/cmd_vel", {"linear": 3}, "it must be in an object"),
        ("/robot/cmd_vel", {}, "a command needs linear and angular"),
        ("/robot/goal_pose", {"header": {"frame_id": "odom"}, "pose": {}}, "must be in the frame 'map'"),
        ("/robot/goal_pose", {"pose": 1}, "a goal needs pose"),
        ("/crowdbot/order", {"data": "{"}, "an order is not JSON"),
        ("/robot/cmd_vell", {}, "did you mean '/robot/cmd_vel'"),
        ("/robot/cmd_vel", [], "must be an object"),
    ],
)
def test_bad_messages_are_refused_with_a_reason(trial, topic, fields, message):
    inbox = Inbox(RobotInterface.of(trial))
    with pytest.raises(InputError, match=message):
        inbox.receive(topic, fields, "test")
    assert inbox.count.refused == 1


def test_too_many_orders_are_refused(trial):
    inbox = Inbox(RobotInterface.of(trial))
    pose = {"pose": {"position": {"x": 1.0}}}
    for _ in range(2000):
        inbox.receive("/robot/goal_pose", pose, "test")
    with pytest.raises(InputError, match="2000 orders wait"):
        inbox.receive("/robot/goal_pose", pose, "test")


def test_an_impossible_order_is_reported_and_the_run_goes_on(trial):
    class Lost(MemoryTransport):
        def publish(self, messages):
            super().publish(messages)
            if len(self.sent) < 30:
                self.inbox.receive("/crowdbot/order", {"data": '{"order": "remove", "person": 99}'}, "test")

    transport = Lost()
    done = run_bridge(trial, [transport], 0, None, BridgeClock("free"))
    assert done.steps == 60
    assert transport.reports[0][0] == "error"
    assert "99" in transport.reports[0][1]


def test_a_robot_stops_when_no_command_comes(trial):
    class Once(MemoryTransport):
        def publish(self, messages):
            super().publish(messages)
            if messages[-1].nanoseconds == 0:
                drive(self, 0.5)

    transport = Once()
    run_bridge(trial, [transport], 0, None, BridgeClock("free"))
    speeds = [item.message.twist.twist.linear.x for item in transport.sent if item.topic == "/robot/ground_truth/odom"]
    assert max(speeds) == pytest.approx(0.5)
    assert speeds[-1] == 0.0
    assert np.argmax(speeds) <= 11
    assert speeds.index(0.0, 12) <= 10 + 0.5 / 1.0 / 0.05 + 2  # timeout, and braking with 1 m/s^2


def test_only_external_robots_are_driven_if_there_are_some(trial):
    both = dataclasses.replace(
        trial,
        robots=(
            dataclasses.replace(trial.robots[0], name="own"),
            dataclasses.replace(trial.robots[0], name="driven", y=1.0, navigator=ExternalNavigator(timeout=0.2)),
        ),
    )
    assert steered_trial(both) is both
    assert [robot.navigator for robot in steered_trial(trial).robots] == [ExternalNavigator(timeout=0.5)]


def test_robots_have_their_own_name_spaces(trial):
    first = trial.robots[0]
    pair = dataclasses.replace(trial, robots=(first, dataclasses.replace(first, name="second", y=1.0, x=-6.0)))
    names = {output.name for output in RobotInterface.of(pair).outputs}
    assert {"/robot/scan", "/second/scan", "/robot/odom", "/second/odom"} <= names
    assert len(names) == len(RobotInterface.of(pair).outputs)

    class Second(MemoryTransport):
        def publish(self, messages):
            super().publish(messages)
            drive(self, 0.5, robot="second")

    transport = Second()
    run_bridge(pair, [transport], 0, None, BridgeClock("free"))
    places = {}
    for item in transport.sent:
        if item.topic.endswith("ground_truth/odom"):
            places.setdefault(item.topic, []).append(item.message.pose.pose.position.x)
    assert places["/robot/ground_truth/odom"][-1] == first.x
    assert places["/second/ground_truth/odom"][-1] > -5.5


def test_an_external_clock_does_not_go_back(trial):
    transport = MemoryTransport()

    def set_clock(nanoseconds):
        seconds, rest = divmod(nanoseconds, 10**9)
        transport.inbox.receive("/clock", {"clock": {"sec": seconds, "nanosec": rest}}, "test")

    with Running(trial, [transport], "follow"):
        set_clock(10**9)
        wait_until(lambda: any(message.nanoseconds == 10**9 for message in transport.sent))
        set_clock(5 * 10**8)
        wait_until(lambda: transport.reports)
    assert "went back to 0.5 s from 1 s" in transport.reports[0][1]
    assert "/clock" not in {item.topic for item in transport.sent}


def test_a_run_that_cannot_keep_up_says_so(trial):
    class Slow(MemoryTransport):
        def publish(self, messages):
            super().publish(messages)
            threading.Event().wait(0.1)

    now = iter(range(10**6))
    pace = Pace(0.05, 1.0, monotonic=lambda: next(now) * 1.0)
    remarks = [pace.note_step() for _ in range(8)]
    assert next(remark for remark in remarks if remark) == "the run cannot keep up: 0.06 instead of 1 times real time"
    transport = Slow()
    assert run_bridge(load_trial("frontal", duration=0.5), [transport], 0).steps == 10


@pytest.mark.parametrize(
    ("values", "message"), [(("later",), "there is no clock 'later'"), (("paced", 0.0), "must be above 0")]
)
def test_a_bad_clock_is_refused(values, message):
    with pytest.raises(InputError, match=message):
        BridgeClock(*values)


def test_the_trial_of_the_episode_has_the_external_robot(trial, tmp_path):
    done = run_bridge(trial, [], 0, tmp_path, BridgeClock("free"))
    assert 'type="external"' in read_episode(done.path).xml


class LateProgram(MemoryTransport):
    """A program whose first answers are lost, and which answers what is sent again."""

    def publish(self, messages):
        super().publish(messages)
        for item in (message for message in messages if message.topic == "/tf"):
            if sum(item.nanoseconds == other.nanoseconds for other in self.sent if other.topic == "/tf") > 1 or (
                item.nanoseconds not in (0, 100_000_000)
            ):
                turn = 0.3 if item.nanoseconds % 150_000_000 else -0.3
                self.inbox.receive("/robot/cmd_vel", {"linear": {"x": 0.4}, "angular": {"z": turn}}, "memory")


def test_an_instant_whose_commands_are_lost_is_sent_again_and_the_result_is_the_same():
    trial, late = load_trial("frontal", duration=0.5), LateProgram()
    with Running(trial, [late], "commands") as running:
        done = running.end()
    times = [item.nanoseconds for item in late.sent if item.topic == "/tf"]
    assert [times.count(k) for k in range(0, 300_000_000, 50_000_000)] == [2, 1, 2, 1, 1, 1]

    class Prompt(LateProgram):
        def publish(self, messages):
            for item in (message for message in messages if message.topic == "/tf"):
                turn = 0.3 if item.nanoseconds % 150_000_000 else -0.3
                self.inbox.receive("/robot/cmd_vel", {"linear": {"x": 0.4}, "angular": {"z": turn}}, "memory")

    assert run_bridge(trial, [Prompt()], 0, None, BridgeClock("free")).digest == done.digest

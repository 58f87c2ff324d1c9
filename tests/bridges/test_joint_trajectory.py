"""Joints follow trajectories of other programs in time, over the encodings of all transports."""

import math

import numpy as np
import pytest
from bridge_runs import MemoryTransport

from crowdbot.bridges import BridgeClock, Inbox, RobotInterface, fields_of, interface_store, message_of, run_bridge
from crowdbot.core import InputError
from crowdbot.messages import Ros1Messages
from crowdbot.recording import replay
from crowdbot.trials import parse_trial

KIND = "trajectory_msgs/msg/JointTrajectory"
TOPIC = "/pepper/joint_trajectory"


def lab(duration=1.5, world="planar"):
    return parse_trial(f"""<trial name="lab" duration="{duration}" step="0.05" world="{world}"><crowd type="orca"/>
      <robot name="pepper" type="pepper" x="0" y="0" default-sensors="false"><goal x="9" y="0"/>
        <navigator type="external"/></robot>
      <recording period="0.05"/>
    </trial>""")


def trajectory(*points, joints=("HeadYaw",), stamp=0.0):
    """Return the fields of a message from points: time [s], positions, and velocities if any."""

    def duration(seconds):
        return {"sec": int(seconds // 1), "nanosec": round(seconds % 1 * 1e9)}

    rows = [
        {"time_from_start": duration(time), "positions": list(positions), "velocities": list(*velocities)}
        for time, positions, *velocities in points
    ]
    return {"header": {"stamp": duration(stamp)}, "joint_names": list(joints), "points": rows}


class Sender(MemoryTransport):
    """Sends messages at instants [s] on topics of joints, and keeps the positions of a joint."""

    def __init__(self, sent):
        super().__init__()
        self.plan = {round(time * 1e9): message for time, message in sent.items()}

    def publish(self, messages):
        super().publish(messages)
        topic, fields = self.plan.pop(messages[-1].nanoseconds, (None, None))
        if topic is not None:
            self.inbox.receive(topic, fields, self.name)

    def positions(self, joint="HeadYaw"):
        """Return the positions of a joint by time [s]."""
        rows = [item for item in self.sent if item.topic == "/pepper/joint_states"]
        return {round(one.nanoseconds / 1e9, 3): one.message.position[one.message.name.index(joint)] for one in rows}


def follow(fields, trial=None, out=None, then=None):
    """Return the sender and the summary of a run with a trajectory at 0.2 s, and other messages by time."""
    sender = Sender({0.2: (TOPIC, fields), **(then or {})})
    done = run_bridge(trial or lab(), [sender], 0, out, BridgeClock("free"))
    return sender, done


def test_positions_are_joined_by_lines_from_the_state_of_the_robot_on(tmp_path):
    fields = trajectory((0.4, (0.8, 0.2)), (0.8, (-0.4, 0.2)), joints=("HeadYaw", "HeadPitch"))
    sender, done = follow(fields, out=tmp_path)
    times = np.array([*sender.positions()])
    expected = np.interp(times - 0.2, [0.0, 0.4, 0.8], [0.0, 0.8, -0.4])
    np.testing.assert_allclose([*sender.positions().values()], expected, atol=1e-12)
    np.testing.assert_allclose(
        [*sender.positions("HeadPitch").values()], np.interp(times - 0.2, [0.0, 0.4], [0.0, 0.2]), atol=1e-12
    )
    assert sender.reports == []
    assert replay(done.path).equal


def test_positions_with_velocities_are_joined_by_cubic_splines():
    sender, _ = follow(trajectory((0.4, (0.5,), (1.0,)), (1.0, (1.0,), (0.0,))))
    positions = sender.positions()
    share = 0.25 / 0.4  # by hand: Hermite from 0 at rest to 0.5 with 1 rad/s
    wanted = 0.5 * (3 * share**2 - 2 * share**3) + 0.4 * 1.0 * (share**3 - share**2)
    assert positions[0.45] == pytest.approx(wanted)
    assert (positions[0.6], positions[1.2], positions[1.5]) == pytest.approx((0.5, 1.0, 1.0))
    assert positions[0.9] == pytest.approx(0.75 + 0.6 / 8 * (1.0 - 0.0))  # the middle of the second spline


def test_a_spline_stays_within_the_limits_of_the_joint():
    sender, _ = follow(trajectory((0.4, (2.0,), (8.0,)), (0.8, (2.0,), (0.0,))))
    assert max(sender.positions().values()) == pytest.approx(2.08567)
    assert sender.reports == []


def test_the_times_count_from_the_stamp_and_what_is_over_is_left_out():
    sender, _ = follow(trajectory((0.1, (0.3,)), (0.6, (0.8,)), stamp=0.5))
    assert [sender.positions()[time] for time in (0.2, 0.4, 0.6, 0.8, 1.1)] == pytest.approx([0.0, 0.15, 0.3, 0.5, 0.8])
    sender, _ = follow(trajectory((0.0, (0.3,)), (0.6, (0.9,)), stamp=0.1))
    assert [sender.positions()[time] for time in (0.2, 0.25, 0.7)] == pytest.approx([0.0, 0.45, 0.9])


def test_a_newer_trajectory_continues_the_motion_and_a_joint_command_ends_it():
    first = trajectory((1.0, (1.0,)))
    newer = (TOPIC, trajectory((0.4, (0.0,), (0.0,))))
    sender, _ = follow(first, then={0.6: newer})
    assert sender.positions()[0.6] == pytest.approx(0.4)
    assert sender.positions()[0.65] == pytest.approx(0.42109375)  # it still moves forward at first
    assert sender.positions()[1.0] == pytest.approx(0.0)
    command = ("/pepper/joint_command", {"name": ["HeadYaw"], "position": [-0.2]})
    sender, _ = follow(first, then={0.6: command})
    assert [sender.positions()[time] for time in (0.6, 0.65, 1.5)] == pytest.approx([0.4, -0.2, -0.2])


def test_motors_of_the_physics_world_follow():
    sender, _ = follow(trajectory((0.8, (0.6,))), lab(1.4, "physics"))
    positions = sender.positions()
    assert positions[0.6] == pytest.approx(0.3, abs=0.12)
    assert positions[1.4] == pytest.approx(0.6, abs=0.03)


@pytest.mark.parametrize("encoding", ["json", "cdr", "ros1"])
def test_each_encoding_gives_the_same_motion(encoding):
    fields = trajectory((0.25, (0.4,), (0.5,)), (0.75, (0.5,), (0.0,)))
    expected = follow(fields)[0].positions()
    if encoding == "cdr":  # ros2, foxglove
        data = interface_store().serialize_cdr(message_of(fields, KIND), KIND)
        fields = fields_of(interface_store().deserialize_cdr(data, KIND))
    elif encoding == "ros1":
        data = Ros1Messages().of_cdr(bytes(interface_store().serialize_cdr(message_of(fields, KIND), KIND)), KIND)
        fields = fields_of(Ros1Messages().message(data, KIND))
    assert follow(fields)[0].positions() == expected


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"points": []}, "needs points, from 1 to 1000"),
        ({"points": [3]}, r"points\[0\] is a int, it must be an object"),
        ({"joint_names": []}, "joint_names must be a list of names of joints"),
        ({"joint_names": ["HeadYaw", "HeadYaw"]}, "joint_names has a joint twice: HeadYaw"),
        ({"points": [{}]}, r"points\[0\].positions has 0 numbers, it must have 1"),
        ({"points": [{"positions": [math.inf]}]}, "must be a finite number"),
        ({"points": [{"positions": [0], "velocities": [0, 1]}]}, "velocities has 2 numbers, it must have 1"),
        ({"points": [{"positions": [0]}] * 2}, r"points\[1\] is 0 s, but it must be later than the 0 s of points\[0\]"),
        (trajectory((0.5, (0,)), (0.2, (0,))), r"points\[1\] is 0.2 s, but it must be later than the 0.5 s"),
        (trajectory((-1.0, (0,))), r"points\[0\] is -1 s, below 0"),
        (trajectory((0.5, (0,), (0.1,))), "the last velocity of 'HeadYaw' is 0.1, but it must be 0"),
        ({"header": {"stamp": {"sec": 2**40}}}, "header.stamp: 1.09951e"),
    ],
)
def test_a_message_that_cannot_be_followed_is_refused_with_its_place(change, message):
    inbox = Inbox(RobotInterface.of(lab()))
    with pytest.raises(InputError, match=message):
        inbox.receive(TOPIC, trajectory((0.5, (0.1,))) | change, "test")
    assert inbox.take_orders() == []


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        (
            trajectory((0.5, (0.1,)), joints=("HeadYow",)),
            "that can be moved, did you mean 'HeadYaw'?",
        ),
        (trajectory((0.5, (0.1,)), (0.6, (9.0,))), "'HeadYaw' of pepper cannot be at 9 rad"),
        (trajectory((0.05, (0.1,)), stamp=0.1), "it ends at 0.15 s, before the current time 0.2 s"),
        (trajectory((0.5, (0.1,)), stamp=1.7e9), "after the end of the trial at 1.5 s; stamps are simulated time"),
    ],
)
def test_a_trajectory_that_the_robot_cannot_follow_is_reported_as_a_whole(fields, message):
    sender, _ = follow(fields)
    ((level, text),) = sender.reports
    assert (level, message in text) == ("error", True), text
    assert {*sender.positions().values()} == {0.0}

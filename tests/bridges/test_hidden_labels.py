"""What robot software that is scored may see: one rule for all topics; no reading says who was met."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from bridge_runs import MemoryTransport
from test_interface_page import load_tool

from crowdbot.bridges import Inbox, RobotInterface
from crowdbot.bridges.foxglove.session import FoxgloveGraph
from crowdbot.bridges.joint_actions import ABORTED, INVALID_GOAL, goal_end
from crowdbot.bridges.rosbridge.graph import RosGraph
from crowdbot.bridges.stack_link import StackPort
from crowdbot.core import InputError
from crowdbot.messages import Messages, Ros1Messages
from crowdbot.messages.point_clouds import points_in
from crowdbot.simulation import Simulation
from crowdbot.trials import parse_trial

TRIAL = """<trial name="met" duration="2" world="planar"><stage/><crowd type="orca"/>
<agent x="0.65" y="0" goal="3,0"/>
<robot name="robot" x="0" y="0" radius="0.3"><goal x="5" y="0"/><drive type="differential-drive"/>
<navigator type="straight" speed="0.01"/>
<sensor name="scan" type="lidar2d" rays="60" rate="20"/>
<sensor name="pulses" type="pulsed-lidar2d" rays="60" rate="20"/>
<sensor name="cloud" type="lidar3d" columns="60" elevations="-0.08 0.08" rate="20"/>
<sensor name="touch" type="bumper" rate="20"/></robot></trial>"""


def sent(truth, trial=None):
    """Return the messages of a run of 5 steps by topic, the latest of each."""
    simulation = Simulation(trial or parse_trial(TRIAL), 0)
    memory = MemoryTransport()
    port = StackPort(simulation.trial, [memory], ["robot"], truth)
    port.start()
    simulation.begin()
    port.begin(simulation)
    for _ in range(5):
        port.publish(simulation)
        simulation.advance()
    return {item.topic: item.message for item in memory.sent}


@pytest.mark.parametrize("truth", [False, True])
def test_a_scan_says_whom_it_met_only_with_the_truth(truth):
    scan = sent(truth)["/robot/scan"]
    met = np.flatnonzero(np.isfinite(scan.ranges) & (scan.ranges < 1.0))
    assert len(met) > 0
    if truth:
        assert set(scan.intensities[met].tolist()) == {0.0}
        assert len(scan.intensities) == len(scan.ranges)
    else:
        assert len(scan.intensities) == 0


@pytest.mark.parametrize("topic", ["/robot/cloud", "/robot/touch"])
def test_the_points_of_a_cloud_have_a_label_only_with_the_truth(topic):
    hidden, labelled = sent(False)[topic], sent(True)[topic]
    names = [field.name for field in labelled.fields]
    assert "label" in names
    assert [field.name for field in hidden.fields] == [name for name in names if name != "label"]
    assert hidden.point_step == labelled.point_step
    assert len(hidden.data) == len(labelled.data)
    rows, told = points_in(hidden), points_in(labelled)
    for name in rows.dtype.names:
        np.testing.assert_array_equal(rows[name], told[name])
    at = next(field.offset for field in labelled.fields if field.name == "label")
    data = np.asarray(hidden.data, dtype=np.uint8).reshape(-1, hidden.point_step)
    assert not data[:, at : at + 4].any()  # nor between the fields


def test_received_power_is_a_measurement_and_stays():
    scans = [sent(truth)["/robot/pulses"].intensities for truth in (False, True)]
    assert len(scans[0]) == 60
    np.testing.assert_array_equal(*scans)


def test_a_hidden_scan_can_be_encoded_for_both_generations_of_ros():
    messages = sent(False)
    for topic in ("/robot/scan", "/robot/cloud", "/robot/touch"):
        kind, data = messages[topic].__msgtype__, Messages().encode_message(messages[topic])
        assert Messages().decode_message(data, kind).header.frame_id == topic[1:]
        assert Ros1Messages().message(Ros1Messages().of_cdr(data, kind), kind).header.frame_id == topic[1:]


MEASURED = {"", "/image", "/camera_info"}
"""Ends of the topics of a sensor that a real robot has, too."""


@pytest.fixture(scope="module")
def everything():
    """A trial with every kind of sensor, a robot without odometry beside it, and people."""
    trial = load_tool().example_trial()
    (robot,) = trial.robots
    other = dataclasses.replace(robot, name="other", x=robot.x + 3.0, sensors=())
    return dataclasses.replace(trial, robots=(robot, other))


def test_without_the_truth_only_what_a_real_robot_has_is_offered_and_sent(everything):
    robot = everything.robots[0]
    allowed = {"/clock", "/tf", "/tf_static", "/map", "/robot/goal", "/robot/robot_description", "/robot/joint_states"}
    assert any(mount.sensor.encoders for mount in robot.sensors)
    allowed |= {"/robot/odom"}
    hidden = [mount.name for mount in robot.sensors if type(mount.sensor).__name__ == "GroundTruthPeople"]
    assert hidden
    allowed |= {
        f"/robot/{sensor.name}{end}" for sensor in robot.sensors if sensor.name not in hidden for end in MEASURED
    }
    port = StackPort(everything, [], ["robot"])
    offered = {output.name for output in port.interface.outputs}
    assert offered <= allowed
    messages = sent(False, everything)
    assert {*messages} <= offered
    assert {f"/robot/{sensor.name}" for sensor in robot.sensors if sensor.name == "scan"} <= {*messages}
    rows = messages["/tf"].transforms
    assert {row.child_frame_id.partition("/")[0] for row in rows} == {"robot"}
    inbox = Inbox(port.interface)
    rosbridge, foxglove = RosGraph(port.interface, inbox, print), FoxgloveGraph(port.interface, inbox, print)
    inputs = {input_topic.name for input_topic in port.interface.inputs}
    assert {*rosbridge.topics} - inputs == {*foxglove.channels} == offered


def test_the_joints_of_other_robots_cannot_be_moved_and_goals_end_with_the_run(everything):
    simulation = Simulation(everything, 0)
    port = StackPort(everything, [MemoryTransport()], ["robot"], truth=True)
    port.start()
    assert [action.name for action in port.interface.actions] == ["/robot/follow_joint_trajectory"]
    points = [{"positions": [0.5], "time_from_start": {"sec": 9, "nanosec": 0}}]
    goal, answers = {"trajectory": {"joint_names": ["HeadYaw"], "points": points}}, []
    with pytest.raises(InputError, match="there is no service '/other/follow_joint_trajectory'"):
        port.inbox.call("/other/follow_joint_trajectory", goal, answers.append, "test")
    simulation.begin()
    port.begin(simulation)
    port.inbox.call("/robot/follow_joint_trajectory", goal, answers.append, "test")
    port.serve(simulation)
    port.inbox.call("/robot/follow_joint_trajectory", goal, answers.append, "test")
    port.stop()
    assert answers == [goal_end(ABORTED, INVALID_GOAL, "the run has ended")] * 2


def test_with_the_truth_everything_of_its_robots_and_the_scene_is_offered(everything):
    offered = {output.name for output in StackPort(everything, [], ["robot"], truth=True).interface.outputs}
    whole = [output for output in RobotInterface.of(everything).outputs if output.robot in ("", "robot")]
    assert offered == {item.name for item in whole} | {"/robot/goal"}
    assert {transform.child_frame_id for transform in sent(True, everything)["/tf"].transforms} >= {"other/base_link"}


def test_a_robot_without_a_sensor_of_odometry_has_exact_odometry():
    trial = parse_trial(TRIAL)
    assert "/robot/odom" in sent(False, trial)
    assert "/robot/ground_truth/odom" not in sent(False, trial)


def test_no_message_changes_with_the_numbers_of_the_people():
    people = [f'<agent x="{x}" y="{y}" goal="{3 * x},{3 * y}"/>' for x, y in ((0.65, 0.0), (0.0, 0.9), (-0.8, 0.3))]
    one = '<agent x="0.65" y="0" goal="3,0"/>'
    flat = TRIAL.replace('<sensor name="cloud" type="lidar3d" columns="60" elevations="-0.08 0.08" rate="20"/>', "")
    assert flat != TRIAL  # in space, the shape of a person follows from the number
    runs = [sent(False, parse_trial(flat.replace(one, "".join(order)))) for order in (people, people[::-1])]
    assert runs[0].keys() == runs[1].keys()
    for topic in runs[0]:
        first, second = (Messages().encode_message(run[topic]) for run in runs)
        assert first == second, topic

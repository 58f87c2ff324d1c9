"""Robot software that is scored gets readings that do not say who was met; the same port with the truth does."""

from __future__ import annotations

import numpy as np
import pytest
from bridge_runs import MemoryTransport

from crowdbot.bridges.stack_link import StackPort
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


def sent(truth):
    """Return the messages of a run of 5 steps by topic, the latest of each."""
    simulation = Simulation(parse_trial(TRIAL), 0)
    memory = MemoryTransport()
    port = StackPort(simulation.trial, [memory], ["robot"], truth)
    port.start()
    simulation.begin()
    port.begin(simulation)
    for _ in range(5):
        port.publish(simulation)
        simulation.advance()
    return {one.topic: one.message for one in memory.sent}


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

"""Motion capture in virtual reality: a suit below a headset, and a person without a headset in the same experiment."""

from __future__ import annotations

import contextlib
import math
import socket
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from headset_sessions import Headset, open_session, phase, until

from crowdbot.bridges import MotionSample, PoseStream
from crowdbot.bridges.motion_capture.xsens import SEGMENTS, xsens_skeleton
from crowdbot.core import InputError
from crowdbot.humans import Gait, People, eye_offsets, reach_poses, rest_skeleton
from crowdbot.recording import read_episode, replay
from crowdbot.vr import RigidTransform, Suit, read_headset_recording

SENDER = Path(__file__).parents[2] / "examples" / "send_xsens.py"
TRIAL = """<trial name="meet" duration="{duration}"><stage/><crowd type="orca"/>
<avatar name="guest" source="external" x="1" y="0.5" body="man-30"{more}/>
<robot name="robot" type="turtlebot2" x="4" y="-4"><goal x="-5" y="-4"/><navigator type="straight" speed="0.1"/></robot>
<end goal="false" collision="false"/></trial>"""
EXPERIMENT = """<experiment name="visit"><instructions name="hello" text="Please stand."/>
<block name="main"><trial name="real" source="real.xml"/><trial name="virtual" source="virtual.xml"/></block>
</experiment>"""


class Stream(PoseStream):
    """A suit that is seen by the test."""

    live = True

    def __init__(self):
        self.sample = None

    def subjects(self):
        return ("Anna",)

    def read(self, subject, now, ahead):
        found, self.sample = self.sample, None
        return [] if found is None else [(now - 0.01, found)]


def actor(number, time, x, y, yaw, skeleton):
    """Return an actor with the left arm raised ahead, at a place and heading of the suit."""
    turn = RigidTransform.at(x, y, yaw)
    rotation = np.tile(turn.rotation, (len(SEGMENTS), 1, 1))
    arm = [SEGMENTS.index(f"Left{name}") for name in ("UpperArm", "ForeArm", "Hand")]
    rotation[arm] = turn.rotation @ RigidTransform.at(0.0, 0.0, -0.5 * math.pi).rotation
    return MotionSample(number, time, turn.apply(skeleton.rest), rotation, skeleton)


def test_the_suit_gives_the_body_and_the_headset_its_place():
    people, stream, skeleton = People.of(["man-20"]), Stream(), xsens_skeleton()
    suit = Suit(stream)
    suit.dress(people, 0)
    head = np.array([1.0, 2.0, 1.63, math.cos(0.25), 0.0, 0.0, math.sin(0.25)])  # heading 0.5
    assert suit.pose(head, 0.0, 0.05) is None
    for k in range(200):  # the suit drifts by 0.1 m/s and 0.02 rad/s
        stream.sample = actor(k, 0.05 * k, 30.0 + 0.005 * k, -5.0, 2.0 + 0.001 * k, skeleton)
        found = suit.pose(head, 0.05 * k, 0.05 * (k + 1))
    assert abs(found.heading - 0.5) < 0.25  # 0.02 rad/s for the 10 s of the time constant
    gait = Gait(people)
    posture = reach_poses(gait.posture(gait.start([[0.0, 0.0]], [0.0])), people, {0: found.row()})
    eyes = eyes_of(posture, people)
    assert np.hypot(*(eyes[:2] - head[:2])) < 0.25  # 0.1 m/s for the 2 s of the time constant
    hand, elbow = posture.position[0, 9] - posture.position[0, 7], posture.position[0, 16] - posture.position[0, 14]
    assert hand @ [math.cos(found.heading), math.sin(found.heading), 0.0] > 0.45  # the raised arm points ahead
    assert abs(elbow @ [math.cos(found.heading), math.sin(found.heading), 0.0]) < 0.1
    assert suit.raw()["number"] == 199
    assert np.array(suit.raw()["rotation"]).shape == (23, 4)
    assert suit.pose(head, 10.15, 10.2) is not None
    assert suit.pose(head, 10.5, 10.55) is None  # silent for longer than 0.25 s


def test_a_still_suit_is_exactly_where_the_headset_is():
    people, stream, skeleton = People.of(["woman-36"]), Stream(), xsens_skeleton()
    suit = Suit(stream)
    suit.dress(people, 0)
    for k in range(5):
        stream.sample = actor(k, 0.05 * k, 30.0, -5.0, 2.0, skeleton)
        found = suit.pose(np.array([1.0, 2.0, 1.6, 1.0, 0.0, 0.0, 0.0]), 0.05 * k, 0.05 * (k + 1))
    gait = Gait(people)
    posture = reach_poses(gait.posture(gait.start([[0.0, 0.0]], [0.0])), people, {0: found.row()})
    eyes = eyes_of(posture, people)
    assert found.heading == pytest.approx(0.0, abs=1e-6)
    assert eyes[:2] == pytest.approx([1.0, 2.0], abs=1e-5)


def eyes_of(posture, people):
    """Return the middle between the eyes of the only person."""
    head = rest_skeleton(people).bone("head")
    return posture.position[0, head] + posture.rotation[0, head] @ eye_offsets(people)[0]


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


@contextlib.contextmanager
def xsens_sender(port):
    """Let the example send what a suit sends, of an actor who walks."""
    words = [sys.executable, str(SENDER), str(port), "600"]
    with subprocess.Popen(words, stdout=subprocess.DEVNULL) as sender:
        yield sender
        sender.kill()


def skeletons(path):
    return [
        order.skeleton is not None for _, order in read_episode(path).orders if type(order).__name__ == "AvatarOrder"
    ]


@pytest.mark.live
def test_one_trial_without_and_one_with_a_headset(tmp_path):
    """In the first trial the suit alone moves the person, and a sleeping headset is no loss; then both do together."""
    files = {
        "visit.xml": EXPERIMENT, "meet.xml": TRIAL.format(duration=300, more=""),
        "real.xml": TRIAL.format(duration=2, more=' headset="false"'),
        "virtual.xml": TRIAL.format(duration=3, more=""),
    }  # fmt: skip
    port = free_port()
    with open_session(tmp_path / "files", files) as session, xsens_sender(port) as sender:
        desk, vr = session.desk("experiments"), session.desk("vr")
        with pytest.raises(InputError, match="expected xsens:PORT=NAME"):
            vr.add_capture("../walk.bvh=guest")
        vr.set({"timeout": 1.0, "pause_when_lost": True})
        desk.open("visit.xml", 1)
        guest = Headset(vr)
        vr.add_capture(f"xsens:{port}=guest")
        with pytest.raises(InputError, match="moves 'guest' already"):
            vr.add_capture("xsens:0=guest")
        until(lambda: vr.state()["captures"][0]["samples"] > 3)
        take = guest.person.take
        guest.person.take = lambda data: {"clock": [0.0, 0.0, 0.0]}  # the headset is put down
        desk.finish_screen(desk.greet()["index"], {})
        state = until(lambda: (found := desk.greet()) and len(found["outcomes"]) == 1 and found)
        assert state["phase"] != "aborted"
        guest.person.take = take
        vr.set({"timeout": 8.0})
        if state["phase"] == "pause":
            vr.resume()
        until(lambda: guest.person.summary()["steps"] > 20)
        sender.kill()  # the suit is silent: the headset alone moves the person
        state = phase(desk, "done", "aborted")
        assert state["phase"] == "done"
        guest.stop()
        vr.remove_capture(f"xsens:{port}=guest")
        assert vr.state()["captures"] == []
        desk.leave()
    home = tmp_path / "files" / "experiments" / "visit" / "participant-001"
    real, virtual = home / "001-real", home / "002-virtual"
    found = skeletons(real / "episode.mcap")
    assert len(found) > 20
    assert all(found)
    assert not (real / "guest.headset").exists()
    raw = [item.note for item in read_headset_recording(real / "motion-capture.headset")]
    assert len(raw) >= len(found)
    assert all(len(item["position"]) == 23 and len(item["rotation"]) == 23 for item in raw)
    both = skeletons(virtual / "episode.mcap")
    assert sum(both) > 10
    assert not both[-1]
    orders = [order for _, order in read_episode(virtual / "episode.mcap").orders if order.skeleton is not None]
    assert all(order.head is not None for order in orders)
    notes = [item.note for item in read_headset_recording(virtual / "guest.headset") if item.note]
    assert sum("suit" in note for note in notes) == sum(both)
    assert replay(virtual / "episode.mcap").equal
    assert replay(real / "episode.mcap").equal

"""A participant in a headset in the session of an experiment: seats, bodies, recordings, pauses, withdrawal."""

import json

import numpy as np
import pytest
from headset_sessions import Headset, open_session, phase, until

from crowdbot.core import InputError
from crowdbot.experiments import read_log, withdraw
from crowdbot.recording import read_episode, replay
from crowdbot.vr import read_headset_recording

EXPERIMENT = """<experiment name="visit"><instructions name="consent" text="Do you take part?">
<choice name="agree" text="Yes or no?"><option value="yes"/><option value="no" ends="true"/></choice></instructions>
<block name="main"><trial name="meet" source="meet.xml"/><after name="rating">
<scale name="comfort" text="How comfortable?" low="1" high="5"/></after></block></experiment>"""
TRIAL = """<trial name="meet" duration="{duration}"><stage/><crowd type="orca"/>
<avatar name="guest" source="external" x="1" y="0.5" body="man-30"/>
<agent x="4" y="1.2" goal="-5,1.2"/><robot name="robot" type="turtlebot2" x="4" y="-1"><goal x="-5" y="-1"/>
<navigator type="straight" speed="0.5"/></robot><end goal="false" collision="false"/></trial>"""


@pytest.fixture
def session(tmp_path):
    """A session with an experiment of one trial; the duration of the trial is in the file."""
    with open_session(tmp_path / "files", {"visit.xml": EXPERIMENT, "meet.xml": TRIAL.format(duration=1)}) as opened:
        yield opened


@pytest.mark.live
def test_a_session_from_consent_to_the_answer_and_its_withdrawal(session):
    desk, vr, folder = session.desk("experiments"), session.desk("vr"), session.workspace.folder
    vr.set({"timeout": 8.0, "pause_when_lost": False})  # a busy machine is not a lost headset
    desk.open("visit.xml", 1)
    guest = Headset(vr)
    assert guest.person.avatar == "guest"
    index = desk.greet()["index"]
    desk.draft(index, {"agree": "yes", "other": 1})
    assert desk.greet()["answers"] == {"agree": "yes"}
    with pytest.raises(InputError, match="not at the screen of step 7"):
        desk.finish_screen(7, {"agree": "yes"})
    bones = {"left": (0.0, 0.70, 1.42), "right": (0.0, -0.70, 1.42)}
    guest.head, guest.hands = (0.0, 0.0, 1.63), bones
    until(lambda: len(guest.person.history(40)) == 40 and guest.person.history(40)[0].left is not None)
    pose = vr.take_pose("guest")
    assert pose.pose == "T"
    guest.head, guest.hands = (0.1, 0.0, 1.6), {}
    desk.finish_screen(index, {"agree": "yes"})
    state = phase(desk, "screen")
    assert [item["name"] for item in state["questions"]] == ["comfort"]
    guest.head = (0.2, 0.0, 1.6)
    desk.finish_screen(state["index"], {"comfort": 4})
    assert phase(desk, "done")
    one = folder / "experiments" / "visit" / "participant-001"
    records = read_log(one / "session.jsonl")
    events = [(record.get("event"), record.get("value")) for record in records if "event" in record]
    assert events.count(("answered", "yes")) == 1  # the draft is not in the log
    assert ("answered", 4) in events
    episode = one / "001-meet" / "episode.mcap"
    orders = [order for _, order in read_episode(episode).orders]
    assert {order.avatar for order in orders} == {"guest"}
    assert replay(episode).equal
    assert f'height="{pose.stature}"' in read_episode(episode).metadata["trial"]
    raw = list(read_headset_recording(one / "001-meet" / "guest.headset"))
    assert sum(record.sample is not None for record in raw) > 10
    steps = [record.note for record in raw if record.note and "step" in record.note]
    assert steps[0]["pose"][:2] == pytest.approx([orders[0].x, orders[0].y])
    guest.stop()
    desk.leave()
    assert list((folder / ".running").glob("vr-*")) == []
    withdraw(one.parent, 1)
    assert not one.exists()
    assert list(folder.rglob("*.headset")) == []


@pytest.mark.live
def test_losses_pause_the_session_and_stops_hold_the_robot(session):
    folder = session.workspace.folder
    (folder / "meet.xml").write_text(TRIAL.format(duration=300))
    desk, vr = session.desk("experiments"), session.desk("vr")
    vr.set({"timeout": 3.0})
    session.desk("simulator").visit({})  # a window opens the first trial
    guest = Headset(vr)  # in the trial of the simulator first
    desk.open("visit.xml", 1)
    until(lambda: vr.state()["experiment"])
    assert session.desk("simulator").run.loop.paused
    assert "guest" not in session.desk("simulator").run.controls
    desk.finish_screen(desk.greet()["index"], {"agree": "yes"})
    until(lambda: vr.state()["participants"][0]["steps"] > 3)
    run = desk._run
    assert vr.stop_robots() == ["robot"]

    def speed():
        scene = run.simulation.world.environment_scene(0)
        return float(np.hypot(*scene.velocity[0, run.simulation.robots[0].agent]))

    until(lambda: speed() < 1e-6)
    vr.release_robots()
    until(lambda: speed() > 0.1)
    vr.limit_room("robot", [[-50, -50], [50, -50], [50, -0.9], [-50, -0.9]])  # the robot is 0.1 m inside
    until(lambda: "robots are stopped" in vr.state()["warnings"])
    guest.person.take = lambda data: {"clock": [0.0, 0.0, 0.0]}  # a headset that sleeps
    state = phase(desk, "pause")
    assert state["reason"] == "tracking of guest was lost"
    until(lambda: vr.state()["pause"] == {"kind": "tracking", "avatar": "guest"})
    del guest.person.take
    desk.resume()  # by the experiments tab
    assert phase(desk, "running")
    until(lambda: vr.state()["pause"] is None)
    until(lambda: not any("tracking" in item for item in vr.state()["warnings"]))
    guest.stop(cut=True)
    assert phase(desk, "pause")["reason"] == "guest is gone"
    again = Headset(vr)  # the net is back: the same avatar, another file
    vr.resume()
    before = again.person.summary()["steps"]
    until(lambda: again.person.summary()["steps"] > before + 3)
    vr.pause("guest")
    state = desk.greet()
    assert (state["phase"], state["reason"]) == ("pause", "guest asked for it")
    assert vr.state()["pause"] == {"kind": "asked", "avatar": "guest"}
    vr.resume()
    vr.pause()
    state = desk.greet()
    assert (state["phase"], state["reason"], vr.state()["pause"]) == ("pause", "virtual reality", None)
    again.stop()
    desk.abort("the test is over")
    until(lambda: not vr.state()["experiment"])
    names = sorted(item.name for item in folder.rglob("participant-001/*/*.headset"))
    assert names == ["guest-2.headset", "guest.headset"]


def test_rooms_are_saved_and_loaded(session):
    vr = session.desk("vr")
    for x, y in ((0, 0), (2, 0), (2, 3)):
        vr.add_pair("person", [x, y, 1], [x + 5, y - 1, 1])
    vr.calibrate("person")
    vr.limit_room("robot", [[0, 0], [4, 0], [4, 3]])
    assert vr.save_rooms("lab") == "lab.json"
    before = json.loads(json.dumps(vr.rooms.record()))
    vr.clear_points("person")
    vr.limit_room("robot", [])
    vr.load_rooms("lab")
    assert json.loads(json.dumps(vr.rooms.record())) == before
    assert vr.rooms.rooms["person"].fit.rms < 1e-9
    file = session.workspace.folder / "lab.json"
    for text, word in (("{", "is not JSON"), ('{"hall": {}}', "must have the keys"), ('{"robot": {"x": 1}}', "damaged"),
                       ('{"robot": 3}', "damaged")):  # fmt: skip
        file.write_text(text)
        with pytest.raises(InputError, match=word):
            vr.load_rooms("lab")
    assert json.loads(json.dumps(vr.rooms.record())) == before

"""Two headsets in one trial: each has an avatar, and a room with an origin and a calibration of its own."""

import pytest
from headset_sessions import Headset, open_session, until

from crowdbot.core import InputError
from crowdbot.vr import SharedRooms

TRIAL = """<trial name="meet" duration="600"><stage/><crowd type="orca"/>
<avatar name="first" source="external" x="1" y="0.5" body="man-30"/>
<avatar name="second" source="external" x="-2" y="-1" heading="1.5707963" body="woman-36"/>
<avatar name="tracked" source="external" x="-2" y="3" headset="false"/>
<agent x="4" y="6" goal="-5,6"/><end collision="false"/></trial>"""


def place(person):
    return person.summary().get("place")


@pytest.mark.live
def test_each_headset_has_its_own_avatar_and_room(tmp_path):
    with open_session(tmp_path / "files", {"meet.xml": TRIAL}) as session:
        vr = session.desk("vr")
        session.desk("simulator").visit({})
        vr.set({"timeout": 8.0, "pause_when_lost": False})
        one = Headset(vr)
        two = Headset(vr)
        assert (one.person.avatar, two.person.avatar) == ("first", "second")
        assert (one.person.room, two.person.room) == ("person", "person second")
        with pytest.raises(InputError, match="each avatar of the trial has a participant already: first, second"):
            Headset(vr)  # the third avatar is moved without a headset
        until(lambda: one.person.summary()["steps"] > 3 and two.person.summary()["steps"] > 3)
        assert place(one.person)[:2] == pytest.approx([1.1, 0.5], abs=1e-3)  # both are 0.1 m ahead of their origins
        assert place(two.person)[:2] == pytest.approx([-2.0, -0.9], abs=1e-3)
        for x, y in ((0, 0), (2, 0), (2, 3)):
            vr.add_pair("person second", [x, y, 1], [x - 4, y + 2, 1])
        vr.calibrate("person second")
        until(lambda: place(two.person)[0] < -3.8)
        assert place(two.person)[:2] == pytest.approx([-3.9, 2.0], abs=1e-3)
        assert place(one.person)[:2] == pytest.approx([1.1, 0.5], abs=1e-3)
        vr.place_room("person", 0.0, 1.0)
        assert set(vr.state()["rooms"]) == {"person", "robot", "person second"}
        assert vr.save_rooms("lab") == "lab.json"
        one.stop(cut=True)
        two.stop(cut=True)
        again = vr.join(lambda message: None, "second")  # the second headset is back before the first
        assert (again.avatar, again.room) == ("second", "person second")
        other = vr.join(lambda message: None, "first")
        assert (other.avatar, other.room) == ("first", "person")
        session.desk("simulator").run_trial(
            session.desk("simulator").run.trial
        )  # a restart keeps what the operator set
        until(lambda: session.desk("simulator").run.controls.get("first") is other or vr._check() or False)
        assert vr.rooms.room("person").place.translation[:2].tolist() == [0.0, 1.0]
        for person in (again, other):
            vr.leave(person)
        vr.load_rooms("lab")
        assert vr.rooms.room("person second").fit.rms < 1e-9


def test_files_of_rooms_have_rooms_of_persons_only():
    rooms = SharedRooms()
    rooms.add_person("second")
    record = rooms.record()
    made = SharedRooms()
    made.restore(record)
    assert set(made.rooms) == {"person", "robot", "person second"}
    with pytest.raises(InputError, match="a file of rooms must have the keys person and robot"):
        made.restore({"kitchen": record["robot"]})
    with pytest.raises(InputError, match="room = 'kitchen': expected person or robot or person second"):
        made.room("kitchen")

"""Motion capture of real robots and of people without a headset, in sessions and on the command line."""

import numpy as np
import pytest
from headset_sessions import open_session, until

from crowdbot.bridges import CaptureSet, RealRobotLink, open_real_robot
from crowdbot.cli import main
from crowdbot.core import InputError
from crowdbot.recording import read_episode, replay
from crowdbot.simulation import AvatarOrder, RobotPoseOrder, Simulation
from crowdbot.trials import parse_trial
from crowdbot.vr import VR_DESKS, with_captures
from crowdbot.vr.trial_seats import link_captures

ROBOT = """<robot name="robot" type="turtlebot2" x="4" y="-1" default-sensors="false" control-period="0.05">
<goal x="-5" y="-1"/><navigator type="real-robot" driver="straight" parameters="speed=0.4"/></robot>"""
TRIAL = f"""<trial name="meet" duration="1"><stage/><crowd type="orca"/>
<avatar name="guest" source="external" x="1" y="0.5" headset="false"/>{ROBOT}
<end goal="false" collision="false"/></trial>"""
EXPERIMENT = """<experiment name="visit"><instructions name="hello" text="Please walk."/>
<block name="main"><trial name="meet" source="meet.xml"/></block></experiment>"""
TABLE = "time,subject,x,y,heading\n" + "".join(
    f"{k / 10},cart,{1 + k / 10},0.5,0\n{k / 10},hat,{k / 20},0,0\n" for k in range(21)
)


@pytest.fixture
def table(tmp_path):
    (tmp_path / "two.csv").write_text(TABLE)
    return tmp_path / "two.csv"


def test_motion_capture_takes_the_place_of_the_odometry_of_a_real_robot(table):
    trial = parse_trial(TRIAL)
    simulation = Simulation(trial)
    with CaptureSet([f"{table}#cart=robot", f"{table}#hat=guest@0,2"]) as captures:
        link = open_real_robot(trial.robots[0].navigator, ["robot"], simulation)
        try:
            assert isinstance(link, RealRobotLink)
            rest = link_captures(captures.captures_of(trial, origin=lambda: (10.0, 1.0, np.pi / 2)), [link])
            assert [binding.target for item in rest for binding in item.bindings] == ["guest"]
            found = []
            for _ in range(8):
                found += link.orders(simulation)
                simulation.advance()
        finally:
            link.close()
    assert all(isinstance(one, RobotPoseOrder) for one in found)
    assert len(found) >= 7
    assert found[-1].x == pytest.approx(9.5)  # the room of the robot is turned by a right angle
    assert 2.0 <= found[-1].y < 3.0


def test_sets_of_motion_capture_say_what_is_wrong(table):
    with CaptureSet([f"{table}#hat=guest"]) as captures:
        assert (captures.targets, captures.live) == (("guest",), False)
        assert captures.stream_of("robot") is None
        for call, text in (
            (lambda: captures.add("xsens:0=guest"), "moves 'guest' already"),
            (lambda: captures.add("guest"), "must have the form"),
            (lambda: captures.remove("xsens:0=guest"), "there is no motion capture 'xsens:0=guest'"),
        ):
            with pytest.raises(InputError, match=text):
                call()
        assert captures.captures_of(parse_trial(TRIAL), leave=["guest"]) == []
        captures.remove(f"{table}#hat=guest")
        assert captures.streams == {}
    with pytest.raises(InputError, match="must have the form"):
        with_captures(VR_DESKS, ["guest"])


@pytest.mark.live
def test_a_session_on_the_command_line_is_moved_by_motion_capture(table, tmp_path, capsys):
    home = tmp_path / "study"
    home.mkdir()
    (home / "experiment.xml").write_text(EXPERIMENT)
    (home / "meet.xml").write_text(TRIAL.replace(ROBOT, ""))
    (tmp_path / "answers.json").write_text("{}")
    words = ["experiment", "run", str(home), "--participant", "1", "--out", str(tmp_path / "data")]
    more = ["--mocap", f"{table}#hat=guest@3,1", "--answers", str(tmp_path / "answers.json")]
    assert main([*words, *more, "--rehearse"]) == 2
    assert "leave out --rehearse" in capsys.readouterr().err
    assert main([*words, *more]) == 0
    episode = tmp_path / "data" / "participant-001" / "001-meet" / "episode.mcap"
    orders = [order for _, order in read_episode(episode).orders]
    assert all(isinstance(order, AvatarOrder) and order.avatar == "guest" for order in orders)
    assert orders[-1].x == pytest.approx(3.5, abs=0.03)
    assert replay(episode).equal
    assert main([*words, "--mocap", "xsens:0=guest", "--rate", "2"]) == 2
    assert "--rate 2 does not fit live motion capture" in capsys.readouterr().err


@pytest.mark.live
def test_a_natnet_server_that_does_not_answer_is_a_problem_and_holds_nothing_up(tmp_path):
    text = TRIAL.replace(ROBOT, '<agent x="4" y="6" goal="-5,6"/>')
    with open_session(tmp_path / "files", {"meet.xml": text}) as session:
        told = []
        session.tell = lambda event, data: told.append((event, data))
        vr = session.desk("vr")
        vr.add_capture("natnet:127.0.0.1:9#Cart=robot")
        assert vr.state()["captures"] == []  # answered at once
        problem = until(lambda: [data for event, data in told if event == "vr.problem"])[0]
        assert "NatNet server 127.0.0.1:9" in problem
        with pytest.raises(InputError, match="must have the form"):
            vr.add_capture("natnet:127.0.0.1:9")

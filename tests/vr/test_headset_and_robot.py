"""A headset and a robot that is not this program's: driven by a program, real, or rehearsed, in one trial."""

import dataclasses
import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from headset_sessions import Headset, open_session, phase, until

from crowdbot.core import InputError
from crowdbot.experiments import read_trial_clock
from crowdbot.navigation import RealRobotNavigator
from crowdbot.recording import read_episode, replay
from crowdbot.trials import load_trial

BRIDGES = Path(__file__).parents[1] / "bridges"
EXPERIMENT = """<experiment name="visit"><instructions name="hello" text="Please stand."/>
<block name="main"><trial name="meet" source="meet.xml"/></block></experiment>"""
TRIAL = """<trial name="meet" duration="{duration}"><stage/><crowd type="orca"/>
<avatar name="guest" source="external" x="1" y="0.5" body="man-30"/>
<robot name="robot" type="turtlebot2" x="4" y="-1" heading="3.14159265" default-sensors="false"
 control-period="0.05"><goal x="-50" y="-1"/>
<sensor name="scan" type="lidar2d" rays="90" rate="10"/>{navigator}</robot>
<end goal="false" collision="false"/></trial>"""
PROGRAM = f'<navigator type="rosbridge" command="{sys.executable} {BRIDGES / "stack_client.py"} {{port}} answer"/>'


def run_visit(folder, navigator, duration=2.0, during=None, timeout=8.0):
    """Run the session of a participant who stands there; return the folder of the trial and the last phase."""
    files = {"visit.xml": EXPERIMENT, "meet.xml": TRIAL.format(duration=duration, navigator=navigator)}
    with open_session(folder, files) as session:
        desk, vr = session.desk("experiments"), session.desk("vr")
        vr.set({"timeout": timeout, "pause_when_lost": False})
        desk.open("visit.xml", 1)
        guest = Headset(vr)
        desk.finish_screen(desk.greet()["index"], {})
        if during is not None:
            until(lambda: guest.person.summary()["steps"] > 3)
            during(desk, vr, guest)
        state = phase(desk, "done", "pause", "aborted")
        guest.stop()
        desk.leave()
    return folder / "experiments" / "visit" / "participant-001" / "001-meet", state


def path_of(episode):
    """Return the positions of the robot."""
    recorded = read_episode(episode)
    return recorded.position[:, recorded.robots[0]]


def orders_of(episode, kind):
    return [order for _, order in read_episode(episode).orders if type(order).__name__ == kind]


def speed_of(run):
    scene = run.simulation.world.environment_scene(0)
    return float(np.hypot(*scene.velocity[0, run.simulation.robots[0].agent]))


@pytest.mark.live
def test_a_program_over_rosbridge_drives_the_robot_beside_a_headset(tmp_path):
    trial, state = run_visit(tmp_path / "files", PROGRAM)
    assert state["phase"] == "done"
    episode = trial / "episode.mcap"
    path = path_of(episode)
    assert path[0, 0] - path[-1, 0] > 0.5  # 0.5 m/s for 2 s
    assert {order.avatar for order in orders_of(episode, "AvatarOrder")} == {"guest"}
    assert {order.source for order in orders_of(episode, "VelocityOrder")} == {"rosbridge"}
    assert len(orders_of(episode, "VelocityOrder")) > 30
    assert replay(episode).equal  # without the program and the headset
    assert (trial / "guest.headset").is_file()


@pytest.mark.live
def test_the_stop_button_holds_a_robot_that_a_program_drives(tmp_path):
    def stop(desk, vr, guest):
        run = desk._run
        until(lambda: speed_of(run) > 0.3)
        assert vr.stop_robots() == ["robot"]
        until(lambda: speed_of(run) < 1e-6)
        vr.release_robots()
        until(lambda: speed_of(run) > 0.3)
        desk.abort("the test is over")

    assert run_visit(tmp_path / "files", PROGRAM, 300.0, stop)[1]["phase"] == "aborted"


def start_real_robot():
    """Start a robot with a rosbridge server and software of its own, and return it with its address."""
    words = [sys.executable, str(BRIDGES / "real_robot.py"), "rosbridge"]
    robot = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    return robot, f"rosbridge-client:ws://127.0.0.1:{robot.stdout.readline().strip()}"


@pytest.mark.live
def test_a_real_robot_drives_beside_a_headset_and_stops_with_the_pause(tmp_path):
    robot, bridge = start_real_robot()
    navigator = f'<navigator type="real-robot" bridge="{bridge}" area="-20,-20,20,20" link-timeout="5"/>'

    def look(desk, vr, guest):
        run = desk._run
        until(lambda: speed_of(run) > 0.3)
        vr.pause()
        assert any("robot 'robot' is stopped: the stop button" in item for item in vr.state()["warnings"])
        assert phase(desk, "pause")
        vr.resume()
        until(lambda: speed_of(run) > 0.3)
        assert not any("is stopped" in item for item in vr.state()["warnings"])
        assert vr.stop_robots() == ["robot"]
        until(lambda: speed_of(run) < 1e-3)
        vr.release_robots()
        until(lambda: speed_of(run) > 0.3)

    trial, state = run_visit(tmp_path / "files", navigator, 12.0, look)
    assert state["phase"] == "done"
    seen = json.loads(robot.communicate(timeout=120)[0].splitlines()[-1])
    path = path_of(trial / "episode.mcap")
    assert path[0] == pytest.approx((4.0, -1.0), abs=0.05)  # its odometry begins somewhere else
    assert path[0, 0] - path[-1, 0] > 0.5
    assert math.dist(path[0], path[-1]) == pytest.approx(seen["driven"], abs=0.6)
    assert 0.3 < seen["fastest"] <= 0.5 + 1e-9  # its software wants 0.9 m/s
    assert seen["stopped"] > 5
    assert {order.source for order in orders_of(trial / "episode.mcap", "RobotPoseOrder")} == {"join"}
    assert orders_of(trial / "episode.mcap", "AvatarOrder")
    assert replay(trial / "episode.mcap").equal


@pytest.mark.live
def test_one_word_rehearses_the_same_trial_with_a_simulated_robot(tmp_path):
    words = 'type="real-robot" bridge="{}" driver="straight" parameters="speed=0.4" area="-20,-20,20,20"'
    trial, state = run_visit(tmp_path / "files", f"<navigator {words.format('simulated')}/>", 3.0)
    assert state["phase"] == "done"
    path = path_of(trial / "episode.mcap")
    clock = read_trial_clock(trial).monotonic  # the robot drives in real time, whatever a busy machine does
    assert 0.4 < path[0, 0] - path[-1, 0] < 0.4 * (clock[-1] - clock[0]) + 0.15  # 0.4 m/s, accelerated at 0.5 m/s2
    assert abs(path[-1, 1] + 1.0) < 0.05
    assert replay(trial / "episode.mcap").equal
    (tmp_path / "meet.xml").write_text(TRIAL.format(duration=1, navigator=f"<navigator {words.format('ros2')}/>"))
    real = load_trial(tmp_path / "meet.xml").robots[0]
    assert real.mirror.source == "external"
    assert dataclasses.replace(real.navigator, bridge="simulated").driver == "straight"


@pytest.mark.live
def test_the_tab_of_the_operator_stops_a_linked_robot_of_the_simulator(tmp_path):
    navigator = '<navigator type="real-robot" driver="straight" parameters="speed=0.4"/>'
    with open_session(tmp_path / "files", {"meet.xml": TRIAL.format(duration=300, navigator=navigator)}) as session:
        simulator, vr = session.desk("simulator"), session.desk("vr")
        simulator.visit({})
        guest = Headset(vr)
        vr.set({"timeout": 8.0, "pause_when_lost": False})
        until(lambda: guest.person.summary()["steps"] > 3)
        run = simulator.run
        until(lambda: run.do(lambda: speed_of(run)) > 0.3)
        assert vr.stop_robots() == ["robot"]
        until(lambda: run.do(lambda: speed_of(run)) < 1e-3)
        assert "robot 'robot' is stopped: the stop button" in vr.state()["warnings"]
        with pytest.raises(InputError, match="is moved over its own connection"):
            simulator.take_over("robot")
        vr.release_robots()
        until(lambda: run.do(lambda: speed_of(run)) > 0.3)
        guest.stop()


@pytest.mark.live
def test_a_real_robot_that_does_not_come_fails_the_trial_and_the_session_waits(tmp_path):
    navigator = '<navigator type="real-robot" bridge="rosbridge:0" area="-20,-20,20,20" start="0.5"/>'
    _, state = run_visit(tmp_path / "files", navigator)
    assert (state["phase"], state["waiting"]) == ("pause", "failed")
    assert "robot 'robot': no pose came on /odom within 0.5 s" in state["reason"]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"bridge": "ros2"}, "a real robot needs an area"),
        ({"bridge": " "}, "bridge must name a connection"),
        ({"parameters": "speed=1"}, "parameters belong to a driver"),
        ({"driver": "straight", "parameters": "fast"}, "must be name=value"),
        ({"odometry": "", "driver": "straight"}, "the robot drives itself"),
        ({"max_speed": 0.0}, "max_speed"),
    ],
)
def test_settings_that_do_not_fit_are_refused(values, message):
    with pytest.raises(InputError, match=message):
        RealRobotNavigator(**values)

"""Trials whose people and robots are moved by motion capture, from Python and the command line."""

from __future__ import annotations

import functools
import itertools
import subprocess
import sys
import time
from pathlib import Path

import motion_senders as senders
import numpy as np
import pytest
from motion_senders import Motive, Sender
from test_mocap_files import WALK, mvnx

from crowdbot.bridges import MotionBinding, MotionCapture, open_stream, parse_captures
from crowdbot.bridges.motion_capture import XsensStream
from crowdbot.cli import main
from crowdbot.core import InputError, PacedClock
from crowdbot.recording import open_run, read_episode, record, replay
from crowdbot.simulation import AvatarOrder, RobotPoseOrder, Simulation, SimulationRun
from crowdbot.trials import parse_trial

TEXT = """<trial name="led" duration="{0}"><stage/><crowd type="orca"/>
<agent x="5.5" y="2.2" goal="-4,2.2"/>
<avatar name="guide" source="external" x="0" y="0" body="man-20"/>
<robot name="twin" type="pepper" x="4" y="-3"><goal x="-3" y="0"/><pose source="external"/>
<navigator type="external"/></robot><end collision="false" goal="false"/></trial>"""
TRIAL = parse_trial(TEXT.format(0.8))


def test_a_recording_of_xsens_moves_the_whole_body(tmp_path: Path) -> None:
    (tmp_path / "walk.mvnx").write_bytes(mvnx())
    captures = parse_captures([f"{tmp_path}/walk.mvnx#Anna=guide@2,1,1.5707963"], TRIAL)
    with open_run(TRIAL, out=tmp_path, sources=captures) as running:
        while running.outcome is None:
            running.step()
    orders = [order for step in read_episode(tmp_path / "episode.mcap").orders for order in [step[1]]]
    assert len(orders) == 9  # 0.5 s of motion; one sample for each step, at its time
    assert all(isinstance(order, AvatarOrder) and order.skeleton is not None for order in orders)
    np.testing.assert_allclose([order.time for order in orders], 0.05 * np.arange(1, 10))
    np.testing.assert_allclose(
        [order.y for order in orders], 1.0 + np.array([order.time for order in orders]), atol=0.03
    )
    np.testing.assert_allclose([order.heading for order in orders], np.pi / 2, atol=1e-6)
    assert replay(tmp_path / "episode.mcap").equal


def test_the_world_shows_the_raised_arm_of_the_actor(tmp_path: Path) -> None:
    from crowdbot.recording import RecordedSimulation

    (tmp_path / "walk.mvnx").write_bytes(mvnx())
    trial = parse_trial(TEXT.format(0.5).replace('duration="0.5"', 'duration="0.5" world="physics"'))
    record(trial, out=tmp_path, sources=parse_captures([f"{tmp_path}/walk.mvnx=guide"], trial))
    with RecordedSimulation(tmp_path / "episode.mcap") as recorded:
        posture = recorded.at(0.4).world.people.posture()
    left, right = posture.position[1, 9], posture.position[1, 16]
    assert left[2] - right[2] > 0.85
    assert 0.3 < posture.position[1, 0, 0] < 0.5


def test_a_rigid_body_moves_a_robot_and_a_person_who_then_walks(tmp_path: Path) -> None:
    rows = "".join(f"{k / 10},cart,{k / 10 + 5},0.5,0\n{k / 10},hat,{k / 10},0.5,0\n" for k in range(9))
    (tmp_path / "two.csv").write_text("time,subject,x,y,heading\n" + rows)
    captures = parse_captures([f"{tmp_path}/two.csv#cart=twin", f"{tmp_path}/two.csv#hat=guide"], TRIAL)
    assert len(captures) == 1
    running = SimulationRun(Simulation(TRIAL), sources=captures)
    for _ in range(10):
        running.step()
    scene = running.simulation.world.scene
    np.testing.assert_allclose(scene.position[0, 1:3], [[0.5, 0.5], [5.5, 0.5]], atol=1e-9)
    np.testing.assert_allclose(scene.velocity[0, 1:3], [[1.0, 0.0]] * 2, atol=1e-6)
    assert captures[0].remarks()[0] == "twin: 9 samples, 10.0 Hz"


@pytest.mark.live
def test_a_live_stream_moves_a_person_in_real_time_and_the_episode_replays(tmp_path: Path) -> None:
    stream = open_stream("xsens:0")
    capture = MotionCapture(stream, [MotionBinding("guide", "Anna")])
    trial = parse_trial(TEXT.format(1.5))
    SimulationRun(Simulation(TRIAL), sources=[capture]).step()  # compiles what the run needs
    with capture, Sender(stream.port):
        while not stream.subjects():
            time.sleep(0.01)
        done = record(trial, out=tmp_path, clock=PacedClock(trial.step), sources=[capture])
    assert done.outcome in ("finished", "collision")  # the end of its duration is planned: no goal ends it
    episode = read_episode(tmp_path / "episode.mcap")
    orders = [order for _, order in episode.orders]
    assert len(orders) >= 25
    assert all(a.x < b.x for a, b in itertools.pairwise(orders))
    assert capture.remarks()[0].startswith("guide: ")
    assert " datagrams refused, age median " in capture.remarks()[0]
    assert replay(tmp_path / "episode.mcap").equal


@pytest.mark.live
def test_motive_moves_a_person_and_a_robot() -> None:
    with Motive() as motive:
        texts = [f"natnet:127.0.0.1:{motive.port}#{item}" for item in ("Anna=guide", "Cart=twin@1,0")]
        (capture,) = parse_captures(texts, TRIAL)
        with capture:
            while len(capture.stream.subjects()) < 2:
                time.sleep(0.01)
            orders = capture.orders(Simulation(TRIAL))
    person, robot = orders
    assert isinstance(person, AvatarOrder)
    assert isinstance(robot, RobotPoseOrder)
    assert person.skeleton is not None
    assert robot.y == pytest.approx(1.0)
    assert robot.x == pytest.approx(1.0 + 0.5 * (person.x + 0.0), abs=0.05)


@pytest.mark.live
def test_the_example_sender_is_understood() -> None:
    script = Path(__file__).parents[2] / "examples" / "send_xsens.py"
    with open_stream("xsens:0") as stream:
        done = subprocess.run([sys.executable, str(script), str(stream.port), "0.5"], capture_output=True, text=True)
        time.sleep(0.1)
    assert done.returncode == 0, done.stderr
    statistics = stream.statistics("0")
    assert (statistics.samples, statistics.lost, statistics.refused) == (30, 0, 0)


def test_a_pose_that_no_person_can_have_is_counted_and_the_run_goes_on() -> None:
    stream = XsensStream(port=0, monotonic=lambda: 5.0)
    capture = MotionCapture(stream, [MotionBinding("guide")])
    stream.take(senders.mxtp02(senders.posed({}, (0.0, 0.0, 50.0)), 1, 0.0), "127.0.0.1:1", 5.0)
    running = SimulationRun(Simulation(TRIAL), sources=[capture])
    running.step()
    assert running.outcome is None
    assert capture.refused == 1
    assert "1 are no pose (BodyPose: skeleton at" in capture.remarks()[0]


@pytest.mark.parametrize(
    ("texts", "message"),
    [
        (["xsens:9763"], "must have the form SOURCE[#SUBJECT]=NAME[@X,Y,HEADING], such as xsens:9763=guide"),
        (["xsens:9763=gide"], "has no avatar 'gide' with source=\"external\" and no robot 'gide' with"),
        (["xsens:9763=guide", "xsens:9764=guide"], "motion capture moves 'guide' twice"),
        (["xsens:9763=guide@here"], "'here' must be X,Y or X,Y,HEADING in m and rad"),
        (["xsens:9763=guide@1,nan"], "the origin 1, nan, 0 of 'guide' must be finite"),
        (["walk.bvh#Eve=guide"], "walk.bvh has no subject 'Eve'; it has Hips"),
    ],
)
def test_a_wrong_option_is_refused(
    texts: list[str], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("walk.bvh").write_bytes(WALK)
    with pytest.raises(InputError) as caught:
        parse_captures(texts, TRIAL)
    assert message in str(caught.value)


@pytest.mark.parametrize(("seconds", "late"), [(0.02, False), (0.06, True)])
def test_a_run_that_is_late_says_so(
    seconds: float, late: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = itertools.count(0.0, seconds)  # real time [s] that a step takes
    clock = functools.partial(PacedClock, monotonic=lambda: next(now), sleep=lambda seconds: None)
    monkeypatch.setattr("crowdbot.core.PacedClock", clock)
    monkeypatch.chdir(tmp_path)
    Path("walk.bvh").write_bytes(WALK)
    Path("led.xml").write_text(TEXT.format(2.0), encoding="utf-8")
    assert main(["run", "led.xml", "--mocap", "walk.bvh=guide", "--pace", "1"]) == 0
    text = "the run could not keep up with --pace 1: 0.3 s late"
    assert (text in capsys.readouterr().err) == late


@pytest.mark.parametrize(("seconds", "late"), [(0.02, False), (0.06, True)])
def test_a_trial_of_an_experiment_that_is_late_says_so(
    seconds: float, late: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = itertools.count(0.0, seconds)
    clock = functools.partial(PacedClock, monotonic=lambda: next(now), sleep=lambda seconds: None)
    monkeypatch.setattr("crowdbot.experiments.console.PacedClock", clock)
    monkeypatch.chdir(tmp_path)
    Path("walk.bvh").write_bytes(WALK)
    Path("led.xml").write_text(TEXT.format(2.0), encoding="utf-8")
    Path("experiment.xml").write_text(
        '<experiment name="visit"><block name="main"><trial name="meet" source="led.xml"/></block></experiment>',
        encoding="utf-8",
    )
    Path("answers.json").write_text("{}", encoding="utf-8")
    words = ["experiment", "run", "experiment.xml", "--participant", "1", "--out", "data", "--answers", "answers.json"]
    assert main([*words, "--mocap", "walk.bvh=guide", "--rate", "1"]) == 0
    text = "warning: trial 1 of 1: the run could not keep up with --rate 1: 0.3 s late"
    assert (text in capsys.readouterr().err) == late


@pytest.mark.live
def test_the_command_runs_a_trial_with_a_recording_and_with_a_live_stream(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("walk.bvh").write_bytes(WALK)
    Path("led.xml").write_text(TEXT.format(0.8), encoding="utf-8")
    assert main(["run", "led.xml", "--mocap", "walk.bvh=guide", "--out", "led"]) == 0
    assert "motion capture guide: 50 samples, 50.0 Hz" in capsys.readouterr().err
    assert replay("led/episode.mcap").equal
    assert main(["run", "led.xml", "--mocap", "xsens:0=guide"]) == 0
    assert "motion capture guide: 0 samples, 0.0 Hz, 0 lost, 0 datagrams refused" in capsys.readouterr().err
    assert main(["run", "led.xml", "--mocap", "xsens:0=guide", "--pace", "2"]) == 2
    assert "--pace 2 does not fit live motion capture, which needs real time" in capsys.readouterr().err

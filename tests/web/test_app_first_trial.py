"""The first trial of the app: its recording is that of the run, which goes on where the recording is."""

import itertools
import threading

import numpy as np
import pytest
from simulator_session import Windows, ready, simulator, wait_until

from crowdbot.core import InputError
from crowdbot.simulation import Simulation
from crowdbot.trials import load_trial
from crowdbot.web import StateFrame, call_command
from crowdbot.web.scene import WalkingBodies, scene_description, scene_frame, scene_resource
from crowdbot.web.simulator import FIRST, LiveRun, live_run
from crowdbot.web.simulator.beginning_player import BeginningPlayer
from crowdbot.web.simulator.recorded_beginning import RecordedBeginning, shipped_beginning

AGAIN = "run make fix"
CALLS = {
    "save": {},
    "order": {"order": {"kind": "push", "person": 1, "force": 100.0}},
    "set_value": {"path": "robot/navigator/type", "text": "orca"},
    "add_robot": {"type": "pepper", "x": 0.0, "y": 0.0, "goal_x": 1.0, "goal_y": 0.0},
    "walk": {"avatar": "you", "forward": 1.0},
    "inspect": {"id": 0},
    "values": {},
}
"""Commands that need a run."""


@pytest.fixture(scope="module")
def simulated():
    """The first 2 s of the first trial, simulated now."""
    name, values, seed = FIRST
    simulation = Simulation(load_trial(name, **values), seed)
    bodies, frames = WalkingBodies(simulation), []
    description = scene_description(simulation, bodies.motion)
    for tick in range(41):
        bodies.follow(simulation)
        if tick % 4 == 0:
            frames.append(scene_frame(simulation, (), bodies.motion))
        simulation.advance()
    return simulation, description, frames


def test_the_shipped_recording_is_that_of_the_first_trial(simulated):
    simulation, known, frames = simulated
    shipped = shipped_beginning()
    assert shipped.seconds > 30.0
    for index, frame in enumerate(frames):
        found, revision = shipped.frame(index, 3), frame.arrays["revision"]
        assert found.time == pytest.approx(frame.time, abs=1e-6)
        assert set(found.arrays) == set(frame.arrays), AGAIN
        for name, values in frame.arrays.items():
            if name == "revision":
                continue
            far = np.abs(found.arrays[name].astype(float) - values)
            if name == "bones":  # q and -q are the same rotation where two parts are equally large
                far = np.minimum(far, np.abs(found.arrays[name].astype(float) + values))
            near = {"place": 6e-4, "pelvis": 2e-3, "bones": 300}.get(name, 0)
            assert far.max() <= near, (name, AGAIN)
            assert found.arrays[name].dtype == values.dtype
    assert shipped.revision(simulation.trial) == revision[0]  # so the page loads nothing again
    assert shipped.description(known["revision"]) == known, AGAIN
    mesh = known["robots"][0]["mesh"]
    assert shipped.resource(mesh).data == scene_resource(simulation, mesh, {}).data, AGAIN
    assert shipped.resource("bodies/2.bin").data == scene_resource(simulation, "bodies/2.bin", {}).data
    with pytest.raises(KeyError):
        shipped.resource("robots/other.bin")


def test_a_recording_survives_its_file():
    shipped = shipped_beginning()
    again = RecordedBeginning.decode(shipped.encode())
    assert again.frame(5, 1).encode() == shipped.frame(5, 1).encode()


@pytest.mark.live
def test_it_plays_again_and_again_until_it_is_stopped(tmp_path):
    windows = Windows(tmp_path)
    shipped = shipped_beginning()
    player = BeginningPlayer(shipped, load_trial(FIRST[0], **FIRST[1]), windows, lambda: 400.0)
    player.start()
    wait_until(lambda: player.now > 2.0 * shipped.seconds)
    player.stop()
    times = [frame.time for frame in windows.frames]
    assert any(after < before for before, after in itertools.pairwise(times))
    sent = len(windows.frames)
    player.show()
    assert (player.active, len(windows.frames)) == (False, sent)


@pytest.mark.live
def test_people_walk_before_the_simulation_is_prepared_and_it_goes_on_there(tmp_path, monkeypatch):
    gate, inner = threading.Event(), live_run.open_run

    def late(*args, **options):
        assert gate.wait(180.0)
        return inner(*args, **options)

    monkeypatch.setattr(live_run, "open_run", late)
    with simulator(tmp_path) as desk:
        desk.visit({})
        wait_until(lambda: len(desk.session.frames) > 3)
        status = desk._status()
        assert (status["state"], status["recorded"]) == ("preparing", True)
        shown = desk.session.frames[-1]
        description = desk.description()
        assert description["revision"] == shown.arrays["revision"][0]
        assert desk.resource(description["robots"][0]["mesh"], {}).data
        desk.show_frame()
        gate.set()
        assert ready(desk)["state"] == "running"
        run = desk._player
        assert isinstance(run, LiveRun)
        assert not run.beginning.active
        wait_until(lambda: desk._status()["time"] > 0.5)
        live = desk.session.frames[-1]
        assert live.time >= shown.time  # nobody is seen to jump back
        assert live.arrays["revision"][0] == description["revision"]
        assert not desk._status()["recorded"]


@pytest.mark.live
def test_nothing_waits_for_a_run_that_is_prepared_and_another_one_opens_meanwhile(tmp_path, monkeypatch):
    gate, inner = threading.Event(), live_run.open_run

    def late(trial, *args, **options):
        assert trial.name != FIRST[0] or gate.wait(180.0)
        return inner(trial, *args, **options)

    monkeypatch.setattr(live_run, "open_run", late)
    with simulator(tmp_path) as desk:
        desk.visit({})
        wait_until(lambda: len(desk.session.frames) > 3)
        assert desk.people() == []
        for command, values in CALLS.items():  # none waits for the run, which never comes
            with pytest.raises(InputError, match="is being prepared; try again as soon as it runs"):
                call_command(desk, command, values)
        desk.open("circle-crossing", seed=3, paused=True)
        assert desk.session.latest("simulator.opened")["source"]["name"] == "circle-crossing"
        status = ready(desk)
        assert (status["trial"], status["seed"], status["state"]) == ("circle-crossing", 3, "paused")
        assert len(desk.people()) > 5
        gate.set()


@pytest.mark.live
def test_meshes_come_and_a_robot_is_taken_over_and_given_back_while_the_run_is_prepared(tmp_path, monkeypatch):
    gate, inner = threading.Event(), live_run.open_run

    def late(*args, **options):
        assert gate.wait(180.0)
        return inner(*args, **options)

    monkeypatch.setattr(live_run, "open_run", late)
    with simulator(tmp_path) as desk:
        desk.open("frontal", {"robot/navigator/type": "social-force", "robot/navigator/relaxation": "0.7"}, paused=True)
        desk.release("robot")  # nobody has taken it over
        assert StateFrame.decode(desk.resource("bodies/2.bin", {}).data).arrays["rest"].size  # those of every trial
        assert desk.resource("robots/robot.bin", {}).data == b""  # that of the scene before, if there was one
        desk.take_over("robot")
        with pytest.raises(InputError, match="there is no robot 'robo', did you mean 'robot'"):
            desk.take_over("robo")
        desk.drive("robot", 0.3, 0.0)
        assert desk._status()["state"] == "preparing"
        gate.set()
        ready(desk)
        robot = next(person["id"] for person in desk.people() if person["kind"] == "robot")
        assert ["navigator", "external"] in [list(row[:2]) for row in desk.inspect(robot)["rows"]]
        desk.release("robot")
        assert ["navigator", "social-force"] in [list(row[:2]) for row in desk.inspect(robot)["rows"]]
        gate.clear()
        desk.restart()
        desk.take_over("robot")
        desk.release("robot")
        gate.set()
        ready(desk)
        rows = {row["path"]: row["text"] for row in desk.values()}
        assert (rows["robot/navigator/type"], rows["robot/navigator/relaxation"]) == ("social-force", "0.7")


@pytest.mark.live
def test_a_run_that_is_ready_late_is_shown_from_its_start(tmp_path, monkeypatch):
    monkeypatch.setattr(live_run, "SEAMLESS", 0.0)
    with simulator(tmp_path) as desk:
        desk.visit({})
        ready(desk)
        assert desk._player.running.simulation.world.times[0] < 5.0
        assert desk._status()["state"] == "running"

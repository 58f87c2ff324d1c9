"""The picture of an episode from its records equals that of its simulation, and needs no simulation."""

import base64
import dataclasses
import gzip
import json
import re
import struct

import numpy as np
import pytest
from simulator_session import ready, simulator, wait_until

from crowdbot.core import EpisodeError
from crowdbot.humans import ACTIVITIES
from crowdbot.recording import RecordedSimulation, open_run, read_episode, record
from crowdbot.simulation import PushOrder
from crowdbot.trials import load_trial, parse_trial, trial_xml
from crowdbot.web.scene import (
    LAYERS,
    RecordedScene,
    WalkingBodies,
    episode_events,
    instant_frame,
    scene_frame,
    simulation_reason,
    write_player,
)
from crowdbot.web.simulator.inspection import inspect_agent
from crowdbot.web.state_frame import StateFrame

HALL = """
<trial name="hall" duration="2" world="physics">
  <stage walkable="-6,-4 6,-4 6,4 -6,4"/><crowd type="orca"/>
  <spawner count="4" zone="1,-2 3,-2 3,2 1,2" goal="-4,-3 -5,-3 -5,3 -4,3"/>
  <robot name="pepper" type="pepper" x="-3" y="0"><goal x="5" y="0"/><navigator type="straight"/></robot>
  <robot name="turtle" type="turtlebot2" x="-3" y="2"><goal x="5" y="2"/><navigator type="straight"/></robot>
</trial>
"""


@pytest.fixture(scope="module")
def hall(tmp_path_factory):
    """An episode of a robot with joints among people in the physics world."""
    path = tmp_path_factory.mktemp("hall") / "hall.mcap"
    record(parse_trial(HALL), 1, path)
    return path


@pytest.fixture(scope="module")
def opened(hall):
    """The recorded scene and the simulation of the episode."""
    with RecordedSimulation(hall) as recorded:
        episode, simulation = read_episode(hall), recorded.trial_simulation()
        assert simulation_reason(simulation, episode, recorded.changes()) == ""
        yield RecordedScene(simulation, episode), recorded


def test_people_robots_and_scans_are_those_of_the_simulation(opened):
    scene, recorded = opened
    for seconds in (0.7, 0.1, 1.6):
        simulation = recorded.at(seconds)
        bodies = WalkingBodies(simulation)
        found = instant_frame(scene.at(seconds), LAYERS).arrays
        expected = scene_frame(simulation, LAYERS, bodies.motion).arrays
        assert set(found) == set(expected)
        for name, tolerance in (("ids", 0), ("who", 0), ("place", 2e-5), ("botplace", 2e-5), ("bots", 0)):
            assert np.allclose(found[name], expected[name], rtol=0, atol=tolerance), (name, seconds)
        assert np.abs(found["links"][:, :3] - expected["links"][:, :3]).max() < 0.02  # the body tilts a little
        scans = [name for name in expected if name.startswith("scan")]
        assert scans
        for name in scans:
            assert np.abs(found[name].astype(int) - expected[name].astype(int)).max() <= 1
        assert np.abs(found["goals"] - expected["goals"]).max() < 1e-5


def test_people_who_come_out_of_a_portal_are_those_of_the_simulation(tmp_path):
    record(load_trial("two-way", duration=8.0, density=0.2), 3, tmp_path / "flow.mcap")
    with RecordedSimulation(tmp_path / "flow.mcap") as recorded:
        episode, first = read_episode(tmp_path / "flow.mcap"), recorded.trial_simulation()
        assert len(episode.ids) > first.world.ids.shape[1]  # somebody has passed a portal
        scene = RecordedScene(first, episode)
        for seconds in (7.9, 4.0):
            simulation = recorded.at(seconds)
            found = scene.at(seconds)
            there = simulation.world.scene.active[0]
            assert np.array_equal(found.scene.active[0], there)
            assert np.array_equal(found.ids[there], simulation.world.ids[0][there])  # the same bodies, too
            assert np.allclose(found.scene.position[0, there], simulation.world.scene.position[0, there], atol=1e-5)


def test_the_joints_of_a_robot_move_as_recorded(opened):
    scene, _ = opened
    assert np.ptp(scene.episode.joints["turtle"]["wheel_left_joint"]) > 0.1
    first, second = (instant_frame(scene.at(at)).arrays["links"][:, 3:] for at in (0.2, 1.4))
    assert np.abs(first - second).max() > 0.05


def test_an_instant_does_not_depend_on_the_way_to_it(opened):
    scene, _ = opened
    scene.at(0.0)
    there = instant_frame(scene.at(1.43), ["scans"]).encode()
    scene.at(0.2)
    assert instant_frame(scene.at(1.43), ["scans"]).encode() == there


def test_people_walk_between_records(opened):
    scene, _ = opened
    scene.at(1.0)
    frames = [instant_frame(scene.at(1.0 + 0.02 * k)).arrays for k in range(11)]
    ways = np.diff([frame["place"][:, 0] for frame in frames], axis=0)
    assert (ways < 0.0).all()  # in each of the steps, although only every fifth instant is recorded
    assert max(np.abs(np.diff(ways, axis=0)).max(axis=0)) < 0.01
    bones = np.abs(np.diff([frame["bones"].astype(int) for frame in frames], axis=0)).max(axis=(1, 2))
    assert (bones > 0).all()


def test_seeking_and_playing_simulate_nothing_and_the_inspector_sees_the_instant(hall):
    with simulator(hall.parent) as desk:
        desk.open_episode(hall.name)
        assert ready(desk)["state"] == "paused"
        for seconds in (1.5, 0.2, 1.0):
            desk.seek(seconds)
            assert desk.session.frames[-1].time == desk._status()["time"] == seconds
        desk.step(4)
        wait_until(lambda: desk._status()["time"] == pytest.approx(1.2))
        people = desk.people()
        assert desk._player._run is None
        one = next(row for row in people if row["kind"] == "person")
        seen = desk.inspect(one["id"])
        assert desk._player._run.simulation.world.clock.time == pytest.approx(1.2)
        assert (seen["x"], seen["y"]) == (pytest.approx(one["x"], abs=0.02), pytest.approx(one["y"], abs=0.02))
        desk.speed(None)
        desk.play()
        wait_until(lambda: desk._status()["state"] == "ended")
        assert desk._status()["time"] == desk._status()["duration"]


def test_an_episode_that_does_not_replay_is_still_shown(hall, monkeypatch):
    def refuse(self, seconds):
        raise EpisodeError("the episode differs from its replay")

    monkeypatch.setattr(RecordedSimulation, "run_from", refuse)
    with simulator(hall.parent) as desk:
        desk.open_episode(hall.name)
        assert ready(desk)["state"] == "paused"
        desk.seek(1.5)
        assert desk.session.frames[-1].time == 1.5
        with pytest.raises(EpisodeError, match="differs from its replay"):
            desk.inspect(0)


@pytest.mark.parametrize(
    ("inside", "reason"),
    [
        ('<stage><cube x="1" y="1" size="0.4" mass="5"/></stage>', "doors or props move"),
        ('<source zone="1,1 2,1 2,2 1,2" goal="-5,0 -4,0 -4,1 -5,1" rate="1"/>', ""),
        ('<spawner count="2" zone="1,1 2,1 2,2 1,2" goal="-5,0 -4,0 -4,1 -5,1"/>', ""),
    ],
)
def test_what_is_not_in_the_records_is_named(tmp_path, inside, reason):
    stage = inside if "stage" in inside else ""
    rest = "" if stage else inside
    world = 'world="physics"' if stage else ""
    trial = f'<trial name="small" duration="4" {world}>{stage}<crowd type="orca"/>{rest}</trial>'
    record(parse_trial(trial), 0, tmp_path / "small.mcap")
    with RecordedSimulation(tmp_path / "small.mcap") as recorded:
        episode = read_episode(tmp_path / "small.mcap")
        found = simulation_reason(recorded.trial_simulation(), episode, recorded.changes())
    assert reason in found
    assert bool(found) == bool(reason)


def test_doors_are_simulated(tmp_path):
    trial = parse_trial(
        '<trial name="door" duration="0.5"><stage walkable="-6,-4 6,-4 6,4 -6,4">'
        '<door name="hall" points="3,-1 3,1" opening="schedule" times="0.2"/></stage><crowd type="orca"/></trial>'
    )
    record(trial, 0, tmp_path / "door.mcap")
    with simulator(tmp_path) as desk:
        desk.open_episode("door.mcap")
        assert ready(desk)["state"] == "paused"
        desk.seek(0.4)
        assert desk.session.frames[-1].arrays["doors"].shape == (1,)
        assert desk._player._run is not None


PUSHED = """
<trial name="pushed" duration="3" world="physics" balance="true" step="0.05"><stage/><crowd type="orca"/>
  <agent x="0" y="0" body="woman-72" speed="0.001"/><agent x="0" y="4" body="man-24" speed="0.001"/></trial>
"""
RAMP = """
<trial name="ramp" duration="10" world="physics"><stage walkable="-2,-2 8,-2 8,2 -2,2">
  <ramp x="2" y="0" length="3" width="3" height="0.24"/><platform x="5" y="0" length="3" width="3" height="0.24"/>
  </stage><crowd type="orca"/><agent x="5" y="1" body="man-24" speed="0.001"/>
  <robot name="bot" type="turtlebot2" x="-1" y="0" default-sensors="false"><goal x="6" y="0"/>
  <navigator type="straight"/></robot></trial>
"""


@pytest.fixture(scope="module")
def pushed(tmp_path_factory):
    """An episode in which one of two people is pushed and falls."""
    folder = tmp_path_factory.mktemp("pushed")
    with open_run(parse_trial(PUSHED), out=folder) as running:
        while running.outcome is None:
            running.step([PushOrder(person=0, force=900, duration=0.25)] if running.simulation.tick == 4 else [])
    return folder / "episode.mcap"


def test_who_has_fallen_lies_as_in_the_simulation(pushed):
    with RecordedSimulation(pushed) as recorded:
        episode, simulation = read_episode(pushed), recorded.trial_simulation()
        assert simulation_reason(simulation, episode, recorded.changes()) == ""
        scene = RecordedScene(simulation, episode)
        for seconds, lies in ((2.5, True), (0.1, False), (2.9, True)):
            found = instant_frame(scene.at(seconds)).arrays
            expected = scene_frame(recorded.at(seconds)).arrays
            assert np.abs(found["pelvis"] - expected["pelvis"]).max() < 0.02
            assert bool(found["pelvis"][0, 2] < 0.5) == lies
            assert found["pelvis"][1, 2] > 0.8
            if lies:
                assert np.abs(found["bones"][0].astype(int) - expected["bones"][0]).max() <= 2
        heights = [instant_frame(scene.at(0.2 + 0.02 * k)).arrays["pelvis"][0, 2] for k in range(80)]
        assert np.abs(np.diff(heights)).max() < 0.17  # no jump between two records: the body falls by 0.7 m


def test_the_inspector_tells_the_balance(pushed):
    with RecordedSimulation(pushed) as recorded:
        for seconds, person, word in ((0.1, 0, "upright"), (2.5, 0, "falls, lies or gets up"), (2.5, 1, "upright")):
            assert ["balance", word, ""] in inspect_agent(recorded.at(seconds), person)["rows"]


def test_gestures_are_shown_as_in_the_simulation(tmp_path):
    text = trial_xml(load_trial("intersection-gesture-wait", duration=7.0))
    assert text.count("<agent ") == 1
    trial = parse_trial(text.replace("<agent ", '<agent activity="carry" '))
    record(trial, 1, tmp_path / "wait.mcap")
    carry, signal = ACTIVITIES.index("carry"), ACTIVITIES.index("signal-wait")
    with RecordedSimulation(tmp_path / "wait.mcap") as recorded:
        episode, simulation = read_episode(tmp_path / "wait.mcap"), recorded.trial_simulation()
        scene = RecordedScene(recorded.trial_simulation(), episode)
        bodies = WalkingBodies(simulation)
        shown = []
        for k in range(0, len(episode.times), 4):
            seconds = float(episode.times[k])
            while simulation.world.times[0] < seconds - 1e-9:
                simulation.advance()
                bodies.follow(simulation)
            scene.at(seconds)
            expected = signal if episode.gestures[k, 0] else carry
            assert bodies.motion.state.wish[0] == expected
            assert scene.motion.state.wish[0] == expected
            shown.append(expected)
        assert set(shown) == {carry, signal}
        for seconds, expected in ((5.0, signal), (1.0, carry)):  # also after a jump in time
            scene.at(seconds)
            assert scene.motion.state.wish[0] == expected


def test_falls_and_pushes_are_events(pushed):
    events = episode_events(read_episode(pushed))
    assert [event.kind for event in events] == ["push", "fall"]
    assert events[0] == (0.2, "push", "person 0 is pushed with 900 N for 0.25 s")
    assert events[1].about == "person 0 falls forward"
    assert 0.25 < events[1].time < 1.0


def test_a_recording_without_poses_of_falls_is_shown_upright(pushed):
    with RecordedSimulation(pushed) as recorded:
        episode = dataclasses.replace(read_episode(pushed), fall_poses=())
        scene = RecordedScene(recorded.trial_simulation(), episode)
        assert instant_frame(scene.at(2.5)).arrays["pelvis"][0, 2] > 0.8


def test_a_player_file_shows_who_has_fallen(pushed, tmp_path):
    text = write_player(pushed, tmp_path / "pushed.html").path.read_text(encoding="utf-8")
    packed = re.search(r'<script id="episode"[^>]*>([^<]*)</script>', text).group(1)
    data = gzip.decompress(base64.b64decode(packed))
    (size,) = struct.unpack_from("<I", data)
    at, heights = 4 + size, []
    for name, length in json.loads(data[4:at]):
        if name == "frame":
            heights.append(StateFrame.decode(data[at : at + length]).arrays["pelvis"][0, 2])
        at += length
    assert heights[0] > 0.8
    assert heights[-1] < 0.5


def test_a_robot_on_a_ramp_is_tilted_without_a_simulation(tmp_path):
    record(parse_trial(RAMP), 0, tmp_path / "ramp.mcap")
    with RecordedSimulation(tmp_path / "ramp.mcap") as recorded:
        episode, simulation = read_episode(tmp_path / "ramp.mcap"), recorded.trial_simulation()
        assert simulation_reason(simulation, episode, recorded.changes()) == ""
        scene = RecordedScene(simulation, episode)
        for seconds in (0.5, 4.0, 9.0):
            found, expected = (
                instant_frame(scene.at(seconds)).arrays,
                scene_frame(recorded.at(seconds)).arrays,
            )
            assert np.abs(found["links"] - expected["links"]).max() < 1e-4
            assert np.abs(found["pelvis"] - expected["pelvis"]).max() < 0.02
        assert np.ptp([scene.episode.tilts[:, 0, 2]]) > 0.07

"""Lab Streaming Layer in and out, with real outlets and inlets on the loopback of this machine; clocks of a session."""

from __future__ import annotations

import dataclasses
import json
import math
import shutil
import time

import numpy as np
import pylsl
import pytest

from crowdbot.cli import main
from crowdbot.core import EpisodeError, InputError, PacedClock
from crowdbot.experiments import (
    Answered,
    BackgroundRun,
    Next,
    RecordedTrial,
    SessionRunner,
    Start,
    StreamOutlets,
    StreamRecorder,
    TrialClockLog,
    load_experiment,
    read_log,
    read_streams,
    read_trial_clock,
    streams,
    view_track,
    withdraw,
)
from crowdbot.experiments.comparison import looking_shares
from crowdbot.recording import read_episode, replay
from crowdbot.simulation import AvatarOrder
from crowdbot.trials import parse_trial
from lsl_network import arrived, inlet_of  # also keeps the streams on this machine

pytestmark = pytest.mark.xdist_group("lsl")

MEETING = """<trial name="meeting" duration="1.5" step="0.05">
  <stage/>
  <end collision="false"/>
  <crowd type="orca"/>
  <avatar name="guide" source="external" x="1.2" y="0" heading="3.14159265"/>
  <robot name="cart" x="0" y="0" radius="0.3"><goal x="5" y="0"/>
    <drive type="differential-drive" max-speed="0.8" max-turn-rate="1.5"/><navigator type="straight"/></robot>
</trial>"""


class Nod:
    """Keeps an avatar at its place and turns its head."""

    def orders(self, simulation):
        """Return the pose at the next step."""
        at = (simulation.tick + 1) * simulation.trial.step
        half = 0.5 * (math.pi - at)
        head = (1.1, 0.0, 1.6, math.cos(half), 0.0, 0.0, math.sin(half))
        return [AvatarOrder(avatar="guide", time=at, x=1.2, y=0.0, heading=math.pi, head=head)]


@pytest.mark.live
def test_poses_and_events_of_a_run_arrive_at_a_receiver(tmp_path):
    trial = parse_trial(MEETING)
    with StreamOutlets("test-poses") as outlets:
        outlets.begin(trial)
        inlets = {name: inlet_of(f"crowdbot-{name}") for name in ("events", "heads", "robots")}
        outlets.tell({"at": 12.0, "event": "begin", "seed": 3, "folder": "001-meet"})
        begin = pylsl.local_clock()
        path = tmp_path / "episode.mcap"
        BackgroundRun(trial, 0, path, PacedClock(trial.step, rate=5.0), [outlets], [Nod()]).result()
        episode = read_episode(path)
        found = {name: arrived(inlet) for name, inlet in inlets.items()}
        labels = inlets["robots"].info(5.0).get_channel_labels()
        for inlet in inlets.values():
            inlet.close_stream()
    assert labels == ["cart.x", "cart.y", "cart.heading"]
    robots = np.array([values for _, values in found["robots"]])
    np.testing.assert_array_equal(robots[:, :2], episode.position[:, episode.robots[0]])
    heads = np.array([values for _, values in found["heads"]])
    assert heads.shape[1] == 7
    assert len(heads) >= 30
    np.testing.assert_allclose(heads[4, 3], math.cos(0.5 * (math.pi - 0.25)), rtol=1e-12)
    stamps = np.array([stamp for stamp, _ in found["robots"]])
    assert np.all(np.diff(stamps) > 0.0)
    assert begin - 0.01 <= stamps[0] <= stamps[-1] <= pylsl.local_clock()
    events = [json.loads(values[0]) for _, values in found["events"]]
    assert events[0] == {"event": "begin", "seed": 3, "folder": "001-meet"}
    contact = next(event for event in events if event["event"] == "contact")
    assert (contact["robot"], contact["other"]) == ("cart", f"person {int(episode.ids[0])}")
    assert contact["time"] == pytest.approx(episode.contacts[0].time)


@pytest.mark.live
def test_a_session_sends_its_answers_and_keeps_both_clocks(tmp_path):
    with StreamOutlets("test-session") as outlets:
        inlet = inlet_of("crowdbot-events")
        runner = SessionRunner(
            load_experiment("robot-speed"), 1, tmp_path, lambda: 5000.0, outlets=outlets, monotonic=lambda: 20.0
        )
        try:
            runner.do(Start())
            runner.do(Answered("age", 30))
            runner.do(Answered("robots", "never"))
            runner.do(Next())
            while runner.session.phase == "screen":
                runner.do(Next())
            trial, _, folder = runner.begin()
            sinks = runner.sinks
            assert len(sinks) == 2
            run = BackgroundRun(trial, 0, folder / "episode.mcap", sinks=sinks)
            runner.end(run.result, folder)
            assert runner.sinks == (outlets,)
        finally:
            runner.close()
        events = [json.loads(values[0]) for _, values in arrived(inlet)]
        inlet.close_stream()
    kinds = [event["event"] for event in events if event["event"] != "contact"]
    assert kinds[:3] == ["start", "answered", "answered"]
    assert kinds[-2:] == ["begin", "finish"]
    assert {"event": "answered", "question": "age", "value": 30} in events
    clocks = [row for row in read_log(runner.folder / "session.jsonl") if "monotonic" in row]
    assert len(clocks) == 2  # the start of the session and that of the trial
    assert all((row["at"], row["monotonic"], row["offset"]) == (5000.0, 20.0, 4980.0) for row in clocks)
    clock = read_trial_clock(folder)
    assert clock is not None
    np.testing.assert_allclose(clock.time, read_episode(folder / "episode.mcap").times, atol=1e-9)
    assert set(clock.monotonic.tolist()) == {20.0}
    now = time.time()
    assert clock.offset == pytest.approx(now - 20.0, abs=600.0)


def sender(name, kind="EEG", labels=("a", "b"), form=pylsl.cf_double64):
    """Return an outlet of another program."""
    info = pylsl.StreamInfo(name, kind, len(labels), 0, form, f"{name}-source")
    info.set_channel_labels(list(labels))
    info.set_channel_units(["uV"] * len(labels))
    return pylsl.StreamOutlet(info)


@pytest.mark.live
def test_a_stream_is_recorded_with_both_clocks_and_its_offset(tmp_path):
    behind = 1000.0  # the sender stamps with a clock of its own
    outlet = sender("signal, left")
    before = time.monotonic()
    with StreamRecorder(tmp_path, ["type=EEG"]) as recorder:
        stamps = [pylsl.local_clock() - behind + 0.01 * k for k in range(200)]
        for k, stamp in enumerate(stamps):
            outlet.push_sample([float(k), 1.0 / 3.0], stamp)
        end = time.monotonic() + 10.0
        while recorder.counts["signal-left"] < 200 and time.monotonic() < end:
            time.sleep(0.02)
    del outlet
    (found,) = read_streams(tmp_path)
    assert (found.name, found.type, found.labels, found.units) == ("signal, left", "EEG", ("a", "b"), ("uV", "uV"))
    np.testing.assert_array_equal(found.values[:, 0], np.arange(200))
    assert found.values[0, 1] == 1.0 / 3.0
    np.testing.assert_allclose(found.stream_time, stamps, atol=1e-6)
    assert np.abs(found.offset).max() < 0.005  # both programs read the same clock of this machine
    np.testing.assert_allclose(found.clock, found.stream_time + found.offset, atol=0.001)  # LSL reads time.monotonic
    after = time.monotonic()
    assert before - behind - 0.01 < found.clock[0] < after - behind


@pytest.mark.live
def test_a_second_part_does_not_replace_the_first(tmp_path):
    outlet = sender("pulse", labels=("rate",), form=pylsl.cf_int32)
    for value in (61, 62):
        with StreamRecorder(tmp_path, ["pulse"]) as recorder:
            end = time.monotonic() + 10.0
            while not any(recorder.counts.values()) and time.monotonic() < end:
                outlet.push_sample([value])
                time.sleep(0.05)
    del outlet
    assert sorted(path.name for path in (tmp_path / "streams").iterdir()) == [
        "pulse-2.csv", "pulse-2.json", "pulse.csv", "pulse.json",
    ]  # fmt: skip
    assert [stream.values[0, 0] for stream in read_streams(tmp_path)] == [62.0, 61.0]


@pytest.mark.live
def test_missing_streams_and_texts_are_refused(tmp_path, monkeypatch):
    with pytest.raises(InputError, match="no stream with the name 'nobody'"):
        StreamRecorder(tmp_path, ["nobody"], wait=0.2)
    outlet = sender("words", "Markers", ("word",), pylsl.cf_string)
    with pytest.raises(InputError, match="carries texts"):
        StreamRecorder(tmp_path, ["words"])
    del outlet
    assert not (tmp_path / "streams").exists()
    monkeypatch.setitem(__import__("sys").modules, "pylsl", None)
    with pytest.raises(ImportError, match=r"crowdbot\[lsl\]"):
        streams.load_pylsl()


def test_damaged_streams_and_clocks_say_where(tmp_path):
    (tmp_path / "streams").mkdir()
    (tmp_path / "streams" / "one.json").write_text('{"name": "one"}')
    with pytest.raises(EpisodeError, match=r"one\.json is damaged"):
        read_streams(tmp_path)
    assert read_trial_clock(tmp_path) is None
    (tmp_path / "clock.csv").write_text("time,monotonic,utc\n0.0,x,1.0\n")
    with pytest.raises(EpisodeError, match=r"clock\.csv is damaged"):
        read_trial_clock(tmp_path)
    (tmp_path / "clock.csv").write_text("time,monotonic,utc\n0.0,1.0,7.0\n1.0,2.0,8.0\n2.0,3")  # a killed session
    clock = read_trial_clock(tmp_path)
    assert clock is not None
    assert clock.simulation_time([0.5, 1.5, 2.5]).tolist()[1] == 0.5
    assert clock.offset == 6.0


def test_a_gaze_stream_turns_with_the_head(tmp_path):
    trial, folder = parse_trial(MEETING), tmp_path / "001-meet"
    folder.mkdir()
    log = TrialClockLog(folder, monotonic=iter(np.arange(100.0, 200.0, 0.1).tolist()).__next__, utc=lambda: 0.0)
    BackgroundRun(trial, 0, folder / "episode.mcap", sinks=[log], sources=[Nod()]).result()
    log.close()
    (tmp_path / "streams").mkdir()
    head = {"name": "eyes", "type": "Gaze", "rate": 0, "labels": ["direction_x", "direction_y", "direction_z"]}
    (tmp_path / "streams" / "eyes.json").write_text(json.dumps(head | {"units": ["1"] * 3}))
    rows = [f"{t - 5.0},5.0,{t},0.0,1.0,0.0" for t in (90.0, 100.5, 101.0)]  # the first is before the trial
    (tmp_path / "streams" / "eyes.csv").write_text("\n".join(["stream_time,offset,clock,x,y,z", *rows]) + "\n")
    recorded = RecordedTrial(trial, read_episode(folder / "episode.mcap"), folder, 0.0)
    view = view_track(recorded, "guide")
    assert view is not None
    assert view.kind == "gaze"
    np.testing.assert_allclose(view.time, [0.5, 1.0], atol=1e-9)
    yaw = math.pi - view.time + 0.5 * math.pi  # the head turns by 1 rad/s to the right, the eyes look to its left
    np.testing.assert_allclose(view.direction, np.column_stack([np.cos(yaw), np.sin(yaw), 0.0 * yaw]), atol=0.01)
    shutil.rmtree(tmp_path / "streams")
    plain = view_track(recorded, "guide")
    assert plain is not None
    assert plain.kind == "head"
    np.testing.assert_allclose(plain.direction[:, 1], np.sin(math.pi - plain.time), atol=1e-9)


class Glance(Nod):
    """Nods, and looks to the left in the head; the eyes are closed between 0.5 s and 1 s."""

    def orders(self, simulation):
        """Return the pose at the next step."""
        (order,) = super().orders(simulation)
        closed = 0.5 < order.time < 1.0
        return [order if closed else dataclasses.replace(order, gaze=(0.0, 2.0, 0.0))]


def test_the_gaze_of_a_headset_is_in_the_episode_and_closed_eyes_are_unknown(tmp_path):
    trial, folder = parse_trial(MEETING), tmp_path / "001-meet"
    folder.mkdir()
    BackgroundRun(trial, 0, folder / "episode.mcap", sources=[Glance()]).result()
    recorded = RecordedTrial(trial, read_episode(folder / "episode.mcap"), folder, 0.0)
    assert replay(folder / "episode.mcap").equal
    view = view_track(recorded, "guide")
    assert view is not None
    assert view.kind == "gaze"
    closed = np.isnan(view.direction[:, 0])
    np.testing.assert_array_equal(closed, (view.time > 0.5 + 1e-9) & (view.time < 1.0 - 1e-9))
    yaw = math.pi - view.time + 0.5 * math.pi
    np.testing.assert_allclose(
        view.direction[~closed], np.column_stack([np.cos(yaw), np.sin(yaw), 0.0 * yaw])[~closed], atol=1e-9
    )
    shares, kind = looking_shares(recorded)
    assert kind == "gaze"
    assert 0.0 <= shares["looking"] <= 1.0


@pytest.mark.parametrize("gaze", [(1.0, 0.0), (0.0, 0.0, 0.0), (math.nan, 0.0, 1.0), "ahead"])
def test_a_gaze_that_is_no_direction_is_refused(gaze):
    with pytest.raises(InputError, match="gaze"):
        AvatarOrder(avatar="guide", x=0.0, y=0.0, head=(0.0, 0.0, 1.6, 1.0, 0.0, 0.0, 0.0), gaze=gaze)
    with pytest.raises(InputError, match="frame of the head"):
        AvatarOrder(avatar="guide", x=0.0, y=0.0, gaze=(1.0, 0.0, 0.0))


@pytest.mark.live
def test_the_command_sends_and_records_and_a_withdrawal_deletes_the_streams(tmp_path, capsys):
    outlet = sender("pulse", labels=("rate",))
    words = ["experiment", "run", "robot-speed", "--participant", "1", "--out", str(tmp_path), "--rehearse"]
    assert main([*words, "--lsl", "--lsl-record", "pulse"]) == 0
    del outlet
    home = tmp_path / "participant-001"
    assert sorted(path.name for path in (home / "streams").iterdir()) == ["pulse.csv", "pulse.json"]
    assert len(list(home.glob("*/clock.csv"))) == 3
    withdraw(tmp_path, 1)
    assert [path.name for path in tmp_path.rglob("*")] == ["withdrawn.json"]
    assert main([*words[:4], "2", *words[5:], "--lsl-record", "pulse=x"]) == 2
    assert "no stream with the name 'pulse=x'" in capsys.readouterr().err
    assert main([*words[:4], "3", *words[5:], "--rate", "0"]) == 2
    assert "--rate 0" in capsys.readouterr().err

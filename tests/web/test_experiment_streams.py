"""The experiments tab sends and records streams of the Lab Streaming Layer, with real ones on the loopback."""

import asyncio
import json
import time

import pylsl
import pytest

from crowdbot.cli import main
from crowdbot.core import InputError
from crowdbot.experiments import read_log, read_streams
from crowdbot.web import AppSession, Workspace, with_streams
from crowdbot.web.experiments import ExperimentDesk, StreamChoice
from lsl_network import arrived, inlet_of  # also keeps the streams on this machine

pytestmark = [pytest.mark.live, pytest.mark.xdist_group("lsl")]


@pytest.fixture
def session(tmp_path):
    loop = asyncio.new_event_loop()
    app_session = AppSession("main", Workspace(tmp_path / "files"), with_streams((ExperimentDesk,), True, []), loop)
    yield app_session
    app_session.close()
    loop.close()


@pytest.fixture
def pulse():
    """A sensor that sends the numbers of heart beats."""
    info = pylsl.StreamInfo("pulse", "ECG", 1, 0.0, pylsl.cf_double64, "app-pulse")
    info.set_channel_labels(["rate"])
    return pylsl.StreamOutlet(info)


def wait_for(desk, *phases):
    for _ in range(6000):
        state = desk.greet()
        if state["phase"] in phases:
            return state
        time.sleep(0.05)
    raise AssertionError(f"{state['phase']} after five minutes")


def test_a_session_sends_poses_and_answers_and_records_a_sensor(session, pulse):
    desk = session.desk("experiments")
    assert desk.greet() == {"open": False, "streams": {"send": True, "record": []}}
    state = desk.open("robot-speed", 1, rate=100.0, record_streams=["pulse", " "])
    assert state["streams"] == {"send": True, "record": ("pulse",)}
    events = inlet_of("crowdbot-events")
    desk.answer({"age": 30, "robots": "often"})
    for beat in range(5):
        pulse.push_sample([60.0 + beat])
    desk.next()
    desk.next()
    wait_for(desk, "running")
    robots = inlet_of("crowdbot-robots")
    wait_for(desk, "screen")
    for _ in range(200):
        if sum(desk._streams.counts.values()) >= 5:
            break
        time.sleep(0.05)
    poses = [values for _, values in arrived(robots)]
    assert len(poses) > 3
    assert all(len(row) == 3 for row in poses)
    told = [json.loads(values[0]) for _, values in arrived(events)]
    assert {"event": "answered", "question": "age", "value": 30} in told
    assert {"begin", "finish"} <= {item["event"] for item in told}
    home = session.workspace.folder / state["folder"]
    desk.abort("a test")
    assert [stream.values[:, 0].tolist() for stream in read_streams(home)] == [[60.0, 61.0, 62.0, 63.0, 64.0]]
    assert any("monotonic" in row for row in read_log(home / "session.jsonl"))
    desk.leave()
    for inlet in (events, robots):
        inlet.close_stream()
    assert pylsl.resolve_byprop("name", "crowdbot-events", 1, 0.5) == []


def test_a_missing_stream_opens_no_session(session, monkeypatch):
    desk = session.desk("experiments")
    with pytest.raises(InputError, match="no stream with the name 'nobody'"):
        desk.open("robot-speed", 2, send_streams=False, record_streams=["nobody"])
    assert desk.greet()["open"] is False
    assert desk.open("robot-speed", 2, resume=True, send_streams=False)["streams"] == {"send": False, "record": ()}
    assert pylsl.resolve_byprop("name", "crowdbot-events", 1, 0.3) == []
    desk.leave()
    monkeypatch.setitem(__import__("sys").modules, "pylsl", None)
    with pytest.raises(ImportError, match=r"crowdbot\[lsl\]"):
        desk.open("robot-speed", 3)
    assert desk.greet()["open"] is False


def test_the_command_line_chooses_the_streams(monkeypatch, tmp_path):
    seen = []
    monkeypatch.setattr("crowdbot.cli.app._serve", lambda server, *_: seen.append(server) or asyncio.sleep(0))
    words = ["app", "--no-browser", "--port", "0", "--folder", str(tmp_path), "--lsl", "--lsl-record", "type=EEG"]
    assert main(words) == 0
    desk = next(desk for desk in seen[0].desks if issubclass(desk, ExperimentDesk))
    assert desk.streams == StreamChoice(send=True, record=("type=EEG",))

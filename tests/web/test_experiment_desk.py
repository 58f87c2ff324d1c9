"""The experiments tab without a browser: a whole session, pause, repeat, failures, resume; files as on the console."""

import asyncio
import functools
import itertools
import json
import time

import pytest

from crowdbot.core import EpisodeError, InputError, PacedClock
from crowdbot.experiments import load_experiment, plan, read_log
from crowdbot.recording import replay
from crowdbot.web import AppSession, Workspace
from crowdbot.web.experiments import ExperimentDesk

ANSWERS = {"age": 30, "robots": "often", "comfort": 5}


@pytest.fixture
def desk(tmp_path):
    loop = asyncio.new_event_loop()
    session = AppSession("main", Workspace(tmp_path / "files"), (ExperimentDesk,), loop)
    yield session.desk("experiments")
    session.close()
    loop.close()


def wait_for(desk, *phases):
    for _ in range(6000):
        state = desk.greet()
        if not state["open"] or state["phase"] in phases:
            return state
        time.sleep(0.05)
    raise AssertionError(f"{state['phase']} after five minutes")


def go_through(desk, until=("done",)):
    """Answer every question and watch every trial until a phase."""
    while (state := wait_for(desk, "screen", "pause", *until))["phase"] not in until:
        named = {item["name"] for item in state["questions"] if item["required"]}
        if named:
            desk.answer({name: value for name, value in ANSWERS.items() if name in named})
        desk.next()
    return state


def test_a_session_has_the_files_and_order_of_the_console(desk):
    state = desk.open("robot-speed", 2, rate=100.0)
    assert (state["phase"], [item["name"] for item in state["questions"]]) == ("screen", ["age", "robots"])
    state = go_through(desk)
    steps = plan(load_experiment("robot-speed"), 2)
    assert [item["name"] for item in state["steps"]] == [step.name for step in steps]
    folder = desk.session.workspace.folder / state["folder"]
    records = read_log(folder / "session.jsonl")
    assert sum(record.get("event") == "finish" for record in records) == 3
    assert records[0]["participant"] == 2
    episodes = sorted(folder.glob("*/episode.mcap"))
    assert len(episodes) == 3
    assert replay(episodes[0]).equal
    given = [json.loads(line) for line in (folder / "answers.jsonl").read_text().splitlines()]
    assert {item["question"]: item["answer"] for item in given} == {"age": 30, "robots": "often"}
    assert [row["opinion.comfort"] for row in desk.answers() if row.get("opinion.comfort")] == [5, 5]


def test_a_trial_is_paused_continued_and_repeated(desk):
    desk.open("robot-speed", 1, rate=1.0)
    desk.answer({"age": 30, "robots": "often"})
    desk.next()
    desk.next()
    wait_for(desk, "running")
    for _ in range(6000):
        if desk.description():
            break
        time.sleep(0.05)
    assert [item["name"] for item in desk.description()["robots"]] == ["robot"]
    assert desk.resource("bodies/2.bin", {}).data
    assert desk.pause()["phase"] == "pause"
    assert desk.resume()["phase"] == "running"
    state = desk.repeat()
    assert state["phase"] in ("trial", "running")
    state = wait_for(desk, "running")
    names = [item.name for item in (desk.session.workspace.folder / state["folder"]).iterdir() if item.is_dir()]
    assert sorted(names) == ["001-alone", "001-alone-attempt-2"]
    assert desk.abort("a test")["phase"] == "aborted"


@pytest.mark.parametrize(("seconds", "late"), [(0.02, False), (0.06, True)])
def test_trials_that_cannot_keep_their_speed_are_told_to_the_operator(seconds, late, desk, monkeypatch):
    """A step of these trials is 0.1 s; a look at the clock takes ``seconds``, and waiting takes no time."""
    now = itertools.count(0.0, seconds)
    clock = functools.partial(PacedClock, monotonic=lambda: next(now), sleep=lambda seconds: None)
    monkeypatch.setattr("crowdbot.web.experiments.experiment_desk.PacedClock", clock)
    desk.open("robot-speed", 1, rate=2.0)
    state = go_through(desk)
    assert list(state["late"]) == (list(state["outcomes"]) if late else [])
    assert all(text.startswith("the run could not keep up with speed 2: ") for text in state["late"].values())


def test_a_session_is_closed_and_continued(desk):
    desk.open("robot-speed", 1)
    desk.answer({"age": 30, "robots": "often"})
    assert desk.leave() == {"open": False, "streams": {"send": False, "record": []}}
    with pytest.raises(EpisodeError, match="already has a session"):
        desk.open("robot-speed", 1)
    state = desk.open("robot-speed", 1, resume=True)
    assert state["answers"] == {"age": 30, "robots": "often"}


@pytest.mark.parametrize(
    ("act", "sentence"),
    [
        (lambda desk: desk.next(), "no session is open; choose an experiment and a participant"),
        (lambda desk: desk.open("robot-speed", 1, rate=0.0), "rate = 0: expected 0.1 to 100"),
        (lambda desk: desk.open("robot-sped", 1), "file 'robot-sped' does not exist"),
        (lambda desk: desk.open("../x", 1), "outside the folder"),
        (lambda desk: desk.open("robot-speed", 0), "participant"),
        (lambda desk: desk.open("robot-speed", 1) and desk.next(), "unanswered questions: 'age', 'robots'"),
        (lambda desk: desk.open("robot-speed", 1) and desk.answer({"age": 7}), "18"),
        (lambda desk: desk.open("robot-speed", 1) and desk.answer({"x": 7}), "has no question 'x'"),
        (lambda desk: desk.open("robot-speed", 1) and desk.open("robot-speed", 2), "has not finished"),
    ],
)
def test_what_is_not_possible_is_told(desk, act, sentence):
    with pytest.raises(InputError, match=sentence):
        act(desk)

"""The evaluation tab without a browser: the numbers of the command line, cancelling, watching a run, reports."""

import asyncio
import time

import pytest

from crowdbot.core import InputError
from crowdbot.evaluation import EvaluationPlan, evaluate, parse_methods
from crowdbot.simulation import simulate
from crowdbot.trials import load_trial, trial_xml
from crowdbot.web import AppSession, Workspace
from crowdbot.web.evaluation import EvaluationDesk


@pytest.fixture
def desk(tmp_path):
    loop = asyncio.new_event_loop()
    session = AppSession("main", Workspace(tmp_path / "files"), (EvaluationDesk,), loop)
    yield session.desk("evaluation")
    session.close()
    loop.close()


def wait_for_end(desk):
    for _ in range(6000):
        state = desk.greet()
        if not state["running"]:
            return state
        time.sleep(0.05)
    raise AssertionError("the evaluation did not end in five minutes")


def test_the_table_is_that_of_evaluate_and_a_run_can_be_watched(desk):
    desk.run("first", ["frontal"], "straight, orca", "0:3")
    assert wait_for_end(desk) == {
        "evaluations": [{"name": "first", "done": True}],
        "running": "",
        "share": 0.0,
        "problem": "",
    }
    table = desk.table("first")
    plan = EvaluationPlan([load_trial("frontal")], parse_methods("straight, orca"), seeds=range(3))
    same = evaluate(plan)
    assert [one["navigator"] for one in table["cells"]] == ["straight", "orca"]
    assert [one["estimates"] for one in table["cells"]] == [
        [str(cell.estimate(name)) for name in table["statistics"]] for cell in same.cells
    ]
    assert table["command"].startswith('crowdbot evaluate frontal --navigators "straight, orca" --seeds 0:3')

    found = desk.watch("first", 1, 2)
    trial = load_trial(str(desk.session.workspace.folder / found["file"]))
    assert simulate(trial, 2).digest == same.cells[1].runs[2].digest
    report = desk.resource("first/report.html", {})
    assert report.sandbox
    assert b"<html" in report.data


def test_a_cancelled_evaluation_continues(desk):
    desk.run("long", ["frontal", "circle-crossing"], "straight, orca", "0:64")
    state = desk.cancel()
    assert state["running"] == ""
    assert "run it again to continue" in wait_for_end(desk)["problem"]
    desk.run("long", ["frontal"], "straight", "0:2")
    assert wait_for_end(desk)["problem"] == ""
    assert len(desk.table("long")["cells"][0]["runs"]) == 2


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("a", [], "orca", "0:2"), "needs a trial"),
        (("a", ["frontl"], "orca", "0:2"), "frontl"),
        (("a", ["../x.xml"], "orca", "0:2"), "neither a built-in trial nor a trial file in the folder"),
        (("a", ["frontal"], "orka", "0:2"), "orka"),
        (("a", ["frontal"], "orca", "two"), "two"),
        (("a", ["frontal"], "orca", "0:200000"), "at most 100000"),
        (("../a", ["frontal"], "orca", "0:2"), "name of an evaluation = '../a'"),
    ],
)
def test_wrong_requests_are_refused_before_they_run(desk, arguments, sentence):
    with pytest.raises(InputError, match=sentence):
        desk.run(*arguments)
    assert desk.greet()["running"] == ""


def test_a_run_of_a_changed_trial_is_not_watched(desk):
    path = desk.session.workspace.writable("mine.xml")
    path.write_text(trial_xml(load_trial("frontal", duration=2.0)))
    desk.run("own", ["mine.xml"], "orca", "0:1")
    assert wait_for_end(desk)["problem"] == ""
    path.write_text(trial_xml(load_trial("frontal", duration=3.0)))
    with pytest.raises(InputError, match="has changed since own was run"):
        desk.watch("own", 0, 0)

"""The evaluation tab without a browser: the numbers of the command line, cancelling, watching a run, reports."""

import asyncio
import time

import pytest

from crowdbot.cli import main
from crowdbot.core import EpisodeError, InputError
from crowdbot.evaluation import EvaluationPlan, evaluate, load_evaluation, parse_methods
from crowdbot.recording import read_episode
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


@pytest.mark.live
def test_the_table_is_that_of_evaluate_and_a_run_can_be_watched(desk, capsys):
    desk.run("first", ["frontal"], "straight, orca", "0:3")
    assert wait_for_end(desk) == {
        "evaluations": [{"name": "first", "done": True}],
        "running": "",
        "share": 0.0,
        "problem": "",
        "first": "",
    }
    table = desk.table("first")
    plan = EvaluationPlan([load_trial("frontal")], parse_methods("straight, orca"), seeds=range(3))
    same = evaluate(plan)
    assert [one["navigator"] for one in table["cells"]] == ["straight", "orca"]
    assert [one["estimates"] for one in table["cells"]] == [
        [str(cell.estimate(name)) for name in table["statistics"]] for cell in same.cells
    ]
    assert table["titles"][-2:] == ["time-to-goal [s]", "min-clearance [m]"]
    assert table["command"].startswith('crowdbot evaluate frontal --navigators "straight, orca" --seeds 0:3')

    exec(table["python"], {})
    assert capsys.readouterr().out.splitlines() == [
        "; ".join([one["trial"], one["navigator"], *one["estimates"]]) for one in table["cells"]
    ]

    found = desk.watch("first", 1, 2)
    trial = load_trial(str(desk.session.workspace.folder / found["file"]))
    assert simulate(trial, 2).digest == same.cells[1].runs[2].digest
    episode = read_episode(desk.session.workspace.folder / found["episode"])
    assert episode.digest == same.cells[1].runs[2].digest
    assert found["at"] == pytest.approx(max(0.0, float(episode.times[-1]) - 5.0), abs=0.21)
    report = desk.resource("first/report.html", {})
    assert report.sandbox
    assert b"<html" in report.data


@pytest.fixture
def result(tmp_path, monkeypatch):
    """A result of the command line, in a folder elsewhere."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.xml").write_text(trial_xml(load_trial("frontal", duration=2.0)).replace('"frontal"', '"mine"'))
    words = ["evaluate", "frontal", "mine.xml", "--navigators", "straight, orca time-horizon=3", "--seeds", "0:2"]
    words += ["--out", "elsewhere"]
    monkeypatch.setattr("sys.argv", ["crowdbot", *words])
    assert main(words) == 0
    return tmp_path / "elsewhere" / "result.json"


def test_a_result_of_the_command_line_is_opened_and_its_runs_are_watched(desk, result, capsys):
    space = desk.session.workspace
    space.writable("result.json").write_bytes(result.read_bytes())
    name = desk.add("result.json")
    assert (name, desk.add("result.json")) == ("result", "result")
    assert desk.greet()["evaluations"] == [{"name": "result", "done": True}]
    table, same = desk.table(name), load_evaluation(result)
    assert [one["estimates"] for one in table["cells"]] == [
        [str(cell.estimate(metric)) for metric in table["statistics"]] for cell in same.cells
    ]
    assert table["command"].split()[1:4] == ["evaluate", "frontal", "mine.xml"]
    assert b"<html" in desk.resource(f"{name}/report.html", {}).data
    found = desk.watch(name, 1, 1)
    assert read_episode(space.folder / found["episode"]).digest == same.cells[1].runs[1].digest
    with pytest.raises(InputError, match="trial 'mine' of this result is not in the folder"):
        desk.watch(name, 2, 0)
    space.writable("mine.xml").write_text(trial_xml(load_trial("frontal", duration=3.0)))
    with pytest.raises(InputError, match="the trial mine is not the one that was run"):
        desk.watch(name, 2, 0)
    space.writable("mine.xml").write_bytes((result.parents[1] / "mine.xml").read_bytes())
    assert read_episode(space.folder / desk.watch(name, 2, 0)["episode"]).digest == same.cells[2].runs[0].digest


def test_another_file_is_no_result(desk):
    desk.session.workspace.writable("a.json").write_text('{"schema": "other"}')
    with pytest.raises(EpisodeError, match="its schema is 'other'"):
        desk.add("a.json")
    with pytest.raises(InputError, match="outside the folder"):
        desk.add("../result.json")
    assert desk.greet()["evaluations"] == []


@pytest.mark.live
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
        (("a", ["frontal"], "orca", "0:2", ["/x/mine.py:Near"]), "metrics: file '/x/mine.py' is outside the folder"),
        (("a", ["frontal"], "orca", "0:2", ["median:a,../m.py:Near"]), "metrics: file '../m.py' is outside"),
    ],
)
def test_wrong_requests_are_refused_before_they_run(desk, arguments, sentence):
    with pytest.raises(InputError, match=sentence):
        desk.run(*arguments)
    assert desk.greet()["running"] == ""


@pytest.mark.live
def test_a_run_of_a_changed_trial_is_not_watched(desk):
    path = desk.session.workspace.writable("mine.xml")
    path.write_text(trial_xml(load_trial("frontal", duration=2.0)))
    desk.run("own", ["mine.xml"], "orca", "0:1")
    assert wait_for_end(desk)["problem"] == ""
    path.write_text(trial_xml(load_trial("frontal", duration=3.0)))
    with pytest.raises(InputError, match="has changed since own was run"):
        desk.watch("own", 0, 0)

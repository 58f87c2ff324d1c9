"""The evaluation tab without a browser: the numbers of the command line, cancelling, watching a run, reports."""

import asyncio
import shutil
import time
from pathlib import Path

import pytest

import crowdbot
from crowdbot.cli import main
from crowdbot.core import EpisodeError, InputError
from crowdbot.evaluation import EvaluationPlan, evaluate, load_evaluation, parse_methods
from crowdbot.recording import read_episode
from crowdbot.simulation import simulate
from crowdbot.trials import load_trial, trial_xml
from crowdbot.web import AppSession, Workspace
from crowdbot.web.evaluation import EvaluationDesk, EvaluationRequest
from crowdbot.world import builtin_robots

ROBOTS = Path(crowdbot.__file__).parent / "assets" / "robots"


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
    assert [item["navigator"] for item in table["cells"]] == ["straight", "orca"]
    assert [item["estimates"] for item in table["cells"]] == [
        [str(cell.estimate(name)) for name in table["statistics"]] for cell in same.cells
    ]
    assert table["titles"][-2:] == ["time-to-goal [s]", "min-clearance [m]"]
    assert table["command"].startswith('crowdbot evaluate frontal --navigators "straight, orca" --seeds 0:3')

    exec(table["python"], {})
    assert capsys.readouterr().out.splitlines() == [
        "; ".join([item["trial"], item["navigator"], *item["estimates"]]) for item in table["cells"]
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
    assert [item["estimates"] for item in table["cells"]] == [
        [str(cell.estimate(metric)) for metric in table["statistics"]] for cell in same.cells
    ]
    assert len(table["comparisons"]) >= 2  # each has the name of its column
    assert all(any(f", {title}: " in line for title in table["titles"]) for line in table["comparisons"])
    assert any(", person-collision-rate [share]: orca" in line for line in table["comparisons"])
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
        (("a", ["frontal"], "orca", "0:2", None, False, "peper"), "'peper'.* not a robot, did you mean 'pepper'"),
        (("a", ["frontal"], "orca", "0:2", None, False, "qolo, ../bot"), "robots: file '../bot' is outside the folder"),
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


@pytest.fixture
def mybot(desk, monkeypatch):
    """A robot folder in the folder of the session, which is the working folder."""
    folder = desk.session.workspace.folder
    shutil.copytree(ROBOTS / "differential", folder / "mybot")
    monkeypatch.chdir(folder)
    return folder / "mybot"


def printed(words, capsys):
    """Return what ``crowdbot evaluate`` prints on stderr and stdout, without line breaks."""
    main(["evaluate", *words, "--seeds", "0:1", "--set", "duration=0.2", "--worst", "0"])
    out, err = capsys.readouterr()
    return err.splitlines(), " ".join(out.split())


def test_robots_are_described_in_the_words_of_the_command_line(desk, mybot, capsys):
    assert desk.sources()["robots"] == ["mybot", *builtin_robots()]
    robots = desk.robots(["doorway"], "wheelchair, mybot")
    lines, text = printed(["doorway", "--robots", "wheelchair, mybot"], capsys)
    assert robots["problem"] == ""
    assert [f"crowdbot: {one}" for one in robots["lines"]] == [line for line in lines if line.startswith("crowdbot: ")]
    assert [line.split(":")[0] for line in robots["lines"][2:]] == [
        "robot 'robot' is wheelchair",
        "robot 'robot' is mybot",
    ]
    assert "instead of <drive" in robots["lines"][1]
    assert robots["remarks"] == []  # the outline of the wheelchair fits the door
    assert "Note on" not in text


@pytest.mark.parametrize("robots", ["peper", "qolo, qolo", "mybot/robot.xml", "own", "a" * 300])
def test_wrong_robots_have_the_message_of_the_command_line(desk, mybot, capsys, robots):
    lines, _ = printed(["frontal", "--robots", robots], capsys)
    found = desk.robots(["frontal"], robots)
    assert found["lines"] == []
    assert f"crowdbot: {found['problem']}" in lines


@pytest.mark.parametrize("robots", ["../other", "/tmp", "link", "qolo, sub/../../other", "~/other"])
def test_robots_outside_the_folder_are_refused(desk, mybot, robots):
    shutil.copytree(mybot, mybot.parents[1] / "other")
    (mybot.parent / "link").symlink_to(mybot.parents[1] / "other")
    assert "is outside the folder of the app" in desk.robots(["frontal"], robots)["problem"]
    with pytest.raises(InputError, match="is outside the folder of the app"):
        desk.run("a", ["frontal"], "orca", "0:1", robots=robots)


def test_a_robot_that_loads_code_from_elsewhere_is_refused(desk, mybot):
    text = (mybot / "robot.xml").read_text()
    (mybot / "robot.xml").write_text(text.replace('"wheel-odometry"', '"../other.py:Other"'))
    (mybot.parent / "other.py").write_text("raise AssertionError")
    assert "../other.py" in desk.robots(["frontal"], "mybot")["problem"]


def test_a_wrong_trial_is_not_a_problem_of_the_robots(desk):
    with pytest.raises(InputError, match="frontl"):
        desk.robots(["frontl"], "pepper")


def test_two_robots_are_two_rows_and_the_run_of_each_is_watched(desk, mybot, monkeypatch):
    space = desk.session.workspace
    space.writable("halls/hall.xml").write_text(trial_xml(load_trial("frontal", duration=2.0)))
    request = EvaluationRequest(("halls/hall.xml",), "straight", "0:2", ("min-clearance",), robots="./mybot, ,qolo")
    request.plan(space.folder)
    request.save(space.folder / "evaluations/two")
    words = [*request.words, "--out", "evaluations/two"]
    assert "--robots=mybot,,qolo" in words
    monkeypatch.setattr("sys.argv", ["crowdbot", *words])
    assert main(words) == 0
    monkeypatch.chdir(mybot.parents[1])
    table, result = desk.table("two"), load_evaluation(space.folder / "evaluations/two/result.json")
    assert [item["robot"] for item in table["cells"]] == ["mybot", "disc of 0.3 m", "qolo"]
    assert [item["named"] for item in table["cells"]] == ["mybot", "", "qolo"]
    assert len({item["estimates"][0] for item in table["cells"]}) == 3
    assert "--robots files/mybot,,qolo" in table["command"]
    assert "['files/mybot', '', 'qolo']" in table["python"]
    for row in (0, 2):
        found = desk.watch("two", row, 1)
        episode = read_episode(space.folder / found["episode"])
        assert episode.digest == result.cells[row].runs[1].digest
        assert simulate(load_trial(str(space.folder / found["file"])), 1).digest == episode.digest

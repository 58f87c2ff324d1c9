"""Jobs: progress, log, cancel, limits, the list after a restart, and results equal to those of the command line."""

import importlib
import json
import re
import shlex
import sys
import threading
import time
from pathlib import Path

import pytest
from job_functions import burn, count, die, fail, fill_disk, fill_memory, fill_memory_of_a_child

from crowdbot.cli import main
from crowdbot.cli.parser import CommandParser
from crowdbot.core import InputError
from crowdbot.data import FILE_OPTIONS
from crowdbot.trials import load_trial
from crowdbot.web import JobBoard, SessionLimits, Workspace, call_command
from crowdbot.web.jobs import JobWork, job_process
from crowdbot.web.jobs.job_desk import JobDesk
from crowdbot.web.prediction import PredictionDesk


class Windows:
    """A session without windows."""

    name = "main"

    def __init__(self, folder, limits=None):
        limits = limits or SessionLimits()
        self.workspace, self.events = Workspace(folder, limit=limits.disk), []
        self.jobs = JobBoard(self.workspace, limits, self.tell)

    def tell(self, event, data):
        self.events.append((event, json.loads(json.dumps(data, allow_nan=False))))


def wait(board, seconds=300):
    end = time.monotonic() + seconds
    while board.active:
        if time.monotonic() > end:
            raise TimeoutError(board.records)
        time.sleep(0.02)
    return board.records[-1]


@pytest.fixture
def session(tmp_path):
    one = Windows(tmp_path / "files")
    yield one
    one.jobs.close()


@pytest.mark.live
def test_a_job_reports_and_is_listed_after_a_restart(session, tmp_path):
    seen, ended = [], threading.Event()
    session.jobs.submit(
        JobWork("count", "to five", count, (5,)), lambda *message: seen.append(message), lambda job: ended.set()
    )
    assert wait(session.jobs).state == "done"
    assert ended.wait(180)
    assert seen == [("number", number) for number in range(5)]
    again = Windows(tmp_path / "files")
    assert again.jobs.facts()["jobs"][0] == session.jobs.records[0].values
    assert again.jobs.records[0].cpu > 0.0
    assert again.jobs.submit(JobWork("count", "more", count, (1,))).record.number == 2
    wait(again.jobs)


@pytest.mark.live
@pytest.mark.parametrize(
    ("target", "arguments", "problem"),
    [
        (fail, ("the value is wrong",), "the value is wrong"),
        (fail, ("",), "ZeroDivisionError: a bug; this is a bug in crowdbot or in your code"),
        (die, (), "the worker process has died (out of memory?)"),
    ],
)
def test_a_failure_is_listed_with_its_sentence(session, target, arguments, problem):
    session.jobs.submit(JobWork("fail", "fails", target, arguments))
    found = wait(session.jobs)
    assert (found.state, found.problem) == ("failed", problem)


def runs(process):
    """Whether a process exists and is not a zombie, which init reaps."""
    try:
        return "\nState:\tZ" not in Path(f"/proc/{process}/status").read_text(encoding="utf-8")
    except OSError:
        return False


@pytest.mark.live
@pytest.mark.parametrize("target", [fill_memory, fill_memory_of_a_child])
def test_a_job_that_takes_too_much_memory_ends(tmp_path, target):
    session, seen = Windows(tmp_path, SessionLimits(memory=400e6)), []
    session.jobs.submit(JobWork("fill", "takes", target, (600,)), lambda *message: seen.append(message))
    found = wait(session.jobs)
    assert found.state == "failed"
    used, limit = re.fullmatch(
        r"the job uses (\d+) MB of memory; the limit of a job is (\d+) MB \(--memory\); it has ended", found.problem
    ).groups()
    assert (400 < int(used) < 2000, int(limit)) == (True, 400)
    for _, child in seen:
        end = time.monotonic() + 180.0
        while runs(child) and time.monotonic() < end:
            time.sleep(0.05)
        assert not runs(child)


@pytest.mark.live
def test_jobs_wait_for_their_turn_and_are_cancelled(tmp_path):
    session = Windows(tmp_path, SessionLimits(jobs=1, waiting=2))
    for title in ("first", "second", "third"):
        session.jobs.submit(JobWork("count", title, count, (10_000, 0.01)))
    assert [record.state for record in session.jobs.records] == ["running", "waiting", "waiting"]
    with pytest.raises(InputError, match="2 jobs are waiting, the limit of a session"):
        session.jobs.submit(JobWork("count", "fourth", count, (1,)))
    session.jobs.cancel(2)
    assert [record.state for record in session.jobs.records] == ["running", "cancelled", "waiting"]
    session.jobs.cancel(1)
    assert [record.state for record in session.jobs.records] == ["cancelled", "cancelled", "running"]
    with pytest.raises(InputError, match="job 3 is running; cancel it first"):
        session.jobs.remove(3)
    session.jobs.close()
    assert [record.state for record in Windows(tmp_path).jobs.records] == ["cancelled", "cancelled", "interrupted"]


@pytest.mark.live
def test_a_job_ends_when_the_processor_time_is_used(tmp_path):
    session = Windows(tmp_path, SessionLimits(cpu=1.0))
    session.jobs.submit(JobWork("burn", "burns", burn))
    found = wait(session.jobs)
    assert (found.state, found.problem) == ("failed", "the processor time of the jobs is used up")
    with pytest.raises(InputError, match=r"used up \(1 s\); ask the person who runs the server"):
        session.jobs.submit(JobWork("count", "more", count, (1,)))


@pytest.mark.live
def test_a_job_ends_when_the_folder_is_full(tmp_path):
    session = Windows(tmp_path / "files", SessionLimits(disk=20e6))
    session.jobs.submit(JobWork("fill", "fills", fill_disk, (str(tmp_path / "files" / "large.bin"),)))
    assert wait(session.jobs).problem.startswith("your folder is full: ")
    with pytest.raises(InputError, match="your folder is full"):
        session.workspace.writable("more.txt")


@pytest.mark.parametrize("text", ["", "[", "[7]", '[{"number": 1}]', '{"a": 1}'])
def test_a_damaged_list_is_an_empty_one(tmp_path, text):
    folder = tmp_path / ".crowdbot-jobs"
    folder.mkdir()
    (folder / "jobs.json").write_text(text)
    assert Windows(tmp_path).jobs.records == []


class TestDesk:
    """The commands of the jobs tab."""

    @pytest.fixture
    def call(self, session):
        desk = JobDesk(session)

        def call(name, **arguments):
            return json.loads(json.dumps(call_command(desk, name, arguments), allow_nan=False))

        call.desk = desk
        return call

    @pytest.mark.live
    def test_generated_data_are_those_of_the_command_line(self, session, call, tmp_path):
        from crowdbot.generation import GenerationPlan, generate
        from crowdbot.trials import load_trial, trial_xml

        path = session.workspace.writable("short.xml")
        path.write_text(trial_xml(load_trial("frontal", duration=1.0)))
        values = {"sources": ["short.xml"], "seeds": "0:2", "sensors": "sick-tim571", "name": "mine"}
        words = call("words", kind="generate", values=values)
        assert words.startswith("crowdbot generate short.xml --seeds=0:2 --sensors=sick-tim571 --format=npz --out")
        number = call("begin", kind="generate", values=values)
        assert wait(session.jobs, 300).problem == ""
        same = generate(GenerationPlan([load_trial(str(path))], range(2), ["sick-tim571"]), tmp_path / "same")
        names = [item["name"] for item in call("files", number=number)]
        assert "README.md" in names
        for name in same.files:
            data = call.desk.resource(f"{number}/files/{name}", {}).data
            assert data == (tmp_path / "same" / name).read_bytes()
        assert call.desk.resource(f"{number}/all.zip", {}).data[:2] == b"PK"
        assert "generate" in call("log", number=number)
        assert any(event.startswith("jobs.") for event, _ in session.events)
        call("remove", number=number, results=True)
        assert not (session.workspace.folder / "generated" / "mine").exists()

    @pytest.mark.live
    def test_a_trained_network_predicts(self, session, call):
        number = call("begin", kind="train", values={"data": ["example:bottleneck"], "epochs": 1, "name": "net"})
        assert wait(session.jobs, 300).problem == ""
        assert (session.workspace.folder / "trainings/net/best.npz").is_file()
        assert "update" in call("log", number=number)
        assert session.jobs.records[-1].share == 1.0
        desk = PredictionDesk(session)
        call_command(desk, "example", {"name": "bottleneck"})
        (weights,) = call_command(desk, "weights", {})
        values = {"predictor": "anchor-net", "samples": 20, "weights": weights}
        call_command(desk, "add", {"settings": values})
        call_command(desk, "run", {})
        assert wait(session.jobs, 300).problem == ""
        assert desk.greet()["predictors"][0]["results"]["clean"]["state"] == "done"
        assert "trainings/net/best.npz" in call_command(desk, "command_line", {})
        with pytest.raises(InputError, match="outside the folder"):
            call_command(desk, "add", {"settings": {**values, "weights": "/etc/passwd"}})

    @pytest.mark.sweep  # test_jobs_page.py does this in the page
    def test_failures_are_searched(self, session, call):
        values = {"trial": "frontal", "navigator": "straight", "search": "plain", "runs": 4, "name": "f"}
        number = call("begin", kind="falsify", values=values)
        assert wait(session.jobs, 300).problem == ""
        report = call.desk.resource(f"{number}/files/report.html", {})
        assert report.sandbox
        assert b"<html" in report.data

    @pytest.mark.live
    def test_a_command_that_fails_says_why_and_runs_again(self, session, call):
        number = call("begin", kind="falsify", values={"trial": "frontal", "navigator": "orka", "name": "f"})
        assert "orka" in wait(session.jobs, 300).problem
        assert call("again", number=number) == number + 1
        wait(session.jobs, 300)

    @pytest.mark.parametrize(
        ("kind", "values", "words"),
        [
            ("train", {"data": ["hall.csv"], "columns": "id=who time=when", "scale": 0.02},
             "crowdbot train anchor-net --data hall.csv --epochs=100 --seed=0 --columns id=who time=when --scale=0.02"
             " --out trainings/mine"),
            ("train", {"data": ["walks"], "topic": "/people", "frame": "map"},
             "crowdbot train anchor-net --data walks --epochs=100 --seed=0 --topic=/people --frame=map"
             " --out trainings/mine"),
            ("recorded", {"data": "walks", "units": "cm"}, "crowdbot new trial mine.xml --recorded=walks --units=cm"),
            ("recorded", {"data": "hall.csv", "mode": "reactive", "replace": 3, "agents": "pedestrians"},
             "crowdbot new trial mine.xml --recorded=hall.csv --reactive --replace=3 --agents=pedestrians"),
            ("measure", {"data": ["hall.csv", "walks"], "methods": "line", "line": "0 0, 0 -3", "area": "0 0 4 0 4 2"},
             "crowdbot measure hall.csv walks --axis=x --methods line --area 0.0 0.0 4.0 0.0 4.0 2.0"
             " --line 0.0 0.0 0.0 -3.0 --out measurements/mine"),
            ("logs", {"data": ["hall.csv"], "robot_id": "7", "goal": "8, -1", "homography": "H.txt"},
             "crowdbot evaluate --logs hall.csv --robot-id=7 --robot-radius=0.3 --goal 8.0 -1.0 --homography=H.txt"
             " --out evaluations/mine"),
            ("real", {"data": "hall.csv", "robot_file": "walks/1.csv", "fps": 25},
             "crowdbot evaluate --real hall.csv --navigators=own --seeds=0:100 --robot-file walks/1.csv"
             " --robot-radius=0.3 --fps=25.0 --out evaluations/mine"),
        ],
    )  # fmt: skip
    def test_forms_of_recordings_have_the_options_of_the_command_line(self, session, call, kind, values, words):
        for name in ("hall.csv", "walks/1.csv", "walks/2.csv", "H.txt"):
            session.workspace.writable(name).write_text("time,id,x,y\n")
        (form,) = (form for form in call("forms") if form["kind"] == kind)
        assert set(FILE_OPTIONS) <= {row["name"] for row in form["rows"]}
        assert call("words", kind=kind, values={**values, "name": "mine"}) == words
        name, *rest = shlex.split(words)[1:]
        parser = CommandParser()
        importlib.import_module(f"crowdbot.cli.{name}").arguments(parser)
        assert parser.parse_args(rest)

    def test_results_are_no_recordings_but_tracks_are(self, session, call):
        results = ("tracks.csv", "scores.json")
        for name in (*(f"tracks/seen/{file}" for file in results), "tracks/seen/tracks-2.csv", "walk.json",
                     "falsifications/f/result.json", "measurements/m/table.csv"):  # fmt: skip
            session.workspace.writable(name).touch()
        for form in call("forms"):
            for row in form["rows"]:
                if row["name"] == "data":
                    names = {name for name, _ in row["choices"] if not name.startswith("example:")}
                    assert names == {"walk.json", "tracks/seen/tracks.csv", "tracks/seen/tracks-2.csv"}

    @pytest.mark.parametrize(
        ("values", "words"),
        [
            ({"starts": 3, "duration": 6, "by": "distance", "no_map": True, "set": "max_range=8"},
             "crossing-flows --detector lidar-clusters --tracker global-nearest-neighbor --set=max_range=8"
             " --duration=6 --by=distance --starts=3 --no-map"),
            ({"source": "lab.bag", "sensor": "/rear_scan", "match_scans": True, "nobody": True,
              "detector": ["lidar-clusters", "scan-network"], "tracker": ["moving-people"]},
             "lab.bag --detector lidar-clusters scan-network --tracker moving-people --sensor=/rear_scan"
             " --match-scans --nobody"),
        ],
    )  # fmt: skip
    def test_people_are_tracked_in_trials_and_recorded_scans(self, session, call, values, words):
        for name in ("lab.bag", "drow.csv", "drow.wp", "plain.csv", "lcas/1.pcd", "lcas/2.pcd"):
            session.workspace.writable(name).touch()
        (form,) = (form for form in call("forms") if form["kind"] == "track")
        choices = next(row["choices"] for row in form["rows"] if row["name"] == "source")
        assert {"lab.bag", "drow.csv", "lcas", "frontal"} <= set(choices)
        assert not {"plain.csv", "drow.wp"} & set(choices)
        whole = f"crowdbot track {words} --out tracks/mine"
        assert call("words", kind="track", values={**values, "name": "mine"}) == whole
        parser = CommandParser()
        importlib.import_module("crowdbot.cli.track").arguments(parser)
        options = parser.parse_args(shlex.split(whole)[2:])
        assert (options.match_scans, options.no_map) == (values.get("match_scans", False), values.get("no_map", False))

    def test_a_trial_is_made_from_a_folder_of_one_file_a_person(self, session, call, monkeypatch):
        for person in (1, 2):
            rows = "".join(f"{0.4 * k:.1f},{100 * (k if person > 1 else 20 - k) * 0.5},{person}\n" for k in range(20))
            session.workspace.writable(f"walks/{person}.csv").write_text("time,x,y\n" + rows)
        values = {"data": "walks", "units": "cm", "name": "hall", "replace": 1}
        monkeypatch.chdir(session.workspace.folder)
        assert main(shlex.split(call("words", kind="recorded", values=values))[1:]) == 0
        (people,) = load_trial("hall.xml").recorded
        assert (people.data, people.units, people.exclude) == ("walks", "cm", "1")

    @pytest.mark.parametrize(
        ("kind", "values", "sentence"),
        [
            ("recorded", {"data": "../x.csv"}, "is not a value of this setting"),
            ("recorded", {"data": "example:bottleneck", "replace": 1.5}, "expected a whole number"),
            ("logs", {"data": ["example:bottleneck"], "goal": "here"}, "expected two numbers, x and y"),
            ("measure", {"data": ["example:bottleneck"], "area": "0 0 4 0"}, "expected corners, an x and a y for each"),
            ("measure", {"data": ["example:bottleneck"], "line": "0 0 nan 1"}, "expected four numbers, x1 y1 x2 y2"),
            ("track", {"source": "/etc/scans.bag"}, "is not a value of this setting"),
            ("track", {"set": "file=/etc/net.onnx"}, "is outside the folder of the app"),
            ("track", {"tracker": []}, "Trackers: choose at least one"),
            ("logs", {"data": ["example:bottleneck"], "fps": -1}, "expected a number from 0"),
            ("real", {"data": "example:bottleneck", "homography": "/etc/passwd"}, "is not a value of this setting"),
            ("train", {"data": ["example:bottleneck"], "columns": "--out=x"}, "columns: unknown '--out'"),
            ("generat", {}, "kind of job 'generat' does not exist, did you mean 'generate'"),
            ("generate", {"sources": []}, "Trials or a recipe: choose at least one"),
            ("generate", {"sources": ["../x.xml"]}, "is not a value of this setting"),
            ("generate", {"sources": ["frontal"], "name": "../a"}, "Name of the results: file '../a' is outside"),
            ("generate", {"sources": ["frontal"], "colour": 1}, "has no setting 'colour'"),
            ("falsify", {"navigator": "/etc/evil.py:Mine"}, "is outside the folder of the app"),
            ("falsify", {"navigator": "policy file=../../x.npz"}, "is outside the folder of the app"),
            ("falsify", {"runs": 0}, "Runs = 0: expected 1 to"),
            ("falsify", {"runs": True}, "is not a value of this setting"),
            ("train", {"data": ["example:none"]}, "is not a value of this setting"),
        ],
    )
    def test_wrong_forms_are_refused(self, call, kind, values, sentence):
        with pytest.raises(InputError, match=sentence.replace("(", r"\(")):
            call("begin", kind=kind, values=values)

    @pytest.mark.parametrize("path", ["x", "1", "1/files/../../secret", "9999999999/all.zip"])
    def test_files_elsewhere_are_not_read(self, call, path):
        with pytest.raises((KeyError, InputError)):
            call.desk.resource(path, {})


def test_without_linux_the_memory_of_a_job_is_that_of_its_own_process(monkeypatch):
    monkeypatch.setattr(job_process, "peak_memory", lambda: 5e6)
    assert job_process.process_memory() != 5e6
    monkeypatch.setattr(sys, "platform", "darwin")
    assert job_process.process_memory() == 5e6

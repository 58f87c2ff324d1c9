"""``crowdbot experiment`` as people use it: typed, from a file, interrupted, killed, resumed, summed up."""

import io
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pandas as pd
import pytest

from crowdbot.cli import main
from crowdbot.experiments import builtin_experiments
from crowdbot.recording import read_episode, run
from crowdbot.trials import load_trial

ROOT = Path(__file__).parents[2]
ANSWERS = {"age": 30, "robots": "never", "comfort": 5, "remarks": '=1+1, "quoted"\nand ünïcode'}

SLOW = """import os
import time
from dataclasses import dataclass
from crowdbot.navigation import Straight


@dataclass(frozen=True)
class Slow(Straight):
    \"\"\"Takes its time where a test wants to come in between.\"\"\"

    def act(self, observation):
        time.sleep(float(os.environ.get("DELAY", 0.0)))
        return super().act(observation)
"""


def _json(capsys, *words):
    status = main([*map(str, words), "--json"])
    return status, json.loads(capsys.readouterr().out)


@pytest.fixture
def answers(tmp_path):
    path = tmp_path / "answers.json"
    path.write_text(json.dumps(ANSWERS))
    return path


def test_the_shipped_experiment_from_start_to_table(capsys, tmp_path, answers):
    out = tmp_path / "data"
    for who in (1, 2):
        status, said = _json(
            capsys, "experiment", "run", "robot-speed", "--participant", who, "--out", out, "--answers", answers
        )
        assert status == 0
        assert (said["session"], said["participant"], said["outcomes"]) == ("done", who, {"success": 3})
        assert said["answers"][0] == {"screen": "welcome", "trial": None, "age": 30, "robots": "never"}
    status, rows = _json(capsys, "experiment", "summary", out, "--out", tmp_path / "table.csv")
    assert status == 0
    assert [(row["participant"], row["trial"]) for row in rows] == [
        (1, "alone"), (1, "slow"), (1, "fast"), (2, "alone"), (2, "fast"), (2, "slow"),
    ]  # fmt: skip
    table = pd.read_csv(tmp_path / "table.csv")
    assert table["opinion.remarks"].tolist()[1] == ANSWERS["remarks"]
    assert table["opinion.comfort"].isna().tolist() == [True, False, False] * 2
    by_trial = table.groupby("trial")["digest"].nunique()
    assert by_trial.to_dict() == {"alone": 1, "fast": 1, "slow": 1}
    free = run(load_trial(builtin_experiments()["robot-speed"] / "fast.xml")).digest
    assert set(table[table.trial == "fast"].digest) == {free}
    for row in rows:
        episode = read_episode(out / f"participant-00{row['participant']}" / row["folder"] / "episode.mcap")
        assert episode.digest == row["digest"]
    assert main(["experiment", "summary", str(out)]) == 0
    assert "participants: 2" in capsys.readouterr().out


def test_orders_are_printed(capsys):
    status, said = _json(capsys, "experiment", "order", "robot-speed", "--participants", 3)
    assert status == 0
    assert said["orders"]["2"] == ["practice.alone", "main.fast", "main.slow"]
    assert said["notes"] == ["block main: not balanced over 3 participants; balanced over multiples of 2"]
    assert main(["experiment", "order", "robot-speed"]) == 0
    text = capsys.readouterr().out
    assert len(re.findall(r"^ +\d+ +practice", text, flags=re.M)) == 12
    assert "balanced over 12 participants" in text


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["run", "robot-sped", "--participant", "1", "--out", "out"], "did you mean 'robot-speed'"),
        (["run", "robot-speed", "--participant", "13", "--out", "out"], "1 to 12"),
        (["run", "robot-speed", "--participant", "1", "--out", "out", "--resume"], "no session"),
        (["run", "robot-speed", "--participant", "1", "--out", "out", "--answers", "none.json"], "none.json"),
        (["run", "robot-speed", "--participant", "1", "--out", "out", "--answers", "list.json"], "one JSON object"),
        (["run", "robot-speed", "--participant", "1", "--out", "out", "--answers", "typo.json"], "did you mean 'age'"),
        (["order", "robot-speed", "--participants", "0"], "at least 1"),
        (["summary", "."], "contains no sessions"),
        (["new", "here"], "already exists"),
        (["new", "there", "--like", "robot"], "did you mean 'robot-speed'"),
    ],
)
def test_wrong_words_are_said_in_a_sentence(capsys, tmp_path, monkeypatch, words, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "here").mkdir()
    (tmp_path / "list.json").write_text("[1]")
    (tmp_path / "typo.json").write_text('{"agee": 3}')
    before = sorted(tmp_path.rglob("*"))
    assert main(["experiment", *words]) == 2
    found = capsys.readouterr()
    assert found.err.startswith("crowdbot: ")
    assert said in found.err
    assert found.out == ""
    assert sorted(tmp_path.rglob("*")) == before


def test_check_reads_experiments_and_trials(capsys, tmp_path):
    file = tmp_path / "experiment.xml"
    file.write_text(
        '<experiment name="e" sed="1">\n<block name="b" ordr="fixed"><trial name="t" source="frontal"/></block>'
        "</experiment>"
    )
    assert main(["check", str(file), "robot-speed", "frontal"]) == 2
    lines = capsys.readouterr().out.splitlines()
    assert "experiment.xml:1: <experiment> has no attribute 'sed', did you mean 'seed'" in lines[0]
    assert "experiment.xml:2: <block> has no attribute 'ordr', did you mean 'order'" in lines[1]
    robot = "  robot 'robot' is a disc: differential-drive, at most 1 m/s, radius 0.3 m, sensors scan (lidar2d)"
    assert lines[2:] == ["experiment.xml: 2 errors", "robot-speed: OK", "frontal: OK", robot]


def test_a_missing_answer_leaves_a_session_to_go_on_with(capsys, tmp_path, answers):
    words = ["experiment", "run", "robot-speed", "--participant", "1", "--out", str(tmp_path / "data")]
    (tmp_path / "some.json").write_text('{"age": 30}')
    assert main([*words, "--answers", str(tmp_path / "some.json")]) == 2
    assert "'robots' requires an answer: never or sometimes or often" in capsys.readouterr().err
    assert main([*words, "--answers", str(answers)]) == 2
    assert "--resume" in capsys.readouterr().err
    assert main([*words, "--answers", str(answers), "--resume"]) == 0
    assert main([*words, "--answers", str(answers), "--resume"]) == 0
    assert "session   done" in capsys.readouterr().out


def _slow_experiment(tmp_path):
    folder = tmp_path / "slow"
    folder.mkdir()
    (folder / "slow.py").write_text(SLOW)
    text = (builtin_experiments()["robot-speed"] / "slow.xml").read_text()
    (folder / "slow.xml").write_text(text.replace('navigator type="orca"', 'navigator type="slow.py:Slow"'))
    (folder / "quick.xml").write_text(text.replace('navigator type="orca"', 'navigator type="straight"'))
    (folder / "experiment.xml").write_text(
        '<experiment name="slow"><block name="b" order="random" repetitions="2"><trial name="t" source="slow.xml"/>'
        '<after name="ask"><scale name="well" text="Well?"/></after></block>'
        '<ending name="bye" text="Bye."/></experiment>'
    )
    return folder


class Program:
    """The program at a console, with what it says in a file."""

    def __init__(self, folder, out, *words):
        self.said = out.parent / f"said-{time.monotonic_ns()}"
        self.log = out / "participant-001" / "session.jsonl"
        command = [sys.executable, "-m", "crowdbot", "experiment", "run", folder, "--participant", "1", "--out", out]
        with self.said.open("wb") as stream:
            self.process = subprocess.Popen(
                [*map(str, command), *words],
                stdin=subprocess.PIPE,
                stdout=stream,
                stderr=stream,
                text=True,
                env={**os.environ, "DELAY": "0.01"},
            )

    def type(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def until(self, where, word, count=1):
        for _ in range(12_000):
            if where.exists() and where.read_text().count(word) >= count:
                return
            assert self.process.poll() is None, self.said.read_text()
            time.sleep(0.01)
        raise AssertionError(self.said.read_text())

    def over(self):
        self.process.stdin.close()
        return self.process.wait(120)


def _digests(out):
    lines = (out / "participant-001" / "session.jsonl").read_text().splitlines()
    return [record["digest"] for record in map(json.loads, lines) if record.get("event") == "finish"]


@pytest.mark.live
def test_ctrl_c_holds_a_trial_and_lets_it_go_on_unchanged(tmp_path):
    folder, out = _slow_experiment(tmp_path), tmp_path / "out"
    program = Program(folder, out)
    program.until(program.log, '"begin"')
    time.sleep(0.3)
    program.process.send_signal(signal.SIGINT)
    program.until(program.said, "PAUSE (Ctrl-C)")
    program.type("resume")
    program.until(program.said, "Well?")
    program.type("4")
    program.type("")
    program.until(program.log, '"begin"', 2)
    time.sleep(0.3)
    program.process.send_signal(signal.SIGINT)
    program.until(program.said, "PAUSE (Ctrl-C)", 2)
    program.type("repeat")
    program.until(program.said, "Well?", 2)
    for line in ("5", "", ""):
        program.type(line)
    assert program.over() == 0, program.said.read_text()
    names = sorted(path.name for path in (out / "participant-001").iterdir() if path.is_dir())
    assert names == ["001-t", "002-t", "002-t-attempt-2"]
    left = out / "participant-001" / "002-t" / "episode.mcap"  # what was done of the trial that was left is kept
    assert sorted(path.name for path in left.parent.iterdir()) == ["clock.csv", "episode.mcap"]
    assert not read_episode(left).complete
    trial = load_trial(folder / "slow.xml")
    assert _digests(out) == [run(trial, seed=seed).digest for seed in (1, read_seed(out, "002-t-attempt-2"))]


def read_seed(out, name):
    return read_episode(out / "participant-001" / name / "episode.mcap").seed


@pytest.mark.live
def test_a_session_that_is_killed_and_left_comes_to_the_same_end(tmp_path, capsys):
    folder, out = _slow_experiment(tmp_path), tmp_path / "out"
    path = tmp_path / "answers.json"
    path.write_text('{"well": 3}')
    program = Program(folder, out, "--answers", str(path))
    program.until(program.log, '"begin"')
    time.sleep(0.4)
    program.process.kill()
    assert program.over() == -signal.SIGKILL
    program = Program(folder, out, "--answers", str(path), "--resume")
    program.until(program.log, '"begin"', 2)
    time.sleep(0.2)
    program.process.send_signal(signal.SIGINT)
    assert program.over() == 130
    assert "continue with --resume" in program.said.read_text()
    words = ["experiment", "run", folder, "--participant", 1, "--out", out, "--answers", path, "--resume"]
    status, said = _json(capsys, *words)
    assert (status, said["session"]) == (0, "done")
    status, _ = _json(capsys, *words[:-1][:6], tmp_path / "whole", "--answers", path)
    assert status == 0
    assert _digests(out) == _digests(tmp_path / "whole")
    rows = _json(capsys, "experiment", "summary", out)[1]
    assert [(row["attempt"], row["outcome"], row["ask.well"]) for row in rows][1] == (1, "success", 3)
    assert rows[0]["attempt"] == 3


def _commands():
    text = (ROOT / "docs" / "tutorials" / "first-experiment.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^ *```(\w*)\n(.*?)^ *```", text, flags=re.S | re.M)
    return [line.split() for kind, block in blocks if not kind for line in block.splitlines() if line.strip()]


def test_the_page_tells_the_truth(capsys, monkeypatch, tmp_path):
    (answers,) = re.findall(
        r"`(\{.*?\})`", (ROOT / "docs" / "tutorials" / "first-experiment.md").read_text(encoding="utf-8")
    )
    (tmp_path / "answers.json").write_text(answers)
    monkeypatch.chdir(tmp_path)
    typed = "30\n1\n\n\n\n5\nfine\n\n\n"  # the input ends at the second opinion
    runs = iter([(typed, 2), ("6\n\n\n\n", 0), ("", 0)])
    for words in _commands():
        given, status = next(runs) if words[1:3] == ["experiment", "run"] else ("", 0)
        monkeypatch.setattr("sys.stdin", io.StringIO(given))
        assert (words[0], main(words[1:])) == ("crowdbot", status), (words, capsys.readouterr())
    table = pd.read_csv("table.csv")
    assert table["session"].tolist() == ["done"] * 6
    assert table["opinion.comfort"].tolist()[1:3] == [5, 6]
    assert (tmp_path / "data" / "participant-001" / "002-slow" / "episode.mcap").exists()

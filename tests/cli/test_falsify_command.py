"""``crowdbot falsify``: table, JSON, files, wrong input, killed searches."""

from __future__ import annotations

import json
import os
import random
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from crowdbot.cli import main

CROSS = """<trial name="cross" duration="8" step="0.1"><crowd type="orca"/>
<agent name="p" x="0" y="4.2" goal="0,-4" speed="1"/>
<robot x="-3" y="0" visible="false"><goal x="3" y="0"/><drive type="differential-drive"/>
<navigator type="straight" speed="0.8"/></robot></trial>"""
WIDE_URDF = """<robot name="wide"><link name="base"><inertial><mass value="60"/>
<inertia ixx="2" iyy="4" izz="5" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.6 0.98 0.4"/></geometry></collision></link></robot>"""
WIDE = '<robot name="wide" urdf="wide.urdf"><drive type="differential-drive"/></robot>'
OVER = ("--over", "agent[p]/y=normal(5.4, 0.4)", "--over", "agent[p]/speed=uniform(0.8,1.2)")


@pytest.fixture
def cross(tmp_path: Path) -> Path:
    file = tmp_path / "cross.xml"
    file.write_text(CROSS, encoding="utf-8")
    return file


def test_the_table_is_printed_and_found_trials_run_with_the_same_digest(
    cross: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["falsify", str(cross), *OVER, "--runs", "150", "--out", str(tmp_path / "out"), "--keep", "2"]
    assert main(words) == 0
    text = capsys.readouterr().out
    assert "The failure probability is" in text
    assert "clusters of failures" in text
    assert re.search(r"found/1\.xml +collision", text)
    stored = json.loads((tmp_path / "out" / "result.json").read_text(encoding="utf-8"))
    assert main(["run", str(tmp_path / "out" / "found" / "1.xml"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["digest"] == stored["found"][0]["digest"]
    assert main([*words, "--json"]) == 0
    again = json.loads(capsys.readouterr().out)
    assert again["clusters"] == stored["clusters"]
    assert "http" not in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")


def test_the_result_names_the_robot_and_a_passage_that_it_does_not_fit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "wide").mkdir()
    (tmp_path / "wide" / "robot.xml").write_text(WIDE, encoding="utf-8")
    (tmp_path / "wide" / "wide.urdf").write_text(WIDE_URDF, encoding="utf-8")
    words = [
        "falsify",
        "doorway",
        "--robots",
        "wide",
        "--navigator",
        "straight",
        "--over",
        "agent[1]/speed=uniform(1,2)",
    ]
    assert main([*words, "--set", "duration=8", "--runs", "6", "--out", "out"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    narrow = "the narrowest passage on the way of the robot is 0.95 m wide: less than the width of the robot, 0.98 m"
    assert "doorway, straight on wide: collision" in text
    assert narrow in text
    assert "The failure probability is 1, 95 % interval" in text
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert "doorway, straight on wide, failure: collision" in page
    assert narrow in page
    assert main(["run", "doorway", "--set", "robot/type=wide", "--set", "duration=1"]) == 0
    assert narrow in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--over", "agent[q]/y=uniform(1,2)"), "no <agent> has the name 'q'"),
        (("--over", "agent[p]/y"), "must be PATH=DISTRIBUTION"),
        (("--failure", "crash"), "failure 'crash' is unknown"),
        (("--search", "nothing"), "search 'nothing' is unknown"),
        (("--runs", "1"), "runs = 1 must be at least 2"),
        (("--navigator", "orca, straight"), "names 2 navigators"),
        (("--failure", "severity", "--runs", "2"), 'needs world="physics"'),
    ],
)
def test_wrong_input_is_explained(
    cross: Path, capsys: pytest.CaptureFixture[str], words: tuple[str, ...], message: str
) -> None:
    assert main(["falsify", str(cross), *words]) == 2
    assert message in capsys.readouterr().err


def _hear_ctrl_c() -> None:
    """Undo what a shell does to programs in its background, whose children ignore Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.mark.live
@pytest.mark.parametrize("workers", ["1", "2"])
def test_ctrl_c_keeps_what_is_done_and_the_same_command_continues(
    cross: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], workers: str
) -> None:
    words = ["falsify", str(cross), *OVER, "--search", "plain", "--runs", "1024", "--keep", "1"]
    words += ["--workers", workers, "--json", "--out"]
    out = tmp_path / "out"
    program = [sys.executable, "-m", "crowdbot", *words, str(out)]
    process = subprocess.Popen(
        program,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=_hear_ctrl_c,  # noqa: PLW1509
    )
    deadline = time.monotonic() + 120.0
    while not list(out.glob("parts/*.json")) and time.monotonic() < deadline:
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    printed, told = process.communicate(timeout=60)
    assert (process.returncode, printed) == (130, ""), told
    assert "the same command continues" in told
    assert "interrupted" in told
    assert "Traceback" not in told
    kept = {part: part.stat().st_mtime_ns for part in out.glob("parts/*.json")}
    assert 0 < len(kept) < 16
    again = _finish(program)
    assert {part: part.stat().st_mtime_ns for part in kept} == kept
    assert len(list(out.glob("parts/*.json"))) == 16
    words[words.index("--workers") + 1] = "1"
    assert main([*words, str(tmp_path / "whole")]) == 0
    assert again == json.loads(capsys.readouterr().out)
    assert again["failures"] > 0


@pytest.mark.sweep
def test_a_search_killed_at_random_moments_ends_with_the_same_table(cross: Path, tmp_path: Path) -> None:
    words = [sys.executable, "-m", "crowdbot", "falsify", str(cross), *OVER, "--runs", "640", "--json", "--out"]
    whole = _finish([*words, str(tmp_path / "whole")])
    chance, kills = random.Random(0), 0
    for _ in range(40):
        process = subprocess.Popen([*words, str(tmp_path / "killed")], stdout=subprocess.DEVNULL, env=os.environ)
        time.sleep(chance.uniform(1.5, 6.0))
        if process.poll() is None:
            process.kill()
            kills += 1
        process.wait()
        if kills == 10:
            break
        if process.returncode == 0:  # finished before: begin anew
            for part in (tmp_path / "killed" / "parts").glob("*.json"):
                part.unlink()
    assert kills == 10
    assert _finish([*words, str(tmp_path / "killed")]) == whole


def _finish(words: list[str]) -> Any:
    done = subprocess.run(words, capture_output=True, text=True, check=True, env=os.environ)
    return json.loads(done.stdout)

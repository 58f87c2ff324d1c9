"""``crowdbot evaluate``: tables, JSON, requirements, report, interruption, wrong input."""

from __future__ import annotations

import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from crowdbot.cli import main
from crowdbot.cli.output import print_table
from crowdbot.core import parse_xml

QUICK = ["evaluate", "frontal", "--set", "duration=2", "--seeds", "0:3"]


def _json(capsys: pytest.CaptureFixture[str], *words: str) -> Any:
    main([*words, "--json"])
    return json.loads(capsys.readouterr().out)


def test_tables_and_requirements_are_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*QUICK, "--navigators", "straight, orca", "--require", "collision-rate<0.9@90%"]) == 0
    text = capsys.readouterr().out
    assert re.search(r"straight +yes +3 +0 \[0, 0\.708\]", text)
    assert "6 runs in" in text
    assert "comparison with straight" in text
    assert re.search(r"frontal +orca +success-rate \[share\] ", text)
    assert "collision-rate<0.9@90%: holds for frontal, orca: collision-rate is 0 in 3 runs" in text


def test_a_requirement_that_does_not_hold_gives_status_1_and_a_failure_in_junit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = [*QUICK, "--navigators", "straight, orca", "--require", "success-rate>0.5", "--out", str(tmp_path)]
    assert main(words) == 1
    assert "DOES NOT HOLD for frontal, straight: success-rate is 0 in 3 runs" in capsys.readouterr().out
    root = parse_xml((tmp_path / "junit.xml").read_bytes(), "junit.xml")
    (suite,) = root.children
    assert (suite.attributes["tests"], suite.attributes["failures"]) == ("2", "2")
    report = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "success-rate is 0 in 3 runs" in report
    assert "http" not in re.sub(r"<pre>.*</pre>", "", report, flags=re.S)
    drawing = json.loads(re.search(r'type="application/json">(.*?)</script>', report, re.S)[1])  # type: ignore[index]
    assert len(drawing) == 2
    assert {agent["robot"] for agent in drawing[0]["agents"]} == {True, False}
    result = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))
    assert [cell["navigator"] for cell in result["cells"]] == ["straight", "orca"]


def test_the_tables_come_before_the_worst_runs_are_played(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(variant: object, seed: int) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("crowdbot.evaluation.worst_run.simulate", interrupted)
    assert main([*QUICK, "--out", str(tmp_path)]) == 130
    assert "3 runs in" in capsys.readouterr().out
    assert json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))["cells"]
    assert not (tmp_path / "report.html").exists()


def test_json_has_all_values(capsys: pytest.CaptureFixture[str]) -> None:
    found = _json(capsys, *QUICK, "--metrics", "success-rate,p95:min-clearance", "--navigators", "orca safety=0.2")
    (cell,) = found["cells"]
    assert (cell["trial"], cell["navigator"], cell["runs"]) == ("frontal", "orca safety=0.2", 3)
    assert set(cell["statistics"]) == {"success-rate", "p95:min-clearance"}
    assert cell["protocol"]["control_period"] == 0.1
    assert found["failed"] == found["invalid"] == found["requirements"] == []


def test_the_command_of_the_worst_runs_plays_them(capsys: pytest.CaptureFixture[str]) -> None:
    words = [*QUICK, "--navigators", "straight, orca safety=0.2", "--sweep", "robot.visible=true,false"]
    rows = _json(capsys, *words)["cells"]
    assert [len(row["worst"]["runs"]) for row in rows] == [3] * 4
    row = next(row for row in rows if row["navigator"] != "straight" and "false" in row["trial"])
    program, *again = shlex.split(row["worst"]["command"])
    assert program == "crowdbot"
    seeds = [run["seed"] for run in row["worst"]["runs"]]
    assert again[again.index("--seeds") + 1] == ",".join(map(str, seeds))
    (same,) = _json(capsys, *again[: again.index("--worst")])["cells"]
    assert same["protocol"] == row["protocol"]
    assert [run["reason"] for run in same["worst"]["runs"]] == [run["reason"] for run in row["worst"]["runs"]]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--navigators", "orcaa"], "unknown navigator 'orcaa', did you mean 'orca'"),
        (["--seeds", "3:1"], "the range '3:1' must have 1 to"),
        (["--require", "collision"], "requirement 'collision' must be like collision-rate<0.01@95%"),
        (["--metrics", "sucess-rate"], "there is no metric 'sucess-rate', did you mean 'success-rate'"),
        (["--robots", "peper"], "peper"),
        (
            ["--require", "collision-rate<0.5,success-rate>0.1"],
            "min-clearance>0.2; give each bound with its own --require",
        ),
        (["--set", "step=10ms"], 'step="10ms" is not a number; give it in s, without the unit'),
        (["--set", "gap=5 m"], 'gap="5 m" is not a number; give it in m, without the unit'),
        (["--workers", "0"], "workers = 0 must be at least 1"),
        (["--worst", "-1"], "--worst -1 must be at least 0"),
    ],
)
def test_wrong_input_is_told_in_a_sentence(words: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*QUICK, *words]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert "Traceback" not in error


def test_a_requirement_on_an_unknown_metric_is_refused_before_the_runs(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert main([*QUICK, "--require", "collision-rat<0.5@95%", "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert error.endswith("crowdbot: there is no metric 'collision-rat', did you mean 'collision-rate'?\n")
    assert "evaluate" not in error
    assert not (tmp_path / "out").exists()


@pytest.mark.live
def test_a_killed_evaluation_continues_with_the_same_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = [
        "evaluate",
        "frontal",
        "--set",
        "duration=3",
        "--seeds",
        "0:96",
        "--navigators",
        "straight, orca",
        "--json",
    ]
    assert main(words) == 0
    whole = json.loads(capsys.readouterr().out)
    command = [sys.executable, "-m", "crowdbot", *words, "--out", str(tmp_path), "--worst", "0"]
    program = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=dict(os.environ))
    end = time.monotonic() + 120.0
    while not list(tmp_path.glob("parts/*.jsonl")) and time.monotonic() < end:
        time.sleep(0.02)
    program.send_signal(signal.SIGKILL)
    program.wait()
    assert list(tmp_path.glob("parts/*.jsonl"))
    assert main([*words, "--out", str(tmp_path), "--worst", "0"]) == 0
    again = json.loads(capsys.readouterr().out)
    assert again["cells"] == whole["cells"]
    assert again["comparisons"] == whole["comparisons"]


def test_names_in_a_table_that_is_too_wide_break_at_their_marks_only(capsys: pytest.CaptureFixture[str]) -> None:
    head = ["navigator", "robot", *(f"collision\nrate{k}" for k in range(12))]
    print_table("hall", head, [["mine.py:Mine", "mybot", *["0.00421 [0.00421, 0.641]"] * 12]], words=2)
    names = [line.split()[0] for line in capsys.readouterr().out.splitlines() if line.split() and line[1] != " "]
    assert [name for name in names if name.startswith(("mine", "Mi", "ne"))] == ["mine.py:", "Mine"]

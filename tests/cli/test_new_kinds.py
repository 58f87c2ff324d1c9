"""``crowdbot new`` from an empty folder: what it writes keeps its contract, and its next step runs as printed."""

from __future__ import annotations

import os
import runpy
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import crowdbot as cb
from crowdbot.cli import main
from crowdbot.core import find_class
from crowdbot.navigation.process.sandbox import sandbox_problem
from crowdbot.trials import load_trial

SOURCES = Path(cb.__file__).parents[1]
FILES = {
    "model": "slow_down.py",
    "predictor": "slow_walk.py",
    "sensor": "tracker.py",
    "goal": "walk_on.py",
    "cost": "last_error.py",
    "navigator": "shy.py",
    "robot": "puck",
    "stage": "hall.geojson",
    "trial": "meeting.xml",
    "metric": "time_near.py",
    "challenge": "door.toml",
    "submission": "quiet",
}
LAB = "mylab"
TRIAL = """<?xml version="1.0" encoding="UTF-8"?>
<trial name="own" duration="1">
  {stage}
  <crowd type="{model}"/>
  <agent x="12" y="1" goal="2,1"/>
  {robot}
    <goal x="14" y="1"/>
    <navigator type="{navigator}"/>
    {sensor}
  </robot>
</trial>
"""


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a recording and all kinds in the folder ``mylab``."""
    folder = tmp_path_factory.mktemp("lab")
    (folder / LAB).mkdir()
    rows = (f"{10 * k}\t{who}\t{0.5 * k}\t{2 * who}\n" for k in range(21) for who in (1, 2))
    (folder / "walk.txt").write_text("".join(rows))
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for kind, name in FILES.items():
            assert main(["new", kind, f"{LAB}/{name}"]) == 0
    return folder


@pytest.fixture
def steps(lab: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    """Return what ``crowdbot new`` prints as the next step of every kind; the working folder is the lab."""
    monkeypatch.chdir(lab)
    lines = {}
    for kind, name in FILES.items():
        assert main(["new", kind, f"{LAB}/{name}", "--force"]) == 0
        (lines[kind],) = [
            line.removeprefix("use it    ")
            for line in capsys.readouterr().out.splitlines()
            if line.startswith("use it    ")
        ]
    return lines


def trial(folder: Path, **parts: str) -> Path:
    """Write a trial that uses the given parts and return its file."""
    values = {
        "stage": '<stage walkable="0,0 16,0 16,6 0,6"/>',
        "robot": '<robot x="1" y="1"><drive type="differential-drive"/>',
        "navigator": "straight",
        "model": "orca",
        "sensor": "",
        **parts,
    }
    file = folder / "own.xml"
    file.write_text(TRIAL.format(**values))
    return file


@pytest.mark.parametrize("kind", FILES)
def test_what_is_written_keeps_its_contract(lab, kind):
    tests = runpy.run_path(str(lab / LAB / f"test_{Path(FILES[kind]).stem}.py"))
    (check,) = [value for name, value in tests.items() if name.startswith("test_")]
    assert check.__doc__ is None
    assert check() is None


@pytest.mark.program
def test_the_contract_test_of_a_fresh_file_runs_by_the_printed_command(tmp_path):
    environment = {**os.environ, "PYTHONPATH": str(SOURCES)}

    def run(*words):
        return subprocess.run(
            [sys.executable, "-m", *words], cwd=tmp_path, env=environment, capture_output=True, text=True
        )

    written = run("crowdbot", "new", "goal", "walk_on.py")
    assert (written.returncode, written.stderr) == (0, "")
    (line,) = [line for line in written.stdout.splitlines() if line.startswith("test it   ")]
    done = run(*line.removeprefix("test it   ").split())
    assert done.returncode == 0, done.stdout
    assert "1 passed" in done.stdout


@pytest.mark.parametrize("kind", ["model", "predictor", "goal", "cost", "navigator", "metric", "trial"])
def test_the_printed_command_runs(steps, capsys, kind):
    program, *words = shlex.split(steps[kind].replace("DATA", "walk.txt"))
    assert program == "crowdbot"
    assert main(words) == 0
    out, err = capsys.readouterr()
    assert out
    assert "Traceback" not in err


@pytest.mark.program
def test_the_printed_command_of_a_challenge_runs_its_submission(steps, tmp_path, capsys):
    words = shlex.split(steps["challenge"].replace("SUBMISSION", f"{LAB}/quiet"))
    assert words == shlex.split(steps["submission"].replace("CHALLENGE", f"{LAB}/door.toml"))
    own = [] if sandbox_problem() is None else ["--no-sandbox"]
    assert main([*words[1:-1], str(tmp_path / "result"), *own]) == 0
    assert "Quiet in Door, public seeds" in capsys.readouterr().out


@pytest.mark.parametrize("kind", ["sensor", "robot", "stage"])
def test_the_printed_element_runs_in_a_trial(steps, lab, capsys, kind):
    element = steps[kind].partition(" in a ")[0]
    if kind == "robot":
        element = element.replace(" .../>", ' x="1" y="1">')
    file = trial(lab / LAB, **{kind: element})
    assert main(["check", str(file)]) == 0
    assert main(["run", str(file)]) == 0
    assert "duration" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("option", "kind", "cls"),
    [("--model", "model", "SlowDown"), ("--predictor", "predictor", "SlowWalk"), ("--goal", "goal", "WalkOn")],
)
def test_a_folder_of_such_files_is_one_package(steps, capsys, option, kind, cls):
    words = ["predict", "--data", "walk.txt", option, f"{LAB}/:{cls}"]
    assert main(words if kind == "predictor" else [*words, "--predictor", "simulated"]) == 0
    name = {"model": "simulated(model=slow-down)", "predictor": "slow-walk", "goal": "simulated(goal=walk-on)"}
    assert name[kind] in capsys.readouterr().out


def test_a_shared_folder_serves_a_trial_beside_it(lab, tmp_path, capsys):
    shutil.copytree(lab / LAB, tmp_path / LAB)
    file = trial(
        tmp_path,
        stage=f'<stage area="{LAB}/hall.geojson"/>',
        model=f"{LAB}/:SlowDown",
        navigator=f"{LAB}/:Shy",
        robot=f'<robot type="{LAB}/puck" x="1" y="1">',
        sensor=f'<sensor name="people" type="{LAB}/:Tracker"/>',
    )
    assert main(["check", str(file)]) == 0
    assert main(["run", str(file), "--out", str(tmp_path / "out")]) == 0
    assert "Traceback" not in capsys.readouterr().err
    found = load_trial(file)
    assert type(found.robots[0].navigator).__name__ == "Shy"
    assert main(["replay", str(tmp_path / "out" / "episode.mcap"), "--folder", str(tmp_path)]) == 0


def test_a_cost_of_a_shared_folder_is_found_by_its_name(lab):
    from crowdbot import calibration

    cost = find_class(f"{LAB}/:LastError", calibration, calibration.Cost, folder=lab)
    calibration.check_cost(cost())
    assert cost.__name__ == "LastError"

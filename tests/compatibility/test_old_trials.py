"""Trials, robots and experiments of an earlier version open with the same content."""

from __future__ import annotations

import warnings
from pathlib import Path

import pandas as pd
import pytest
from old_files import EXPECTED, FILES, assert_same, command_json, copy

from crowdbot.experiments import load_experiment, read_log
from crowdbot.trials import OldNameWarning, load_trial, parse_trial, trial_xml
from crowdbot.world import Robot

TRIALS = sorted(path.name for path in (FILES / "trials").glob("*.xml"))
OLD_WORDS = ("berth=", "symmetry=", "most=", "equipped=", "rates=", "near=", "without=")
OLD_TRIALS = [
    name for name in TRIALS if any(f" {word}" in (FILES / "trials" / name).read_text("utf-8") for word in OLD_WORDS)
]

pytestmark = [
    pytest.mark.filterwarnings("ignore::crowdbot.trials.OldNameWarning"),
    pytest.mark.filterwarnings("ignore:.*is read as rows per second"),
]


@pytest.mark.parametrize("name", TRIALS)
def test_an_old_trial_loads_with_at_most_one_line_about_names(name: str) -> None:
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        trial = load_trial(FILES / "trials" / name)
        lines = [str(one.message) for one in found if one.category is OldNameWarning]
        assert len(lines) == (name in OLD_TRIALS)
        assert all("old names of attributes: " in line and "\n" not in line for line in lines)
        assert parse_trial(trial_xml(trial), folder=FILES / "trials") == trial
    assert len([one for one in found if one.category is OldNameWarning]) == len(lines)


def test_an_old_robot_folder_loads() -> None:
    robot = Robot.load(FILES / "trials" / "scout")
    found = {name: getattr(robot, name) for name in ("name", "about", "base", "latency")}
    drive = str(robot.drive).replace(", max_lateral_acceleration=inf", "")  # a limit that it did not have
    found |= {"drive": drive, "footprint": robot.footprint.tolist(), "links": sorted(robot.model.links)}
    found |= {"sensors": {mount.name: str(mount.sensor) for mount in robot.mounts}}
    assert found | {"wheels": [wheel.joint for wheel in robot.wheels]} == EXPECTED["robot"]


def test_an_old_experiment_loads_with_one_line() -> None:
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        experiment = load_experiment(FILES / "experiment")
    lines = [str(one.message) for one in found if "experiment.xml" in str(one.message)]
    assert len(lines) == 1
    assert "<number at-least> is now min" in lines[0]
    assert [trial.name for block in experiment.blocks for trial in block.trials] == ["slow", "fast"]


def test_an_old_session_log_is_read() -> None:
    logs = sorted((FILES / "sessions").rglob("session.jsonl"))
    assert len(logs) == 2
    assert all(len(read_log(path)) > 3 for path in logs)


@pytest.mark.parametrize("participant", [1, 2])
def test_an_old_session_is_resumed(participant: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = copy("sessions", tmp_path)
    found = command_json(
        capsys, "experiment", "run", FILES / "experiment", "--participant", participant, "--out", out, "--resume",
        "--answers", FILES / "experiment" / "answers.json",
    )  # fmt: skip
    assert found["session"] == "done"
    old = EXPECTED["session"]
    assert_same([found["outcomes"], found["answers"]], [old["outcomes"], old["answers"]])


def test_old_sessions_are_summed_up(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    table = tmp_path / "summary.csv"
    command_json(capsys, "experiment", "summary", FILES / "sessions", "--out", table)
    found, old = pd.read_csv(table), pd.read_csv(FILES / "summary.csv")
    assert set(old.columns) <= set(found.columns)
    assert_same(found[list(old.columns)].to_dict("records"), old.to_dict("records"))

"""``crowdbot generate`` as a user runs it."""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from crowdbot.cli import main

ARGUMENTS = ("crossing-flows", "--set", "duration=2", "--sensors", "sick-tim571@10", "--shard-size", "1")


def crowdbot(*words: object, **more: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "crowdbot", "generate", *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)


@pytest.mark.program
def test_it_writes_data_and_a_card(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    done = crowdbot(*ARGUMENTS, "--seeds", "0:2", "--out", tmp_path / "data")
    assert done.returncode == 0, done.stderr
    assert "simulated minutes" in done.stdout
    card = json.loads((tmp_path / "data" / "card.json").read_text())
    assert card["rows"]["robot/sick_tim571"] == 42
    assert "What the data does not show" in (tmp_path / "data" / "README.md").read_text()
    assert main(["generate", *ARGUMENTS, "--seeds", "0:2", "--out", str(tmp_path / "data"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["files"] == card["files"]
    assert told["wall"] > 0.0


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("flow", "frontal"), "recipe 'flow' must be the only source"),
        (("frontal", "--format", "zip"), "format 'zip' must be one of npz, parquet, webdataset, mcap"),
        (("frontal", "--sensors", "hokuyo"), "unknown sensor preset 'hokuyo'"),
        (("frontal", "--seeds", "5:1"), "the range '5:1' must have 1 to"),
        (("nowhere",), "nowhere"),
        (("flo",), "there is no trial or recipe 'flo', did you mean 'flow'?"),
    ],
)
def test_wrong_input_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: tuple[str, ...], message: str
) -> None:
    assert main(["generate", *words, "--out", str(tmp_path / "data")]) == 2
    assert message in " ".join(capsys.readouterr().err.split())
    assert not (tmp_path / "data").exists()


@pytest.mark.sweep
def test_killed_runs_continue_with_the_same_files(tmp_path: Path) -> None:
    words = (*ARGUMENTS, "--seeds", "0:40", "--workers", "2")
    assert crowdbot(*words, "--out", tmp_path / "whole").returncode == 0
    whole = json.loads((tmp_path / "whole" / "card.json").read_text())
    rng = random.Random(3)
    command = [sys.executable, "-m", "crowdbot", "generate", *words, "--out", str(tmp_path / "killed")]
    kills = 0
    for _ in range(50):
        process = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
        )
        time.sleep(rng.uniform(0.5, 6.0))
        if process.poll() is not None:
            break
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        kills += 1
    assert kills >= 1
    assert crowdbot(*words, "--out", tmp_path / "killed").returncode == 0
    killed = json.loads((tmp_path / "killed" / "card.json").read_text())
    assert killed["files"] == whole["files"]

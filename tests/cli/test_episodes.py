"""The commands for episodes: branch, repair, export."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest

from crowdbot.cli import main
from samples import sample


def _json(capsys, *arguments):
    assert main([*arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.fixture(scope="module")
def episode(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    assert main(["run", "frontal", "--out", str(folder)]) == 0
    return folder / "episode.mcap"


def test_branch(capsys, episode, tmp_path):
    whole = _json(capsys, "replay", str(episode))
    same = _json(capsys, "branch", str(episode), "--at", "3", "--out", str(tmp_path / "same"))
    assert same["digest"] == whole["recorded"]
    words = ["--set", "robot.drive.max-speed=0.3", "duration=9", "--seed", "5"]
    other = _json(capsys, "branch", str(episode), "--at", "3", "--out", str(tmp_path / "other"), *words)
    assert other["digest"] != whole["recorded"]
    assert other["seed"] == 5
    again = _json(capsys, "replay", str(tmp_path / "other" / "episode.mcap"))
    assert (again["equal"], again["recorded"]) == (True, other["digest"])
    assert main(["branch", str(episode), "--at", "3.01"]) == 2
    assert "the nearest is 3 s" in capsys.readouterr().err


def test_export(capsys, episode, tmp_path):
    done = _json(capsys, "export", str(episode), "--to", str(tmp_path / "people.csv"))
    assert done["rows"] == len((tmp_path / "people.csv").read_text().splitlines()) - 1 > 100
    assert main(["export", str(episode), "--to", str(tmp_path / "scans.parquet"), "--table", "scans"]) == 0
    assert "rows" in capsys.readouterr().out


def test_repair(capsys, episode, tmp_path):
    cut = tmp_path / "cut.mcap"
    whole = episode.read_bytes()
    cut.write_bytes(whole[: len(whole) // 2])
    assert main(["repair", str(cut), str(episode)]) == 0
    out = capsys.readouterr().out
    assert "cut.mcap: repaired, ends at " in out
    assert "complete, nothing to repair" in out
    assert episode.read_bytes() == whole
    assert _json(capsys, "replay", str(cut))["equal"] is True


@pytest.mark.live
@pytest.mark.parametrize("world", sample(["physics", "planar"], 1))
def test_ctrl_c_keeps_what_is_done(capsys, tmp_path, world):
    words = ["run", "crossing-flows", "--world", world, "--out", str(tmp_path), "--pace", "2", "--json"]
    process = subprocess.Popen([sys.executable, "-m", "crowdbot", *words], stdout=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 120.0
    while not (tmp_path / "episode.mcap").exists() and time.monotonic() < deadline:
        time.sleep(0.02)
    time.sleep(0.5)
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate(timeout=60)
    assert process.returncode == 0
    done = json.loads(out)
    assert done["outcome"] == "interrupted"
    assert 0.0 <= done["sim_seconds"] < 20.0
    assert os.listdir(tmp_path) == ["episode.mcap"]
    again = _json(capsys, "replay", str(tmp_path / "episode.mcap"))
    assert (again["equal"], again["outcome"], again["complete"]) == (True, "interrupted", True)

"""Episodes of an earlier version: content, tables, replay, branch and repair."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from old_files import EXPECTED, FILES, SAME_MACHINE, array_hash, copy, describe

from builtin_digests import level_environment
from crowdbot.cli import main
from crowdbot.recording import RecordedEpisode, branch, export, read_episode, record, repair, replay, run
from crowdbot.recording.provenance import Provenance
from crowdbot.sensors import RgbImage
from crowdbot.trials import parse_trial

EPISODES: dict[str, Any] = EXPECTED["episodes"]
SENSORS = {
    "bumper", "depth-camera", "ground-truth-people", "imu", "infrared", "lidar2d", "lidar3d", "rgbcamera", "ultrasound",
    "wheel-odometry",
}  # fmt: skip
"""Every sensor of the earlier version, with the words of its trial files."""
CHANGED = {
    "all-sensors-physics": "0.1.0 ignored the latency of a robot without a type in the physics world",
    "pepper-physics": "odometry of its robot with wheels was the true pose in the physics world",
}
"""Episodes that do not replay with the same digest, and why; see CHANGELOG."""
MOVED = {name for name, row in EPISODES.items() if row["world"] == "physics"}
"""Robots of the physics world drive otherwise since: 0.1.0 let tyres slip, and bases lag behind; see CHANGELOG."""
SAME = "SAME_MACHINE"
"""Variable of the process in which every bit must be compared."""
NEAR = 0.1
"""Distance [m] within which a moved robot is after the seconds of these episodes."""
DRAWN = "camera"
"""The episode with a colour camera; another graphics library draws other shades."""
RENAMED = {
    f"{prefix}{old}": f"{prefix}{new}"
    for prefix in ("", "command_")
    for old, new in (("forward", "linear_x"), ("turn", "angular_z"), ("left", "linear_y"))
}
"""Columns of the tables of robots and of odometry that now have the names of ROS."""
TABLES = [(name, table) for name, row in EPISODES.items() for table in row["tables"]]

pytestmark = pytest.mark.filterwarnings("ignore:.*is read as rows per second")


def episode_file(name: str) -> Path:
    """Return the file of an episode."""
    return FILES / "episodes" / f"{name}.mcap"


def test_there_are_episodes_of_every_kind() -> None:
    assert {path.stem for path in (FILES / "episodes").iterdir()} == set(EPISODES)
    assert len(EPISODES) >= 20
    assert {row["world"] for row in EPISODES.values()} == {"planar", "physics"}
    assert {row["complete"] for row in EPISODES.values()} == {True, False}
    assert any(row["collisions"] and row["forces"] for row in EPISODES.values())
    texts = "".join(path.read_text("utf-8") for path in (FILES / "trials").rglob("*.xml"))
    assert {name for name in SENSORS if f'type="{name}"' in texts} == SENSORS


@pytest.mark.parametrize("name", EPISODES)
def test_an_old_episode_has_the_same_content(name: str) -> None:
    old, episode = EPISODES[name], read_episode(episode_file(name))
    assert episode.software == "crowdbot 0.1.0"
    assert (episode.outcome, len(episode.times), episode.complete) == (old["outcome"], old["instants"], old["complete"])
    assert episode.digest == old["digest"]
    assert {key: len(readings) for key, readings in episode.readings.items()} == old["readings"]
    counts = (len(episode.contacts), len(episode.forces), len(episode.collisions))
    assert counts == (old["contacts"], old["forces"], old["collisions"])
    assert {key: episode.metrics[key] for key in old["metrics"]} == pytest.approx(old["metrics"])
    arrays = (episode.times, episode.position, episode.velocity, episode.heading, episode.radius, episode.active)
    assert array_hash(*arrays, episode.ids, episode.commands) == old["arrays"]


@pytest.mark.parametrize(("name", "table"), TABLES)
def test_an_old_episode_is_exported_to_the_same_table(name: str, table: str, tmp_path: Path) -> None:
    assert export(episode_file(name), tmp_path / "table.csv", table) == EPISODES[name]["tables"][table]["rows"]
    expected = EPISODES[name]["tables"][table]
    renamed = RENAMED if table in ("robots", "odometry") else {}
    columns = [renamed.get(column, column) for column in expected["columns"]]
    assert describe(pd.read_csv(tmp_path / "table.csv")) == expected | {"columns": columns}


@pytest.mark.parametrize("name", [name for name in EPISODES if name != DRAWN])
def test_an_old_episode_replays(name: str) -> None:
    assert SAME_MACHINE or SAME not in os.environ
    found, old = replay(episode_file(name), folder=FILES / "trials", trust=True), EPISODES[name]
    assert found.recorded_versions == old["versions"] | {"processor": "unknown"}
    assert (found.software, found.complete) == ("crowdbot 0.1.0", old["complete"])
    assert f"(made with crowdbot 0.1.0{'' if found.complete else ', killed before its end'})" in str(found)
    assert found.outcomes == (old["outcome"], old["outcome"])
    if name in CHANGED or name in MOVED:
        assert not found.equal
    elif SAME_MACHINE:
        assert (found.equal, found.replayed) == (True, old["digest"]), str(found)


@pytest.mark.program
@pytest.mark.usefixtures("digests")
def test_old_episodes_are_equal_to_the_last_bit_at_their_level_of_processor() -> None:
    """The tests of replays and branches in another process, where they compare every bit."""
    words = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "-p", "no:xdist", "-k", "replays or branches"]
    place = level_environment("x86-64-v3") | {SAME: "yes"}
    program = subprocess.run([*words, __file__], env=place, capture_output=True, text=True)
    assert program.returncode == 0, program.stdout


@pytest.mark.usefixtures("drawing")
def test_an_old_episode_with_a_colour_camera_runs_to_the_same_pictures() -> None:
    old = read_episode(episode_file(DRAWN))
    new = run(parse_trial(old.xml, quiet=True), seed=old.seed)
    assert new.position == pytest.approx(old.position, abs=NEAR)
    pictures, before = new.readings["puck/eye"], old.readings["puck/eye"]
    assert len(pictures) == len(before)
    for picture, other in zip(pictures, before, strict=True):
        assert isinstance(picture, RgbImage)
        assert isinstance(other, RgbImage)
        assert np.abs(picture.rgb.astype(float) - other.rgb).mean() < 2.0


def test_replay_prints_the_version_that_made_the_episode(capsys: pytest.CaptureFixture[str]) -> None:
    path = str(episode_file("own-code"))
    status = main(["replay", path, "--folder", str(FILES / "trials")])
    assert "with seed 1 (made with crowdbot 0.1.0)" in " ".join(capsys.readouterr().out.split())
    assert main(["replay", path, "--folder", str(FILES / "trials"), "--json"]) == status
    printed = json.loads(capsys.readouterr().out)
    assert printed["software"] == "crowdbot 0.1.0"
    assert printed["recorded_versions"] == EPISODES["own-code"]["versions"] | {"processor": "unknown"}


def make_again(old: RecordedEpisode, folder: Path) -> Path:
    """Run the trial of an episode, and branch where the episode did."""
    rows = json.loads(old.metadata.get("origin", "[]"))
    rows.append({"tick": old.metadata.get("begin", 0), "trial": old.xml, "seed": old.seed})
    trials = [part.trial for part in Provenance.of(old.path, FILES / "trials").parts]
    path = folder / "again.mcap"
    record(trials[0], int(rows[0]["seed"]), path)
    for row, trial in zip(rows[1:], trials[1:], strict=True):
        at = int(row["tick"]) * int(old.metadata["step_ns"]) * 1e-9
        before, path = path, folder / f"again-{row['tick']}.mcap"
        branch(before, at, seed=row["seed"], trial=trial, out=path)
    return path


@pytest.mark.parametrize("name", ["flow", "hall", "branch", "killed", "bump"])
def test_an_old_episode_branches(name: str, tmp_path: Path) -> None:
    old = read_episode(episode_file(name))
    at = float(old.times[len(old.times) // 2])
    source = episode_file(name)
    same = SAME_MACHINE and name not in MOVED
    if not same:  # a branch starts from the same bytes, so the episode is made on this machine first
        source = make_again(old, tmp_path)
    done = branch(source, at, changes={"duration": at + 0.5}, out=tmp_path)
    new = read_episode(tmp_path / "episode.mcap")
    assert done.outcome == new.outcome
    assert new.times == pytest.approx(np.arange(len(new.times)) * 0.1 + at)
    k = len(old.times) // 2
    first = old.position[k, old.active[k]]
    exact = 0.0 if same else NEAR if name in MOVED else 1e-6
    assert new.position[0, new.active[0]] == pytest.approx(first, abs=exact)


def test_an_old_episode_that_was_killed_is_repaired(tmp_path: Path) -> None:
    path, repaired = copy("episodes/killed.mcap", tmp_path), read_episode(episode_file("repaired"))
    assert repair(path) == read_episode(episode_file("killed")).times[-1]
    found = read_episode(path)
    assert (found.digest, found.outcome, found.complete) == (repaired.digest, "interrupted", True)
    assert array_hash(found.position) == array_hash(repaired.position)
    assert found.metrics == pytest.approx(repaired.metrics, nan_ok=True)

"""Export: tables that other tools open, with every row of the episode."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from trial_texts import FLOW

from crowdbot.core import EpisodeError, InputError
from crowdbot.trials import Recorded, Trial, export, read_episode, record


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Recorded]:
    folder = tmp_path_factory.mktemp("flow")
    record(Trial.parse(FLOW), out=folder)
    return folder / "episode.mcap", read_episode(folder / "episode.mcap")


def table(path: Path, to: Path, name: str) -> pd.DataFrame:
    rows = export(path, to, name)
    found = pd.read_parquet(to) if to.suffix == ".parquet" else pd.read_csv(to, keep_default_na=False)
    assert len(found) == rows
    return found


@pytest.mark.parametrize("ending", ["parquet", "csv"])
def test_people(recorded: tuple[Path, Recorded], tmp_path: Path, ending: str) -> None:
    path, read = recorded
    found = table(path, tmp_path / "deep" / f"people.{ending}", "people")
    k, agent = np.nonzero(read.active)
    assert np.array_equal(found["time"], read.times[k])
    assert np.array_equal(found["id"], read.ids[agent])
    for column, value in {"x": read.position[..., 0], "vy": read.velocity[..., 1], "heading": read.heading}.items():
        assert np.array_equal(found[column], value[k, agent]), column
    assert np.array_equal(found["radius"], read.radius[agent])
    robot = found["robot"] == "robot"
    assert set(found["id"][robot]) == {read.robots[0]}
    assert set(found["robot"]) == {"", "robot"}
    assert os.listdir(tmp_path / "deep") == [f"people.{ending}"]


def test_robots_scans_and_contacts(recorded: tuple[Path, Recorded], tmp_path: Path) -> None:
    path, read = recorded
    robots = table(path, tmp_path / "robots.parquet", "robots")
    assert np.array_equal(robots["time"], read.times)
    assert np.array_equal(robots[["command_forward", "command_turn", "command_left"]], read.commands[:, 0])
    scans = table(path, tmp_path / "scans.parquet", "scans")
    assert np.array_equal(scans["range"], np.concatenate([scan.ranges for scan in read.scans]))
    assert np.array_equal(scans["hit"], np.concatenate([scan.hit for scan in read.scans]))
    contacts = table(path, tmp_path / "contacts.csv", "contacts")
    assert len(contacts) == len(read.contacts) > 0
    assert contacts["clearance"].max() < 0.0


def test_what_cannot_be_exported_is_said(recorded: tuple[Path, Recorded], tmp_path: Path) -> None:
    path = recorded[0]
    with pytest.raises(InputError, match=r"there is no table 'peple', did you mean 'people'"):
        export(path, tmp_path / "a.csv", "peple")
    with pytest.raises(InputError, match=r"ends in .txt; give a name that ends in .parquet or .csv"):
        export(path, tmp_path / "a.txt")
    with pytest.raises(EpisodeError, match="there is no episode file"):
        export(tmp_path / "none.mcap", tmp_path / "a.csv")
    whole = path.read_bytes()
    hole = tmp_path / "hole.mcap"
    hole.write_bytes(whole[: len(whole) // 2] + bytes(2000) + whole[len(whole) // 2 + 2000 :])
    with pytest.raises(EpisodeError, match="is damaged"):
        export(hole, tmp_path / "b" / "a.csv")
    assert not list(tmp_path.glob("b/*"))

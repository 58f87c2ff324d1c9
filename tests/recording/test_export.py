"""Export: tables that other tools open, with every row of the episode."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from PIL import Image

from crowdbot.cli import main
from crowdbot.core import EpisodeError, InputError
from crowdbot.recording import RecordedEpisode, export, read_episode, record
from crowdbot.sensors import RgbImage
from crowdbot.trials import parse_trial
from episode_copies import copy_episode
from space_trials import ROOM, room
from trial_texts import FLOW


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, RecordedEpisode]:
    folder = tmp_path_factory.mktemp("flow")
    record(parse_trial(FLOW), out=folder)
    return folder / "episode.mcap", read_episode(folder / "episode.mcap")


def table(path: Path, to: Path, name: str) -> pd.DataFrame:
    rows = export(path, to, name)
    data_frame = pd.read_parquet(to) if to.suffix == ".parquet" else pd.read_csv(to, keep_default_na=False)
    assert len(data_frame) == rows
    return data_frame


def test_commands_that_the_file_does_not_have_are_nan(recorded: tuple[Path, RecordedEpisode], tmp_path: Path) -> None:
    path = copy_episode(recorded[0], tmp_path / "part.mcap", without=["/robot/cmd_vel"])
    robots = table(path, tmp_path / "robots.parquet", "robots")
    assert len(robots) == len(recorded[1].times)
    assert robots[["command_linear_x", "command_angular_z", "command_linear_y"]].isna().all(axis=None)
    assert robots["linear_x"].notna().all()


@pytest.mark.parametrize("ending", ["parquet", "csv"])
def test_people(recorded: tuple[Path, RecordedEpisode], tmp_path: Path, ending: str) -> None:
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


def test_robots_scans_and_contacts(recorded: tuple[Path, RecordedEpisode], tmp_path: Path) -> None:
    path, read = recorded
    robots = table(path, tmp_path / "robots.parquet", "robots")
    assert np.array_equal(robots["time"], read.times)
    assert np.array_equal(robots[["command_linear_x", "command_angular_z", "command_linear_y"]], read.commands[:, 0])
    scans = table(path, tmp_path / "scans.parquet", "scans")
    assert np.array_equal(scans["range"], np.concatenate([scan.ranges for scan in read.scans]))
    assert np.array_equal(scans["hit"], np.concatenate([scan.hit for scan in read.scans]))
    contacts = table(path, tmp_path / "contacts.csv", "contacts")
    assert len(contacts) == len(read.contacts) > 0
    assert contacts["clearance"].max() < 0.0


@pytest.fixture(scope="module")
def seen(drawing: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("seen")
    record(parse_trial(room(text=ROOM)), out=folder)
    return folder / "episode.mcap"


@pytest.mark.parametrize("ending", ["parquet", "csv"])
def test_pictures_are_rows_and_files(seen: Path, tmp_path: Path, ending: str) -> None:
    found = table(seen, tmp_path / f"eyes.{ending}", "pictures")
    pictures = read_episode(seen).readings["pepper/eyes"]
    assert np.array_equal(found["time"], [picture.time for picture in pictures])
    assert len(found) == 6
    assert set(found["sensor"]) == {"pepper/eyes"}
    assert (set(found["width"]), set(found["height"]), set(found["cx"])) == ({32}, {24}, {15.5})
    for row, picture in zip(found.itertuples(), pictures, strict=True):
        assert isinstance(picture, RgbImage)
        assert picture.hit is not None
        assert np.array_equal(np.asarray(Image.open(tmp_path / str(row.file))), picture.rgb[0])
        assert set(str(row.seen).split()) == {str(who) for who in np.unique(picture.hit) if who >= 0}
        assert row.z == pytest.approx(picture.pose.position[0, 2])
    assert found["file"][1] == "eyes-images/pepper-eyes-0000200000000.png"
    assert sorted(os.listdir(tmp_path)) == ["eyes-images", f"eyes.{ending}"]
    assert len(list((tmp_path / "eyes-images").iterdir())) == 6


def test_the_program_says_where_the_images_are(
    seen: Path, recorded: tuple[Path, RecordedEpisode], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["export", str(seen), "--to", str(tmp_path / "p.csv"), "--table", "pictures"]) == 0
    assert capsys.readouterr().out == f"{tmp_path}/p.csv: 6 rows, images in {tmp_path}/p-images\n"
    assert main(["export", str(recorded[0]), "--to", str(tmp_path / "none.csv"), "--table", "pictures"]) == 0
    assert capsys.readouterr().out == f"{tmp_path}/none.csv: 0 rows: the episode holds no pictures\n"
    assert sorted(os.listdir(tmp_path)) == ["none.csv", "p-images", "p.csv"]
    whole = seen.read_bytes()
    (tmp_path / "hole.mcap").write_bytes(whole[: len(whole) // 2] + bytes(2000) + whole[len(whole) // 2 + 2000 :])
    with pytest.raises(EpisodeError, match="is damaged"):
        export(tmp_path / "hole.mcap", tmp_path / "hole" / "p.csv", "pictures")
    assert not list(tmp_path.glob("hole/*"))


def test_what_cannot_be_exported_is_said(recorded: tuple[Path, RecordedEpisode], tmp_path: Path) -> None:
    path = recorded[0]
    with pytest.raises(InputError, match=r"there is no table 'peple', did you mean 'people'"):
        export(path, tmp_path / "a.csv", "peple")
    with pytest.raises(InputError, match=r"has the extension '.txt'; use .parquet or .csv"):
        export(path, tmp_path / "a.txt")
    with pytest.raises(EpisodeError, match="there is no episode file"):
        export(tmp_path / "none.mcap", tmp_path / "a.csv")
    whole = path.read_bytes()
    hole = tmp_path / "hole.mcap"
    hole.write_bytes(whole[: len(whole) // 2] + bytes(2000) + whole[len(whole) // 2 + 2000 :])
    with pytest.raises(EpisodeError, match="is damaged"):
        export(hole, tmp_path / "b" / "a.csv")
    assert not list(tmp_path.glob("b/*"))

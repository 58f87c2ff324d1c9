"""Readers of data sets from robots and motion capture: what is left out, and damaged files."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from synthetic_recordings import PEOPLE, lcas_csv, thor_magni_csv, wildtrack_frames

from crowdbot.core import DataError
from crowdbot.data import load


def test_objects_of_thor_magni_are_left_out_and_roles_are_labels(tmp_path: Path) -> None:
    file = tmp_path / "run.csv"
    thor_magni_csv(file)
    tracks = load(file)
    assert tracks.robots == frozenset({PEOPLE + 1})
    assert "1 objects are left out" in tracks.note
    assert tracks.labels[1] == "Visitors-Alone"
    assert load(file, fps=50.0).dt == pytest.approx(0.02)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("Frame,Time", "Row,Time", "no line of column names that begins with Frame"),
        ("Helmet_1 Centroid_X", "Helmet_1 Middle_X", "has no columns Helmet_1 Centroid_X"),
        ("\n100,", "\nx100,", "line .*: a frame or a position is missing or is not a number"),
    ],
)
def test_damaged_files_of_thor_magni(old: str, new: str, words: str, tmp_path: Path) -> None:
    file = tmp_path / "run.csv"
    thor_magni_csv(file)
    text = file.read_text().replace(old, new)
    if "Middle" in new:
        text = text.replace("Helmet_1 - 1 X", "a").replace("Helmet_1 - 2 X", "b")
    file.write_text(text)
    with pytest.raises(DataError, match=words):
        load(file)


def test_a_frame_of_wildtrack_stands_for_its_folder(tmp_path: Path) -> None:
    file = tmp_path / "annotations" / "00000030.json"
    wildtrack_frames(file)
    tracks = load(file)
    assert "frames of the folder annotations" in tracks.note
    assert tracks.dt == pytest.approx(0.5)
    other = load(file.with_name("00000005.json"))
    assert other.position.tolist() == tracks.position.tolist()


@pytest.mark.parametrize(
    ("content", "name", "words"),
    [
        ([{"personID": 1, "positionID": 480 * 1440}], "00000005.json", "positionID is 691200, it must be at least 0"),
        ([{"personID": 1, "positionID": 5}, 7], "00000005.json", "is not a file of WILDTRACK, or is damaged"),
        ([{"personID": 1, "positionID": 5}], "five.json", "the name of a WILDTRACK file is its frame"),
    ],
)
def test_damaged_files_of_wildtrack(content: object, name: str, words: str, tmp_path: Path) -> None:
    file = tmp_path / name
    file.write_text(json.dumps(content))
    with pytest.raises(DataError, match=words):
        load(file)


def test_rows_of_lcas(tmp_path: Path) -> None:
    file = tmp_path / "data.csv"
    lcas_csv(file)
    assert load(file).dt == pytest.approx(0.4)
    lines = file.read_text().splitlines()
    file.write_text("\n".join([*lines[:30], "x,1,0.0,0.0,0.0,1.0", *lines[30:]]))
    with pytest.raises(DataError, match="line 31: the first four of 6 columns must be numbers"):
        load(file)

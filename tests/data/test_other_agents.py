"""Cyclists and cars that the labels of a file name are no pedestrians."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from crowdbot.cli import main
from crowdbot.core import DataError, InputError
from crowdbot.data import Recording, load


@pytest.fixture
def street(tmp_path: Path) -> Path:
    """Write boxes in pixels at 30 Hz: a pedestrian at 1.5 m/s and two bikers at 6 m/s, 0.05 m per pixel."""
    lines = []
    for id, (label, speed) in enumerate((("Pedestrian", 1), ("Biker", 4), ("Biker", 4))):
        for frame in range(300):
            x = 10 + speed * frame
            lines.append(f'{id} {x - 5} {95 + 50 * id} {x + 5} {105 + 50 * id} {frame} 0 0 0 "{label}"\n')
    (tmp_path / "annotations.txt").write_text("".join(lines))
    return tmp_path / "annotations.txt"


def test_only_pedestrians_are_read_and_scored(street: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = ["predict", "--data", str(street), "--scale", "0.05", "--step", "0.4"]
    assert main(asked) == 0
    err = capsys.readouterr().err
    assert "annotations.txt: pixels; 0 rows marked lost are excluded; left out by their labels: 2 Biker\n" in err
    assert "check fps" not in err
    persons = []
    for agents in ("pedestrians", "all"):
        assert main([*asked, "--agents", agents, "--json"]) == 0
        persons.append(json.loads(capsys.readouterr().out)["results"][0]["total"]["persons"])
    assert persons[1] == 3 * persons[0] > 0


def test_the_labels_decide_who_is_left(street: Path) -> None:
    tracks = load(street, transform=0.05)
    assert tracks.other_agents == {1: "Biker", 2: "Biker"}
    assert tracks.without_other_agents().ids.tolist() == [0]
    with pytest.raises(DataError, match="has no pedestrians; the labels of its tracks are 2 Biker"):
        tracks.only("Biker").without_other_agents()
    with pytest.raises(InputError, match="unknown agents 'everyone'; known are pedestrians, all"):
        Recording(str(street), agents="everyone")


def test_boxes_of_whole_pixels_do_not_stand_still(tmp_path: Path) -> None:
    rows = (f'0 {x - 5} 95 {x + 5} 105 {frame} 0 0 0 "Pedestrian"\n' for frame in range(300) for x in [10 + frame // 3])
    (tmp_path / "annotations.txt").write_text("".join(rows))
    assert (
        "warning" not in load(tmp_path / "annotations.txt", transform=0.1).note
    )  # 1 m/s, 2 of 3 frames without motion


def test_speeds_of_pedestrians_are_still_checked(street: Path) -> None:
    assert "check the frame rate (fps) and the units" in load(street, transform=0.5).note
    assert "check fps" not in load(street, transform=0.05).note


@pytest.mark.parametrize("kind", ["Misc", "Truck", "Tram", "Van", "Cyclist", "Car"])
def test_other_types_of_kitti_are_no_people(kind: str, tmp_path: Path) -> None:
    """Of KITTI's types, Pedestrian, Person and Person_sitting are people."""
    types = ("Pedestrian", "Person", "Person_sitting", kind)
    rows = (
        f"{k} {id} {name} 0 0 -1 {100 * id + k} 100 {100 * id + 40} 260 1.7 0.6 0.6 {0.1 * k} 1.6 {5 + id} 0.1\n"
        for k in range(30)
        for id, name in enumerate(types)
    )
    file = tmp_path / "0000.txt"
    file.write_text("".join(rows))
    tracks = Recording(str(file)).tracks
    assert tracks.ids.tolist() == [0, 1, 2]
    assert f"left out by their labels: 1 {kind}" in tracks.note


def test_people_on_vehicles_of_mot_are_no_pedestrians(tmp_path: Path) -> None:
    file = tmp_path / "gt.txt"
    classes = (1, 2, 3, 6, 7)
    file.write_text("".join(f"{k},{id},{100 * id + k},100,20,60,1,{id},1\n" for k in range(1, 31) for id in classes))
    assert Recording(str(file), fps=25.0).tracks.ids.tolist() == [1, 7]

"""Labels of recorded episodes, and what drew their images."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from test_people_labels import TRIAL

from crowdbot.cli import main
from crowdbot.core import InputError
from crowdbot.generation import export_labels
from crowdbot.recording import read_episode


@pytest.fixture(scope="module")
def episode(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the recording of the trial, in a folder without the trial."""
    folder = tmp_path_factory.mktemp("recorded")
    (folder / "lab.xml").write_text(TRIAL, encoding="utf-8")
    assert main(["run", str(folder / "lab.xml"), "--out", str(folder / "run"), "--json"]) == 0
    (folder / "lab.xml").unlink()
    (found,) = (folder / "run").rglob("*.mcap")
    return found


def test_coco_has_the_recorded_image_and_everybody_in_it(episode: Path, tmp_path: Path) -> None:
    assert main(["export", str(episode), "--labels", "coco", "--to", str(tmp_path / "coco")]) == 0
    document = json.loads((tmp_path / "coco" / "coco.json").read_text(encoding="utf-8"))
    assert len(document["images"]) == 1
    assert len(document["annotations"]) == 3
    assert all(one["num_keypoints"] > 0 for one in document["annotations"])
    assert main(["export", str(episode), "--table", "pictures", "--to", str(tmp_path / "pictures.csv")]) == 0
    (recorded,) = (tmp_path / "pictures-images").glob("*.png")
    with Image.open(tmp_path / "coco" / document["images"][0]["file_name"]) as one, Image.open(recorded) as other:
        np.testing.assert_array_equal(np.asarray(one), np.asarray(other))


def test_kitti_has_images_and_clouds(episode: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["export", str(episode), "--labels", "kitti", "--to", str(tmp_path / "kitti"), "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert (summary["images"], summary["scans"]) == (1, 1)
    lines = (tmp_path / "kitti" / "robot-eye" / "label_2" / "000000.txt").read_text(encoding="ascii").splitlines()
    assert len(lines) == 3
    assert (tmp_path / "kitti" / "robot-cloud" / "labels" / "000000.label").stat().st_size > 4000


def test_an_existing_folder_is_replaced_on_request_only(episode: Path, tmp_path: Path) -> None:
    (tmp_path / "coco").mkdir()
    (tmp_path / "coco" / "old").write_text("old", encoding="utf-8")
    with pytest.raises(InputError, match=r"coco already exists; give a new folder, or --force to replace it"):
        export_labels(episode, tmp_path / "coco", "coco")
    assert (tmp_path / "coco" / "old").is_file()
    export_labels(episode, tmp_path / "coco", "coco", force=True)
    assert not (tmp_path / "coco" / "old").exists()
    assert [item.name for item in tmp_path.iterdir()] == ["coco"]


def test_robots_without_such_sensors_are_refused(tmp_path: Path) -> None:
    plain = TRIAL.split("<sensor")[0] + "</robot></trial>"
    (tmp_path / "lab.xml").write_text(plain, encoding="utf-8")
    assert main(["run", str(tmp_path / "lab.xml"), "--out", str(tmp_path / "run"), "--json"]) == 0
    (found,) = (tmp_path / "run").rglob("*.mcap")
    steps: list[float] = []
    with pytest.raises(InputError, match=r"its robots have no colour camera; such labels need one"):
        export_labels(found, tmp_path / "coco", "coco", progress=steps.append)
    assert steps == []  # nothing has run
    with pytest.raises(InputError, match=r"no colour camera or 3-D laser scanner; such labels need one"):
        export_labels(found, tmp_path / "kitti", "kitti")
    with pytest.raises(InputError, match=r"there is no format 'voc' of labels; choose coco or kitti"):
        export_labels(found, tmp_path / "voc", "voc")
    assert not (tmp_path / "coco").exists()


def test_a_recording_says_that_the_software_drew_its_images(episode: Path) -> None:
    assert read_episode(episode).metadata["drawn_by"] == "software"


@pytest.mark.usefixtures("drawing")
def test_a_recording_names_the_graphics_library_that_drew_its_images(tmp_path: Path) -> None:
    (tmp_path / "lab.xml").write_text(TRIAL.replace(' renderer="software" antialiasing="2"', ""), encoding="utf-8")
    assert main(["run", str(tmp_path / "lab.xml"), "--out", str(tmp_path / "run"), "--json"]) == 0
    (found,) = (tmp_path / "run").rglob("*.mcap")
    drawn = read_episode(found).metadata["drawn_by"]
    assert "software" not in drawn.split(", ")
    assert len(drawn) > 3

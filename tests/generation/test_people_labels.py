"""Labels of colour cameras: keypoints, boxes in space, COCO and KITTI, against the geometry of the scene."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from crowdbot.cli import main
from crowdbot.core import InputError
from crowdbot.generation import GenerationPlan
from crowdbot.trials import load_trial

TRIAL = """<trial name="lab" duration="0.2">
<stage walkable="-2,-4 10,-4 10,4 -2,4"><appearance floor="random" walls="brick" sky="overcast"/></stage>
<crowd type="orca"/>
<agent name="ann" x="4" y="0.5" heading="3.1416" body="woman-36"/>
<agent name="ben" x="6" y="-0.8" heading="0.0" body="man-44"/>
<agent name="cat" x="5.2" y="0.72" heading="0.0" body="boy-08"/>
<robot name="robot" type="turtlebot2" x="0" y="0" default-sensors="false">
<goal x="0.1" y="0"/><navigator type="straight"/>
<sensor name="eye" type="rgbcamera" z="1.2" width="320" height="240" rate="1" renderer="software" antialiasing="2"/>
<sensor name="cloud" type="lidar3d" z="1.0" rate="1"/></robot></trial>"""


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of generated data of the trial."""
    folder = tmp_path_factory.mktemp("labels")
    (folder / "lab.xml").write_text(TRIAL, encoding="utf-8")
    words = ["generate", str(folder / "lab.xml"), "--seeds", "0:1", "--coco", "--kitti", "--out", str(folder / "data")]
    assert main([*words, "--json"]) == 0
    return folder / "data"


def people(data: Path) -> list[dict[str, Any]]:
    document = json.loads((data / "coco.json").read_text(encoding="utf-8"))
    return [one for one in document["annotations"] if one["image_id"] == 1]


def test_keypoints_lie_in_the_box_of_the_pixels_and_heads_are_up(data: Path) -> None:
    found = people(data)
    assert len(found) == 3
    for one in found:
        points = np.array(one["keypoints"]).reshape(17, 3)
        left, top, wide, high = one["bbox"]
        assert one["num_keypoints"] == np.count_nonzero(points[:, 2])
        seen = points[points[:, 2] == 2]
        assert len(seen) >= 2
        assert np.all((seen[:, 0] > left - 2) & (seen[:, 0] < left + wide + 2))
        assert np.all((seen[:, 1] > top - 2) & (seen[:, 1] < top + high + 2))
        assert points[0, 1] < points[5, 1] < points[11, 1] < points[13, 1] < points[15, 1]  # nose to ankle


def test_left_and_right_are_those_of_the_person(data: Path) -> None:
    ann, ben = sorted(people(data), key=lambda person: person["box_3d"]["center"][0])[::2]
    for item, toward in ((ann, 1.0), (ben, -1.0)):
        points = np.array(item["keypoints"]).reshape(17, 3)
        assert toward * (points[5, 0] - points[6, 0]) > 0.0  # the left shoulder of who looks at the camera is right


def test_who_stands_behind_another_is_hidden(data: Path) -> None:
    hidden = [person for person in people(data) if np.count_nonzero(np.array(person["keypoints"])[2::3] == 1) > 5]
    assert len(hidden) == 1
    assert hidden[0]["box_3d"]["size"][2] < 1.4  # the boy


def test_boxes_in_space_enclose_the_person(data: Path) -> None:
    for person in people(data):
        x, y, z = person["box_3d"]["center"]
        length, width, height = person["box_3d"]["size"]
        place = min(((4, 0.5, 1.6), (6, -0.8, 1.75), (5.2, 0.72, 1.3)), key=lambda p: abs(p[0] - x))
        assert (x, y) == pytest.approx(place[:2], abs=0.12)
        assert height == pytest.approx(place[2], abs=0.12)
        assert z == pytest.approx(0.5 * height, abs=0.03)
        assert 0.2 < length < 0.9
        assert 0.3 < width < 0.9


def test_kitti_has_the_same_people(data: Path) -> None:
    (place,) = (data / "kitti").glob("*/robot-eye")
    lines = [line.split() for line in (place / "label_2" / "000000.txt").read_text(encoding="ascii").splitlines()]
    assert [line[0] for line in lines] == ["Pedestrian"] * 3
    assert all(len(line) == 15 for line in lines)
    numbers = np.array([[float(word) for word in line[1:]] for line in lines])
    away = np.sort(numbers[:, 12])  # z forward
    assert away == pytest.approx([4.0, 5.2, 6.0], abs=0.15)
    assert numbers[:, 11] == pytest.approx(1.2, abs=0.06)  # the floor is below the camera
    with Image.open(place / "image_2" / "000000.png") as image:
        assert image.size == (320, 240)
    text = (place / "calib" / "000000.txt").read_text(encoding="ascii")
    assert [row.partition(":")[0] for row in text.splitlines()][:5] == ["P0", "P1", "P2", "P3", "R0_rect"]
    matrix = np.array([float(word) for word in text.splitlines()[2].split()[1:]]).reshape(3, 4)
    for row in numbers:
        column, line, scale = matrix @ (*row[10:13], 1.0)
        box = row[3:7]
        assert box[0] - 3 < column / scale < box[2] + 3
        assert line / scale == pytest.approx(box[3], abs=8.0) or row[1] > 0  # the feet are at the lower edge


def test_clouds_have_instances(data: Path) -> None:
    (place,) = (data / "kitti").glob("*/robot-cloud")
    points = np.frombuffer((place / "velodyne" / "000000.bin").read_bytes(), "<f4").reshape(-1, 4)
    labels = np.frombuffer((place / "labels" / "000000.label").read_bytes(), "<u4")
    assert len(points) == len(labels) > 1000
    assert np.all(np.isfinite(points))
    kinds = labels & 0xFFFF
    assert {30, 50} <= set(kinds.tolist())
    for item in np.unique(labels[kinds == 30] >> 16):
        mine = points[(labels >> 16) == item]
        assert np.ptp(mine[:, :2], axis=0).max() < 1.2
    assert np.all(labels[kinds != 30] >> 16 == 0)


def test_kitti_needs_a_camera_or_a_scanner() -> None:
    with pytest.raises(InputError, match=r"KITTI needs a colour camera or a 3-D scanner, and its robot has neither"):
        GenerationPlan([load_trial("frontal")], range(1), sensors=["sick-tim571"], kitti=True)

"""Detectors in images: boxes become places on the floor; networks of the user; hostile files."""

from dataclasses import dataclass

import numpy as np
import pytest

from crowdbot.core import DataError, InputError, Pose, Scene, SpatialPose
from crowdbot.perception import BoxDetector, Boxes, DepthClusters, HogPeople, NetworkPeople
from crowdbot.perception.camera import select_boxes
from crowdbot.sensors import DepthCamera, Lens, RgbImage

LENS = Lens(640, 480, 550.0, 550.0, 319.5, 239.5)
POSE = SpatialPose.of((1.0, 2.0, 1.2), yaw=0.5)


def box_of(away, side, height=1.7, pose=POSE, lens=LENS):
    """Return the box of a person at a place in the camera's level frame."""
    low, top = ((pose.position[0, 2] - z) / away for z in (0.0, height))
    middle = -side / away * lens.fx + lens.cx
    half = 0.2 * height / away * lens.fx
    return [middle - half, top * lens.fy + lens.cy, middle + half, low * lens.fy + lens.cy]


@dataclass(frozen=True, kw_only=True)
class Fixed(BoxDetector):
    rows: tuple = ()

    def find_boxes(self, rgb):
        return Boxes(np.array(self.rows, dtype=float).reshape(-1, 4), np.ones(len(self.rows)))


def image(lens=LENS, pose=POSE):
    return RgbImage(0.7, pose, np.zeros((1, lens.height, lens.width, 3), dtype=np.uint8), None, lens)


def world(away, side):
    cos, sin = np.cos(0.5), np.sin(0.5)
    return np.array([1.0 + cos * away - sin * side, 2.0 + sin * away + cos * side])


@pytest.mark.parametrize(("away", "side"), [(4.0, 0.0), (8.0, 2.0), (6.0, -1.5)])
def test_a_box_becomes_the_place_on_the_floor(away, side):
    found = Fixed(rows=(box_of(away, side),)).detect(image())
    assert found.position[0] == pytest.approx(world(away, side), abs=0.02)
    assert found.time == 0.7
    spread, axes = np.linalg.eigh(found.covariance[0])
    ray = found.position[0] - POSE.position[0, :2]
    assert spread[1] > spread[0] > 0.0
    assert abs(axes[:, 1] @ ray / np.linalg.norm(ray)) > 0.99


def test_a_tall_person_is_placed_by_the_floor_more_than_by_the_height():
    found = Fixed(rows=(box_of(3.0, 0.0, height=2.0),)).detect(image())
    off = np.linalg.norm(found.position[0] - POSE.position[0, :2]) - 3.0
    assert -0.35 < off < 0.0


def test_a_person_whose_feet_are_outside_is_placed_by_the_head():
    away = 2.0
    box = box_of(away, 0.0)
    box[3] = 479.0
    found = Fixed(rows=(box,)).detect(image())
    assert np.linalg.norm(found.position[0] - POSE.position[0, :2]) == pytest.approx(away, abs=0.05)


def test_distortion_is_removed():
    bent = Lens(640, 480, 550.0, 550.0, 319.5, 239.5, (-0.2, 0.05, 0.0, 0.0, 0.0))
    box = box_of(5.0, 1.5)
    middle = 0.5 * (box[0] + box[2])
    low, top = (
        bent.distort(np.array((middle - 319.5) / 550.0), np.array((y - 239.5) / 550.0)) for y in (box[3], box[1])
    )
    x, y, up = low[0] * 550.0 + 319.5, low[1] * 550.0 + 239.5, top[1] * 550.0 + 239.5
    found = Fixed(rows=((x - 20, up, x + 20, y),)).detect(image(bent))
    assert found.position[0] == pytest.approx(world(5.0, 1.5), abs=0.1)


def test_far_people_are_left_out_and_people_hide_what_is_behind():
    found = Fixed(rows=(box_of(4.0, 0.0), box_of(30.0, 3.0))).detect(image())
    assert len(found) == 1
    places = [world(4.0, 0.0), world(8.0, 0.0), world(8.0, 3.0), world(-3.0, 0.0)]
    assert found.coverage.visible(places).tolist() == [1.0, 0.0, 1.0, 0.0]


def test_boxes_that_overlap_a_stronger_one_are_left_out():
    rows = np.array([[0, 0, 10, 20], [1, 0, 11, 20], [50, 0, 60, 20.0], [80, 0, 90, 20]])
    boxes = select_boxes(rows, np.array([0.9, 0.8, 0.7, 0.1]), 0.5)
    assert boxes.box[:, 0].tolist() == [0, 50]


def test_hog_finds_nobody_in_an_empty_or_a_tiny_image():
    assert len(HogPeople().detect(image())) == 0
    tiny = Lens.of(32, 24, 1.0)
    assert len(HogPeople().detect(image(tiny))) == 0


def rows_of(layout, table):
    file = "none.onnx"
    return NetworkPeople(file=file, layout=layout)._rows(np.asarray(table, dtype=float))


def test_outputs_of_both_layouts_are_read():
    rows, score = rows_of("yolov8", np.array([[10, 20, 4, 8, 0.9]]).T[None])
    assert rows.tolist() == [[10, 20, 4, 8]]
    assert score.tolist() == [0.9]
    rows, score = rows_of("yolov5", [[[10, 20, 4, 8, 0.5, 0.8]]])
    assert score.tolist() == [0.4]
    for table in (np.zeros((2, 5, 7)), np.zeros((1, 4, 3)), np.full((1, 5, 2), np.nan)):
        with pytest.raises(DataError, match="is not of layout yolov8"):
            rows_of("yolov8", table)


def test_files_that_are_no_networks_are_rejected(tmp_path):
    file = tmp_path / "weights.onnx"
    file.write_bytes(b"no network")
    for name in (file, tmp_path / "none.onnx"):
        with pytest.raises(DataError, match="cannot be read as ONNX"):
            NetworkPeople(file=str(name)).detect(image())


def test_wrong_values_are_rejected():
    with pytest.raises(InputError, match="layout = 'ssd' must be yolov5 or yolov8"):
        NetworkPeople(file="a.onnx", layout="ssd")
    with pytest.raises(InputError, match="upscale = 9"):
        HogPeople(upscale=9.0)


def test_depth_clusters_find_people_before_a_wall():
    places = [[3.0, 0.5], [5.0, -1.0]]
    scene = Scene.of(places, radius=0.25, walls=[[(7.0, -5.0), (7.0, 5.0)]])
    pose = Pose.of((0.0, 0.0), 0.0).to_spatial(1.0)
    found = DepthClusters().detect(DepthCamera().read(scene, pose), scene.walls)
    away = np.linalg.norm(found.position[:, None] - np.array(places)[None], axis=-1)
    assert len(found) == 2
    assert away.min(axis=0).max() < 0.15
    assert found.coverage.visible([[3.0, 0.5], [6.0, 1.0], [-2.0, 0.0], [2.5, 1.0]]).tolist() == [1.0, 0.0, 0.0, 1.0]

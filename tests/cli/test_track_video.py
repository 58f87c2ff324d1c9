"""``crowdbot track --video``: a video of a robot's camera becomes tracks and forecasts in metres; wrong input."""

import csv
import json
import math

import cv2
import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.core import DataError, Pose
from crowdbot.evaluation import read_camera, read_odometry, read_true_paths

WIDTH, HEIGHT, FOCAL, MOUNT = 320, 240, 300.0, 1.2
FRAMES, RATE = 30, 10.0
DETECTOR = '''
from dataclasses import dataclass

import numpy as np

from crowdbot.perception import BoxDetector, Boxes


@dataclass(frozen=True, kw_only=True)
class Red(BoxDetector):
    """The box around the red pixels."""

    def find_boxes(self, rgb):
        row, column = np.nonzero((rgb[..., 0] > 150) & (rgb[..., 1] < 90))
        if not len(row):
            return Boxes(np.zeros((0, 4)), np.zeros(0))
        box = [column.min(), row.min(), column.max() + 1.0, row.max() + 1.0]
        return Boxes(np.array([box], dtype=float), np.ones(1))
'''
CAMERA = f"""image_width: {WIDTH}
image_height: {HEIGHT}
distortion_model: plumb_bob
camera_matrix: {{rows: 3, cols: 3, data: [{FOCAL}, 0.0, 159.5, 0.0, {FOCAL}, 119.5, 0.0, 0.0, 1.0]}}
distortion_coefficients: {{rows: 1, cols: 5, data: [0.0, 0.0, 0.0, 0.0, 0.0]}}
mount: {{x: 0.1, y: 0.0, z: {MOUNT}}}
"""


def person(time):
    return 6.0, -1.0 + 0.8 * time


@pytest.fixture
def folder(tmp_path):
    """Write a video of a person who walks across before a robot that moves ahead, and what else is needed."""
    (tmp_path / "camera.yaml").write_text(CAMERA)
    (tmp_path / "red.py").write_text(DETECTOR)
    with (tmp_path / "odometry.csv").open("w") as robot, (tmp_path / "truth.csv").open("w") as truth:
        robot.write("time,x,y,heading\n")
        truth.write("id,time,x,y\n")
        for k in range(80):
            time = k / RATE
            robot.write(f"{time},{0.2 * time},0.0,0.0\n")
            truth.write(f"7,{time},{person(time)[0]},{person(time)[1]}\n")
    video = cv2.VideoWriter(str(tmp_path / "film.avi"), cv2.VideoWriter_fourcc(*"MJPG"), RATE, (WIDTH, HEIGHT))
    for k in range(FRAMES):
        x, y = person(k / RATE)
        away = x - 0.1 - 0.2 * k / RATE
        foot, head, middle = (MOUNT / away, (MOUNT - 1.7) / away, -y / away)
        image = np.full((HEIGHT, WIDTH, 3), 200, dtype=np.uint8)
        left, right = (round(FOCAL * (middle + side / away) + 159.5) for side in (-0.25, 0.25))
        top, low = (round(FOCAL * item + 119.5) for item in (head, foot))
        cv2.rectangle(image, (left, top), (right, low), (30, 30, 220), -1)
        video.write(image)
    video.release()
    return tmp_path


def words(folder, *more):
    given = ["--video", f"{folder}/film.avi", "--camera", f"{folder}/camera.yaml"]
    return ["track", *given, "--odometry", f"{folder}/odometry.csv", "--detector", f"{folder}/red.py:Red", *more]


def test_people_of_a_video_are_tracked_and_predicted_in_metres(folder, capsys):
    plot = folder / "map.png"
    files = ["--out", f"{folder}/found", "--plot", str(plot), "--truth", f"{folder}/truth.csv"]
    assert main(words(folder, *files, "--steps", "4", "--json")) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["frames"] == FRAMES
    assert document["tracks"] == 1
    assert document["scores"]["motp"] < 0.25
    assert document["scores"]["mota"] > 0.7
    assert document["scores"]["error_at_1.6_s"] < 0.8
    assert plot.stat().st_size > 20_000
    with (folder / "found" / "tracks.csv").open() as lines:
        rows = list(csv.DictReader(lines))
    assert float(rows[-1]["x"]) == pytest.approx(6.0, abs=0.3)
    assert float(rows[-1]["vy"]) == pytest.approx(0.8, abs=0.3)
    assert json.loads((folder / "found" / "scores.json").read_text()) == document
    assert (folder / "found" / "tracks.png").read_bytes() == plot.read_bytes()
    with (folder / "found" / "forecasts.csv").open() as lines:
        ahead = [row for row in csv.DictReader(lines) if float(row["time"]) == 2.9]
    assert [float(row["ahead"]) for row in ahead] == [0.4, 0.8, 1.2, 1.6]


def test_true_people_are_read_with_the_options_of_recordings(folder, capsys):
    rows = [line.split(",") for line in (folder / "truth.csv").read_text().splitlines()[1:]]
    lines = [f"{who};{1000 * float(time)};{100 * float(x)};{100 * float(y)}\n" for who, time, x, y in rows]
    (folder / "other.csv").write_text("who;stamp;east;north\n" + "".join(lines))
    options = ["--columns", "id=who", "time_ms=stamp", "x=east", "y=north", "--units", "cm"]
    scores = []
    for more in ([f"{folder}/truth.csv"], [f"{folder}/other.csv", *options]):
        assert main(words(folder, "--steps", "1", "--json", "--truth", *more)) == 0
        found = json.loads(capsys.readouterr().out)["scores"]
        scores.append({name: value for name, value in found.items() if value is not None})
    assert len(scores[0]) > 3
    assert scores[1] == pytest.approx(scores[0], rel=1e-6)


def test_options_of_recordings_need_true_people(folder, capsys):
    assert main(words(folder, "--units", "cm")) == 2
    assert "--units is for recordings; give --truth" in capsys.readouterr().err
    assert main(["track", "frontal", "--scale", "0.1"]) == 2
    assert "--scale is for recordings; give --video with --truth" in capsys.readouterr().err


def test_the_table_names_the_errors(folder, capsys):
    assert main(words(folder, "--truth", f"{folder}/truth.csv", "--steps", "1")) == 0
    shown = capsys.readouterr().out
    assert "30 frames" in shown
    assert "error at 0.4 s" in shown


@pytest.mark.parametrize(
    ("more", "text"),
    [
        (["--camera", "none.yaml"], "none.yaml cannot be read as a calibration"),
        (["--detector", "lidar-clusters"], "LidarClusters does not find people in images"),
        (["--steps", "0"], "--steps 0 must be at least 1"),
        (["--tracker", "a", "b"], "--video takes one detector, tracker, motion model and predictor"),
        (["--seed", "1", "crossing-flows"], "give a SOURCE, --scenes or --video, and only one"),
        (["--video", "none.avi"], "none.avi does not exist"),
    ],
)
def test_wrong_input_is_one_sentence(folder, more, text, capsys):
    assert main(words(folder, *more)) == 2
    assert text in capsys.readouterr().err


def test_images_of_another_size_and_files_that_are_no_videos_are_rejected(folder, capsys):
    (folder / "camera.yaml").write_text(CAMERA.replace(f"image_width: {WIDTH}", "image_width: 640"))
    assert main(words(folder)) == 2
    assert "has images of 320 x 240 pixels, the camera has 640 x 240" in capsys.readouterr().err
    (folder / "film.avi").write_text("no video")
    assert main(words(folder)) == 2
    assert "cannot be read as a video" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("plumb_bob", "equidistant", "distortion_model = 'equidistant' is not supported"),
        ("mount:", "place:", "mount must have x, y, z"),
        (f"z: {MOUNT}", "z: -1.0", "the camera is above the floor"),
        ("image_height: 240", "image_height: high", "image_height = 'high' must be a number"),
        ("0.0, 0.0, 1.0]", "0.0, 1.0]", "camera_matrix must have data with 9 numbers"),
    ],
)
def test_wrong_calibrations_are_rejected(tmp_path, old, new, text):
    file = tmp_path / "camera.yaml"
    file.write_text(CAMERA.replace(old, new))
    with pytest.raises(DataError, match=text):
        read_camera(file)


def test_poses_and_paths_are_interpolated(folder):
    robot = read_odometry(folder / "odometry.csv")
    assert robot.at(1.05).position[0] == pytest.approx([0.21, 0.0])
    pose = read_camera(folder / "camera.yaml").pose(Pose.of((1.0, 2.0), math.pi / 2))
    assert pose.position[0] == pytest.approx([1.0, 2.1, MOUNT])
    assert read_true_paths(folder / "truth.csv").at(0.25)[7] == pytest.approx((6.0, -0.8))
    assert read_true_paths(folder / "truth.csv").at(99.0) == {}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time,x,y\n0,0,0\n", "has no column 'heading'; odometry need"),
        ("time,x,y,heading\n0,0,0,0\n0,1,0,0\n", "the times of odometry must grow"),
        ("time,x,y,heading\n0,0,nan,0\n", "need rows of finite numbers"),
        ("time,x,y,heading\n0,0,a,0\n", "cannot be read as odometry"),
    ],
)
def test_wrong_odometry_is_rejected(tmp_path, text, message):
    file = tmp_path / "odometry.csv"
    file.write_text(text)
    with pytest.raises(DataError, match=message):
        read_odometry(file)

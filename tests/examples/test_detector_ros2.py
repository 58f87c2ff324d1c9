"""The person detector of the examples as a node of ROS 2, by the real rclpy."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import rclpy
from page_commands import ROOT, page_commands
from std_msgs.msg import Header
from test_person_detector import FOLDER, write_network
from visualization_msgs.msg import ImageMarker

from crowdbot.bridges.ros2 import Ros2Node
from crowdbot.bridges.ros2.node import Participant
from crowdbot.trials import load_trial

sys.path[:0] = [str(FOLDER), str(ROOT / "tests" / "bridges")]
from bridge_runs import Running  # noqa: E402
from detect_ros2 import detections_of, image_of, markers_of  # noqa: E402
from detectors import Detections  # noqa: E402

FOUND = Detections(np.array([[10.0, 20.0, 30.0, 80.0]]), np.array([0.75]))
HEADER = Header(frame_id="robot/camera_optical")


def vision_msgs():
    """Return the classes of vision_msgs 4 that the node fills; the wheels lack them."""
    point, center = SimpleNamespace, SimpleNamespace
    return SimpleNamespace(
        Detection2DArray=lambda: SimpleNamespace(header=None, detections=[]),
        Detection2D=lambda: SimpleNamespace(
            header=None, results=[], id="", bbox=SimpleNamespace(center=center(position=point(x=0.0, y=0.0)))
        ),
        ObjectHypothesisWithPose=lambda: SimpleNamespace(hypothesis=SimpleNamespace(class_id="", score=0.0)),
    )


def test_detections_have_the_fields_of_vision_msgs():
    array = detections_of(HEADER, FOUND, vision_msgs())
    (one,) = array.detections
    assert (array.header, one.header) == (HEADER, HEADER)
    assert (one.bbox.center.position.x, one.bbox.center.position.y) == (20.0, 50.0)
    assert (one.bbox.size_x, one.bbox.size_y) == (20.0, 60.0)
    assert (one.results[0].hypothesis.class_id, one.results[0].hypothesis.score) == ("person", 0.75)


def test_markers_are_the_edges_of_the_boxes():
    import visualization_msgs.msg

    marker = markers_of(HEADER, FOUND, visualization_msgs.msg)
    assert (marker.header.frame_id, marker.type) == ("robot/camera_optical", ImageMarker.LINE_LIST)
    assert [(point.x, point.y) for point in marker.points[:4]] == [
        (10.0, 20.0),
        (30.0, 20.0),
        (30.0, 20.0),
        (30.0, 80.0),
    ]
    assert len(marker.points) == 8


def test_an_image_is_turned_to_red_green_blue():
    image = SimpleNamespace(encoding="bgr8", height=1, width=1, step=4, data=b"\1\2\3\0")
    assert image_of(image).tolist() == [[[3, 2, 1]]]
    image.encoding = "mono8"
    with pytest.raises(ValueError, match="encoding 'mono8' must be one of rgb8, bgr8"):
        image_of(image)


@pytest.mark.usefixtures("drawing")
def test_the_process_answers_images_over_ros2(domain, tmp_path, monkeypatch):
    for name, value in (
        ("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"),
        ("ROS_LOG_DIR", str(tmp_path)),
        ("ROS_DOMAIN_ID", str(domain)),
    ):
        monkeypatch.setenv(name, value)
    network = write_network(tmp_path / "person.onnx", "yolov8")
    trial = replace(load_trial(str(FOLDER / "hall.xml")), duration=60.0)
    (file, *words) = next(command for command in page_commands("person-detector", "python") if "markers" in command)
    command = [sys.executable, ROOT / file, *words, "--model", network, "--size", "64", "--threshold", "0.1"]
    listener, seen = Participant(rclpy, "listener", domain), []
    listener.node.create_subscription(ImageMarker, "/robot/camera/detection_markers", seen.append, 10)
    listener.start()
    with Running(trial, [Ros2Node(domain)], rate=0.5) as running:
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        end = time.monotonic() + 90.0
        while not seen and process.poll() is None and time.monotonic() < end:
            time.sleep(0.05)
        running.run.stop.asked = True
        running.end(60.0)
        running.run.port.stop()
        printed, errors = process.communicate(timeout=60)
    listener.stop()
    assert process.returncode == 0, errors
    assert re.match(r"[1-9]\d* images, [1-9]\d* people, median \d+ ms an image", printed), (printed, errors)
    assert seen[0].header.frame_id == "robot/camera_optical"
    assert max(point.x for point in seen[0].points) - min(point.x for point in seen[0].points) == pytest.approx(200.0)


@pytest.mark.program
def test_a_message_whose_package_is_missing_is_named(tmp_path):
    environment = {**os.environ, "ROS_LOG_DIR": str(tmp_path)}
    words = [sys.executable, str(FOLDER / "detect_ros2.py")]
    done = subprocess.run(words, capture_output=True, text=True, timeout=100, env=environment)
    assert done.returncode == 1
    assert "--message detections needs the ROS package vision_msgs, which is not installed" in done.stderr

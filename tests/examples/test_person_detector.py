"""The person detector of the examples: true boxes, scores, networks in ONNX files, and the process over rosbridge."""

import json
import re
import runpy
import subprocess
import sys
from dataclasses import replace

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper
from page_commands import ROOT, page_commands
from rosbags.typesys import get_types_from_msg
from websockets.sync.client import connect

from crowdbot.bridges.fields import message_of as ros_message
from crowdbot.bridges.interface import interface_store
from crowdbot.sensors import Lens
from crowdbot.trials import load_trial

FOLDER = ROOT / "examples" / "person_detector"
sys.path[:0] = [str(FOLDER), str(ROOT / "tests" / "bridges")]
from bridge_runs import serve  # noqa: E402
from detect_rosbridge import image_of, message_of  # noqa: E402
from detectors import Detections, HogDetector, OnnxDetector, strongest  # noqa: E402
from evaluate_detector import Tally, overlap  # noqa: E402
from truth import TrueBoxes, true_boxes  # noqa: E402

LENS = Lens.of(100, 80, 1.0)
DEFINITIONS = {
    "ObjectHypothesis": "string class_id\nfloat64 score",
    "ObjectHypothesisWithPose": "vision_msgs/ObjectHypothesis hypothesis\ngeometry_msgs/PoseWithCovariance pose",
    "Point2D": "float64 x\nfloat64 y",
    "Pose2D": "vision_msgs/Point2D position\nfloat64 theta",
    "BoundingBox2D": "vision_msgs/Pose2D center\nfloat64 size_x\nfloat64 size_y",
    "Detection2D": "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\n"
    "vision_msgs/BoundingBox2D bbox\nstring id",
    "Detection2DArray": "std_msgs/Header header\nvision_msgs/Detection2D[] detections",
}
"""Messages of vision_msgs 4 (docs.ros.org/en/jazzy/p/vision_msgs), without their comments."""


def write_network(file, layout):
    """Write a network that sees one person whose score is the mean of red.

    The box is 20 x 40 pixels around the middle of an input of 64 x 64 pixels.
    """
    rows = 6 if layout == "yolov5" else 5
    weight, bias = np.zeros((rows, 3, 1, 1), dtype=np.float32), np.zeros(rows, dtype=np.float32)
    weight[-1, 0], bias[:4] = 1.0, (32.0, 32.0, 20.0, 40.0)
    if layout == "yolov5":
        bias[4] = 0.5  # objectness
    shape = [1, 1, rows] if layout == "yolov5" else [1, rows, 1]
    graph = helper.make_graph(
        [
            helper.make_node("GlobalAveragePool", ["image"], ["mean"]),
            helper.make_node("Conv", ["mean", "weight", "bias"], ["table"], kernel_shape=[1, 1]),
            helper.make_node("Reshape", ["table", "shape"], ["boxes"]),
        ],
        "one_person",
        [helper.make_tensor_value_info("image", TensorProto.FLOAT, [1, 3, 64, 64])],
        [helper.make_tensor_value_info("boxes", TensorProto.FLOAT, shape)],
        [
            numpy_helper.from_array(weight, "weight"),
            numpy_helper.from_array(bias, "bias"),
            numpy_helper.from_array(np.array(shape, dtype=np.int64), "shape"),
        ],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 13)], ir_version=8)
    onnx.checker.check_model(model)
    onnx.save(model, str(file))
    return file


@pytest.mark.parametrize(("layout", "factor"), [("yolov8", 1.0), ("yolov5", 0.5)])
def test_a_network_of_an_onnx_file_finds_boxes_in_pixels_of_the_image(layout, factor, tmp_path):
    file = write_network(tmp_path / "person.onnx", layout)
    image = np.zeros((64, 128, 3), dtype=np.uint8)
    image[..., 0] = 255
    found = OnnxDetector(file, layout, size=64).detect(image)
    np.testing.assert_allclose(found.boxes, [[44.0, 0.0, 84.0, 64.0]], atol=1e-3)  # cut at the image
    np.testing.assert_allclose(found.scores, [factor * (0.5 + 0.5 * 114 / 255)], atol=1e-3)
    dark = OnnxDetector(file, layout, size=64, threshold=0.5).detect(np.zeros_like(image))
    assert dark.boxes.shape == (0, 4)


def test_what_is_wrong_with_a_network_is_said(tmp_path):
    file = write_network(tmp_path / "person.onnx", "yolov8")
    with pytest.raises(ValueError, match="layout = 'yolov7' must be one of yolov5, yolov8"):
        OnnxDetector(file, "yolov7")
    with pytest.raises(ValueError, match=r"an output of shape \(1, 5, 1\) is not of layout yolov5"):
        OnnxDetector(file, "yolov5", size=64).detect(np.zeros((64, 64, 3), dtype=np.uint8))
    (tmp_path / "no.onnx").write_bytes(b"no network")
    with pytest.raises(ValueError, match="no.onnx cannot be read as ONNX"):
        OnnxDetector(tmp_path / "no.onnx")
    with pytest.raises(ValueError, match="upscale = 9 must be from 0.5 to 4"):
        HogDetector(upscale=9)


def test_of_overlapping_boxes_the_strongest_stays():
    boxes = [[0, 0, 10, 20], [1, 0, 11, 20], [30, 0, 40, 20], [60, 0, 70, 20]]
    found = strongest(boxes, [0.6, 0.9, 0.7, 0.2], threshold=0.5)
    assert found.boxes.tolist() == [[1, 0, 11, 20], [30, 0, 40, 20]]
    assert found.scores.tolist() == [0.9, 0.7]
    assert strongest(np.zeros((0, 4)), [], 0.5).boxes.shape == (0, 4)


def test_true_boxes_are_those_of_the_segmentation():
    hit = np.full((80, 100), -1)
    hit[10:70, 20:40] = 1  # 60 pixels tall: counts
    hit[10:70, 60:63] = 2  # the others of agent 2 are behind agent 3
    hit[5:78, 63:80] = 3
    hit[30:40, 90:100] = 0  # small, and cut by the image
    people = np.array([[20.0, 0.0], [2.0, 0.0], [2.2, 0.0], [1.8, 0.0]])
    found = true_boxes(hit, LENS, np.array([0.0, 0.0, 0.85]), people)
    np.testing.assert_array_equal(found.boxes[1], [20, 10, 40, 70])
    np.testing.assert_allclose(found.distance, [20.0, 2.0, 2.2, 1.8])
    assert found.counts.tolist() == [False, True, False, True]


def test_overlap_is_intersection_over_union():
    boxes = np.array([[0.0, 0.0, 2.0, 2.0], [5.0, 5.0, 6.0, 6.0]])
    np.testing.assert_allclose(overlap(boxes, boxes + [1.0, 0.0, 1.0, 0.0]), [[1 / 3, 0.0], [0.0, 0.0]])
    np.testing.assert_allclose(np.diag(overlap(boxes, boxes)), 1.0)


def test_people_who_do_not_count_are_neither_missed_nor_found():
    boxes = np.array([[0.0, 0.0, 41.0, 100.0], [200.0, 0.0, 241.0, 100.0], [400.0, 0.0, 441.0, 100.0]])
    truth = TrueBoxes(boxes, np.array([3.0, 5.0, 7.0]), np.array([True, False, True]))
    detections = Detections(boxes[[0, 1, 0]] + [[0.0], [0.0], [600.0]], np.array([0.9, 0.8, 0.7]))
    tally = Tally()
    tally.add(detections, truth, focal=100.0)
    assert tally.right == [True, False]
    assert tally.recall() == (0.5, 2)
    assert tally.recall(0.0, 4.0) == (1.0, 1)
    assert tally.precision() == (0.5, 2)
    assert tally.average_precision() == 0.5
    assert np.isnan(tally.recall(20.0, 30.0)[0])


@pytest.mark.usefixtures("drawing")
def test_hog_finds_the_near_people_of_the_simulation(tmp_path, monkeypatch, capsys):
    ((file, *words),) = [words for words in page_commands("person-detector", "python") if "--seeds" in words]
    fast = "--seeds 1 --seconds 3 --upscale 1"  # of an option that comes twice, the last counts
    words += [*fast.split(), "--plot", str(tmp_path / "plot.png")]
    monkeypatch.setattr(sys, "argv", [file, *words])
    runpy.run_path(str(ROOT / file), run_name="__main__")
    printed = capsys.readouterr().out.splitlines()
    assert printed[0] == "HOG x 1, 3 images"
    ((people, recall, count, precision),) = [line.split()[1:] for line in printed if line.startswith("all ")]
    assert int(people) >= 10
    assert int(count) >= 4
    assert float(recall) >= 0.2
    assert float(precision) >= 0.6
    assert (tmp_path / "plot.png").read_bytes().startswith(b"\x89PNG")


def test_the_message_is_that_of_vision_msgs():
    store = interface_store()
    for name, text in DEFINITIONS.items():
        if f"vision_msgs/msg/{name}" not in store.fielddefs:
            store.register(get_types_from_msg(text, f"vision_msgs/msg/{name}"))
    header = {"stamp": {"sec": 3, "nanosec": 5}, "frame_id": "robot/camera_optical"}
    found = message_of(header, Detections(np.array([[10.0, 20.0, 30.0, 80.0]]), np.array([0.75])))
    kind = "vision_msgs/msg/Detection2DArray"
    message = store.deserialize_cdr(store.serialize_cdr(ros_message(found, kind), kind), kind)
    (one,) = message.detections
    assert (one.header.frame_id, one.header.stamp.nanosec) == ("robot/camera_optical", 5)
    assert (one.bbox.center.position.x, one.bbox.center.position.y) == (20.0, 50.0)
    assert (one.bbox.size_x, one.bbox.size_y) == (20.0, 60.0)
    assert (one.results[0].hypothesis.class_id, one.results[0].hypothesis.score) == ("person", 0.75)


def test_an_image_of_another_encoding_is_refused():
    message = {"encoding": "bgr8", "height": 1, "width": 1, "step": 4, "data": "AQIDAA=="}
    assert image_of(message).tolist() == [[[3, 2, 1]]]
    with pytest.raises(ValueError, match="encoding 'mono8' must be one of rgb8, bgr8"):
        image_of(message | {"encoding": "mono8"})


@pytest.mark.live
@pytest.mark.usefixtures("drawing")
def test_the_process_answers_images_over_rosbridge(tmp_path):
    network = write_network(tmp_path / "person.onnx", "yolov8")
    trial = replace(load_trial(str(FOLDER / "hall.xml")), duration=4.0)
    running, server = serve(trial, rate=0.5)
    file, *words = page_commands("person-detector", "python")[0]
    with running:
        words += ["--port", str(server.port), "--model", network, "--size", "64", "--threshold", "0.1"]
        command = [sys.executable, ROOT / file, *words]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        try:
            with connect(f"ws://127.0.0.1:{server.port}") as listener:
                listener.send(json.dumps({"op": "subscribe", "topic": "/robot/camera/detections"}))
                message = json.loads(listener.recv(timeout=120.0))["msg"]
            running.run.stop.asked = True
            printed, errors = process.communicate(timeout=120)
        finally:
            process.kill()
            process.wait()
    assert process.returncode == 0, errors
    assert re.match(r"\d+ images, \d+ people, median \d+ ms an image", printed), (printed, errors)
    assert message["header"]["frame_id"] == "robot/camera_optical"
    (one,) = message["detections"]
    assert one["header"] == message["header"]
    assert one["bbox"]["size_x"] == pytest.approx(200.0)
    assert one["results"][0]["hypothesis"]["class_id"] == "person"

"""A person detector of ROS 2, as a process of its own: images in, boxes out.

    crowdbot run examples/person_detector/hall.xml --bridge ros2 --out detected
    python examples/person_detector/detect_ros2.py

It publishes vision_msgs/Detection2DArray on CAMERA/detections (apt install ros-$ROS_DISTRO-vision-msgs). The wheels of
crowdbot[ros2-wheels] lack vision_msgs; with --message markers it publishes visualization_msgs/ImageMarker on
CAMERA/detection_markers, boxes without scores, which viewers draw over the image. It needs rclpy and OpenCV
(pip install 'crowdbot[perception]'). While an image is searched, newer ones replace each other.
"""

from __future__ import annotations

import argparse
import importlib
import threading

import rclpy
from detectors import add_options, detectors_of
from image_search import ImageSearch, pixels_of
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import Image

NEWEST = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
"""As ``qos_profile_sensor_data``, but only the newest image."""


def image_of(message):
    """Return the pixels ``[H, W, 3]`` of a ``sensor_msgs/Image``.

    Raises:
        ValueError: the encoding is neither rgb8 nor bgr8.
    """
    return pixels_of(message.encoding, message.height, message.width, message.step, message.data)


def detections_of(header, found, package):
    """Return detections as a ``vision_msgs/Detection2DArray`` of version 4 (ROS 2 Humble and later).

    Args:
        header: header of the image.
        found: detections.
        package: the module ``vision_msgs.msg``.
    """
    array = package.Detection2DArray()
    array.header = header
    for (left, top, right, bottom), score in zip(found.boxes.tolist(), found.scores.tolist(), strict=True):
        one, result = package.Detection2D(), package.ObjectHypothesisWithPose()
        one.header = header
        one.bbox.center.position.x, one.bbox.center.position.y = 0.5 * (left + right), 0.5 * (top + bottom)
        one.bbox.size_x, one.bbox.size_y = right - left, bottom - top
        result.hypothesis.class_id, result.hypothesis.score = "person", score
        one.results.append(result)
        array.detections.append(one)
    return array


def markers_of(header, found, package):
    """Return detections as a ``visualization_msgs/ImageMarker`` that draws the edges of all boxes.

    Args:
        header: header of the image.
        found: detections.
        package: the module ``visualization_msgs.msg``.
    """
    marker = package.ImageMarker()
    marker.header, marker.ns, marker.type = header, "people", package.ImageMarker.LINE_LIST
    marker.scale, marker.outline_color.g, marker.outline_color.a = 2.0, 1.0, 1.0
    point = importlib.import_module("geometry_msgs.msg").Point
    for left, top, right, bottom in found.boxes.tolist():
        corners = [(left, top), (right, top), (right, bottom), (left, bottom)]
        for k in range(4):
            marker.points += [point(x=x, y=y) for x, y in (corners[k], corners[(k + 1) % 4])]
    return marker


MESSAGES = {
    "detections": ("vision_msgs", "Detection2DArray", detections_of, "detections"),
    "markers": ("visualization_msgs", "ImageMarker", markers_of, "detection_markers"),
}
"""Package, message, its conversion, and the last part of its topic, by the value of --message."""


def connect_search(node, camera, detector, form):
    """Return a search of the images of a camera that publishes what it finds, with the header of the image.

    Args:
        node: node of rclpy.
        camera: topic of the camera without ``/image``, such as ``/robot/camera``.
        detector: has ``detect(rgb)``.
        form: a key of :data:`MESSAGES`.

    Raises:
        SystemExit: the package of the message is not installed.
    """
    name, kind, convert, topic = MESSAGES[form]
    try:
        package = importlib.import_module(f"{name}.msg")
    except ImportError:
        raise SystemExit(
            f"--message {form} needs the ROS package {name}, which is not installed: "
            f"apt install ros-$ROS_DISTRO-{name.replace('_', '-')}, or choose --message markers"
        ) from None
    out = node.create_publisher(getattr(package, kind), f"{camera}/{topic}", 1)
    search = ImageSearch(
        detector, image_of, lambda message, found: out.publish(convert(message.header, found, package))
    )
    node.create_subscription(Image, f"{camera}/image", search.take_image, NEWEST)
    return search


def listen(node, search):
    """Take images until the simulation has ended."""
    seen = False
    while not seen or node.count_publishers("/clock"):
        rclpy.spin_once(node, timeout_sec=0.1)
        seen = seen or node.count_publishers("/clock") > 0
    search.close()


def main():
    """Detect people until the simulation ends."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--camera", default="/robot/camera", help="topic of the camera, without /image")
    parser.add_argument("--message", choices=tuple(MESSAGES), default="detections", help="what is published")
    add_options(parser)
    options = parser.parse_args()
    rclpy.init()
    node = rclpy.create_node("detect")
    search = connect_search(node, options.camera, next(iter(detectors_of(options).values())), options.message)
    listener = threading.Thread(target=listen, args=(node, search))
    listener.start()
    search.work()
    listener.join()
    print(search.summary())
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()

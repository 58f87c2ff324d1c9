"""A person detector over rosbridge, as a process of its own: images in, vision_msgs/Detection2DArray out.

    crowdbot run hall.xml --bridge rosbridge --out detected
    python examples/person_detector/detect_rosbridge.py

It needs roslibpy and OpenCV (pip install roslibpy 'crowdbot[detector]') and any rosbridge server: that of crowdbot, or
rosbridge_suite of a real robot. While an image is searched, newer ones replace each other, so the answer is never older
than two searches.
"""

from __future__ import annotations

import argparse
import base64
import statistics
import threading
import time

import numpy as np
import roslibpy
from detectors import add_options, detectors_of

KIND = "vision_msgs/Detection2DArray"
ORDERS = {"rgb8": (0, 1, 2), "bgr8": (2, 1, 0)}
"""Positions of red, green and blue in a pixel, by encoding."""


def image_of(message):
    """Return the pixels ``[H, W, 3]`` of a ``sensor_msgs/Image`` as JSON.

    Raises:
        ValueError: the encoding is neither rgb8 nor bgr8.
    """
    if message["encoding"] not in ORDERS:
        raise ValueError(f"encoding {message['encoding']!r} must be one of {', '.join(ORDERS)}")
    height, width = message["height"], message["width"]
    rows = np.frombuffer(base64.b64decode(message["data"]), dtype=np.uint8).reshape(height, message["step"])
    pixels = rows[:, : 3 * width].reshape(height, width, 3)
    return np.ascontiguousarray(pixels[..., ORDERS[message["encoding"]]])


def message_of(header, detections):
    """Return detections as a ``vision_msgs/Detection2DArray`` of version 4 (ROS 2 Humble and later), with the header
    of the image."""
    pose = {"pose": {"position": dict.fromkeys("xyz", 0.0), "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}}
    pose["covariance"] = [0.0] * 36
    rows = []
    for (left, top, right, bottom), score in zip(detections.boxes.tolist(), detections.scores.tolist(), strict=True):
        center = {"position": {"x": 0.5 * (left + right), "y": 0.5 * (top + bottom)}, "theta": 0.0}
        box = {"center": center, "size_x": right - left, "size_y": bottom - top}
        result = {"hypothesis": {"class_id": "person", "score": score}, "pose": pose}
        rows.append({"header": header, "results": [result], "bbox": box, "id": ""})
    return {"header": header, "detections": rows}


class DetectorNode:
    """Searches the newest image and publishes what it finds, with the header of the image.

    Args:
        ros: connection.
        camera: topic of the camera without ``/image``, such as ``/robot/camera``.
        detector: has ``detect(rgb)``.
    """

    def __init__(self, ros, camera, detector):
        self.detector, self.newest, self.fresh = detector, None, threading.Condition()
        self.times, self.people, self.closed = [], 0, False
        self.out = roslibpy.Topic(ros, f"{camera}/detections", KIND, queue_size=1)
        self.out.advertise()
        ros.on("close", lambda *_: self.close())
        image = roslibpy.Topic(ros, f"{camera}/image", "sensor_msgs/Image", queue_length=1)
        image.subscribe(self.take_image)

    def take_image(self, message):
        """Keep an image until it is searched or replaced."""
        with self.fresh:
            self.newest = message
            self.fresh.notify()

    def close(self):
        """End :meth:`work`."""
        with self.fresh:
            self.closed = True
            self.fresh.notify()

    def work(self):
        """Answer images until the connection is closed."""
        while True:
            with self.fresh:
                self.fresh.wait_for(lambda: self.closed or self.newest is not None)
                if self.closed:
                    return
                message, self.newest = self.newest, None
            begin = time.perf_counter()
            found = self.detector.detect(image_of(message))
            self.times.append(time.perf_counter() - begin)
            self.people += len(found.scores)
            self.out.publish(roslibpy.Message(message_of(message["header"], found)))


def main():
    """Detect people until the simulation ends."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=9090)
    parser.add_argument("--camera", default="/robot/camera", help="topic of the camera, without /image")
    add_options(parser)
    options = parser.parse_args()
    ros = roslibpy.Ros(options.host, options.port)
    ros.run(timeout=60)
    node = DetectorNode(ros, options.camera, next(iter(detectors_of(options).values())))
    node.work()
    median = 1000.0 * statistics.median(node.times) if node.times else 0.0
    print(f"{len(node.times)} images, {node.people} people, median {median:.0f} ms an image")
    ros.terminate()


if __name__ == "__main__":
    main()

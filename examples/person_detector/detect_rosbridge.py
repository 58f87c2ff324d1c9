"""A person detector over rosbridge, as a process of its own: images in, vision_msgs/Detection2DArray out.

    crowdbot run hall.xml --bridge rosbridge --out detected
    python examples/person_detector/detect_rosbridge.py

It needs roslibpy and OpenCV (pip install roslibpy 'crowdbot[perception]') and any rosbridge server: that of crowdbot, or
rosbridge_suite of a real robot. While an image is searched, newer ones replace each other, so the answer is never older
than two searches.
"""

from __future__ import annotations

import argparse
import base64

import roslibpy
from detectors import add_options, detectors_of
from image_search import ImageSearch, pixels_of

KIND = "vision_msgs/Detection2DArray"


def image_of(message):
    """Return the pixels ``[H, W, 3]`` of a ``sensor_msgs/Image`` as JSON.

    Raises:
        ValueError: the encoding is neither rgb8 nor bgr8.
    """
    data = base64.b64decode(message["data"])
    return pixels_of(message["encoding"], message["height"], message["width"], message["step"], data)


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


def connect_search(ros, camera, detector):
    """Return a search of the images of a camera that publishes what it finds, with the header of the image.

    Args:
        ros: connection.
        camera: topic of the camera without ``/image``, such as ``/robot/camera``.
        detector: has ``detect(rgb)``.
    """
    out = roslibpy.Topic(ros, f"{camera}/detections", KIND, queue_size=1)
    out.advertise()

    def answer(message, found):
        out.publish(roslibpy.Message(message_of(message["header"], found)))

    search = ImageSearch(detector, image_of, answer)
    ros.on("close", lambda *_: search.close())
    roslibpy.Topic(ros, f"{camera}/image", "sensor_msgs/Image", queue_length=1).subscribe(search.take_image)
    return search


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
    search = connect_search(ros, options.camera, next(iter(detectors_of(options).values())))
    search.work()
    print(search.summary())
    ros.terminate()


if __name__ == "__main__":
    main()

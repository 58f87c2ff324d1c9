"""Message types on the topics of a sensor, known before its first reading."""

from __future__ import annotations

import re

from crowdbot.sensors import (
    BumperReading,
    DepthImage,
    ImuReading,
    Odometry,
    PointCloud,
    PulsedScan,
    RangeReading,
    Reading,
    RgbImage,
    Scan,
    Sensor,
    TrackedPeople,
)

from .reading_codecs import CODECS, KIND, REST

IMAGES = {
    "/image": "sensor_msgs/msg/Image",
    "/labels": "sensor_msgs/msg/Image",
    "/camera_info": "sensor_msgs/msg/CameraInfo",
}
KINDS: dict[type[Reading], dict[str, str]] = {
    Scan: {"": "sensor_msgs/msg/LaserScan"},
    PointCloud: {"": "sensor_msgs/msg/PointCloud2"},
    RangeReading: {"": "sensor_msgs/msg/Range"},
    DepthImage: IMAGES,
    ImuReading: {"": "sensor_msgs/msg/Imu"},
    Odometry: {"": "nav_msgs/msg/Odometry"},
    RgbImage: IMAGES,
    BumperReading: {"": "sensor_msgs/msg/PointCloud2"},
    PulsedScan: {"": "sensor_msgs/msg/LaserScan"},
    TrackedPeople: {"": "people_msgs/msg/People"},
}
"""Message types by suffix of the topic, for each class of readings in the table of codecs."""


def reading_topics(sensor: Sensor) -> dict[str, str]:
    """Return the message types of a sensor by suffix of its topic; empty if ``measure`` names no known reading.

    >>> from crowdbot.sensors import Lidar2D
    >>> reading_topics(Lidar2D())
    {'': 'sensor_msgs/msg/LaserScan', '/reading': 'crowdbot_msgs/msg/Reading'}
    """
    names = {cls.__name__: cls for cls in CODECS}
    for kind in type(sensor).__mro__:
        told = vars(kind).get("measure")
        words = re.findall(r"\w+", str(getattr(told, "__annotations__", {}).get("return", "")))
        for word in words:
            if word in names:
                return {**KINDS[names[word]], REST: KIND}
    return {}

"""Readings of a virtual Pepper as values of ``ALMemory``, under the keys of the real sensors.

The keys are those of the NAOqi documentation 2.5. The horizontal lasers have 15 points each, x forward and y left in
the frame of the device [m], from the leftmost (``Seg01``) to the rightmost.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from crowdbot.messages import points_in

PLATFORM = "Device/SubDeviceList/Platform"
SEGMENTS = 15
BUMPERS = ("FrontLeft", "Back", "FrontRight")
"""Bumpers counter-clockwise from straight ahead, as the sectors of the virtual bumper."""


def _laser(side: str, message: Any) -> dict[str, float]:
    """Return the points of a laser; where it sees nothing, they are at its largest range."""
    angles = message.angle_min + message.angle_increment * np.arange(len(message.ranges))
    ranges = np.clip(np.nan_to_num(message.ranges, nan=message.range_max), 0.0, message.range_max)
    wanted = np.linspace(angles[-1], angles[0], SEGMENTS)
    distance = np.interp(wanted, angles, ranges)
    found = {}
    for k, (x, y) in enumerate(zip(distance * np.cos(wanted), distance * np.sin(wanted), strict=True), 1):
        for axis, value in (("X", x), ("Y", y)):
            found[f"{PLATFORM}/LaserSensor/{side}/Horizontal/Seg{k:02}/{axis}/Sensor/Value"] = float(value)
    return found


def _sonar(side: str, message: Any) -> dict[str, float]:
    """Return the distance of an ultrasound [m]; where it hears nothing, its largest range."""
    distance = min(max(float(message.range), 0.0), float(message.max_range))
    return {f"{PLATFORM}/{side}/Sonar/Sensor/Value": distance}


def _bumper(message: Any) -> dict[str, float]:
    """Return the switches of the bumper: 1 pressed, 0 not."""
    pressed = {int(one) for one in points_in(message)["sector"].ravel()}
    return {f"{PLATFORM}/{name}/Bumper/Sensor/Value": float(k in pressed) for k, name in enumerate(BUMPERS)}


SENSORS: dict[str, tuple[str, Callable[[Any], dict[str, float]]]] = {
    "base_laser_front": ("sensor_msgs/msg/LaserScan", lambda message: _laser("Front", message)),
    "base_laser_left": ("sensor_msgs/msg/LaserScan", lambda message: _laser("Left", message)),
    "base_laser_right": ("sensor_msgs/msg/LaserScan", lambda message: _laser("Right", message)),
    "sonar_front": ("sensor_msgs/msg/Range", lambda message: _sonar("Front", message)),
    "sonar_back": ("sensor_msgs/msg/Range", lambda message: _sonar("Back", message)),
    "bumper": ("sensor_msgs/msg/PointCloud2", _bumper),
}
"""Sensors of a virtual Pepper that the memory knows, with their message type."""


def memory_values(sensor: str, message: Any) -> dict[str, float]:
    """Return the values of a reading by their key.

    Args:
        sensor: name of the sensor, one of :data:`SENSORS`.
        message: its message.

    >>> from crowdbot.messages import Messages
    >>> make = Messages()
    >>> header = make.header(0)
    >>> echo = make.make("sensor_msgs/msg/Range", header=header, radiation_type=0, field_of_view=0.5, min_range=0.2,
    ...                  max_range=5.0, range=float("inf"))
    >>> memory_values("sonar_front", echo)
    {'Device/SubDeviceList/Platform/Front/Sonar/Sensor/Value': 5.0}
    """
    return SENSORS[sensor][1](message)

"""Readings of range sensors as arrays of a state frame."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Pose
from crowdbot.sensors import Ultrasound
from crowdbot.typing import Floats

NOTHING = 65_535
"""Range of a beam without a return."""
LARGEST = 65.5
"""Largest range [m] in millimetres of 16 bits."""
MOST_POINTS = 8_000
"""Largest number of points of a scan in space; more are thinned out."""


def scan_array(number: int, reading: Any, sensor: Any) -> dict[str, NDArray[Any]]:
    """Return ``scanK`` ``[R]`` in millimetres, 65535 without a return, and ``poseK`` ``[7]`` of a planar scan."""
    return {f"scan{number}": _millimetres(reading.ranges[0]), f"pose{number}": _pose(reading.pose, sensor)}


def cloud_array(number: int, reading: Any) -> dict[str, NDArray[Any]]:
    """Return ``cloudK`` ``[N, 3]`` [m]: the points of a scan in space, in the world."""
    points = reading.points(in_world=True)[0].reshape(-1, 3)
    points = points[np.isfinite(points[:, 0])]
    return {f"cloud{number}": points[:: max(1, -(-len(points) // MOST_POINTS))].astype(np.float32)}


def range_array(reading: Any, sensor: Any) -> tuple[float, ...]:
    """Return the row of a cone: pose of the sensor (7), length [m], and 1 with an echo or 0 without."""
    distance = float(reading.ranges[0])
    echo = bool(np.isfinite(distance))
    kind = sensor.mount.sensor
    reach = distance if echo else (kind.range_min if distance < 0.0 else kind.range_max)
    return (*_pose(reading.pose, sensor).tolist(), reach, float(echo))


def cone_angle(sensor: Any) -> float:
    """Return half the opening angle of a sonar or infrared sensor [rad]."""
    return float(sensor.half_angle if isinstance(sensor, Ultrasound) else sensor.dispersion)


def _millimetres(ranges: Floats) -> NDArray[np.uint16]:
    seen = np.isfinite(ranges) & (ranges <= LARGEST)
    return np.where(seen, np.round(1000.0 * np.where(seen, ranges, 0.0)), NOTHING).astype(np.uint16)


def _pose(pose: Any, sensor: Any) -> NDArray[np.float32]:
    """Return position [m] and quaternion ``[7]``; a planar pose is at the height of its mount."""
    if isinstance(pose, Pose):
        (x, y), half = pose.position[0].tolist(), 0.5 * float(pose.heading[0])
        return np.array([x, y, sensor.placed[2], math.cos(half), 0.0, 0.0, math.sin(half)], dtype=np.float32)
    return np.concatenate([pose.position[0], pose.rotation[0]]).astype(np.float32)

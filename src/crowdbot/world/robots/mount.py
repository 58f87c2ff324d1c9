"""Mounting positions of sensors on a robot."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from crowdbot.core import InputError
from crowdbot.sensors import Sensor
from crowdbot.typing import Floats
from crowdbot.world.urdf.transforms import frame, roll_pitch_yaw


class MountPlacement(NamedTuple):
    """Mounting pose of a sensor in two frames.

    Fields:
        link: name of the link; empty for the root.
        origin: ``[4, 4]`` frame of the sensor in the frame of the link.
        placed: x, y, z [m], roll, pitch, yaw [rad] in the frame of the robot in its posture.
    """

    link: str
    origin: Floats
    placed: tuple[float, float, float, float, float, float]


@dataclass(frozen=True)
class SensorMount:
    """A sensor with its pose in the frame of a link: x, y, z [m]; roll, pitch, yaw [rad] as in URDF."""

    name: str
    sensor: Sensor
    link: str
    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    roll: float = 0.0
    pitch: float = 0.0
    yaw: float = 0.0

    def __post_init__(self) -> None:
        for name in ("x", "y", "z", "roll", "pitch", "yaw"):
            if not math.isfinite(getattr(self, name)):
                raise InputError(f"SensorMount: {name} = {getattr(self, name)} must be finite")

    @property
    def origin(self) -> Floats:
        """Frame ``[4, 4]`` of the sensor in the frame of the link."""
        return frame((self.x, self.y, self.z), roll_pitch_yaw(self.roll, self.pitch, self.yaw))

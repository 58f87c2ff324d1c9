"""Where a sensor is mounted on a robot."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.sensors import Sensor
from crowdbot.world.urdf.transforms import frame, roll_pitch_yaw

__all__ = ["SensorMount"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class SensorMount:
    """A sensor and where it sits in the frame of a link: x, y, z [m]; roll, pitch, yaw [rad] as in URDF."""

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
        """Its frame ``[4, 4]`` in the link's frame."""
        return frame((self.x, self.y, self.z), roll_pitch_yaw(self.roll, self.pitch, self.yaw))

"""Sensors: what a robot can measure of a scene. Contract :class:`Sensor`; noise is a value attached to it."""

from .lidar import Lidar2D, Scan
from .noise import Gaussian, Noise, Offset, Peak, disturbed
from .sensor import Reading, Sensor

__all__ = ["Gaussian", "Lidar2D", "Noise", "Offset", "Peak", "Reading", "Scan", "Sensor", "disturbed"]

"""Sensors: what a robot can measure of a scene. Contract :class:`Sensor`; noise is a value attached to it."""

from .bumper import Bumper, Touch
from .camera import ImageSource, Lens
from .depth import DepthCamera, DepthImage
from .echo import Echo
from .imu import IMU, Inertial
from .infrared import Infrared
from .lidar import Lidar2D, Scan
from .lidar3d import Cloud, Lidar3D
from .noise import Dropout, Gaussian, Noise, Offset, Peak, Quantised, disturbed
from .odometry import Odometry, WheelOdometry
from .people import GroundTruthPeople, Tracked
from .picture import Picture, RGBCamera
from .presets import PRESETS, Preset, preset
from .sensor import Reading, Sensor
from .timing import Schedule, Waiting
from .ultrasound import Ultrasound

__all__ = [
    "IMU",
    "PRESETS",
    "Bumper",
    "Cloud",
    "DepthCamera",
    "DepthImage",
    "Dropout",
    "Echo",
    "Gaussian",
    "GroundTruthPeople",
    "ImageSource",
    "Inertial",
    "Infrared",
    "Lens",
    "Lidar2D",
    "Lidar3D",
    "Noise",
    "Odometry",
    "Offset",
    "Peak",
    "Picture",
    "Preset",
    "Quantised",
    "RGBCamera",
    "Reading",
    "Scan",
    "Schedule",
    "Sensor",
    "Touch",
    "Tracked",
    "Ultrasound",
    "Waiting",
    "WheelOdometry",
    "disturbed",
    "preset",
]

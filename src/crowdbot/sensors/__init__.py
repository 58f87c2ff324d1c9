"""Sensors: what a robot can measure of a scene. Contract :class:`Sensor`; noise is a value attached to it."""

from .bumper import Bumper, Touch
from .camera import ImageSource, Lens, distorted
from .depth import DepthCamera, DepthImage
from .echo import Echo
from .imu import IMU, ImuState, Inertial
from .infrared import Infrared
from .lidar import Lidar2D, Scan
from .lidar3d import Cloud, Lidar3D
from .noise import Dropout, Gaussian, Noise, Offset, Peak, Quantised, disturbed
from .odometry import Odometry, OdometryState, WheelOdometry
from .people import GroundTruthPeople, Tracked
from .picture import Picture, RGBCamera
from .presets import PRESETS, Preset, preset
from .sensor import Reading, Sensor, planar_pose, spatial_pose
from .shapes import FLOOR, NOTHING, PROP, WALLS
from .timing import Schedule
from .ultrasound import Ultrasound
from .view import SensorView

__all__ = [
    "FLOOR",
    "IMU",
    "NOTHING",
    "PRESETS",
    "PROP",
    "WALLS",
    "Bumper",
    "Cloud",
    "DepthCamera",
    "DepthImage",
    "Dropout",
    "Echo",
    "Gaussian",
    "GroundTruthPeople",
    "ImageSource",
    "ImuState",
    "Inertial",
    "Infrared",
    "Lens",
    "Lidar2D",
    "Lidar3D",
    "Noise",
    "Odometry",
    "OdometryState",
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
    "SensorView",
    "Touch",
    "Tracked",
    "Ultrasound",
    "WheelOdometry",
    "distorted",
    "disturbed",
    "planar_pose",
    "preset",
    "spatial_pose",
]

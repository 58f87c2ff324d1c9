"""Sensors: what a robot can measure of a scene. Contract :class:`Sensor`; noise is a value attached to it."""

from .bumper import Bumper, Touch
from .depth_camera import DepthCamera, DepthImage
from .ground_truth_people import GroundTruthPeople, Tracked
from .imu import IMU, ImuState, Inertial
from .infrared import Infrared
from .lens import ImageSource, Lens, distorted
from .lidar import Lidar2D, Scan
from .lidar3d import Cloud, Lidar3D
from .noise import Dropout, Gaussian, Noise, Offset, Peak, Quantised, disturbed
from .odometry import Odometry, OdometryState, WheelOdometry
from .presets import PRESETS, Preset, preset
from .range_reading import Echo
from .ray_shapes import FLOOR, NOTHING, PROP, WALLS
from .rgb_camera import Picture, RGBCamera
from .schedule import Schedule
from .sensor import Reading, Sensor, planar_pose, spatial_pose
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

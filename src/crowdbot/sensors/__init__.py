"""Sensors of robots. Contract: :class:`Sensor`; input: :class:`SensorView`; output: a :class:`Reading`."""

from .beams import unit_vectors
from .bumper import Bumper, BumperReading
from .contract import check_sensor
from .depth_camera import DepthCamera, DepthImage
from .ground_truth_people import GroundTruthPeople, TrackedPeople
from .imu import IMU, ImuReading, ImuState
from .lens import ImageSource, Lens, distort_image
from .lidar import Lidar2D, Scan, cast_plane, main_scan, main_scanner
from .lidar3d import Lidar3D, PointCloud
from .noise import Dropout, Gaussian, Noise, Offset, Peak, Quantised, apply_noise
from .presets import PRESETS, SensorPreset, preset
from .range_finders import Infrared, RangeReading, Ultrasound
from .ray_shapes import FLOOR, NOTHING, PROP, WALLS
from .realism import ExposedCamera, PulsedLidar2D, PulsedScan
from .rgb_camera import RENDERERS, SAMPLE_COUNTS, RGBCamera, RgbImage, check_renderer
from .sensor import Reading, Sensor, SensorSchedule, join_readings, planar_pose, spatial_pose
from .skin_scans import triangles_one_by_one
from .state_rows import StateGroups, measure_rows, put_state_rows, take_state_rows
from .view import SensorView, WheelGeometry, WheelRotation
from .wheel_odometry import Odometry, OdometryState, WheelOdometry, along_arc, arc_between

__all__ = [
    "FLOOR",
    "IMU",
    "NOTHING",
    "PRESETS",
    "PROP",
    "RENDERERS",
    "SAMPLE_COUNTS",
    "WALLS",
    "Bumper",
    "BumperReading",
    "DepthCamera",
    "DepthImage",
    "Dropout",
    "ExposedCamera",
    "Gaussian",
    "GroundTruthPeople",
    "ImageSource",
    "ImuReading",
    "ImuState",
    "Infrared",
    "Lens",
    "Lidar2D",
    "Lidar3D",
    "Noise",
    "Odometry",
    "OdometryState",
    "Offset",
    "Peak",
    "PointCloud",
    "PulsedLidar2D",
    "PulsedScan",
    "Quantised",
    "RGBCamera",
    "RangeReading",
    "Reading",
    "RgbImage",
    "Scan",
    "Sensor",
    "SensorPreset",
    "SensorSchedule",
    "SensorView",
    "StateGroups",
    "TrackedPeople",
    "Ultrasound",
    "WheelGeometry",
    "WheelOdometry",
    "WheelRotation",
    "along_arc",
    "apply_noise",
    "arc_between",
    "cast_plane",
    "check_renderer",
    "check_sensor",
    "distort_image",
    "join_readings",
    "main_scan",
    "main_scanner",
    "measure_rows",
    "planar_pose",
    "preset",
    "put_state_rows",
    "spatial_pose",
    "take_state_rows",
    "triangles_one_by_one",
    "unit_vectors",
]

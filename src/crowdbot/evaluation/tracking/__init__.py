"""Evaluation of perception: detectors and trackers on logged readings, against the true people."""

from .camera_files import CameraCalibration, RobotOdometry, TruePaths, read_camera, read_odometry, read_true_paths
from .downstream import DOWNSTREAM_INPUTS, DOWNSTREAM_SCORES, estimate_downstream
from .reading_log import LoggedReading, ReadingLog, log_readings, read_readings
from .scan_statistics import BAND_LIMITS, ReturnsOfPeople, scan_statistics
from .strata import STRATA, estimate_strata
from .track_plot import plot_tracks
from .tracking_run import TrackingRun, estimate_scores, track_people
from .video_plot import plot_video_run
from .video_run import VideoForecast, VideoRun, track_video

__all__ = [
    "BAND_LIMITS",
    "DOWNSTREAM_INPUTS",
    "DOWNSTREAM_SCORES",
    "STRATA",
    "CameraCalibration",
    "LoggedReading",
    "ReadingLog",
    "ReturnsOfPeople",
    "RobotOdometry",
    "TrackingRun",
    "TruePaths",
    "VideoForecast",
    "VideoRun",
    "estimate_downstream",
    "estimate_scores",
    "estimate_strata",
    "log_readings",
    "plot_tracks",
    "plot_video_run",
    "read_camera",
    "read_odometry",
    "read_readings",
    "read_true_paths",
    "scan_statistics",
    "track_people",
    "track_video",
]

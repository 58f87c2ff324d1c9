"""Evaluation of perception: detectors and trackers on logged readings, against the true people."""

from .reading_log import LoggedReading, ReadingLog, log_readings, read_readings
from .track_plot import plot_tracks
from .tracking_run import TrackingRun, estimate_scores, track_people

__all__ = [
    "LoggedReading",
    "ReadingLog",
    "TrackingRun",
    "estimate_scores",
    "log_readings",
    "plot_tracks",
    "read_readings",
    "track_people",
]

"""Recorded scans with annotated people or odometry, and scores of detectors and trackers on them."""

from .annotated_scan import AnnotatedScan
from .detection_scores import DetectionScores, score_detections, score_positions
from .drow_files import read_drow
from .frog_files import read_frog
from .lcas_files import read_lcas
from .ogm_files import OGM_PERIOD, find_ogm_split, read_ogm

__all__ = [
    "OGM_PERIOD",
    "AnnotatedScan",
    "DetectionScores",
    "find_ogm_split",
    "read_drow",
    "read_frog",
    "read_lcas",
    "read_ogm",
    "score_detections",
    "score_positions",
]

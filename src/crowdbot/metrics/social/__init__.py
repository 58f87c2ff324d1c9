"""Metrics of a robot among people from a log alone, one file for each family; see :func:`log_metrics`."""

from __future__ import annotations

from .body_region import BodyRegion
from .coordination import Coordination, coordination
from .crowd_effect import crowd_effect, empty_scene_ratios
from .gate_flow import gate_metrics
from .gaze_dwell import GAZE_HALF_ANGLE, HEAD_HALF_ANGLE, GazeDwell, gaze_dwell
from .group_intrusion import detect_groups
from .log_metric import LogMetric, check_log_metric
from .log_metrics import LOG_FAMILIES, log_metrics
from .metric import Metric, metric_families, metric_page, metric_table
from .multiple_tests import correct_p_values
from .robot_log import RobotLog
from .severity import head_injury_criterion, impact_region_metrics

__all__ = [
    "GAZE_HALF_ANGLE",
    "HEAD_HALF_ANGLE",
    "LOG_FAMILIES",
    "BodyRegion",
    "Coordination",
    "GazeDwell",
    "LogMetric",
    "Metric",
    "RobotLog",
    "check_log_metric",
    "coordination",
    "correct_p_values",
    "crowd_effect",
    "detect_groups",
    "empty_scene_ratios",
    "gate_metrics",
    "gaze_dwell",
    "head_injury_criterion",
    "impact_region_metrics",
    "log_metrics",
    "metric_families",
    "metric_page",
    "metric_table",
]

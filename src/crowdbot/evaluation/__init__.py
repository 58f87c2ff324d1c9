"""Evaluation of navigators: many trials, robots and seeds, with intervals, comparisons and requirements."""

from .comparison import PairedComparison, paired_comparison
from .decision_metrics import DECISION_METRICS
from .episode_metrics import PAIRED_FAMILIES, episode_log, episode_metrics, families_of
from .factor_sweep import FactorSweep, parse_factors, sweep_trials
from .intervals import Estimate, bootstrap_interval, exact_interval, wilson_interval
from .job import RunRow, row_of, row_values
from .junit import junit_xml
from .method import Method, own_method, parse_methods, with_safety
from .pareto import pareto_front
from .person_contacts import PersonContact, person_contacts
from .plan import EvaluationCell, EvaluationPlan, parse_seeds
from .reality import RealPlacement, place_reality, reality_svg
from .recorded_scans import (
    OGM_PERIOD,
    AnnotatedScan,
    DetectionScores,
    find_ogm_split,
    read_drow,
    read_frog,
    read_lcas,
    read_ogm,
    score_detections,
    score_positions,
)
from .report import write_report
from .requirement import Requirement, RequirementVerdict, parse_requirement
from .result import CellResult, EvaluationResult, load_evaluation, result_schema
from .robot_recording import RobotRecording, load_robot_recording
from .runner import evaluate
from .scan_prediction import SCAN_SCORES, SOGMP, ScanProtocol, ScanScores, TruePeople, plot_scan_scores, score_scans
from .statistic import Statistic, metric_unit, parse_statistic
from .sweep_effects import FactorEffect, factor_effects
from .tracking import (
    BAND_LIMITS,
    DOWNSTREAM_INPUTS,
    DOWNSTREAM_SCORES,
    STRATA,
    CameraCalibration,
    LoggedReading,
    ReadingLog,
    ReturnsOfPeople,
    RobotOdometry,
    TrackingRun,
    TruePaths,
    VideoForecast,
    VideoRun,
    estimate_downstream,
    estimate_scores,
    estimate_strata,
    log_readings,
    plot_tracks,
    plot_video_run,
    read_camera,
    read_odometry,
    read_readings,
    read_true_paths,
    scan_statistics,
    track_people,
    track_video,
)
from .trial_of_recording import recorded_trial
from .verdict import Verdict, judge_cell, runs_without_event
from .worst_run import WorstRun, worst_runs

__all__ = [
    "BAND_LIMITS",
    "DECISION_METRICS",
    "DOWNSTREAM_INPUTS",
    "DOWNSTREAM_SCORES",
    "OGM_PERIOD",
    "PAIRED_FAMILIES",
    "SCAN_SCORES",
    "SOGMP",
    "STRATA",
    "AnnotatedScan",
    "CameraCalibration",
    "CellResult",
    "DetectionScores",
    "Estimate",
    "EvaluationCell",
    "EvaluationPlan",
    "EvaluationResult",
    "FactorEffect",
    "FactorSweep",
    "LoggedReading",
    "Method",
    "PairedComparison",
    "PersonContact",
    "ReadingLog",
    "RealPlacement",
    "Requirement",
    "RequirementVerdict",
    "ReturnsOfPeople",
    "RobotOdometry",
    "RobotRecording",
    "RunRow",
    "ScanProtocol",
    "ScanScores",
    "Statistic",
    "TrackingRun",
    "TruePaths",
    "TruePeople",
    "Verdict",
    "VideoForecast",
    "VideoRun",
    "WorstRun",
    "bootstrap_interval",
    "episode_log",
    "episode_metrics",
    "estimate_downstream",
    "estimate_scores",
    "estimate_strata",
    "evaluate",
    "exact_interval",
    "factor_effects",
    "families_of",
    "find_ogm_split",
    "judge_cell",
    "junit_xml",
    "load_evaluation",
    "load_robot_recording",
    "log_readings",
    "metric_unit",
    "own_method",
    "paired_comparison",
    "pareto_front",
    "parse_factors",
    "parse_methods",
    "parse_requirement",
    "parse_seeds",
    "parse_statistic",
    "person_contacts",
    "place_reality",
    "plot_scan_scores",
    "plot_tracks",
    "plot_video_run",
    "read_camera",
    "read_drow",
    "read_frog",
    "read_lcas",
    "read_odometry",
    "read_ogm",
    "read_readings",
    "read_true_paths",
    "reality_svg",
    "recorded_trial",
    "result_schema",
    "row_of",
    "row_values",
    "runs_without_event",
    "scan_statistics",
    "score_detections",
    "score_positions",
    "score_scans",
    "sweep_trials",
    "track_people",
    "track_video",
    "wilson_interval",
    "with_safety",
    "worst_runs",
    "write_report",
]

"""Evaluation of navigators: many trials, robots and seeds, with intervals, comparisons and requirements."""

from .comparison import PairedComparison, paired_comparison
from .decision_metrics import DECISION_METRICS
from .episode_metrics import PAIRED_FAMILIES, episode_log, episode_metrics, families_of
from .factor_sweep import FactorSweep, parse_factors, sweep_trials
from .intervals import Estimate, bootstrap_interval, wilson_interval
from .job import RunRow, row_of, row_values
from .junit import junit_xml
from .method import Method, own_method, parse_methods, with_safety
from .pareto import pareto_front
from .plan import EvaluationCell, EvaluationPlan, parse_seeds
from .reality import RealPlacement, place_reality, reality_svg
from .report import write_report
from .requirement import Requirement, RequirementVerdict, parse_requirement
from .result import CellResult, EvaluationResult, load_evaluation, result_schema
from .robot_recording import RobotRecording, load_robot_recording
from .runner import evaluate
from .statistic import Statistic, parse_statistic
from .sweep_effects import FactorEffect, factor_effects
from .tracking import (
    LoggedReading,
    ReadingLog,
    TrackingRun,
    estimate_scores,
    log_readings,
    plot_tracks,
    read_readings,
    track_people,
)
from .trial_of_recording import recorded_trial
from .worst_run import WorstRun, worst_runs

__all__ = [
    "DECISION_METRICS",
    "PAIRED_FAMILIES",
    "CellResult",
    "Estimate",
    "EvaluationCell",
    "EvaluationPlan",
    "EvaluationResult",
    "FactorEffect",
    "FactorSweep",
    "LoggedReading",
    "Method",
    "PairedComparison",
    "ReadingLog",
    "RealPlacement",
    "Requirement",
    "RequirementVerdict",
    "RobotRecording",
    "RunRow",
    "Statistic",
    "TrackingRun",
    "WorstRun",
    "bootstrap_interval",
    "episode_log",
    "episode_metrics",
    "estimate_scores",
    "evaluate",
    "factor_effects",
    "families_of",
    "junit_xml",
    "load_evaluation",
    "load_robot_recording",
    "log_readings",
    "own_method",
    "paired_comparison",
    "pareto_front",
    "parse_factors",
    "parse_methods",
    "parse_requirement",
    "parse_seeds",
    "parse_statistic",
    "place_reality",
    "plot_tracks",
    "read_readings",
    "reality_svg",
    "recorded_trial",
    "result_schema",
    "row_of",
    "row_values",
    "sweep_trials",
    "track_people",
    "wilson_interval",
    "with_safety",
    "worst_runs",
    "write_report",
]

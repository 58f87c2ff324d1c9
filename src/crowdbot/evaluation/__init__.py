"""Evaluation of navigators: many trials, robots and seeds, with intervals, comparisons and requirements."""

from .comparison import PairedComparison, correct_p_values, paired_comparison
from .intervals import Estimate, bootstrap_interval, wilson_interval
from .job import RunRow
from .junit import junit_xml
from .method import Method, own_method, parse_methods, with_safety
from .pareto import pareto_front
from .plan import EvaluationCell, EvaluationPlan, parse_seeds
from .report import write_report
from .requirement import Requirement, RequirementVerdict, parse_requirement
from .result import CellResult, EvaluationResult, load_evaluation
from .runner import evaluate
from .statistic import Statistic, parse_statistic
from .worst_run import WorstRun, worst_runs

__all__ = [
    "CellResult",
    "Estimate",
    "EvaluationCell",
    "EvaluationPlan",
    "EvaluationResult",
    "Method",
    "PairedComparison",
    "Requirement",
    "RequirementVerdict",
    "RunRow",
    "Statistic",
    "WorstRun",
    "bootstrap_interval",
    "correct_p_values",
    "evaluate",
    "junit_xml",
    "load_evaluation",
    "own_method",
    "paired_comparison",
    "pareto_front",
    "parse_methods",
    "parse_requirement",
    "parse_seeds",
    "parse_statistic",
    "wilson_interval",
    "with_safety",
    "worst_runs",
    "write_report",
]

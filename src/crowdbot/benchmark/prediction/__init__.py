"""Evaluation of predictors on recordings, clean and degraded, and its plots."""

from .degraded import DegradedScore, DegradedTask, sweep_degradations
from .degraded_plot import plot_degraded
from .evaluation import Evaluation, EvaluationJob, FrameResults, JobResult, PredictorResult
from .plots import animate_window, plot_errors, plot_frames
from .predictor_score import evaluate

__all__ = [
    "DegradedScore",
    "DegradedTask",
    "Evaluation",
    "EvaluationJob",
    "FrameResults",
    "JobResult",
    "PredictorResult",
    "animate_window",
    "evaluate",
    "plot_degraded",
    "plot_errors",
    "plot_frames",
    "sweep_degradations",
]

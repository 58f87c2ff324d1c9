"""Evaluation of predictors on recordings, clean and degraded, and its plots."""

from .degraded import DegradedScore, DegradedTask, sweep_degradations
from .degraded_plot import plot_degradation
from .evaluation import Evaluation, EvaluationJob, JobResult, PredictorResult
from .plots import animate_window, plot_errors, plot_frames
from .predictor_score import evaluate
from .window_results import FrameResults, WindowResults, predict_windows

__all__ = [
    "DegradedScore",
    "DegradedTask",
    "Evaluation",
    "EvaluationJob",
    "FrameResults",
    "JobResult",
    "PredictorResult",
    "WindowResults",
    "animate_window",
    "evaluate",
    "plot_degradation",
    "plot_errors",
    "plot_frames",
    "predict_windows",
    "sweep_degradations",
]

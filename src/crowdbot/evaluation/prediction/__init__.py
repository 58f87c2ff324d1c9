"""Evaluation of predictors on recordings, clean and degraded, and its plots."""

from .degraded import DegradedScore, DegradedTask, sweep_degradations
from .degraded_plot import plot_degradation
from .demo import Demo, run_demo
from .demo_report import PredictionResult, write_demo_report
from .evaluation import PredictorEvaluation, PredictorJob, PredictorJobResult, PredictorResult
from .plots import animate_window, plot_errors, plot_frames
from .predictor_score import score_predictor
from .window_results import FrameResults, WindowResults, predict_windows

__all__ = [
    "DegradedScore",
    "DegradedTask",
    "Demo",
    "FrameResults",
    "PredictionResult",
    "PredictorEvaluation",
    "PredictorJob",
    "PredictorJobResult",
    "PredictorResult",
    "WindowResults",
    "animate_window",
    "plot_degradation",
    "plot_errors",
    "plot_frames",
    "predict_windows",
    "run_demo",
    "score_predictor",
    "sweep_degradations",
    "write_demo_report",
]

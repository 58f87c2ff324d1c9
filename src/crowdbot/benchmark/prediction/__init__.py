"""Evaluation of predictors on recordings, clean and degraded, and its plots."""

from .degraded import DegradedScore, Task, sweep
from .degraded_plot import draw_degraded
from .evaluation import Frames, Part, Piece, Result, Study
from .plots import animate, plot_errors, plot_frames
from .predictor_score import evaluate

__all__ = [
    "DegradedScore",
    "Frames",
    "Part",
    "Piece",
    "Result",
    "Study",
    "Task",
    "animate",
    "draw_degraded",
    "evaluate",
    "plot_errors",
    "plot_frames",
    "sweep",
]

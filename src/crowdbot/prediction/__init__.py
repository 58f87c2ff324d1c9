"""Floor 4: where people will be in the next seconds; predictors, and their scores on recordings."""

from .constant import ConstantAcceleration, ConstantVelocity, SampledConstantVelocity
from .degraded import DegradedScore, Seen, Task, seen_windows, sweep
from .evaluate import evaluate
from .kalman import Kalman
from .predictor import Predictor, window_streams
from .simulated import Simulated

__all__ = [
    "ConstantAcceleration",
    "ConstantVelocity",
    "DegradedScore",
    "Kalman",
    "Predictor",
    "SampledConstantVelocity",
    "Seen",
    "Simulated",
    "Task",
    "evaluate",
    "seen_windows",
    "sweep",
    "window_streams",
]

"""Floor 4: where people will be in the next seconds; predictors, and their scores on recordings."""

from .anchor_net import AnchorNet, Modes
from .anchors import Anchors
from .constant import ConstantAcceleration, ConstantVelocity, LeastSquares, SampledConstantVelocity
from .degraded import DegradedScore, Seen, Task, seen_windows, sweep
from .evaluate import evaluate
from .kalman import Kalman, KalmanAcceleration
from .learned.social_ways_predictor import SocialWays
from .live import Live
from .predictor import Predictor, window_streams
from .recipe import Recipe
from .simulated import Simulated
from .study import Frames, Part, Piece, Result, Study

__all__ = [
    "AnchorNet",
    "Anchors",
    "ConstantAcceleration",
    "ConstantVelocity",
    "DegradedScore",
    "Frames",
    "Kalman",
    "KalmanAcceleration",
    "LeastSquares",
    "Live",
    "Modes",
    "Part",
    "Piece",
    "Predictor",
    "Recipe",
    "Result",
    "SampledConstantVelocity",
    "Seen",
    "Simulated",
    "SocialWays",
    "Study",
    "Task",
    "evaluate",
    "seen_windows",
    "sweep",
    "window_streams",
]

"""Floor 4: where people will be in the next seconds; predictors, and their scores on recordings."""

from crowdbot.benchmark.prediction.evaluate import evaluate
from crowdbot.benchmark.prediction.evaluation import Frames, Part, Piece, Result, Study

from .anchor_net.anchors import Anchors
from .anchor_net.predictor import AnchorNet, Modes
from .constant import ConstantAcceleration, ConstantVelocity, LeastSquares, SampledConstantVelocity
from .degraded import DegradedScore, Seen, Task, seen_windows, sweep
from .kalman import Kalman, KalmanAcceleration
from .live import Live
from .predictor import Predictor, window_streams
from .predictor_spec import Recipe
from .simulated import Simulated
from .social_ways.predictor import SocialWays

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

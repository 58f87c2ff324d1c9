"""Floor 4: where people will be in the next seconds; predictors, and their scores on recordings."""

from .constant import ConstantAcceleration, ConstantVelocity, SampledConstantVelocity
from .evaluate import evaluate
from .kalman import Kalman
from .predictor import Predictor, window_streams
from .recipe import Recipe
from .simulated import Simulated
from .study import Frames, Part, Piece, Result, Study

__all__ = [
    "ConstantAcceleration",
    "ConstantVelocity",
    "Frames",
    "Kalman",
    "Part",
    "Piece",
    "Predictor",
    "Recipe",
    "Result",
    "SampledConstantVelocity",
    "Simulated",
    "Study",
    "evaluate",
    "window_streams",
]

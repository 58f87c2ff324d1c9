"""Floor 4: where people will be in the next seconds; predictors, and their scores on recordings."""

from .constant import ConstantAcceleration, ConstantVelocity, LeastSquares, SampledConstantVelocity
from .evaluate import evaluate
from .kalman import Kalman, KalmanAcceleration
from .predictor import Predictor, window_streams
from .simulated import Simulated

__all__ = [
    "ConstantAcceleration",
    "ConstantVelocity",
    "Kalman",
    "KalmanAcceleration",
    "LeastSquares",
    "Predictor",
    "SampledConstantVelocity",
    "Simulated",
    "evaluate",
    "window_streams",
]

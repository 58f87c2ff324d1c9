"""The prediction tab: recordings, predictors, runs in worker processes, and their results."""

from .example_recordings import EXAMPLES
from .prediction_desk import PredictionDesk, PredictionRun
from .predictor_choice import PredictorChoice

__all__ = ["EXAMPLES", "PredictionDesk", "PredictionRun", "PredictorChoice"]

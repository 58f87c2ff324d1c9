"""Predictors of the next seconds of a crowd, and the training of those that are learned.

``SocialWaysTraining`` loads PyTorch on first use and is therefore not in ``__all__``.

Names are loaded on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.lazy import lazy_exports

if TYPE_CHECKING:
    from .anchor_net import AnchorNet, Anchors, Modes
    from .constant import ConstantAcceleration, ConstantVelocity, LeastSquares, SampledConstantVelocity
    from .contract import check_predictor
    from .degraded import DegradedWindows, degraded_windows
    from .kalman import Kalman, KalmanAcceleration
    from .learned_predictor import LearnedPredictor
    from .learners import WEIGHTS_FIELDS, make_learner
    from .live import Live, LiveReport
    from .predictor import Predictor, window_streams
    from .predictor_spec import PredictorSpec
    from .simulated import Simulated
    from .social_ways import PRESETS, STEADY, SocialWays, SocialWaysConfig
    from .social_ways.training import SocialWaysTraining as SocialWaysTraining
    from .stored_forecasts import forecast_file, forecasts_of
    from .tracker_plausibility import TrackerWarning
    from .training.checkpoint import load_checkpoint, save_checkpoint
    from .training.loop import BEST, LAST, LOG, LogRow, Trainable, TrainingResult, TrainingSchedule, train
    from .training.samples import (
        DataSet,
        Samples,
        TimeSplit,
        leave_out,
        recordings_with_windows,
        short_recordings,
        split_in_time,
    )
    from .training.torch_backend import torch_device, torch_module, torch_threads

__getattr__, __dir__, _ = lazy_exports(__name__)

__all__ = [
    "BEST",
    "LAST",
    "LOG",
    "PRESETS",
    "STEADY",
    "WEIGHTS_FIELDS",
    "AnchorNet",
    "Anchors",
    "ConstantAcceleration",
    "ConstantVelocity",
    "DataSet",
    "DegradedWindows",
    "Kalman",
    "KalmanAcceleration",
    "LearnedPredictor",
    "LeastSquares",
    "Live",
    "LiveReport",
    "LogRow",
    "Modes",
    "Predictor",
    "PredictorSpec",
    "SampledConstantVelocity",
    "Samples",
    "Simulated",
    "SocialWays",
    "SocialWaysConfig",
    "TimeSplit",
    "TrackerWarning",
    "Trainable",
    "TrainingResult",
    "TrainingSchedule",
    "check_predictor",
    "degraded_windows",
    "forecast_file",
    "forecasts_of",
    "leave_out",
    "load_checkpoint",
    "make_learner",
    "recordings_with_windows",
    "save_checkpoint",
    "short_recordings",
    "split_in_time",
    "torch_device",
    "torch_module",
    "torch_threads",
    "train",
    "window_streams",
]

"""Predictors of the next seconds of a crowd, and the training of those that are learned.

``SocialWaysTraining`` loads PyTorch on first use and is therefore not in ``__all__``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .anchor_net import AnchorNet, Anchors, Modes
from .constant import ConstantAcceleration, ConstantVelocity, LeastSquares, SampledConstantVelocity
from .degraded import Seen, seen_windows
from .kalman import Kalman, KalmanAcceleration
from .learned_predictor import LearnedPredictor
from .learners import WEIGHTS_FIELDS, make_learner
from .live import Live
from .predictor import Predictor, window_streams
from .predictor_spec import Recipe
from .simulated import Simulated
from .social_ways import PRESETS, STEADY, SocialWays, SocialWaysConfig
from .training import (
    BEST,
    LAST,
    LOG,
    Row,
    Samples,
    Schedule,
    Trainable,
    Trained,
    device_of,
    leave_out,
    load_checkpoint,
    save_checkpoint,
    short_recordings,
    split_in_time,
    threads,
    torch_module,
    train,
)

if TYPE_CHECKING:
    from .social_ways.training import SocialWaysTraining as SocialWaysTraining

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
    "Kalman",
    "KalmanAcceleration",
    "LearnedPredictor",
    "LeastSquares",
    "Live",
    "Modes",
    "Predictor",
    "Recipe",
    "Row",
    "SampledConstantVelocity",
    "Samples",
    "Schedule",
    "Seen",
    "Simulated",
    "SocialWays",
    "SocialWaysConfig",
    "Trainable",
    "Trained",
    "device_of",
    "leave_out",
    "load_checkpoint",
    "make_learner",
    "save_checkpoint",
    "seen_windows",
    "short_recordings",
    "split_in_time",
    "threads",
    "torch_module",
    "train",
    "window_streams",
]


def __getattr__(name: str) -> Any:
    if name == "SocialWaysTraining":
        from .social_ways.training import SocialWaysTraining

        return SocialWaysTraining
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

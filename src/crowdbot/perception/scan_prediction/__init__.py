"""Prediction of perception: future scans of a laser scanner from past scans. Contract: :class:`ScanPredictor`."""

from .last_scan import LastScan, MovedScan
from .learned_scene import LearnedScene, LearnedState, MotionFit, train_learned_scene
from .scan_predictor import ScanForecast, ScanPredictor, continue_motion
from .tracked_scene import SceneState, TrackedScene, walk_straight

__all__ = [
    "LastScan",
    "LearnedScene",
    "LearnedState",
    "MotionFit",
    "MovedScan",
    "ScanForecast",
    "ScanPredictor",
    "SceneState",
    "TrackedScene",
    "continue_motion",
    "train_learned_scene",
    "walk_straight",
]

"""Perception: people found in raw readings of sensors, and followed over time.

Contracts: :class:`Detector`, :class:`Tracker` and :class:`ScanPredictor`.

Names are loaded on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.lazy import lazy_exports

if TYPE_CHECKING:
    from .camera import BoxDetector, Boxes, HogPeople, NetworkPeople
    from .clusters import CloudClusters, DepthClusters, LidarClusters, hide_walls
    from .detector import Coverage, Detections, Detector
    from .moving_people import MovingPeople
    from .scan_network import NetworkFit, ScanNetwork, train_scan_network
    from .scan_odometry import ScanOdometry, ScanOdometryState
    from .scan_prediction import (
        LastScan,
        LearnedScene,
        LearnedState,
        MotionFit,
        MovedScan,
        ScanForecast,
        ScanPredictor,
        SceneState,
        TrackedScene,
        continue_motion,
        train_learned_scene,
        walk_straight,
    )
    from .track_forecast import predict_uncertain
    from .tracker import Tracker, TrackerState, Tracks
    from .trackers import (
        GlobalNearestNeighbor,
        InteractingMultipleModel,
        JointProbabilisticDataAssociation,
        PredictorMotion,
    )

__getattr__, __dir__, _ = lazy_exports(__name__)

__all__ = [
    "BoxDetector",
    "Boxes",
    "CloudClusters",
    "Coverage",
    "DepthClusters",
    "Detections",
    "Detector",
    "GlobalNearestNeighbor",
    "HogPeople",
    "InteractingMultipleModel",
    "JointProbabilisticDataAssociation",
    "LastScan",
    "LearnedScene",
    "LearnedState",
    "LidarClusters",
    "MotionFit",
    "MovedScan",
    "MovingPeople",
    "NetworkFit",
    "NetworkPeople",
    "PredictorMotion",
    "ScanForecast",
    "ScanNetwork",
    "ScanOdometry",
    "ScanOdometryState",
    "ScanPredictor",
    "SceneState",
    "TrackedScene",
    "Tracker",
    "TrackerState",
    "Tracks",
    "continue_motion",
    "hide_walls",
    "predict_uncertain",
    "train_learned_scene",
    "train_scan_network",
    "walk_straight",
]

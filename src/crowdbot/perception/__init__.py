"""Perception: people found in raw readings of sensors, and followed over time.

Contracts: :class:`Detector`, :class:`Tracker` and :class:`ScanPredictor`.
"""

from .camera import BoxDetector, Boxes, HogPeople, NetworkPeople
from .cloud_clusters import CloudClusters
from .cluster_kernels import hide_walls
from .depth_clusters import DepthClusters
from .detections import Coverage, Detections
from .detector import Detector
from .joint_association import JointProbabilisticDataAssociation
from .lidar_clusters import LidarClusters
from .nearest_neighbor_tracker import GlobalNearestNeighbor, InteractingMultipleModel
from .predictor_motion import PredictorMotion
from .scan_network import NetworkFit, ScanNetwork, train_scan_network
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
from .tracker import Tracker
from .tracker_state import TrackerState
from .tracks import Tracks

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
    "NetworkFit",
    "NetworkPeople",
    "PredictorMotion",
    "ScanForecast",
    "ScanNetwork",
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

"""Perception: people found in raw readings of sensors, and followed over time.

Contracts: :class:`Detector` and :class:`Tracker`.
"""

from .cloud_clusters import CloudClusters
from .detections import Coverage, Detections
from .detector import Detector
from .lidar_clusters import LidarClusters
from .nearest_neighbor_tracker import GlobalNearestNeighbor, InteractingMultipleModel, TrackerState
from .tracker import Tracker
from .tracks import Tracks

__all__ = [
    "CloudClusters",
    "Coverage",
    "Detections",
    "Detector",
    "GlobalNearestNeighbor",
    "InteractingMultipleModel",
    "LidarClusters",
    "Tracker",
    "TrackerState",
    "Tracks",
]

"""Scores of tracks against true people: CLEAR MOT, IDF1, HOTA, OSPA, GOSPA and latency."""

from .occupancy import (
    OccupancyGrid,
    occupancy_iou,
    range_error,
    scan_time_to_collision,
    structural_similarity,
    weighted_squared_error,
)
from .track_comparison import TrackComparison, match_nearest
from .tracking_scores import (
    TRACKING_SCORES,
    ClearMot,
    Hota,
    OcclusionCount,
    clear_mot,
    count_occlusions,
    gospa,
    hota,
    identity_f1,
    ospa,
    track_latency,
    tracking_scores,
)

__all__ = [
    "TRACKING_SCORES",
    "ClearMot",
    "Hota",
    "OcclusionCount",
    "OccupancyGrid",
    "TrackComparison",
    "clear_mot",
    "count_occlusions",
    "gospa",
    "hota",
    "identity_f1",
    "match_nearest",
    "occupancy_iou",
    "ospa",
    "range_error",
    "scan_time_to_collision",
    "structural_similarity",
    "track_latency",
    "tracking_scores",
    "weighted_squared_error",
]

"""Scores of tracks against true people: CLEAR MOT, IDF1, HOTA, OSPA, GOSPA and latency."""

from .clear_mot import ClearMot, clear_mot
from .hota import Hota, hota
from .identity_f1 import identity_f1
from .latency import track_latency
from .ospa import gospa, ospa
from .track_comparison import TrackComparison
from .tracking_scores import TRACKING_SCORES, tracking_scores

__all__ = [
    "TRACKING_SCORES",
    "ClearMot",
    "Hota",
    "TrackComparison",
    "clear_mot",
    "gospa",
    "hota",
    "identity_f1",
    "ospa",
    "track_latency",
    "tracking_scores",
]

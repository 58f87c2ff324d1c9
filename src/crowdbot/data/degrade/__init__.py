"""Degradations: tracking errors added to recordings, as noise, gaps, occlusion, switched, late and false tracks."""

from .chain import Chain
from .correlated_noise import CorrelatedNoise
from .degradation import GHOST, Degradation, DegradedTracks, EmptyRecordingError
from .false_tracks import FalseTracks
from .gaussian_noise import GaussianNoise
from .heavy_tails import HeavyTails
from .identity_switches import IdentitySwitches
from .late_start import LateStart
from .missing_frames import MissingFrames
from .occlusion import Occlusion

__all__ = [
    "GHOST",
    "Chain",
    "CorrelatedNoise",
    "Degradation",
    "DegradedTracks",
    "EmptyRecordingError",
    "FalseTracks",
    "GaussianNoise",
    "HeavyTails",
    "IdentitySwitches",
    "LateStart",
    "MissingFrames",
    "Occlusion",
]

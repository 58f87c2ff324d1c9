"""Scenarios: built-in trials with parameters."""

from .arenas import ARENAS
from .challenge import CHALLENGE
from .crowdnav import CROWDNAV
from .crowds import CROWDS, DENSITIES
from .meetings import MEETINGS
from .preset import Preset, PresetOption, ScenarioCard
from .random_hall import RANDOM
from .rooms import ROOMS
from .shared_ways import SHARED_WAYS

__all__ = ["DENSITIES", "PRESETS", "UNSIMULATED", "Preset", "PresetOption", "ScenarioCard"]

PRESETS = {
    preset.name: preset
    for preset in (*MEETINGS, *ROOMS, *SHARED_WAYS, *CROWDS, *ARENAS, *RANDOM, *CROWDNAV, *CHALLENGE)
}
"""Presets by name."""

UNSIMULATED = {
    "Intersection Gesture Wait": "no activity of people is a sign to wait, and no built-in navigator reads signs",
    "Intersection Gesture Proceed": "no activity of people is a sign to proceed, and no built-in navigator reads signs",
}
"""Scenarios of Francis et al. 2025 that no built-in trial simulates, with the reason."""

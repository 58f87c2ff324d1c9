"""Scenarios: built-in trials with parameters."""

from .arenas import ARENAS
from .challenge import CHALLENGE
from .crowdnav import CROWDNAV
from .crowds import CROWDS, DENSITIES
from .meetings import MEETINGS
from .preset import Preset, PresetOption
from .shared_ways import SHARED_WAYS

__all__ = ["DENSITIES", "PRESETS", "Preset", "PresetOption"]

PRESETS = {preset.name: preset for preset in (*MEETINGS, *SHARED_WAYS, *CROWDS, *ARENAS, *CROWDNAV, *CHALLENGE)}
"""Presets by name."""

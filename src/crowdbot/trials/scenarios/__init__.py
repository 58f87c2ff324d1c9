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

__all__ = ["DENSITIES", "PRESETS", "Preset", "PresetOption", "ScenarioCard"]

PRESETS = {
    preset.name: preset
    for preset in (*MEETINGS, *ROOMS, *SHARED_WAYS, *CROWDS, *ARENAS, *RANDOM, *CROWDNAV, *CHALLENGE)
}
"""Presets by name."""

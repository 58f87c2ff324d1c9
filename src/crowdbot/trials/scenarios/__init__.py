"""Scenarios: the built-in trials that are made from parameters."""

from .challenge import CHALLENGE, FLOWS, SIZES
from .crowds import CROWDS, DENSITIES
from .meetings import MEETINGS
from .preset import Option, Preset

__all__ = ["DENSITIES", "FLOWS", "PRESETS", "SIZES", "Option", "Preset"]

PRESETS = {preset.name: preset for preset in (*MEETINGS, *CROWDS, *CHALLENGE)}
"""Every preset by name."""

"""Emulated people for rehearsals: how they walk, and where they look."""

from .emulated_glances import EmulatedGlances
from .emulated_pedestrian import EmulatedPedestrian
from .emulated_wander import EmulatedWander
from .participant_agent import participant_agent

__all__ = ["EmulatedGlances", "EmulatedPedestrian", "EmulatedWander", "participant_agent"]

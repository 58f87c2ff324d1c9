"""Emulated people for rehearsals: how they walk, and where they look."""

from .emulated_pedestrian import EmulatedGlances, EmulatedPedestrian, EmulatedWander, participant_agent

__all__ = ["EmulatedGlances", "EmulatedPedestrian", "EmulatedWander", "participant_agent"]

"""The experiment on a participant among a crowd and robots with different navigators."""

from .encounter_study import EncounterStudy

__all__ = ["EncounterStudy"]

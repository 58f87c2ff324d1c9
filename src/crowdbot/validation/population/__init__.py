"""Fit of the preset people to recorded tracks and to published values of crowds."""

from .crowd_values import CrowdValues
from .energy_law import EnergyFit, count_energy, find_companions, fit_energy, read_streets, walk_again
from .experiments import FOLDS, RecordedExperiment, read_experiments
from .fit import BOX, Candidate, PopulationFit, set_of
from .predictions import PredictionTable, compare_predictions
from .report import fit_report
from .track_errors import measure_tracks
from .value_profiles import ValueStudy, draw_profiles, study_values, write_study

__all__ = [
    "BOX",
    "FOLDS",
    "Candidate",
    "CrowdValues",
    "EnergyFit",
    "PopulationFit",
    "PredictionTable",
    "RecordedExperiment",
    "ValueStudy",
    "compare_predictions",
    "count_energy",
    "draw_profiles",
    "find_companions",
    "fit_energy",
    "fit_report",
    "measure_tracks",
    "read_experiments",
    "read_streets",
    "set_of",
    "study_values",
    "walk_again",
    "write_study",
]

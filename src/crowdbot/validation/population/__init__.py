"""Fit of the preset people to recorded tracks and to published values of crowds."""

from .crowd_values import CrowdValues
from .experiments import FOLDS, RecordedExperiment, read_experiments
from .fit import BOX, Candidate, PopulationFit, set_of
from .predictions import PredictionTable, compare_predictions
from .report import fit_report
from .track_errors import measure_tracks

__all__ = [
    "BOX",
    "FOLDS",
    "Candidate",
    "CrowdValues",
    "PopulationFit",
    "PredictionTable",
    "RecordedExperiment",
    "compare_predictions",
    "fit_report",
    "measure_tracks",
    "read_experiments",
    "set_of",
]

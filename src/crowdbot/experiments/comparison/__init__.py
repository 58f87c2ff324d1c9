"""Comparison of conditions within participants: measures of trials, paired tests, report."""

from .paired_test import PairedTest, paired_test
from .path_figure import draw_paths
from .study import COLORS, EmulatedPerson, Measure, RecordedTrial, Study, TrialMeasures
from .study_analysis import LOOKING, SETTLING, StudyAnalysis, analyse_study, experiment_of, rating_measures
from .study_report import measures_figure, write_study_report
from .trial_latency import LATENCY_FILE, TrialLatency, read_trial_latency, write_trial_latency
from .view_track import ViewTrack, looking_shares, view_track

__all__ = [
    "COLORS",
    "LATENCY_FILE",
    "LOOKING",
    "SETTLING",
    "EmulatedPerson",
    "Measure",
    "PairedTest",
    "RecordedTrial",
    "Study",
    "StudyAnalysis",
    "TrialLatency",
    "TrialMeasures",
    "ViewTrack",
    "analyse_study",
    "draw_paths",
    "experiment_of",
    "looking_shares",
    "measures_figure",
    "paired_test",
    "rating_measures",
    "read_trial_latency",
    "view_track",
    "write_study_report",
    "write_trial_latency",
]

"""Evaluation of predictors of scans on logged scans."""

from .scan_plot import plot_scan_scores
from .scan_protocol import SOGMP, ScanProtocol
from .scan_scores import SCAN_SCORES, ScanScores, TruePeople, score_scans

__all__ = ["SCAN_SCORES", "SOGMP", "ScanProtocol", "ScanScores", "TruePeople", "plot_scan_scores", "score_scans"]

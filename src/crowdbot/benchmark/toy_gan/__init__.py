"""Comparison of GANs against mode collapse on toy data.

The module ``training`` imports PyTorch; nothing else here does.
"""

from .methods import METHODS
from .plots import plot_measures, plot_samples
from .study import GanComparison, GanRun, with_settings

__all__ = ["METHODS", "GanComparison", "GanRun", "plot_measures", "plot_samples", "with_settings"]

"""Comparison of GANs against mode collapse on toy data.

The module ``training`` imports PyTorch; nothing else here does.
"""

from .methods import METHODS
from .plots import plot_measures, plot_samples
from .study import Run, ToyStudy, with_values

__all__ = ["METHODS", "Run", "ToyStudy", "plot_measures", "plot_samples", "with_values"]

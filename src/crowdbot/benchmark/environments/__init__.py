"""Speed of simulations of many environments, with navground and ir-sim in the same run."""

from .report import EnvironmentReport, measure_environments
from .rows import EnvironmentRow, PeerRate
from .sizes import BenchmarkSizes

__all__ = ["BenchmarkSizes", "EnvironmentReport", "EnvironmentRow", "PeerRate", "measure_environments"]

"""Speed measurements, the rows of ``crowdbot bench``."""

from .timing import SpeedRow, measure
from .workloads import measurements

__all__ = ["SpeedRow", "measure", "measurements"]

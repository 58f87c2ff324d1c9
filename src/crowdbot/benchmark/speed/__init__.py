"""Speed measurements, the rows of ``crowdbot bench``."""

from .measurement import Gauge, Measurement
from .timing import SpeedRow, measure
from .workloads import measurements

__all__ = ["Gauge", "Measurement", "SpeedRow", "measure", "measurements"]

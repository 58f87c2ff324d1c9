"""Speed of crowd models beside other engines: the same people, time step and neighbours, in one run."""

from .engine_row import EngineRow, MillionRow
from .report import EngineReport, EngineSizes, measure_engines

__all__ = ["EngineReport", "EngineRow", "EngineSizes", "MillionRow", "measure_engines"]

"""Speed measurements, and how robots follow velocity commands in the physics world.

Names are loaded on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.lazy import lazy_exports

__getattr__, __dir__, __all__ = lazy_exports(__name__)

if TYPE_CHECKING:
    from .drives import DRIVE_BARS as DRIVE_BARS
    from .drives import DRIVE_COLUMNS as DRIVE_COLUMNS
    from .drives import DriveFigures as DriveFigures
    from .drives import DriveReport as DriveReport
    from .drives import DriveRow as DriveRow
    from .drives import DriveTrace as DriveTrace
    from .drives import Manoeuvre as Manoeuvre
    from .drives import compare_traces as compare_traces
    from .drives import grid_cells as grid_cells
    from .drives import manoeuvres as manoeuvres
    from .drives import measure_drives as measure_drives
    from .drives import speed_grid as speed_grid
    from .drives import trace_physics as trace_physics
    from .drives import trace_planar as trace_planar
    from .engines import EngineReport as EngineReport
    from .engines import EngineRow as EngineRow
    from .engines import EngineSizes as EngineSizes
    from .engines import MillionRow as MillionRow
    from .engines import measure_engines as measure_engines
    from .environments import BenchmarkSizes as BenchmarkSizes
    from .environments import EnvironmentReport as EnvironmentReport
    from .environments import EnvironmentRow as EnvironmentRow
    from .environments import PeerRate as PeerRate
    from .environments import measure_environments as measure_environments
    from .speed import Gauge as Gauge
    from .speed import Measurement as Measurement
    from .speed import SpeedRow as SpeedRow
    from .speed import measure as measure
    from .speed import measurements as measurements

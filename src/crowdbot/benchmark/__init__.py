"""Speed measurements, and how robots follow velocity commands in the physics world.

Names are loaded on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.lazy import lazy_exports

__getattr__, __dir__, __all__ = lazy_exports(__name__)

if TYPE_CHECKING:
    from .drives.figures import DRIVE_COLUMNS as DRIVE_COLUMNS
    from .drives.figures import DriveFigures as DriveFigures
    from .drives.figures import compare_traces as compare_traces
    from .drives.figures import grid_cells as grid_cells
    from .drives.laboratory import DRIVE_BARS as DRIVE_BARS
    from .drives.laboratory import DriveReport as DriveReport
    from .drives.laboratory import DriveRow as DriveRow
    from .drives.laboratory import measure_drives as measure_drives
    from .drives.traces import DriveTrace as DriveTrace
    from .drives.traces import Manoeuvre as Manoeuvre
    from .drives.traces import manoeuvres as manoeuvres
    from .drives.traces import speed_grid as speed_grid
    from .drives.traces import trace_physics as trace_physics
    from .drives.traces import trace_planar as trace_planar
    from .engines.report import EngineReport as EngineReport
    from .engines.report import EngineRow as EngineRow
    from .engines.report import EngineSizes as EngineSizes
    from .engines.report import MillionRow as MillionRow
    from .engines.report import measure_engines as measure_engines
    from .environments.report import BenchmarkSizes as BenchmarkSizes
    from .environments.report import EnvironmentReport as EnvironmentReport
    from .environments.report import EnvironmentRow as EnvironmentRow
    from .environments.report import PeerRate as PeerRate
    from .environments.report import measure_environments as measure_environments
    from .environments.work_rate import WorkRate as WorkRate
    from .speed.measurement import Gauge as Gauge
    from .speed.measurement import Measurement as Measurement
    from .speed.timing import SpeedRow as SpeedRow
    from .speed.timing import measure as measure
    from .speed.workloads import measurements as measurements

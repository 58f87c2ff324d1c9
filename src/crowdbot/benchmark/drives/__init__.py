"""The drive laboratory: how robots follow velocity commands in the physics world, beside the planar world."""

from .figures import DRIVE_COLUMNS, DriveFigures, compare_traces, grid_cells
from .laboratory import DRIVE_BARS, DriveReport, DriveRow, measure_drives
from .manoeuvre import Manoeuvre, manoeuvres, speed_grid
from .traces import DriveTrace, trace_physics, trace_planar

__all__ = [
    "DRIVE_BARS",
    "DRIVE_COLUMNS",
    "DriveFigures",
    "DriveReport",
    "DriveRow",
    "DriveTrace",
    "Manoeuvre",
    "compare_traces",
    "grid_cells",
    "manoeuvres",
    "measure_drives",
    "speed_grid",
    "trace_physics",
    "trace_planar",
]

"""Recordings of people: readers, writers and windows; and forecasts."""

from .example import example_windows
from .file_formats import FORMATS, load
from .forecast import Forecast
from .mcap_reader import MCAP_MAGIC, McapError, McapOpcode, McapReader, has_summary, read_attachment
from .motion import fill_gaps, observed_velocity, slice_rows, steady_velocity
from .protocols import PROTOCOLS
from .readers.time_base import RowRateError
from .readers.ucy import TO_METRES as UCY_TO_METRES
from .recording import Recording
from .track_writers import save
from .trajectories import PrimaryScene, Trajectories
from .walkable import walkable_rings
from .windows import Windows

__all__ = [
    "FORMATS",
    "MCAP_MAGIC",
    "PROTOCOLS",
    "UCY_TO_METRES",
    "Forecast",
    "McapError",
    "McapOpcode",
    "McapReader",
    "PrimaryScene",
    "Recording",
    "RowRateError",
    "Trajectories",
    "Windows",
    "example_windows",
    "fill_gaps",
    "has_summary",
    "load",
    "observed_velocity",
    "read_attachment",
    "save",
    "slice_rows",
    "steady_velocity",
    "walkable_rings",
]

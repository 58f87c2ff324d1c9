"""Floor 1: recordings of people, read, cut into windows and written; and forecasts of where they go."""

from .forecast import Forecast
from .load import FORMATS, load
from .mcap_reader import MCAP_MAGIC, McapError, McapOpcode, McapReader, has_summary, read_attachment
from .motion import fill_gaps, observed_velocity, slice_rows, steady_velocity
from .protocols import PROTOCOLS
from .recording import Recording
from .save import save
from .time_base import RowRateError
from .trajectories import PrimaryScene, Trajectories
from .ucy import TO_METRES as UCY_TO_METRES
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
    "fill_gaps",
    "has_summary",
    "load",
    "observed_velocity",
    "read_attachment",
    "save",
    "slice_rows",
    "steady_velocity",
]

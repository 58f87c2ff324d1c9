"""Floor 1: recordings of people, read, cut into windows and written; and forecasts of where they go."""

from .forecast import Forecast
from .load import FORMATS, load
from .motion import bridged, observed_velocity, slice_rows, steady_velocity
from .protocols import PROTOCOLS
from .recording import Recording
from .save import save
from .tape import MAGIC, Kind, Tape, TapeError, attachment, is_whole
from .time_base import RowRateError
from .trajectories import PrimaryScene, Trajectories
from .ucy import TO_METRES as UCY_TO_METRES
from .windows import Windows

__all__ = [
    "FORMATS",
    "MAGIC",
    "PROTOCOLS",
    "UCY_TO_METRES",
    "Forecast",
    "Kind",
    "PrimaryScene",
    "Recording",
    "RowRateError",
    "Tape",
    "TapeError",
    "Trajectories",
    "Windows",
    "attachment",
    "bridged",
    "is_whole",
    "load",
    "observed_velocity",
    "save",
    "slice_rows",
    "steady_velocity",
]

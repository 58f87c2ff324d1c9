"""Floor 1: recordings of people, read, cut into windows and written; and forecasts of where they go."""

from .cut import PROTOCOLS
from .forecast import Forecast
from .load import FORMATS, load
from .recording import Recording
from .save import save
from .trajectories import PrimaryScene, Trajectories
from .ucy import TO_METRES as UCY_TO_METRES
from .windows import Windows

__all__ = [
    "FORMATS",
    "PROTOCOLS",
    "UCY_TO_METRES",
    "Forecast",
    "PrimaryScene",
    "Recording",
    "Trajectories",
    "Windows",
    "load",
    "save",
]

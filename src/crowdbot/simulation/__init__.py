"""Simulation: a trial and a seed become an episode. Contract :class:`Simulation`, verb ``run``."""

from .batch import run_batch
from .episode import Episode, Log, ScanRow, scan_row, tracks_of
from .overrides import apply_overrides
from .runner import Bridge, Running, Sink, Stop, drive, simulate, stopping
from .simulation import WALL, Carrier, Frame, Simulation, Touch
from .statistics import Digest, Summary, Tally, robot_metrics
from .world_builder import start_scene

__all__ = [
    "WALL",
    "Bridge",
    "Carrier",
    "Digest",
    "Episode",
    "Frame",
    "Log",
    "Running",
    "ScanRow",
    "Simulation",
    "Sink",
    "Stop",
    "Summary",
    "Tally",
    "Touch",
    "apply_overrides",
    "drive",
    "robot_metrics",
    "run_batch",
    "scan_row",
    "simulate",
    "start_scene",
    "stopping",
    "tracks_of",
]

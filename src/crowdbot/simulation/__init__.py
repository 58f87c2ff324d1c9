"""Simulation of a trial with a seed; the result is an episode."""

from .batch import run_batch
from .episode import Episode, EpisodeLog, ScanRow, scan_row, tracks_of
from .failure import RunFailure, RunFailureWarning
from .overrides import apply_overrides
from .runner import Bridge, SimulationRun, Sink, StopRequest, catch_interrupt, run_to_end, simulate, warn_of_failure
from .simulation import WALL, RobotContact, RobotRuntime, Simulation, StepRecord
from .statistics import EpisodeDigest, EpisodeStatistics, RunSummary, robot_metrics
from .world_builder import start_scene

__all__ = [
    "WALL",
    "Bridge",
    "Episode",
    "EpisodeDigest",
    "EpisodeLog",
    "EpisodeStatistics",
    "RobotContact",
    "RobotRuntime",
    "RunFailure",
    "RunFailureWarning",
    "RunSummary",
    "ScanRow",
    "Simulation",
    "SimulationRun",
    "Sink",
    "StepRecord",
    "StopRequest",
    "apply_overrides",
    "catch_interrupt",
    "robot_metrics",
    "run_batch",
    "run_to_end",
    "scan_row",
    "simulate",
    "start_scene",
    "tracks_of",
    "warn_of_failure",
]

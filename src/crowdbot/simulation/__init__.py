"""Simulation of a trial with a seed; the result is an episode."""

from .episode import Episode, ScanRow, log_of, scan_row, tracks_of
from .episode_digest import EpisodeDigest
from .episode_log import EpisodeLog
from .failure import RunFailure, RunFailureWarning
from .orders import MissedDecisionOrder, Order, VelocityOrder, order_kinds, read_order, write_order
from .overrides import apply_overrides
from .parameter_order import ParameterOrder
from .people_orders import AddPersonOrder, MoveOrder, RedirectOrder, RemoveOrder
from .robot_control import RobotControl
from .runner import catch_interrupt, run_to_end, simulate, simulate_seeds, warn_of_failure
from .simulation import Simulation
from .simulation_run import BatchSink, OrderSource, RunEnd, RunSnapshot, SimulationRun, Sink, StopRequest
from .statistics import EpisodeStatistics, RunSummary, robot_metrics
from .step_batch import BatchReadings, StepBatch
from .step_record import WALL, RobotContact, StepRecord
from .world_builder import start_scene

__all__ = [
    "WALL",
    "AddPersonOrder",
    "BatchReadings",
    "BatchSink",
    "Episode",
    "EpisodeDigest",
    "EpisodeLog",
    "EpisodeStatistics",
    "MissedDecisionOrder",
    "MoveOrder",
    "Order",
    "OrderSource",
    "ParameterOrder",
    "RedirectOrder",
    "RemoveOrder",
    "RobotContact",
    "RobotControl",
    "RunEnd",
    "RunFailure",
    "RunFailureWarning",
    "RunSnapshot",
    "RunSummary",
    "ScanRow",
    "Simulation",
    "SimulationRun",
    "Sink",
    "StepBatch",
    "StepRecord",
    "StopRequest",
    "VelocityOrder",
    "apply_overrides",
    "catch_interrupt",
    "log_of",
    "order_kinds",
    "read_order",
    "robot_metrics",
    "run_to_end",
    "scan_row",
    "simulate",
    "simulate_seeds",
    "start_scene",
    "tracks_of",
    "warn_of_failure",
    "write_order",
]

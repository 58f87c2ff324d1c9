"""Simulation of a trial with a seed; the result is an episode."""

from .avatar_order import AvatarOrder
from .episode import Episode, EpisodeLog, ScanRow, scan_row, tracks_of
from .external_robots import UncommandedRobotWarning
from .failure import RunFailure, RunFailureWarning
from .goal_order import GoalOrder
from .joint_order import JointOrder
from .orders import MissedDecisionOrder, Order, VelocityOrder, order_kinds, read_order, write_order
from .overrides import apply_overrides
from .parameter_order import ParameterOrder
from .people_orders import AddPersonOrder, MoveOrder, RedirectOrder, RemoveOrder
from .robot_control import RobotControl
from .runner import catch_interrupt, run_to_end, simulate, simulate_seeds, warn_of_failure
from .simulation import Simulation
from .simulation_run import OrderSource, RunEnd, RunSnapshot, SimulationRun, Sink, StopRequest
from .statistics import EpisodeDigest, EpisodeStatistics, RunSummary, robot_metrics
from .step_record import WALL, RobotContact, StepRecord
from .world_builder import start_scene

__all__ = [
    "WALL",
    "AddPersonOrder",
    "AvatarOrder",
    "Episode",
    "EpisodeDigest",
    "EpisodeLog",
    "EpisodeStatistics",
    "GoalOrder",
    "JointOrder",
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
    "StepRecord",
    "StopRequest",
    "UncommandedRobotWarning",
    "VelocityOrder",
    "apply_overrides",
    "catch_interrupt",
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
